// Bags that were left open because their writer died.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "episode_index.hpp"

namespace threelink_tasks {

// Those in a folder that nobody writes any more; a folder that cannot be read holds none.
std::vector<std::filesystem::path> leftover_bags(const std::filesystem::path& folder);

// Turns NAME.bag.active into NAME_recovered.bag with every message that reached the file, lists it
// in episodes.csv, and says what is in it: nothing if the file was empty, or whole but for its
// name. Throws std::runtime_error or rosbag::BagException if that fails; the leftover then stays.
std::optional<IndexRow> recover_leftover(const std::filesystem::path& leftover);

}  // namespace threelink_tasks
