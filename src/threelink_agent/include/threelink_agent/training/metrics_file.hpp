/// @file
/// metrics.csv: a row an update.
#pragma once

#include <cstdint>
#include <string>

#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_agent {

/// Rows reach the file whole or not at all: one that cannot be written is kept and tried again with
/// the next. Not for several threads, but sync() may be called from another one.
class MetricsFile {
 public:
  /// A new file with nothing but its header; one that was there is emptied.
  explicit MetricsFile(const std::string& path);
  /// Goes on behind the first `bytes` bytes of a file; rows after them are cut off. Throws
  /// FileError if it is shorter.
  MetricsFile(const std::string& path, std::uint64_t bytes);

  /// seconds: wall time since the start; steps_per_s: of this update. Throws FileError.
  void add(const UpdateReport& report, double seconds, double steps_per_s);

  /// Writes the rows that are kept. Throws FileError.
  void flush();
  bool flushed() const { return kept_.empty(); }
  /// Length after the last row that was written.
  std::uint64_t bytes() const { return bytes_; }

  /// Puts what was written onto the disk. Throws FileError.
  void sync() const;

 private:
  std::string path_;
  threelink_sim::Descriptor file_;
  std::uint64_t bytes_ = 0;
  std::string kept_;
};

}  // namespace threelink_agent
