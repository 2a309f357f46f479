// Reads tests/data/reference; THREELINK_TEST_DATA is the path of tests/data.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "threelink_sim/swimmer.hpp"

namespace threelink_tests {

// One part of a file, by value: a loop over a part of a temporary whole would outlive it.
inline nlohmann::json reference(const std::string& name, const std::string& part) {
  const std::string path = std::string(THREELINK_TEST_DATA) + "/reference/" + name + ".json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " cannot be read");
  return nlohmann::json::parse(file).at(part);
}

// A number that is stored as a number or, for its last digits, as a string.
inline double value(const nlohmann::json& json) {
  if (!json.is_string()) return json.get<double>();
  const std::string text = json.get<std::string>();
  std::size_t used = 0;
  const double number = std::stod(text, &used);
  if (used != text.size()) throw std::runtime_error(text + " is no number");
  return number;
}

inline Eigen::Vector2d point(const nlohmann::json& x, const nlohmann::json& y) {
  return {value(x), value(y)};
}

inline threelink_sim::HingeVector hinges(const nlohmann::json& json) {
  threelink_sim::HingeVector result(json.size());
  for (std::size_t j = 0; j < json.size(); ++j) result[j] = value(json[j]);
  return result;
}

}  // namespace threelink_tests
