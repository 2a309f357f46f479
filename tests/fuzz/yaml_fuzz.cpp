// YAML text. What is accepted can be written, and reads back.
#include <sstream>

#include "fuzz.hpp"
#include "threelink_sim/yaml.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_sim;
  threelink_fuzz::value_or<FormatError>([&] {
    const YAML::Node node = parse_yaml(threelink_fuzz::text(data, size));
    std::ostringstream text;
    text << node;
    threelink_fuzz::require(YAML::Load(text.str()).size() == node.size(),
                            "written otherwise than read");
  });
  return 0;
}
