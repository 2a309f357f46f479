#include "threelink_agent/distributed/lease_book.hpp"

#include <algorithm>
#include <cmath>

namespace threelink_agent {

void LeaseBook::open(int episodes) {
  states_.assign(episodes, State::kOpen);
  in_ = 0;
  entries_.clear();
}

std::vector<Lease> LeaseBook::give(const std::vector<Hand>& hands, int most,
                                   const std::function<Time(const Lease&)>& deadline) {
  double speed = 0;  // of the hands that are still to have their part
  for (const Hand& hand : hands) speed += hand.speed;
  auto open = std::count(states_.begin(), states_.end(), State::kOpen);
  std::vector<Lease> given;
  auto begin = states_.begin();
  for (const Hand& hand : hands) {
    if (!hand.free) continue;
    begin = std::find(begin, states_.end(), State::kOpen);
    if (begin == states_.end()) break;
    const auto share =
        std::clamp(std::lround(open * std::min(1.0, hand.speed / speed)), 1L, long{most});
    auto end = begin;
    while (end != states_.end() && *end == State::kOpen && end - begin < share)
      *end++ = State::kLeased;
    const Lease lease{++last_id_, hand.worker, static_cast<int>(begin - states_.begin()),
                      static_cast<int>(end - begin)};
    entries_[lease.id] = {lease, deadline(lease), true};
    given.push_back(lease);
    open -= end - begin;
    speed -= hand.speed;
    begin = end;
  }
  return given;
}

const Lease* LeaseBook::find(std::uint64_t id) const {
  const auto entry = entries_.find(id);
  return entry == entries_.end() ? nullptr : &entry->second.lease;
}

std::vector<LeaseBook::Run> LeaseBook::settle(std::uint64_t id) {
  Entry& entry = entries_.at(id);
  entry.running = false;
  std::vector<Run> fresh;
  for (int i = entry.lease.first; i < entry.lease.first + entry.lease.count; ++i) {
    if (states_[i] == State::kIn) continue;
    states_[i] = State::kIn;
    ++in_;
    if (fresh.empty() || fresh.back().first + fresh.back().count < i) fresh.push_back({i, 0});
    ++fresh.back().count;
  }
  return fresh;
}

void LeaseBook::reopen(std::uint64_t id) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || !found->second.running) return;
  Entry& entry = found->second;
  entry.running = false;
  for (int i = entry.lease.first; i < entry.lease.first + entry.lease.count; ++i)
    if (states_[i] == State::kLeased) states_[i] = State::kOpen;
}

template <class Which>
std::vector<Lease> LeaseBook::lose(Which which) {
  std::vector<Lease> lost;
  for (const auto& [id, entry] : entries_)
    if (entry.running && which(entry)) lost.push_back(entry.lease);
  for (const Lease& lease : lost) reopen(lease.id);
  return lost;
}

std::vector<Lease> LeaseBook::expire(Time now) {
  return lose([&](const Entry& entry) { return entry.deadline <= now; });
}

std::vector<Lease> LeaseBook::revoke(std::uint64_t worker) {
  return lose([&](const Entry& entry) { return entry.lease.worker == worker; });
}

}  // namespace threelink_agent
