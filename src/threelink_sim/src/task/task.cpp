#include "threelink_sim/task/task.hpp"

#include "threelink_sim/environment.hpp"

namespace threelink_sim {

SwimmerState start_state(const Model& model, const Start& start, std::uint64_t seed,
                         std::uint32_t episode) {
  if (start.random) return random_start(model, seed, episode);
  HingeVector alpha = start.alpha;
  if (alpha.size() == 0) alpha.setZero(model.hinges());
  return state_from_free_end(model, start.x_1, start.theta_1, alpha);
}

}  // namespace threelink_sim
