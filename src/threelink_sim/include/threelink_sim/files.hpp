/// @file
/// Reading and writing of whole files.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace threelink_sim {

/// Error for a file that cannot be read or written. what() names path, reason and, if relevant, the
/// number of bytes; it never quotes the content.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owns a file descriptor, or -1 for none, and closes it.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  /// Opens a file with O_CLOEXEC. On failure the descriptor is -1 and errno gives the reason.
  Descriptor(const std::string& path, int flags, unsigned mode = 0666);
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : value_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    reset(other.release());
    return *this;
  }

  int get() const { return value_; }
  explicit operator bool() const { return value_ >= 0; }
  int release() {
    const int value = value_;
    value_ = -1;
    return value;
  }
  void reset(int value = -1);

 private:
  int value_ = -1;
};

/// Reads a regular file of at most max_bytes. Throws FileError, also for a pipe or a device.
std::string read_file(const std::string& path, std::size_t max_bytes);

/// The same for a file that the user named. Throws UsageError.
std::string read_input(const std::string& path, std::size_t max_bytes);

/// Writes a file atomically: after a crash or power cut at any moment there is either the old file
/// or the new one. Writes a temporary file in the same folder, syncs it, renames it, and syncs the
/// folder. Throws FileError; the old file then remains. A new file keeps the permissions of the
/// file that it replaces.
void write_file(const std::string& path, std::string_view bytes);

/// Whether a name has the form FILE.DIGITS.tmp that write_file() gives to temporary files, which a
/// crash can leave behind.
bool is_temporary_name(const std::string& name);

/// Writes all bytes. On failure returns false, and errno gives the reason.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace threelink_sim
