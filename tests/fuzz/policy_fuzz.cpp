// A policy file: container, metadata, shapes, numbers. One that is accepted has its own bytes and
// plays.
#include <cmath>
#include <vector>

#include "fuzz.hpp"
#include "threelink_agent/policy.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_agent;
  threelink_fuzz::value_or<PolicyError>([&] {
    const Policy policy = Policy::parse(threelink_fuzz::text(data, size), "input");
    const Policy again = Policy::parse(policy.serialize(), "its own bytes");
    threelink_fuzz::require(again.serialize() == policy.serialize(), "written otherwise than read");
    const std::vector<double> observation(policy.observation_size(), 0.5);
    std::vector<double> rates(policy.hinges());
    policy.act(observation.data(), rates.data());
    for (double rate : rates) threelink_fuzz::require(std::abs(rate) <= 1, "a rate beyond 1");
  });
  return 0;
}
