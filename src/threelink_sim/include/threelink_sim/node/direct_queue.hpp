/// @file
/// A callback queue that runs callbacks immediately in the calling thread, which for messages is
/// roscpp's network thread.
///
/// In the usual way the network thread wakes another thread, which wakes it again to send the
/// answer; this takes more than half of the time of a closed loop over topics. Use it for the
/// subscriptions of a loop by node.setCallbackQueue(&direct_queue). The callbacks must be short,
/// lock the data that they share with other threads, not throw, and neither subscribe nor
/// unsubscribe.
#pragma once

#include <ros/callback_queue_interface.h>

namespace threelink_sim {

/// The queue; it holds nothing.
class DirectQueue : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, uint64_t) override {
    callback->call();
  }
  void removeByID(uint64_t) override {}
};

}  // namespace threelink_sim
