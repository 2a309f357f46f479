/// @file
/// Tasks of other packages, found by pluginlib.
#pragma once

namespace threelink_sim {

/// Registers (task_factory.hpp) every task that a package of the workspace exports with
///   <export><threelink_tasks plugin="${prefix}/FILE.xml"/></export>
/// by its name in that file, as soon as a task is asked for that is not one of ours: to look for
/// them takes a while. So the names of our own tasks stay ours. Its library is loaded when the task
/// is made; if that fails, making it throws UsageError. Does nothing in a shell where no workspace
/// is sourced.
void load_task_plugins();

}  // namespace threelink_sim
