// JSON text: what is accepted is the same as for the library, and an excerpt of it is short.
#include "fuzz.hpp"
#include "threelink_sim/json.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_sim;
  threelink_fuzz::value_or<FormatError>([&] {
    const std::string text = threelink_fuzz::text(data, size);
    const nlohmann::json value = parse_json(text);
    threelink_fuzz::require(value == nlohmann::json::parse(text), "read otherwise than JSON");
    threelink_fuzz::require(parse_json(value.dump()) == value, "written otherwise than read");
    threelink_fuzz::require(json_excerpt(value).size() < 200, "a long excerpt");
  });
  return 0;
}
