/// @file
/// An episode of a training, played by a swimmer that is elsewhere: the simulator node, or a robot.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// The lock-step (docs/nodes.md) as agent and task see it, as a state machine without ROS:
///
///   state(0), observation(0) -> rates(), state(1), .., state(N_s), observation(N_s): done()
///
/// Does not allocate but when it is made.
class LiveEpisode {
 public:
  /// What becomes of a message.
  enum class Verdict {
    kAccepted,
    kStale,      ///< a repetition
    kFuture,     ///< a step was missed, or taken without an answer of ours: the episode is spoilt
    kMalformed,  ///< wrong number of values, or one that is not finite or too large: likewise
    kNotOurs,    ///< the step was taken with other rates than rates(): likewise
  };

  /// Episode i of the rollout. Play and rollout must outlive it.
  LiveEpisode(const Play& play, int i, Rollout& rollout);

  /// state(step): hinge angles, the reward of the step that led there and the rates of that step,
  /// all as in SwimmerState. Once it is accepted, its target is to be given.
  Verdict state(std::uint64_t step, const std::vector<double>& alpha,
                const std::vector<double>& applied, double reward);
  /// What is seen of it, values as in Observation. Once it is accepted, rates() are to be given,
  /// unless the episode is done.
  Verdict observation(std::uint64_t step, const std::vector<double>& values);

  bool done() const { return done_; }
  std::uint64_t step() const { return step_; }                 ///< of the last state
  const std::vector<double>& rates() const { return rates_; }  ///< [1/T0] clipped to [-1, 1]

 private:
  bool applied_ours(const std::vector<double>& alpha, const std::vector<double>& applied) const;

  RolloutActor actor_;
  double joint_limit_;
  std::uint64_t steps_;
  std::size_t inputs_;
  std::uint64_t step_ = 0;
  bool begun_ = false;     ///< state(0) has come
  bool observed_ = false;  ///< observation(step_) has come
  bool done_ = false;
  std::vector<double> rates_;
};

/// In which number episode i of a Rollout or an EpisodeBatch differs from the one that collect()
/// plays, as "reward 3 is .., and should be .."; empty if they are the same to the bit. The first
/// episode has the number play.first_episode.
template <class Episodes>
std::string difference_from_collect(const Play& play, const Episodes& episodes, int i);

}  // namespace threelink_agent
