// The simulator of a recorded episode, as the episode's own configuration says.
#pragma once

#include "../core/bag_reader.hpp"
#include "threelink_sim/node/simulator_config.hpp"

namespace threelink_tasks {

// Throws BagError if the bag holds no episode, and UsageError if that does not say.
threelink_sim::SimulatorConfig recorded_swimmer(const BagReader& bag);

}  // namespace threelink_tasks
