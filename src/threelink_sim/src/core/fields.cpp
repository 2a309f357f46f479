#include "threelink_sim/fields.hpp"

namespace threelink_sim {

std::string to_yaml(const FieldTexts& texts) {
  std::string yaml, section;
  for (const auto& [name, value] : texts) {
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) {
      section.clear();
      yaml += name + ": " + value + "\n";
      continue;
    }
    if (section != name.substr(0, dot)) yaml += (section = name.substr(0, dot)) + ":\n";
    yaml += "  " + name.substr(dot + 1) + ": " + value + "\n";
  }
  return yaml;
}

std::optional<FieldDifference> first_difference(const FieldTexts& a, const FieldTexts& b) {
  // The names are the same up to the first value that differs, or to the end of one of the lists.
  const std::pair<std::string, std::string> nothing{"", "nothing"};
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const auto& in_a = i < a.size() ? a[i] : nothing;
    const auto& in_b = i < b.size() ? b[i] : nothing;
    if (in_a != in_b)
      return FieldDifference{std::max(in_a.first, in_b.first), in_a.second, in_b.second};
  }
  return {};
}

}  // namespace threelink_sim
