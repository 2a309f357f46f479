// What the fuzz harnesses share. A harness hands its input to a reader and lets through the errors
// which that reader promises; any other exception ends the program, as a crash does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace threelink_fuzz {

// Calls read(), which may throw any of these errors.
template <class Error, class... Others, class Read>
void value_or(const Read& read) {
  try {
    if constexpr (sizeof...(Others) == 0)
      read();
    else
      value_or<Others...>(read);
  } catch (const Error&) {
  }
}

inline std::string text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// For what must hold of every value that a reader accepts.
inline void require(bool condition, const char* what) {
  if (!condition) throw std::logic_error(what);
}

// A folder in memory for readers that want a path; empty at the start and removed at the end.
class ScratchFolder {
 public:
  ScratchFolder()
      : path_(std::filesystem::path("/dev/shm") / ("threelink_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directory(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::string file(const std::string& name, const std::uint8_t* data, std::size_t size) const {
    const std::string path = path_ / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace threelink_fuzz
