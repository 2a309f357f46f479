#include "threelink_agent/files.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace threelink_agent {
namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw FileError(fmt::format("{}: {}: {}", path, what, std::generic_category().message(error)));
}

// Closes what it holds.
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : value_(::open(path.c_str(), flags, 0666)) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }

 private:
  int value_;
};

void sync_folder(const std::filesystem::path& file) {
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  const Descriptor descriptor(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor.value() < 0) fail(folder, "cannot open the folder", errno);
  // Some file systems cannot sync a folder, and say so.
  if (::fsync(descriptor.value()) != 0 && errno != EINVAL)
    fail(folder, "cannot sync the folder", errno);
}

// Null if all went well, else what failed; errno says why.
const char* write_and_sync(const std::string& path, std::string_view bytes) {
  const Descriptor descriptor(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  if (descriptor.value() < 0) return "cannot create";
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor.value(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return "cannot write";
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(descriptor.value()) != 0) return "cannot sync";
  return nullptr;
}

}  // namespace

std::string read_file(const std::string& path, std::size_t max_bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const Descriptor descriptor(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor.value() < 0) fail(path, "cannot open", errno);
  struct stat status {};
  if (::fstat(descriptor.value(), &status) != 0) fail(path, "cannot read", errno);
  if (!S_ISREG(status.st_mode)) throw FileError(path + ": not a file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > max_bytes)
    throw FileError(fmt::format("{}: {} bytes, at most {} are allowed", path, size, max_bytes));
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(descriptor.value(), &bytes[done], size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot read", errno);
    if (got == 0) throw FileError(path + ": became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

void write_file(const std::string& path, std::string_view bytes) {
  const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
  const char* failed = write_and_sync(temporary, bytes);
  if (!failed && ::rename(temporary.c_str(), path.c_str()) != 0) failed = "cannot rename";
  if (failed) {
    const int error = errno;
    ::unlink(temporary.c_str());
    fail(path, fmt::format("{} {} bytes", failed, bytes.size()).c_str(), error);
  }
  sync_folder(path);
}

}  // namespace threelink_agent
