#include "threelink_agent/training/samples.hpp"

#include <cstring>

namespace threelink_agent {

Samples::Samples(const Rollout& rollout, const Advantages& advantages)
    : row_{rollout.observation_size, rollout.hinges},
      count_(static_cast<std::uint32_t>(rollout.log_probs.size())),
      values_(std::size_t(count_) * row_.stride()) {
  const auto fill = [&](int at, const float* component) {
    const int stride = row_.stride();
    float* value = values_.data() + at;
    for (std::uint32_t i = 0; i < count_; ++i, value += stride) *value = component[i];
  };
  const std::size_t observation_stride = count_ + rollout.episodes;
  for (int k = 0; k < row_.observation_size; ++k)
    fill(k, &rollout.observations[k * observation_stride]);
  for (int j = 0; j < row_.hinges; ++j)
    fill(row_.action() + j, &rollout.actions[std::size_t(j) * count_]);
  fill(row_.log_prob(), rollout.log_probs.data());
  fill(row_.advantage(), advantages.advantages.data());
  fill(row_.value_target(), advantages.returns.data());
}

void Samples::gather(const std::int64_t* chosen, int n, float* rows) const {
  const int stride = row_.stride();
  for (int i = 0; i < n; ++i)
    for (int line = 0; line < stride; line += kPackedFloats)
      std::memcpy(rows + i * stride + line, values_.data() + chosen[i] * stride + line,
                  kPackedFloats * sizeof(float));
}

}  // namespace threelink_agent
