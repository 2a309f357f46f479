/// @file
/// metrics.csv: one row for each update.
#pragma once

#include <cstdint>
#include <string>

#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_agent {

/// Rows reach the file completely or not at all: a row that cannot be written is kept and written
/// with the next one. Not thread-safe, except that another thread may call sync().
class MetricsFile {
 public:
  /// Creates a file with only the header, or empties an existing one.
  explicit MetricsFile(const std::string& path);
  /// Continues after the first `bytes` bytes of a file; later rows are removed. Throws FileError if
  /// it is shorter.
  MetricsFile(const std::string& path, std::uint64_t bytes);

  /// Adds a row. seconds: wall time since the start; steps_per_s: of this update. Throws FileError.
  void add(const UpdateReport& report, double seconds, double steps_per_s);

  /// Writes the kept rows. Throws FileError.
  void flush();
  bool flushed() const { return kept_.empty(); }
  /// Length after the last row that was written.
  std::uint64_t bytes() const { return bytes_; }

  /// Syncs the written rows to the disk. Throws FileError.
  void sync() const;

 private:
  std::string path_;
  threelink_sim::Descriptor file_;
  std::uint64_t bytes_ = 0;
  std::string kept_;
};

}  // namespace threelink_agent
