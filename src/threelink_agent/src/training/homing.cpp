#include "threelink_agent/training/homing.hpp"

#include <algorithm>
#include <cmath>

#include "threelink_sim/random.hpp"

namespace threelink_agent {

using threelink_sim::Random;
using threelink_sim::Stream;

HomingTargets::HomingTargets(const HomingConfig& config, std::uint64_t seed,
                             std::uint32_t first_episode, threelink_sim::Environment& environment)
    : config_(config),
      seed_(seed),
      first_episode_(first_episode),
      environment_(environment),
      has_point_(environment.lanes()),
      points_(environment.lanes()) {
  for (std::size_t i = 0; i < has_point_.size(); ++i) {
    Random random(seed_, Stream::kTarget, first_episode_ + i);
    has_point_[i] = random.uniform() > config_.direction_share;
    if (has_point_[i]) draw(i, random);
  }
}

void HomingTargets::draw(std::size_t i, Random& random) {
  const double distance =
      std::exp(random.uniform(std::log(config_.nearest), std::log(config_.farthest)));
  const double bearing = random.uniform(-threelink_sim::kPi, threelink_sim::kPi);
  const threelink_sim::Batch& batch = environment_.batch();
  points_[i] = {batch.x()[i] + distance * std::cos(bearing),
                batch.y()[i] + distance * std::sin(bearing)};
  environment_.aim(i, points_[i]);
}

void HomingTargets::after_step(std::uint32_t k, float* rewards, std::uint8_t* captured) {
  const double b = environment_.config().b, c = environment_.config().c;
  std::copy_n(environment_.rewards(), has_point_.size(), rewards);
  std::fill_n(captured, has_point_.size(), 0);
  for (std::size_t i = 0; i < has_point_.size(); ++i) {
    if (!has_point_[i]) continue;
    const double before = environment_.distance(i);
    environment_.aim(i, points_[i]);
    const double now = environment_.distance(i);
    captured[i] = now < config_.threshold;
    rewards[i] = static_cast<float>(b * (before - now) - c * environment_.batch().work()[i] +
                                    captured[i] * config_.bonus);
    if (!captured[i]) continue;
    Random random(seed_, Stream::kTarget, first_episode_ + i, k + 1);
    draw(i, random);
  }
}

}  // namespace threelink_agent
