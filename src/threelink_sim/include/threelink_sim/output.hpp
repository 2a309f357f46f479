/// @file
/// Output of command-line tools: files are written completely or not at all, and a failure is
/// reported.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace threelink_sim {

/// A file to be written at the end of some work. Errors that can be detected before the work are
/// reported before it.
class OutputFile {
 public:
  /// `option` is the name of the path in messages; `inputs` are files that must not be overwritten.
  /// Throws UsageError if the path denotes one of them, under any name or link, if it is a folder,
  /// or if it or its folder is not writable.
  OutputFile(std::string option, std::string path, const std::vector<std::string>& inputs = {});

  /// Writes by write_file(), through links; to a device or pipe the bytes are simply written.
  /// Throws FileError.
  void write(std::string_view bytes) const;
  const std::string& path() const { return path_; }

 private:
  std::string option_, path_;
};

/// Runs a command-line tool: returns what `work` returns, 2 for UsageError and
/// std::invalid_argument, 1 for another exception, after one sentence on standard error. If
/// standard output did not accept everything (closed, full), this is reported and the status is 1.
/// A closed pipe does not end the process, so that `work` can save its results.
int run_tool(const char* name, const std::function<int()>& work);

/// Flushes standard output. Returns whether it accepted everything.
bool flush_stdout();

}  // namespace threelink_sim
