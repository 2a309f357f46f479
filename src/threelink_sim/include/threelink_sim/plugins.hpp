/// @file
/// Tasks and flows of other packages, found by pluginlib.
#pragma once

namespace threelink_sim {

/// Registers (task_factory.hpp, world/flow.hpp) every task and every flow that a package of the
/// workspace exports with
///   <export><threelink_tasks plugin="${prefix}/FILE.xml"/></export>  (tasks)
///   <export><threelink_sim plugin="${prefix}/FILE.xml"/></export>    (flows)
/// by its name in that file, as soon as one is asked for that is not one of ours: to look for them
/// takes a while. The names of our own tasks and flows stay ours. The library of a plug-in is
/// loaded when it is made; if that fails, making it throws UsageError. Does nothing in a shell
/// where no workspace is sourced.
void load_plugins();

}  // namespace threelink_sim
