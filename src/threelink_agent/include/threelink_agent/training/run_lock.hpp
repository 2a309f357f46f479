/// @file
/// A lock that lets only one process train in a folder.
#pragma once

#include <string>

#include "threelink_sim/files.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_agent {

/// Error for a folder that cannot be used for a run. what() names it and the reason.
class RunFolderError : public threelink_sim::UsageError {
 public:
  using UsageError::UsageError;
};

/// Holds FOLDER/run.lock, which contains the process number, by flock(2): the system releases the
/// lock when the process ends in any way. The file remains.
class RunLock {
 public:
  static constexpr char kFile[] = "run.lock";

  /// Does not wait: throws RunFolderError that names the process that holds the lock, or another
  /// reason.
  explicit RunLock(const std::string& folder);

 private:
  threelink_sim::Descriptor file_;
};

}  // namespace threelink_agent
