/// @file
/// The state of a node on /diagnostics, once a second of wall time, independent of /clock.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>

#include "threelink_sim/mutex.hpp"

namespace threelink_sim {

/// Publishes the level, values and counters of a node.
class Diagnostics {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  /// Adds the node's own values and its level: `seconds` is the wall time since the last report.
  using Report = std::function<void(Status& status, double seconds)>;

  /// The status is named "NODE: title". Everything runs in the global callback queue.
  Diagnostics(const std::string& title, const std::string& hardware_id, Report report);

  /// A counter that is shown under its name; initially zero. May be increased from any thread.
  using Counter = std::atomic<std::uint64_t>;
  /// The counter of that name. The reference is valid as long as this object.
  Counter& counter(const std::string& name);
  /// A counter that also sets the level WARN whenever it has grown since the last report.
  Counter& refusals(const std::string& name);

  /// Publishes immediately, for the last report before the node ends.
  void publish() { updater_.force_update(); }

 private:
  struct Entry {
    Entry(const std::string& name, bool warns) : name(name), warns(warns) {}
    std::string name;
    bool warns;
    Counter value{0};
    std::uint64_t reported = 0;
  };

  Counter& entry(const std::string& name, bool warns);
  void update(Status& status);

  Report report_;
  Mutex mutex_;  ///< guards the entries, since a node may still be under construction
  std::deque<Entry> entries_ GUARDED_BY(mutex_);
  ros::SteadyTime last_;
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace threelink_sim
