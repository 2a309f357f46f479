/// @file
/// Checkpoints on a thread of their own, so that training never waits for a disk.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "threelink_agent/training/checkpoint.hpp"

namespace threelink_agent {

/// Hands checkpoints to `write` one after the other. While one is being written, at most one waits,
/// the newest: syncing to a slow disk takes longer than an update, and a checkpoint that a newer
/// one is about to replace is worth nothing.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(std::function<void(const Checkpoint&)> write);
  /// Finishes the one that is being written, and drops the one that waits.
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  void put(Checkpoint checkpoint);
  /// Until all are written.
  void wait();
  /// Throws what the newest write threw, once.
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
