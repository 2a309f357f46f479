// A map of parameters as it comes by a message: every kind of getter. What was accepted reads back
// from its own text.
#include "fuzz.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace {

using namespace threelink_sim;

std::string read(const std::string& yaml) {
  ParameterMap parameters = parse_parameters("input", yaml);
  parameters.real("real", {-1e300, 1e300}, 0.5);
  parameters.integer("integer", {-1000000, 1000000}, 1);
  parameters.flag("flag", false);
  parameters.text("text", "words");
  parameters.choice("choice", {"one", "two"}, "one");
  const ParameterMap::Points none;
  parameters.points(
      "points", {-1e6, 1e6},
      [](const std::string&) {
        return ParameterMap::Points{{1, 2}};
      },
      &none);
  parameters.finish();
  return parameters.effective();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  threelink_fuzz::value_or<UsageError>([&] {
    const std::string effective = read(threelink_fuzz::text(data, size));
    threelink_fuzz::require(read(effective) == effective, "written otherwise than read");
  });
  return 0;
}
