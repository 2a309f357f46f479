// The goals that have a target; each is described in its own file.
#pragma once

#include <cstdint>
#include <memory>

#include "threelink_sim/goal/goals.hpp"

namespace threelink_sim {

// The swimmers are in their first states.
std::unique_ptr<Goals> make_points_goals(const PointsGoal& config, std::uint64_t seed,
                                         std::uint32_t first_episode, Environment& environment);
std::unique_ptr<Goals> make_task_goals(const TaskGoal& config, std::uint64_t seed,
                                       std::uint32_t first_episode, Environment& environment);

}  // namespace threelink_sim
