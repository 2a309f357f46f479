// Bags that were left open because their writer died.
#pragma once

#include <filesystem>
#include <vector>

#include "episode_index.hpp"

namespace threelink_tasks {

// Those in a folder that nobody writes any more; a folder that cannot be read holds none.
std::vector<std::filesystem::path> leftover_bags(const std::filesystem::path& folder);

// Turns NAME.bag.active into NAME_recovered.bag with every message that reached the file, and says
// what is in it. Throws std::runtime_error or rosbag::BagException if that fails; the leftover then
// stays.
IndexRow recover_leftover(const std::filesystem::path& leftover);

}  // namespace threelink_tasks
