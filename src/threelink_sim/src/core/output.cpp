#include "threelink_sim/output.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "threelink_sim/files.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {
namespace {

namespace fs = std::filesystem;

constexpr int kFailure = 1, kMisuse = 2;

std::string reason() { return std::generic_category().message(errno); }

// The file that a path leads to, through links, even if it is not there yet.
std::string target_of(const std::string& path) {
  std::error_code none;
  fs::path target = path;
  constexpr int kMostLinks = 40;
  for (int i = 0; i < kMostLinks && fs::is_symlink(target, none); ++i) {
    const fs::path next = fs::read_symlink(target, none);
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

// A file that the process opens would take the place of a standard stream that is closed, and what
// is printed would go into it. What takes it here cannot be written.
void occupy_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) return;
}

// Unlike fmt::print() this does not throw where nobody takes it.
void complain(const std::string& text) { std::fputs(text.c_str(), stderr); }

int run_guarded(const char* name, const std::function<int()>& work) {
  const auto fail = [name](int status, const std::string& reason) {
    // A failure to print is told at the end.
    if (!std::ferror(stdout)) complain(fmt::format("{}: {}\n", name, reason));
    return status;
  };
  try {
    return work();
  } catch (const UsageError& error) {
    return fail(kMisuse, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(kMisuse, error.what());
  } catch (const std::exception& error) {
    return fail(kFailure, error.what());
  }
}

}  // namespace

OutputFile::OutputFile(std::string option, std::string path, const std::vector<std::string>& inputs)
    : option_(std::move(option)), path_(std::move(path)) {
  const auto refuse = [&](const std::string& reason) {
    throw UsageError(fmt::format("{} {}: {}", option_, path_, reason));
  };
  if (path_.empty()) refuse("is empty, must be the name of a file");
  struct stat own {};
  if (::stat(path_.c_str(), &own) == 0) {
    if (S_ISDIR(own.st_mode)) refuse("is a folder");
    if (::access(path_.c_str(), W_OK) != 0) refuse("cannot be written: " + reason());
    for (const std::string& input : inputs) {
      struct stat other {};
      if (::stat(input.c_str(), &other) == 0 && other.st_dev == own.st_dev &&
          other.st_ino == own.st_ino && S_ISREG(own.st_mode))
        refuse(fmt::format("is the same file as {}, which would be overwritten", input));
    }
    if (!S_ISREG(own.st_mode)) return;
  } else if (errno != ENOENT) {
    refuse("cannot be written: " + reason());
  }
  const fs::path target = target_of(path_);
  if (!target.has_filename()) refuse("is a folder");
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(fmt::format("cannot be written: {}: {}", folder, reason()));
}

void OutputFile::write(std::string_view bytes) const {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0 || S_ISREG(status.st_mode)) {
    write_file(target_of(path_), bytes);
    return;
  }
  const Descriptor descriptor(path_, O_WRONLY);
  if (!descriptor || !write_all(descriptor.get(), bytes))
    throw FileError(fmt::format("{}: cannot write {} bytes: {}", path_, bytes.size(), reason()));
}

bool flush_stdout() {
  std::cout.flush();
  return std::fflush(stdout) == 0 && !std::ferror(stdout);
}

int run_tool(const char* name, const std::function<int()>& work) {
  occupy_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  const int status = run_guarded(name, work);
  errno = 0;
  if (flush_stdout()) return status;
  // The write that failed may be an earlier one, and errno another's.
  complain(fmt::format("{}: standard output cannot be written{}\n", name,
                       errno != 0 ? ": " + reason() : ""));
  return status == 0 ? kFailure : status;
}

}  // namespace threelink_sim
