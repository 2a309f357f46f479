/// @file
/// Numbers in rows and columns, as text.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "threelink_sim/usage_error.hpp"

namespace threelink_sim {

struct CsvLimits {
  std::size_t columns = 1;  ///< of every row
  std::size_t rows = 10'000;
  bool skip_blank_lines = false;  ///< wherever they are; those at the end never count
};

struct CsvRow {
  std::size_t line;  ///< counted from 1
  std::vector<double> values;
};

/// The decimal number that is all of the text but for blanks around it; nothing if there is none.
/// The smallest ones (1e-320) are numbers, too; those that are too large are infinite.
std::optional<double> decimal_number(std::string_view text);

/// Rows of numbers with commas between them, without a header. A byte order mark at the start and
/// ends of lines of either kind are taken. Throws FormatError that begins with
/// "SOURCE:LINE: column N: "; `source` is the name of the file.
std::vector<CsvRow> parse_csv(const std::string& text, const std::string& source,
                              const CsvLimits& limits);

}  // namespace threelink_sim
