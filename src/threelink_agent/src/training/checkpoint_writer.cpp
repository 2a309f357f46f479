#include "threelink_agent/training/checkpoint_writer.hpp"

#include <utility>

namespace threelink_agent {
CheckpointWriter::CheckpointWriter(std::function<void(const Checkpoint&)> write)
    : write_(std::move(write)), thread_([this] { run(); }) {}

CheckpointWriter::~CheckpointWriter() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CheckpointWriter::put(Checkpoint checkpoint) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_ = std::move(checkpoint);
  changed_.notify_all();
}

void CheckpointWriter::wait() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return !waiting_ && !busy_; });
}

void CheckpointWriter::check() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void CheckpointWriter::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return waiting_ || ending_; });
    if (ending_) return;
    const Checkpoint checkpoint = *std::exchange(waiting_, std::nullopt);
    busy_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
      write_(checkpoint);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace threelink_agent
