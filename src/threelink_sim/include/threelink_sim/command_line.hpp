/// @file
/// Validators of numbers on a command line for CLI11. Their messages name option, value and bound.
#pragma once

#include <cerrno>
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

/// A whole number from low to high in decimal. Octal notation such as 010, which CLI11 would read,
/// is refused.
template <class Integer>
CLI::Validator whole_number(Integer low, Integer high = std::numeric_limits<Integer>::max()) {
  static_assert(std::is_integral_v<Integer>);
  const std::string bounds = fmt::format("in [{}, {}]", low, high);
  const auto taken = [=](const std::string& text) {
    const bool negative = text[0] == '-';
    const std::string digits = text.substr(negative ? 1 : 0);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return false;
    if ((digits[0] == '0' && text.size() > 1) || (negative && low >= 0)) return false;
    errno = 0;
    if (negative) return std::strtoll(text.c_str(), nullptr, 10) >= std::int64_t(low) && errno == 0;
    const std::uint64_t value = std::strtoull(text.c_str(), nullptr, 10);
    return errno == 0 && value <= static_cast<std::uint64_t>(high) &&
           (low < 0 || value >= static_cast<std::uint64_t>(low));
  };
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        if (taken(text)) return "";
        return fmt::format("\"{}\" must be a whole number {}", excerpt(text), bounds);
      },
      bounds);
}

/// A number from low to high.
inline CLI::Validator real_number(double low = -std::numeric_limits<double>::max(),
                                  double high = std::numeric_limits<double>::max()) {
  const bool bounded = high < std::numeric_limits<double>::max();
  const std::string bounds = bounded ? fmt::format("in [{:.10g}, {:.10g}]", low, high) : "";
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto value = decimal_number(text);
        const bool blank = text.find_first_of(" \t\r") != std::string::npos;  // CLI11 takes none
        if (value && *value >= low && *value <= high && !blank) return "";
        return fmt::format("\"{}\" must be a {}number{}", excerpt(text), bounded ? "" : "finite ",
                           bounded ? " " + bounds : "");
      },
      bounds);
}

/// Parses the command line. Returns false if only help was requested. Throws UsageError.
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
