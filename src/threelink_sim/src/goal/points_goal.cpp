// points: a point at a log-uniform distance in [nearest, farthest] and any bearing; once it is
// captured, another one, from where the swimmer is. All are keyed by (seed, episode, step at which
// they are drawn). A share of the episodes has none and goes on towards theta_T = 0.
#include <algorithm>
#include <cmath>
#include <vector>

#include "goal_kinds.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {
namespace {

class PointsGoals : public Goals {
 public:
  PointsGoals(const PointsGoal& config, std::uint64_t seed, std::uint32_t first_episode,
              Environment& environment)
      : config_(config),
        seed_(seed),
        first_episode_(first_episode),
        environment_(environment),
        has_point_(environment.lanes()),
        points_(environment.lanes()) {
    for (std::size_t i = 0; i < has_point_.size(); ++i) {
      Random random(seed_, Stream::kTarget, episode(i));
      has_point_[i] = random.uniform() > config_.direction_share;
      if (has_point_[i]) draw(i, random);
    }
  }

  void after_step(std::uint32_t k, float* rewards, std::uint8_t* captured) override {
    const double b = environment_.config().b, c = environment_.config().c;
    std::copy_n(environment_.rewards(), has_point_.size(), rewards);
    std::fill_n(captured, has_point_.size(), 0);
    for (std::size_t i = 0; i < has_point_.size(); ++i) {
      if (!has_point_[i]) continue;
      const double before = environment_.distance(i);
      environment_.aim(i, points_[i]);
      const double now = environment_.distance(i);
      captured[i] = now < config_.threshold;
      rewards[i] = static_cast<float>(b * (before - now) - c * environment_.effort(i) +
                                      captured[i] * config_.bonus);
      if (!captured[i]) continue;
      Random random(seed_, Stream::kTarget, episode(i), k + 1);
      draw(i, random);
    }
  }

 private:
  std::uint32_t episode(std::size_t i) const {
    return first_episode_ + static_cast<std::uint32_t>(i);
  }

  void draw(std::size_t i, Random& random) {
    const double distance =
        std::exp(random.uniform(std::log(config_.nearest), std::log(config_.farthest)));
    const double bearing = random.uniform(-kPi, kPi);
    points_[i] =
        environment_.centroid(i) + distance * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    environment_.aim(i, points_[i]);
  }

  PointsGoal config_;
  std::uint64_t seed_;
  std::uint32_t first_episode_;
  Environment& environment_;
  std::vector<char> has_point_;
  std::vector<Eigen::Vector2d> points_;  // [L]
};

}  // namespace

std::unique_ptr<Goals> make_points_goals(const PointsGoal& config, std::uint64_t seed,
                                         std::uint32_t first_episode, Environment& environment) {
  return std::make_unique<PointsGoals>(config, seed, first_episode, environment);
}

}  // namespace threelink_sim
