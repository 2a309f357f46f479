// A file of points, as CSV and as YAML.
#include "fuzz.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/task/point_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const threelink_fuzz::ScratchFolder folder;
  for (const char* name : {"points.csv", "points.yaml"}) {
    const std::string path = folder.file(name, data, size);
    threelink_fuzz::value_or<threelink_sim::UsageError>([&] {
      const auto points = threelink_sim::read_point_file(path);
      threelink_fuzz::require(!points.empty() && points.size() <= threelink_sim::kMaxPoints,
                              "a number of points out of bounds");
    });
  }
  return 0;
}
