#include "threelink_agent/training/run_lock.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace threelink_agent {
namespace {

// Nobody but its holder is to write into this file: whatever else it holds is not shown.
std::string process_in(int descriptor) {
  char text[16];
  const ssize_t got = ::pread(descriptor, text, sizeof(text), 0);
  const std::string process(text, text + std::max<ssize_t>(got, 0));
  const bool digits = process.find_first_not_of("0123456789") == std::string::npos;
  return digits && !process.empty() ? "process " + process : "another process";
}

}  // namespace

RunLock::RunLock(const std::string& folder) {
  const std::string path = fmt::format("{}/{}", folder, kFile);
  const auto refuse = [&](const std::string& reason) {
    return RunFolderError(
        fmt::format("{}: {}: {}", path, reason, std::generic_category().message(errno)));
  };
  // O_NOFOLLOW: through a link it would empty a file of somebody else.
  file_ = threelink_sim::Descriptor(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK);
  if (!file_) throw refuse("cannot be written");
  if (::flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) throw refuse("cannot be locked");
    throw RunFolderError(fmt::format("{}: is in use by {}", folder, process_in(file_.get())));
  }
  const std::string process = fmt::format("{}", ::getpid());
  if (::ftruncate(file_.get(), 0) != 0 || ::pwrite(file_.get(), process.data(), process.size(),
                                                   0) != static_cast<ssize_t>(process.size()))
    throw refuse(fmt::format("cannot write {} bytes", process.size()));
}

}  // namespace threelink_agent
