#include "threelink_agent/training/rollout_source.hpp"

#include <algorithm>

namespace threelink_agent {

Rollout LocalRollouts::play(const Play& play, int episodes) {
  Rollout rollout(play.environment, episodes);
  // A share is a whole number of half registers, so that few lanes are idle.
  constexpr int kMultiple = 8;
  const int share = (episodes + threads_ * kMultiple - 1) / (threads_ * kMultiple) * kMultiple;
  crew_.run((episodes + share - 1) / share, [&](int task) {
    collect(play, task * share, std::min((task + 1) * share, episodes), rollout);
  });
  return rollout;
}

}  // namespace threelink_agent
