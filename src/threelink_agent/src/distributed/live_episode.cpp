#include "threelink_agent/distributed/live_episode.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "threelink_agent/distributed/episode_batch.hpp"

namespace threelink_agent {
namespace {

bool bounded(double value) { return std::abs(value) <= kMaxObservation; }

}  // namespace

LiveEpisode::LiveEpisode(const Play& play, int i, Rollout& rollout)
    : actor_(play, i, i + 1, rollout),
      joint_limit_(play.environment.model.joint_limit),
      steps_(rollout.steps),
      inputs_(rollout.observation_size),
      rates_(rollout.hinges) {}

// The joint limit alone may change a rate.
bool LiveEpisode::applied_ours(const std::vector<double>& alpha,
                               const std::vector<double>& applied) const {
  constexpr double kNear = 1e-9;  // [rad]
  for (std::size_t j = 0; j < rates_.size(); ++j)
    if (applied[j] != rates_[j] && std::abs(alpha[j]) < joint_limit_ - kNear) return false;
  return true;
}

LiveEpisode::Verdict LiveEpisode::state(std::uint64_t step, const std::vector<double>& alpha,
                                        const std::vector<double>& applied, double reward) {
  const std::uint64_t next = begun_ ? step_ + 1 : 0;
  if (begun_ && step <= step_) return Verdict::kStale;
  if (step != next || (begun_ && !observed_) || done_) return Verdict::kFuture;
  if (alpha.size() != rates_.size() || applied.size() != rates_.size() || !bounded(reward))
    return Verdict::kMalformed;
  if (begun_ && !applied_ours(alpha, applied)) return Verdict::kNotOurs;
  if (begun_) actor_.earn(static_cast<int>(step_), &reward);
  begun_ = true;
  observed_ = false;
  step_ = step;
  return Verdict::kAccepted;
}

LiveEpisode::Verdict LiveEpisode::observation(std::uint64_t step,
                                              const std::vector<double>& values) {
  if (!begun_ || step > step_) return Verdict::kFuture;
  if (step < step_ || observed_) return Verdict::kStale;
  if (values.size() != inputs_ || !std::all_of(values.begin(), values.end(), bounded))
    return Verdict::kMalformed;
  const int t = static_cast<int>(step);
  actor_.see(t, values.data());
  observed_ = true;
  done_ = step == steps_;
  if (done_) return Verdict::kAccepted;
  const double* rates = actor_.act(t);
  std::transform(rates, rates + rates_.size(), rates_.begin(),
                 [](double rate) { return std::clamp(rate, -1.0, 1.0); });
  return Verdict::kAccepted;
}

template <class Episodes>
std::string difference_from_collect(const Play& play, const Episodes& episodes, int i) {
  Play alone = play;
  alone.first_episode += i;
  Rollout expected(play.environment, 1);
  collect(alone, 0, 1, expected);
  const auto difference = [&](const char* name, const auto& all, const auto& one) -> std::string {
    for (std::size_t k = 0; k < one.size(); ++k) {
      const auto& value = all[k * episodes.episodes + i];
      if (std::memcmp(&value, &one[k], sizeof value) != 0)
        return fmt::format("{} {} is {}, and should be {}", name, k, value, one[k]);
    }
    return "";
  };
  for (const std::string& text :
       {difference("observation", episodes.observations, expected.observations),
        difference("action", episodes.actions, expected.actions),
        difference("log-probability", episodes.log_probs, expected.log_probs),
        difference("reward", episodes.rewards, expected.rewards),
        difference("capture", episodes.captured, expected.captured)})
    if (!text.empty()) return text;
  return "";
}

template std::string difference_from_collect(const Play&, const Rollout&, int);
template std::string difference_from_collect(const Play&, const EpisodeBatch&, int);

}  // namespace threelink_agent
