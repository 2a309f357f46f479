#include "threelink_agent/training/advantage.hpp"

#include <cmath>

namespace threelink_agent {

Advantages generalised_advantages(int steps, int episodes, const std::vector<float>& rewards,
                                  const std::vector<std::uint8_t>& captured,
                                  const std::vector<float>& values,
                                  const AdvantageSettings& settings) {
  const float discount = static_cast<float>(settings.discount);
  const float decay = static_cast<float>(settings.discount * settings.lambda);
  Advantages result{std::vector<float>(rewards.size()), std::vector<float>(rewards.size())};
  std::vector<float> next_value(episodes, 0.0f), advantage(episodes, 0.0f);
  if (settings.bootstrap_at_time_limit) next_value.assign(values.end() - episodes, values.end());
  for (int t = steps - 1; t >= 0; --t) {
    for (int i = 0; i < episodes; ++i) {
      const int k = t * episodes + i;
      if (captured[k]) next_value[i] = advantage[i] = 0;
      const float delta = rewards[k] + discount * next_value[i] - values[k];
      advantage[i] = delta + decay * advantage[i];
      next_value[i] = values[k];
      result.advantages[k] = advantage[i];
      result.returns[k] = advantage[i] + values[k];
    }
  }
  return result;
}

void normalise(std::vector<float>& advantages) {
  double sum = 0, square = 0;
  for (float a : advantages) sum += a;
  const double mean = sum / advantages.size();
  for (float a : advantages) square += (a - mean) * (a - mean);
  const double deviation = std::sqrt(square / advantages.size());
  const double scale = deviation > 0 ? 1 / deviation : 0;
  for (float& a : advantages) a = static_cast<float>((a - mean) * scale);
}

}  // namespace threelink_agent
