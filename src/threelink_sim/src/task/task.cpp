#include "threelink_sim/task/task.hpp"

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

SwimmerState start_state(const EnvironmentConfig& config, const Start& start, std::uint64_t seed,
                         std::uint32_t episode) {
  if (start.random) return random_start(config, seed, episode);
  HingeVector alpha = start.alpha;
  if (alpha.size() == 0) alpha.setZero(config.model.hinges());
  return state_from_free_end(config.model, start.x_1, start.theta_1, alpha);
}

}  // namespace threelink_sim
