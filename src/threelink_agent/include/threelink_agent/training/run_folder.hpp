/// @file
/// The folder of a run: the files that a training writes and resumes from.
///
///   config.yaml                      the effective configuration
///   metrics.csv                      one row for each update
///   checkpoint_<update>.safetensors  the newest kCheckpointsKept
///   policy.safetensors               the best policy by evaluation
///   last.safetensors                 the policy of the last update, once the training has ended
///   run.lock                         held while a process trains
///
/// At whatever moment a process is killed or the power is lost, a resumed run ends with the same
/// files as an uninterrupted one: all files but metrics.csv are replaced atomically, metrics.csv is
/// on the disk before the checkpoint that holds its length, and rows after that length are removed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "threelink_agent/training/checkpoint.hpp"
#include "threelink_agent/training/checkpoint_writer.hpp"
#include "threelink_agent/training/metrics_file.hpp"
#include "threelink_agent/training/run_lock.hpp"
#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

/// Number of checkpoints that remain in the folder.
constexpr int kCheckpointsKept = 3;

/// The open folder of a run; holds its lock.
class RunFolder {
 public:
  enum class Opening {
    kNew,     ///< the folder must be empty or absent
    kResume,  ///< continues the run in the folder; begins one if there is none
  };

  /// Locks the folder, which is created if needed, and finds the newest valid checkpoint.
  ///
  /// Throws RunFolderError if the folder cannot be used as wanted. An existing run must have the
  /// same backend and the same configuration, including the number of episodes, because the
  /// schedules depend on it; the message names the difference with both values.
  RunFolder(const std::filesystem::path& path, Opening opening, const TrainConfig& config,
            const std::string& backend);

  /// The checkpoint to continue from; empty for a new run.
  const std::optional<Checkpoint>& checkpoint() const { return checkpoint_; }
  /// The reasons why newer checkpoints were skipped.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// To be called once before the first add(): removes rows and files that are newer than the
  /// checkpoint. Throws FileError.
  void begin();

  /// Appends a row to metrics.csv. seconds: wall time of the run; steps_per_s: of this update.
  /// Throws FileError if the row cannot be written, in which case it is written with the next one,
  /// or if the last checkpoint could not be written.
  void add(const UpdateReport& report, double seconds, double steps_per_s);

  /// Writes checkpoint and best policy in the background. No effect while rows of metrics.csv wait
  /// to be written.
  void save(const Trainer& trainer, double seconds);

  /// Writes the last checkpoint and both policies unless they are written already, and waits.
  /// Throws FileError.
  void finish(const Trainer& trainer, double seconds);

  std::filesystem::path policy_path() const { return path_ / "policy.safetensors"; }
  std::filesystem::path last_path() const { return path_ / "last.safetensors"; }

 private:
  std::filesystem::path metrics_path() const { return path_ / "metrics.csv"; }
  std::filesystem::path config_path() const { return path_ / "config.yaml"; }
  bool holds_a_run() const { return std::filesystem::exists(config_path()); }
  void refuse_strangers(Opening opening) const;
  void find_checkpoint();
  void put(const Trainer& trainer, double seconds);
  void write(const Checkpoint& checkpoint);

  std::filesystem::path path_;
  TrainConfig config_;
  std::string backend_;
  std::unique_ptr<RunLock> lock_;
  std::optional<Checkpoint> checkpoint_;
  std::vector<std::string> warnings_;
  std::unique_ptr<MetricsFile> metrics_;
  std::optional<std::uint32_t> newest_;  ///< update of the last checkpoint read or given to writer_
  std::unique_ptr<CheckpointWriter> writer_;  ///< last member, destroyed first
};

}  // namespace threelink_agent
