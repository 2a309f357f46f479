// Files of points: good ones, and bad ones refused with file and line.
#include "threelink_tasks/point_file.hpp"

#include <cstdio>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/parameter_map.hpp"

namespace {

using Eigen::Vector2d;
using threelink_tasks::read_point_file;

std::vector<Vector2d> read(const std::string& name, const std::string& contents) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << contents;
  return read_point_file(path);
}

std::string refusal(const std::string& name, const std::string& contents) {
  try {
    read(name, contents);
  } catch (const threelink_sim::UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(PointFile, ReadsCsvAndYaml) {
  const std::vector<Vector2d> points = {{1, 2}, {-0.1, 1e-5}, {3, 0}};
  EXPECT_EQ(read("a.csv", "1,2\n-0.1,1e-5\n3,0"), points);
  EXPECT_EQ(read("a.csv", " 1 , 2\r\n-0.1,1.0e-05\r\n\r\n3,0\r\n\n"), points);
  EXPECT_EQ(read("a.yaml", "- [1, 2]\n- [-0.1, 1.0e-5]\n- [3, 0]\n"), points);
  EXPECT_EQ(read("a.yml", "[[1, 2], [-0.1, 1e-5], [3, 0]]"), points);
}

TEST(PointFile, RefusesWithFileAndLine) {
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"b.csv", "x,y\n1,2\n", "b.csv:1: \"x\" is no number"},
      {"b.csv", "1,2\n\n3;4\n", "b.csv:3: \"3;4\" must be \"x,y\""},
      {"b.csv", "1,2\n3,4,5\n", "b.csv:2: \"3,4,5\" must be"},
      {"b.csv", "1,2\n3,\n", "b.csv:2: \"\" is no number"},
      {"b.csv", "1,nan\n", "b.csv:1: \"nan\" is no number"},
      {"b.csv", "1,2\n1,2e6\n", "b.csv:2: 2e6 must be in"},
      {"b.csv", "1,0x10\n", "is no number"},
      {"b.csv", "\n\n", "b.csv: holds no point"},
      {"b.csv", "", "b.csv: holds no point"},
      {"b.yaml", "a: 1\n", "b.yaml:1: must be a list"},
      {"b.yaml", "- [1, 2]\n- [1]\n", "b.yaml:2: must be a pair"},
      {"b.yaml", "- [1, 2]\n- [1, [2]]\n", "b.yaml:2: must be a pair"},
      {"b.yaml", "- [1, 2]\n- [1, two]\n", "b.yaml:2: \"two\" is no number"},
      {"b.yaml", "- [1, 2\n- [\n", "b.yaml:"},
  };
  for (const auto& [name, contents, message] : cases)
    EXPECT_NE(refusal(name, contents).find(message), std::string::npos)
        << contents << refusal(name, contents);
  for (const std::string path : {"/no/such/file.csv", "/", "/dev/null"})
    EXPECT_THROW(read_point_file(path), threelink_sim::UsageError) << path;
  std::string many;
  for (std::size_t i = 0; i <= threelink_tasks::kMaxPoints; ++i) many += "1,2\n";
  EXPECT_NE(refusal("c.csv", many).find(":10001: more than 10000 points"), std::string::npos);
}

}  // namespace
