// One process a run.
#pragma once

#include <stdexcept>
#include <string>

namespace threelink_agent {

// A folder that cannot be used for a run; what() names it and the reason.
class RunFolderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Holds FOLDER/run.lock, which names the process, by flock(2): the system drops the lock with the
// process, however it ends. The file stays.
class RunLock {
 public:
  static constexpr char kFile[] = "run.lock";

  // Throws RunFolderError at once, naming the process that holds the lock, or the reason.
  explicit RunLock(const std::string& folder);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace threelink_agent
