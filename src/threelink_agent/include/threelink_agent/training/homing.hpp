// Points to reach, in the distribution of the training's episodes.
//
// The reward of a direction says to swim on, past a point. In an episode with points it is instead
// b (r_k - r_{k+1}) - c W with r the distance to the point, and a bonus on the capture. That is an
// end: its return is cut there, as nothing of the future depends on the action, and a new point is
// drawn for the rest of the episode.
#pragma once

#include <cstdint>
#include <vector>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/range.hpp"

namespace threelink_agent {

struct HomingConfig {
  // What the policy is shown. The critic, which only training needs, is shown "target" always.
  threelink_sim::ObservationKind observation = threelink_sim::ObservationKind::kTarget;
  double direction_share = 0;
  double nearest = 0;
  double farthest = 0;
  double threshold = 0;
  double bonus = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    using threelink_sim::Range;
    visit("observation", self.observation, "what the policy is shown");
    visit("direction_share", self.direction_share, Range<double>{0, 1},
          "of the episodes, without points, towards theta_T = 0");
    visit("nearest", self.nearest, Range<double>{1e-9, 1e3},
          "[L] a point's distance when it is drawn: log-uniform, from this");
    visit("farthest", self.farthest, Range<double>{1e-9, 1e3}, "[L] to this, at any bearing");
    visit("threshold", self.threshold, Range<double>{1e-9, 1e3}, "[L] nearer than this: captured");
    visit("bonus", self.bonus, Range<double>{0, 1e6}, "reward of the capture");
  }
};

// The targets of episodes first .. first + lanes - 1 in the lanes of an environment, at rest in
// their states 0. Points are keyed by (seed, episode, step at which they are drawn).
class HomingTargets {
 public:
  HomingTargets(const HomingConfig& config, std::uint64_t seed, std::uint32_t first_episode,
                threelink_sim::Environment& environment);

  // After step k of all lanes, and before state k + 1 is observed: rewards (lanes) of the step, and
  // whether it ended in a capture.
  void after_step(std::uint32_t k, float* rewards, std::uint8_t* captured);

 private:
  void draw(std::size_t i, threelink_sim::Random& random);

  HomingConfig config_;
  std::uint64_t seed_;
  std::uint32_t first_episode_;
  threelink_sim::Environment& environment_;
  std::vector<char> has_point_;
  std::vector<Eigen::Vector2d> points_;  // [L]
};

}  // namespace threelink_agent
