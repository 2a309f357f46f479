/// @file
/// The folder of a run: what a training writes, and what it goes on from.
///
///   config.yaml                      the effective configuration
///   metrics.csv                      a row an update
///   checkpoint_<update>.safetensors  the newest kCheckpointsKept
///   policy.safetensors               the best policy by evaluation
///   last.safetensors                 the policy of the last update, once the training has ended
///   run.lock                         held while a process trains
///
/// Whatever the moment at which a process is killed, or the power lost, a resumed run ends with the
/// same files as an unbroken one: all but metrics.csv are replaced whole, metrics.csv is on the
/// disk before the checkpoint that counts its bytes, and what a checkpoint does not know of is
/// undone.
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

constexpr int kCheckpointsKept = 3;

class RunFolder {
 public:
  enum class Opening {
    kNew,     ///< the folder must be empty, or not there
    kResume,  ///< goes on with the run that is there; begins one if there is none
  };

  /// Locks the folder, made if needed, and finds the newest checkpoint that verifies.
  ///
  /// Throws RunFolderError if the folder cannot be used as wanted. A run that is there must have
  /// the same configuration, since schedules depend on all of it, the number of episodes too, and
  /// the same backend; the message names what differs, and both values.
  RunFolder(const std::filesystem::path& path, Opening opening, const TrainConfig& config,
            const std::string& backend);

  /// Where to go on; nothing for a run that begins.
  const std::optional<Checkpoint>& checkpoint() const { return checkpoint_; }
  /// What is wrong with newer checkpoints that had to be passed over.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// To be called once, before the first add(): what the checkpoint does not know of is undone.
  /// Throws FileError.
  void begin();

  /// Appends a row to metrics.csv. seconds: wall time of the run; steps_per_s: of this update.
  /// Throws FileError if it cannot be written, and then writes it with the next one; or if the last
  /// checkpoint could not be written.
  void add(const UpdateReport& report, double seconds, double steps_per_s);

  /// Has checkpoint and best policy written in the background; without effect while rows of
  /// metrics.csv wait to be written.
  void save(const Trainer& trainer, double seconds);

  /// Writes the last checkpoint and both policies, those that are not there yet, and waits for
  /// them. Throws FileError.
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
  std::unique_ptr<CheckpointWriter> writer_;  ///< last, to be gone first
};

}  // namespace threelink_agent
