// Whole files in, whole files out.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace threelink_agent {

// A file that cannot be read or written; what() names path, reason and, where it matters, bytes.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The bytes of a regular file of at most max_bytes.
std::string read_file(const std::string& path, std::size_t max_bytes);

// Puts bytes at path so that a crash or power cut at any moment leaves the old file or the new one:
// writes a temporary file in the same folder, syncs it, renames it, syncs the folder. A failure
// leaves the old file as it was.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace threelink_agent
