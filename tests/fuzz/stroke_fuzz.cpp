// A stroke's JSON file.
#include "fuzz.hpp"
#include "threelink_sim/stroke_file.hpp"
#include "threelink_sim/usage_error.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  threelink_fuzz::value_or<threelink_sim::UsageError>(
      [&] { threelink_sim::parse_stroke(threelink_fuzz::text(data, size)).validate(); });
  return 0;
}
