/// @file
/// An episode of a training that is played by a swimmer in another process: the simulator node, or
/// a robot.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "threelink_agent/training/rollout.hpp"

namespace threelink_agent {

/// The lock-step (docs/nodes.md) from the view of agent and task, as a state machine without ROS:
///
///   state(0), observation(0) -> rates(), state(1), .., state(N_s), observation(N_s): done()
///
/// Only the constructor allocates.
class LiveEpisode {
 public:
  /// Result of a message.
  enum class Verdict {
    kAccepted,
    kStale,      ///< a repetition
    kFuture,     ///< a step was missed, or taken without an answer of this agent: the episode is
                 ///< invalid
    kMalformed,  ///< wrong number of values, or one that is not finite or too large: the episode is
                 ///< invalid
    kNotOurs,    ///< the step was taken with rates other than rates(): the episode is invalid
  };

  /// Episode i of the rollout. Play and rollout must outlive it.
  LiveEpisode(const Play& play, int i, Rollout& rollout);

  /// state(step): hinge angles, the reward of the step that led there and the rates of that step,
  /// all as in SwimmerState. Once it is accepted, publish its target.
  Verdict state(std::uint64_t step, const std::vector<double>& alpha,
                const std::vector<double>& applied, double reward);
  /// The observation of that state, values as in Observation. Once it is accepted, publish rates()
  /// unless done().
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
  bool begun_ = false;     ///< state(0) has arrived
  bool observed_ = false;  ///< observation(step_) has arrived
  bool done_ = false;
  std::vector<double> rates_;
};

/// The first difference of episode i of a Rollout or an EpisodeBatch from the episode that
/// collect() plays, as "reward 3 is .., and should be .."; empty if they are equal to the bit. The
/// first episode has the number play.first_episode.
template <class Episodes>
std::string difference_from_collect(const Play& play, const Episodes& episodes, int i);

}  // namespace threelink_agent
