/// @file
/// Tables of numbers as text.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

/// Shape of a table.
struct CsvLimits {
  std::size_t columns = 1;  ///< number of columns of every row
  std::size_t rows = 10'000;
  bool skip_blank_lines =
      false;  ///< skip blank lines everywhere; those at the end are always skipped
};

/// One row with its position in the file.
struct CsvRow {
  std::size_t line;  ///< counted from 1
  std::vector<double> values;
};

/// The decimal number that the text consists of, apart from surrounding blanks; nothing if it is
/// not a number. Subnormal numbers such as 1e-320 are accepted; numbers that are too large become
/// infinite.
std::optional<double> decimal_number(std::string_view text);

/// Parses rows of numbers, separated by commas, without a header. A byte order mark at the start
/// and both kinds of line ends are accepted. Throws FormatError that begins with "SOURCE:LINE:
/// column N: "; `source` is the name of the file.
std::vector<CsvRow> parse_csv(const std::string& text, const std::string& source,
                              const CsvLimits& limits);

}  // namespace threelink_sim
