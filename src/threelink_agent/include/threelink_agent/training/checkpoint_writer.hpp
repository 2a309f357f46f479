/// @file
/// Writes checkpoints on a separate thread, so that training never waits for a disk.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "threelink_agent/training/checkpoint.hpp"

namespace threelink_agent {

/// Calls `write` for one checkpoint after the other. While one is being written, only the newest of
/// the later ones waits: a sync to a slow disk takes longer than an update, and a checkpoint that a
/// newer one is about to replace is not needed.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(std::function<void(const Checkpoint&)> write);
  /// Waits for the write in progress and discards the waiting checkpoint.
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  void put(Checkpoint checkpoint);
  /// Waits until all checkpoints are written.
  void wait();
  /// Throws the exception of the newest write, once.
  void check();

 private:
  void run();

  std::function<void(const Checkpoint&)> write_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Checkpoint> waiting_;
  bool busy_ = false, ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace threelink_agent
