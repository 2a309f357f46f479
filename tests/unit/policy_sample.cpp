// policy_sample FILE [none|reversal]: writes a random policy to FILE and prints what it answers,
// one line each: an observation's four values, then the two rates. For tests in other languages.
#include <cstdio>
#include <string>

#include "random_policy.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const threelink_agent::Policy policy =
      threelink_tests::random_policy(11, threelink_agent::symmetry_from_string(argv[2]));
  policy.save(argv[1]);
  constexpr std::size_t kCount = 200;
  const std::vector<double> all = threelink_tests::random_observations(kCount, 2, 12);
  for (std::size_t i = 0; i < kCount; ++i) {
    double observation[4], rates[2];
    for (int k = 0; k < 4; ++k) observation[k] = all[k * kCount + i];
    policy.act(observation, rates);
    for (double value : observation) std::printf("%.17g ", value);
    std::printf("%.17g %.17g\n", rates[0], rates[1]);
  }
}
