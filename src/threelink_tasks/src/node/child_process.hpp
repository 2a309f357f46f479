// A program that runs beside the node.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace threelink_tasks {

class ChildProcess {
 public:
  // Starts arguments[0] (a path) with the lowest priority. Throws std::runtime_error if it cannot.
  explicit ChildProcess(const std::vector<std::string>& arguments);
  // Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Its exit status, 128 + signal if one ended it; nothing while it runs.
  std::optional<int> poll();

 private:
  pid_t pid_;
  std::optional<int> status_;
};

// FOLDER_OF_THIS_PROGRAM/name: scripts lie beside the nodes, in devel space as in install space.
std::string beside_this_program(const std::string& name);

}  // namespace threelink_tasks
