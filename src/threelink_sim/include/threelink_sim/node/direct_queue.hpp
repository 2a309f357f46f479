/// @file
/// A callback queue without a queue: callbacks run at once, in the thread in which they arise. For
/// messages that is roscpp's network thread.
///
/// The usual way, in which the network thread wakes up another one, and that one wakes it up again
/// to send the answer, takes more than half of the time of a closed loop over topics. To be used
/// for a loop's own subscriptions,
///   node.setCallbackQueue(&direct_queue);
/// by callbacks that are short, lock what they share with other threads, do not throw, and neither
/// subscribe nor unsubscribe.
#pragma once

#include <ros/callback_queue_interface.h>

namespace threelink_sim {

class DirectQueue : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, uint64_t) override {
    callback->call();
  }
  void removeByID(uint64_t) override {}
};

}  // namespace threelink_sim
