// CSV text with the limits of the files that hold such: rates of hinges, points.
#include "fuzz.hpp"
#include "threelink_sim/csv.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_sim;
  const std::string text = threelink_fuzz::text(data, size);
  for (const bool skip_blank_lines : {false, true})
    threelink_fuzz::value_or<FormatError>([&] {
      const CsvLimits limits{2, 100, skip_blank_lines};
      for (const CsvRow& row : parse_csv(text, "input", limits))
        threelink_fuzz::require(row.line > 0 && row.values.size() == limits.columns,
                                "a row of another length");
    });
  return 0;
}
