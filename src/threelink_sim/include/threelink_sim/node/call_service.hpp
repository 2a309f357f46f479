/// @file
/// Calls of services with a time limit: roscpp itself waits for an answer forever, unless the
/// connection breaks.
#pragma once

#include <chrono>
#include <future>

#include <ros/service_client.h>

#include "threelink_sim/node/node_main.hpp"

namespace threelink_sim {

/// Result of a call.
enum class Called { kAnswered, kFailed, kTooLate, kEnding };

/// Calls a service. Gives up after `seconds` of wall time or when the node has to end; `client` can
/// then no longer be used.
template <class Service>
Called call_service(ros::ServiceClient& client, Service& service, double seconds) {
  using Clock = std::chrono::steady_clock;
  auto answered = std::async(std::launch::async, [&] { return client.call(service); });
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  bool late = false;
  while (answered.wait_for(std::chrono::milliseconds(2)) != std::future_status::ready) {
    late = Clock::now() > deadline;
    if (late || !running()) client.shutdown();  // breaks the connection, and so ends the call
  }
  if (!running()) return Called::kEnding;
  if (answered.get()) return Called::kAnswered;
  return late ? Called::kTooLate : Called::kFailed;
}

}  // namespace threelink_sim
