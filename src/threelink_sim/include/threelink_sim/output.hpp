/// @file
/// What command-line tools write: whole or not at all, and never in silence.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace threelink_sim {

/// A file that is to be written at the end of some work. All that can be known before the work is
/// refused before it.
class OutputFile {
 public:
  /// `option` is what the path is called in messages; `inputs` are files that must not be
  /// overwritten. Throws UsageError if path is one of them, by whatever name or link, if it is a
  /// folder, or if it or its folder cannot be written.
  OutputFile(std::string option, std::string path, const std::vector<std::string>& inputs = {});

  /// By write_file(), through links; a device or pipe just gets the bytes. Throws FileError.
  void write(std::string_view bytes) const;
  const std::string& path() const { return path_; }

 private:
  std::string option_, path_;
};

/// Runs a command-line tool: returns what `work` returns, 2 for UsageError and
/// std::invalid_argument, 1 for another exception, after one sentence on standard error. If
/// standard output did not take all that was printed (closed, full), that is said, and the status
/// is 1. A closed pipe does not end the process, so that `work` can save what it has.
int run_tool(const char* name, const std::function<int()>& work);

/// Whether standard output has taken all that was printed.
bool flush_stdout();

}  // namespace threelink_sim
