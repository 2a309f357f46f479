#include "threelink_agent/training/run_lock.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace threelink_agent {
namespace {

std::string process_in(int descriptor) {
  char text[32];
  const ssize_t got = ::pread(descriptor, text, sizeof(text), 0);
  return got > 0 ? fmt::format("process {}", std::string(text, text + got)) : "another process";
}

}  // namespace

RunLock::RunLock(const std::string& folder) {
  const std::string path = fmt::format("{}/{}", folder, kFile);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw RunFolderError(
        fmt::format("{}: cannot be written: {}", path, std::generic_category().message(errno)));
  const auto refuse = [&](const std::string& reason) {
    ::close(descriptor_);
    return RunFolderError(reason);
  };
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    throw refuse(error == EWOULDBLOCK
                     ? fmt::format("{}: is in use by {}", folder, process_in(descriptor_))
                     : fmt::format("{}: cannot be locked: {}", path,
                                   std::generic_category().message(error)));
  }
  const std::string process = fmt::format("{}", ::getpid());
  const auto size = static_cast<ssize_t>(process.size());
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::pwrite(descriptor_, process.data(), process.size(), 0) != size)
    throw refuse(fmt::format("{}: cannot write {} bytes: {}", path, size,
                             std::generic_category().message(errno)));
}

RunLock::~RunLock() { ::close(descriptor_); }

}  // namespace threelink_agent
