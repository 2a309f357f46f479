// The tasks of this package; each is described in its own file.
#pragma once

#include <memory>

#include "threelink_sim/task/task.hpp"

namespace threelink_sim {

std::unique_ptr<Task> make_clicked_point();
std::unique_ptr<Task> make_direction();
std::unique_ptr<Task> make_path();
std::unique_ptr<Task> make_point();
std::unique_ptr<Task> make_pursuit();
std::unique_ptr<Task> make_waypoints();

}  // namespace threelink_sim
