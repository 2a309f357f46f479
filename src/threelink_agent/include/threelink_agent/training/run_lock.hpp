/// @file
/// One process a run.
#pragma once

#include <string>

#include "threelink_sim/files.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_agent {

/// A folder that cannot be used for a run; what() names it and the reason.
class RunFolderError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

/// Holds FOLDER/run.lock, which names the process, by flock(2): the system drops the lock with the
/// process, however it ends. The file stays.
class RunLock {
 public:
  static constexpr char kFile[] = "run.lock";

  /// Throws RunFolderError at once, naming the process that holds the lock, or the reason.
  explicit RunLock(const std::string& folder);

 private:
  threelink_sim::Descriptor file_;
};

}  // namespace threelink_agent
