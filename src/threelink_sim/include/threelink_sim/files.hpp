/// @file
/// Whole files in, whole files out.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace threelink_sim {

/// A file that cannot be read or written; what() names path, reason and, where it matters, bytes.
/// It never quotes what the file holds.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file descriptor, or -1 for none; closes it.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  /// Opens with O_CLOEXEC. errno says why there is none.
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

/// The bytes of a regular file of at most max_bytes; throws FileError. Neither waits for whoever
/// writes a pipe nor reads from a device.
std::string read_file(const std::string& path, std::size_t max_bytes);

/// The same for a file that the user has named; throws UsageError.
std::string read_input(const std::string& path, std::size_t max_bytes);

/// Puts bytes at path so that a crash or power cut at any moment leaves the old file or the new
/// one: writes a temporary file in the same folder, syncs it, renames it, syncs the folder. A
/// failure leaves the old file as it was; throws FileError. A new file keeps the permissions of the
/// one that it replaces.
void write_file(const std::string& path, std::string_view bytes);

/// Whether a name is one that write_file() gives to a temporary file, which a crash leaves behind:
/// FILE.DIGITS.tmp.
bool is_temporary_name(const std::string& name);

/// All bytes; false if that fails, and errno says why.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace threelink_sim
