/// @file
/// Tasks of other packages, which pluginlib finds.
#pragma once

namespace threelink_sim {

/// Registers (task_factory.hpp) every task that a package of the workspace exports with
///   <export><threelink_tasks plugin="${prefix}/FILE.xml"/></export>
/// under its name in that file. The search takes some time and is made when a task is first
/// requested that this package does not have; built-in names therefore cannot be replaced. The
/// library is loaded when the task is made; if that fails, make_task() throws UsageError. Without a
/// sourced workspace the function does nothing.
void load_task_plugins();

}  // namespace threelink_sim
