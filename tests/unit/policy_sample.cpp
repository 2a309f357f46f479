// policy_sample FILE none|reversal direction|target: writes a random policy to FILE and prints what
// it answers, one line each: an observation's values, then the two rates. For tests in other
// languages.
#include <cstdio>
#include <string>

#include "random_policy.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto kind = threelink_sim::observation_kind_from_string(argv[3]);
  const threelink_agent::Policy policy =
      threelink_tests::random_policy(11, threelink_agent::symmetry_from_string(argv[2]), 3, kind);
  policy.save(argv[1]);
  constexpr std::size_t kCount = 200;
  const std::vector<double> all = threelink_tests::random_observations(kCount, 2, 12, kind);
  for (std::size_t i = 0; i < kCount; ++i) {
    std::vector<double> observation(policy.observation_size());
    for (std::size_t k = 0; k < observation.size(); ++k) observation[k] = all[k * kCount + i];
    double rates[2];
    policy.act(observation.data(), rates);
    for (double value : observation) std::printf("%.17g ", value);
    std::printf("%.17g %.17g\n", rates[0], rates[1]);
  }
}
