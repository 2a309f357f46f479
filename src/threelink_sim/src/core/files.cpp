#include "threelink_sim/files.hpp"

#include <cerrno>
#include <filesystem>
#include <random>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {
namespace {

constexpr char kTemporary[] = ".tmp";

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw FileError(fmt::format("{}: {}: {}", path, what, std::generic_category().message(error)));
}

void sync_folder(const std::filesystem::path& file) {
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  const Descriptor descriptor(folder, O_RDONLY | O_DIRECTORY);
  if (!descriptor) fail(folder, "cannot open the folder", errno);
  // Some file systems cannot sync a folder, and say so.
  if (::fsync(descriptor.get()) != 0 && errno != EINVAL)
    fail(folder, "cannot sync the folder", errno);
}

// A new file under a name that nobody can have foreseen; errno says why there is none.
Descriptor create_temporary(const std::string& path, std::string& name) {
  std::random_device random;
  Descriptor descriptor;
  for (int attempt = 0; attempt < 10; ++attempt) {
    name = fmt::format("{}.{:010}{:010}{}", path, random(), random(), kTemporary);
    descriptor = Descriptor(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW);
    if (descriptor || errno != EEXIST) break;
  }
  return descriptor;
}

// Null if all went well, else what failed; errno says why.
const char* write_and_rename(const Descriptor& descriptor, const std::string& temporary,
                             const std::string& path, std::string_view bytes) {
  struct stat old {};
  const bool replaces = ::stat(path.c_str(), &old) == 0 && S_ISREG(old.st_mode);
  if (replaces && ::fchmod(descriptor.get(), old.st_mode & 0777) != 0 && errno != EPERM)
    return "cannot set the permissions of";
  if (!write_all(descriptor.get(), bytes)) return "cannot write";
  if (::fsync(descriptor.get()) != 0) return "cannot sync";
  if (::rename(temporary.c_str(), path.c_str()) != 0) return "cannot rename";
  return nullptr;
}

}  // namespace

Descriptor::Descriptor(const std::string& path, int flags, unsigned mode)
    : value_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}

void Descriptor::reset(int value) {
  if (value_ >= 0) ::close(value_);
  value_ = value;
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const Descriptor descriptor(path, O_RDONLY | O_NONBLOCK);
  if (!descriptor) fail(path, "cannot open", errno);
  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0) fail(path, "cannot read", errno);
  if (!S_ISREG(status.st_mode)) throw FileError(path + ": not a file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > max_bytes)
    throw FileError(fmt::format("{}: {} bytes, at most {} are allowed", path, size, max_bytes));
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(descriptor.get(), &bytes[done], size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot read", errno);
    if (got == 0) throw FileError(path + ": became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

std::string read_input(const std::string& path, std::size_t max_bytes) {
  try {
    return read_file(path, max_bytes);
  } catch (const FileError& error) {
    throw UsageError(error.what());
  }
}

void write_file(const std::string& path, std::string_view bytes) {
  std::string temporary;
  const Descriptor descriptor = create_temporary(path, temporary);
  if (!descriptor) fail(path, fmt::format("cannot create {} bytes", bytes.size()).c_str(), errno);
  if (const char* failed = write_and_rename(descriptor, temporary, path, bytes)) {
    const int error = errno;
    ::unlink(temporary.c_str());
    fail(path, fmt::format("{} {} bytes", failed, bytes.size()).c_str(), error);
  }
  sync_folder(path);
}

bool is_temporary_name(const std::string& name) {
  const std::filesystem::path path(name);
  const std::string digits = path.stem().extension().string();
  return path.extension() == kTemporary && digits.size() > 1 &&
         digits.find_first_not_of("0123456789", 1) == std::string::npos;
}

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace threelink_sim
