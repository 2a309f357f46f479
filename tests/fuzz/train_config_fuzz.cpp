// A training's configuration. One that is accepted reads back from its own text.
#include "fuzz.hpp"
#include "threelink_agent/training/train_config.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_agent;
  threelink_fuzz::value_or<ConfigError>([&] {
    const TrainConfig config = parse_train_config(threelink_fuzz::text(data, size), "input");
    const TrainConfig again = parse_train_config(to_yaml(config), "its own text");
    threelink_fuzz::require(!first_difference(config, again), "written otherwise than read");
  });
  return 0;
}
