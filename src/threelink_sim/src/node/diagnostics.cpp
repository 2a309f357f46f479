#include "threelink_sim/node/diagnostics.hpp"

#include <utility>

namespace threelink_sim {

using diagnostic_msgs::DiagnosticStatus;

Diagnostics::Diagnostics(const std::string& title, const std::string& hardware_id, Report report)
    : report_(std::move(report)), last_(ros::SteadyTime::now()) {
  updater_.setHardwareID(hardware_id);
  updater_.add(title, this, &Diagnostics::update);
  // The updater's own period goes by ros::Time, which stands still between episodes.
  timer_ = ros::NodeHandle().createSteadyTimer(
      ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) { updater_.force_update(); });
}

Diagnostics::Counter& Diagnostics::counter(const std::string& name) { return entry(name, false); }

Diagnostics::Counter& Diagnostics::refusals(const std::string& name) { return entry(name, true); }

Diagnostics::Counter& Diagnostics::entry(const std::string& name, bool warns) {
  const Lock lock(mutex_);
  for (Entry& entry : entries_)
    if (entry.name == name) return entry.value;
  return entries_.emplace_back(name, warns).value;
}

void Diagnostics::update(Status& status) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  status.summary(DiagnosticStatus::OK, "");
  report_(status, (now - last_).toSec());
  last_ = now;
  const Lock lock(mutex_);
  for (Entry& entry : entries_) {
    const std::uint64_t value = entry.value;
    status.add(entry.name, value);
    if (entry.warns && value > entry.reported)
      status.mergeSummaryf(DiagnosticStatus::WARN, "%s: %llu more", entry.name.c_str(),
                           static_cast<unsigned long long>(value - entry.reported));
    entry.reported = value;
  }
}

}  // namespace threelink_sim
