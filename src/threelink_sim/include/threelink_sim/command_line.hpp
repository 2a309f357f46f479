// Numbers on the command line of a tool, for CLI11: refusals that say option, value and bound.
#pragma once

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/csv.hpp"
#include "threelink_sim/excerpt.hpp"

namespace threelink_sim {

// A whole number from low to high, in decimal.
template <class Integer>
CLI::Validator whole_number(Integer low, Integer high = std::numeric_limits<Integer>::max()) {
  static_assert(std::is_integral_v<Integer>);
  const std::string bounds = fmt::format("in [{}, {}]", low, high);
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        errno = 0;
        char* end = nullptr;
        // -1 is a number of strtoull(), too.
        const bool negative = text.find('-') != std::string::npos;
        const auto large = negative ? 0 : std::strtoull(text.c_str(), &end, 10);
        const auto small = negative ? std::strtoll(text.c_str(), &end, 10) : 0;
        const bool in_range =
            negative ? std::is_signed_v<Integer> && small >= static_cast<std::int64_t>(low)
                     : large <= static_cast<std::uint64_t>(high) &&
                           (low < 0 || large >= static_cast<std::uint64_t>(low));
        const bool digits = text.find_first_not_of("0123456789+-") == std::string::npos;
        if (text.empty() || !digits || *end != '\0' || errno == ERANGE || !in_range)
          return fmt::format("\"{}\" must be a whole number {}", excerpt(text), bounds);
        return "";
      },
      bounds);
}

// A number, from low to high.
inline CLI::Validator real_number(double low = -std::numeric_limits<double>::max(),
                                  double high = std::numeric_limits<double>::max()) {
  const bool bounded = high < std::numeric_limits<double>::max();
  const std::string bounds = bounded ? fmt::format("in [{:.10g}, {:.10g}]", low, high) : "";
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = decimal_number(text);
        if (value && *value >= low && *value <= high) return "";
        return fmt::format("\"{}\" must be a {}number{}", excerpt(text), bounded ? "" : "finite ",
                           bounded ? " " + bounds : "");
      },
      bounds);
}

// Parses the command line; false if there is nothing more to do, since help was asked for. Throws
// UsageError.
inline bool parse_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& help) {
    app.exit(help);
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("{}\nRun with --help for more information.", error.what()));
  }
}

}  // namespace threelink_sim
