// A checkpoint of one small training.
#include "fuzz.hpp"
#include "threelink_agent/training/checkpoint.hpp"
#include "tiny_training.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_agent;
  static const TrainConfig config = threelink_fuzz::tiny_training();
  threelink_fuzz::value_or<CheckpointError>([&] {
    const Checkpoint checkpoint =
        parse_checkpoint(threelink_fuzz::text(data, size), "input", config);
    const std::string bytes = serialize(checkpoint);
    const Checkpoint again = parse_checkpoint(bytes, "its own bytes", config);
    threelink_fuzz::require(serialize(again) == bytes, "written otherwise than read");
  });
  return 0;
}
