#include "state_sequence.hpp"

namespace threelink_tasks {
namespace {

// [ns] An hour, more than any step takes: the simulator's units allow 1000 s.
constexpr std::uint64_t kLongestStep = 3'600'000'000'000;
constexpr std::size_t kBelieved = 3;  // so many leaps after each other are true
constexpr std::size_t kMostHinges = 1000;

bool is_next(const ros::Time& stamp, const ros::Time& before) {
  // Not by a ros::Duration, which throws where it is longer than 68 years.
  return stamp >= before && stamp.toNSec() - before.toNSec() <= kLongestStep;
}

}  // namespace

bool StateSequence::is_due(const State& state) const {
  return state.step == due_ && is_next(state.header.stamp, stamp_);
}

void StateSequence::add(const State& state, const Take& take) {
  if (state.step < due_) return;  // a repetition
  if (state.header.stamp < stamp_ || state.alpha.size() > kMostHinges ||
      state.theta.size() > kMostHinges || state.hinge_rates.size() > kMostHinges ||
      (last_ && state.alpha.size() != hinges_)) {
    ++refused_;
    return;
  }
  if (is_due(state)) {
    refuse_leaps();
    accept(state, take);
    return;
  }
  if (!leaps_.empty() && state.step <= leaps_.back().step) refuse_leaps();
  const bool goes_on = !leaps_.empty() && state.step == leaps_.back().step + 1 &&
                       is_next(state.header.stamp, leaps_.back().header.stamp);
  leaps_.push_back(state);
  if (goes_on || leaps_.size() == kBelieved) accept_leaps(take);
}

bool StateSequence::reaches(std::uint64_t step) const {
  return step < due_ || (!leaps_.empty() && leaps_.back().step == step);
}

void StateSequence::finish(std::optional<std::uint64_t> last_step, const Take& take) {
  if (!leaps_.empty() && leaps_.back().step == last_step) accept_leaps(take);
  refuse_leaps();
  if (last_step && *last_step >= due_) missing_ += *last_step - due_ + 1;
}

void StateSequence::accept(const State& state, const Take& take) {
  missing_ += state.step - due_;
  if (!last_) hinges_ = state.alpha.size();
  last_ = state.step;
  due_ = state.step + 1;
  stamp_ = state.header.stamp;
  take(state);
}

void StateSequence::accept_leaps(const Take& take) {
  for (const State& state : leaps_) accept(state, take);
  leaps_.clear();
}

void StateSequence::refuse_leaps() {
  refused_ += leaps_.size();
  leaps_.clear();
}

}  // namespace threelink_tasks
