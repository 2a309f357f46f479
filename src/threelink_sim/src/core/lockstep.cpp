#include "threelink_sim/lockstep.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace threelink_sim {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kWrongLength:
      return "wrong length";
    case Verdict::kNotFinite:
      return "not finite";
    case Verdict::kOutOfRange:
      return "out of range";
    case Verdict::kStale:
      return "stale";
    case Verdict::kFuture:
      return "future";
  }
  return "";
}

Lockstep::Lockstep(const Config& config) : config_(config), command_(config.hinges) {}

void Lockstep::start(Time now) {
  ++episode_;
  ++ticks_;
  step_ = 0;
  watchdog_tripped_ = false;
  due_ = now + config_.period;
  asked_ = now;
  phase_ = Phase::kAwaitTarget;
}

Verdict Lockstep::target(std::uint64_t stamp, double x, double y, Time now) {
  if (!std::isfinite(x) || !std::isfinite(y)) return Verdict::kNotFinite;
  if (stamp > this->stamp()) return Verdict::kFuture;
  if (stamp < this->stamp() || phase_ != Phase::kAwaitTarget) return Verdict::kStale;
  asked_ = now;
  phase_ = Phase::kAwaitRates;
  return Verdict::kAccepted;
}

Verdict Lockstep::rates(std::uint32_t episode, std::uint64_t step, const double* values,
                        std::size_t count) {
  if (count != config_.hinges) return Verdict::kWrongLength;
  const auto finite = [](double rate) { return std::isfinite(rate); };
  if (!std::all_of(values, values + count, finite)) return Verdict::kNotFinite;
  const auto in_range = [](double rate) { return std::abs(rate) <= 1; };
  if (!std::all_of(values, values + count, in_range)) return Verdict::kOutOfRange;

  const auto answered = std::tie(episode, step), current = std::tie(episode_, step_);
  if (answered > current) return Verdict::kFuture;
  if (answered < current) return Verdict::kStale;
  if (phase_ == Phase::kAwaitTarget) return Verdict::kFuture;
  if (phase_ != Phase::kAwaitRates) return Verdict::kStale;
  std::copy_n(values, count, command_.begin());
  watchdog_tripped_ = false;
  phase_ = Phase::kAwaitPace;
  return Verdict::kAccepted;
}

Lockstep::Action Lockstep::poll(Time now) {
  if (now < deadline()) return Action::kWait;
  switch (phase_) {
    case Phase::kAwaitPace:
      return Action::kStep;
    case Phase::kAwaitRates:
      if (!paced()) return Action::kAbort;
      watchdog_tripped_ = true;
      std::fill(command_.begin(), command_.end(), 0.0);
      return Action::kStep;
    case Phase::kAwaitTarget:
      return Action::kAbort;
    case Phase::kIdle:
      break;
  }
  return Action::kWait;
}

void Lockstep::stepped(Time now) {
  ++step_;
  ++ticks_;
  // Keep to the grid after a small delay; after a long one begin anew, without catching up.
  const Time next = due_ + config_.period;
  due_ = now < next ? next : now + config_.period;
  asked_ = now;
  phase_ = Phase::kAwaitTarget;
}

Lockstep::Time Lockstep::deadline() const {
  switch (phase_) {
    case Phase::kAwaitTarget:
      return asked_ + config_.peer_timeout;
    case Phase::kAwaitRates:
      if (!paced()) return asked_ + config_.peer_timeout;
      return std::max(due_, asked_ + (watchdog_tripped_ ? config_.period : config_.watchdog));
    case Phase::kAwaitPace:
      return due_;
    case Phase::kIdle:
      break;
  }
  return Time::max();
}

}  // namespace threelink_sim
