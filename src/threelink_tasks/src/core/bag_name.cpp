#include "bag_name.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace threelink_tasks {
namespace {

constexpr std::string_view kDate = "dddd-dd-dd-dd-dd-dd";  // d: a digit

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Takes an ending off; false if there is none.
bool take_ending(std::string_view& text, std::string_view ending) {
  if (text.size() < ending.size() || text.substr(text.size() - ending.size()) != ending)
    return false;
  text.remove_suffix(ending.size());
  return true;
}

}  // namespace

bool is_plain_name(std::string_view text) {
  return !text.empty() && text.size() <= kMostNameLetters &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return is_letter(c) || is_digit(c) || c == '-' || c == '_'; });
}

std::string bag_name(const std::string& task, const std::string& date, std::uint32_t episode) {
  if (!is_plain_name(task)) throw std::invalid_argument("a task without a plain name");
  return fmt::format("{}_{}_ep{:04}.bag", task, date, episode);
}

bool is_bag_name(std::string_view name) {
  if (!take_ending(name, ".bag")) return false;
  take_ending(name, "_recovered");
  std::size_t digits = 0;
  while (!name.empty() && is_digit(name.back())) {
    name.remove_suffix(1);
    ++digits;
  }
  if (digits < 4 || digits > 10 || !take_ending(name, "_ep")) return false;
  if (name.size() < kDate.size()) return false;
  const std::string_view date = name.substr(name.size() - kDate.size());
  for (std::size_t i = 0; i < kDate.size(); ++i)
    if (kDate[i] == 'd' ? !is_digit(date[i]) : date[i] != kDate[i]) return false;
  name.remove_suffix(kDate.size());
  return take_ending(name, "_") && is_plain_name(name);
}

}  // namespace threelink_tasks
