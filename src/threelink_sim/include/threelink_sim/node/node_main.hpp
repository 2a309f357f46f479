/// @file
/// The main function of every node: start, signals, loss of the master, errors, exit status.
#pragma once

#include <functional>
#include <string>

#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

/// Exit status of a node.
enum ExitStatus : int {
  kSuccess = 0,
  kFailure = 1,      ///< an error of the node itself
  kBadInput = 2,     ///< UsageError: bad arguments, parameters or files
  kMasterLost = 75,  ///< no ROS master, or it was lost (EX_TEMPFAIL: a retry may succeed)
  kShutDown = 76,    ///< ended by another node's `shutdown`: rosnode kill, or a node of its name
};

/// Name and help of a node.
struct NodeDescription {
  std::string name;        ///< default name of the node
  std::string help;        ///< topics, services and parameters, for --help
  bool anonymous = false;  ///< make the name unique by a suffix
  /// [s] time after SIGINT or SIGTERM after which the process is ended in any case; 0: no limit.
  /// For nodes without data that could be lost.
  double patience = 0;
};

/// Runs body() between ros::start() and ros::shutdown(), and returns the exit status: that of
/// body(), or one of the above. body() constructs the node and must return soon after running()
/// becomes false.
///
///   --help           prints the description and returns kSuccess; needs no master
///   SIGINT, SIGTERM  turn running() false; ROS is up until body() has returned
///   master           must answer within 5 s at the start; when it has not known this node for 3 s,
///                    ROS is shut down, running() turns false, and the status is kMasterLost
///   shutdown         by another node turns running() false, and the status is kShutDown
int run_node(int argc, char** argv, const NodeDescription& description,
             const std::function<int()>& body);

/// Returns false once the node has to end.
bool running();

/// Serves the global callback queue until the node has to end; returns kSuccess.
int spin();

}  // namespace threelink_sim
