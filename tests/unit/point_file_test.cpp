// Files of points: good ones, and bad ones refused with file and line.
#include "threelink_sim/task/point_file.hpp"

#include <cstdio>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/parameter_map.hpp"

namespace {

using Eigen::Vector2d;
using threelink_sim::read_point_file;

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
  EXPECT_EQ(read("a.csv",
                 "\xef\xbb\xbf"
                 "1,2\r\n-0.1,1e-5\r\n3,1e-400\r\n"),
            points);
  EXPECT_EQ(read("a.yaml", "- [1, 2]\n- [-0.1, 1.0e-5]\n- [3, 0]\n"), points);
  EXPECT_EQ(read("a.yml", "[[1, 2], [-0.1, 1e-5], [3, 0]]"), points);
}

TEST(PointFile, RefusesWithFileAndLine) {
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"b.csv", "x,y\n1,2\n", "b.csv:1: column 1: \"x\" is no number"},
      {"b.csv", "1,2\n\n3;4\n", "b.csv:3: column 1: \"3;4\" is no number"},
      {"b.csv", "1,2\n3,4,5\n", "b.csv:2: \"3,4,5\" has more than 2 numbers"},
      {"b.csv", "1,2\n3,\n", "b.csv:2: column 2: \"\" is no number"},
      {"b.csv", "1,nan\n", "b.csv:1: column 2: \"nan\" is no number"},
      {"b.csv", "1,2\n1,2e6\n", "b.csv:2: 2000000 must be in"},
      {"b.csv", "1,0x10\n", "is no number"},
      {"b.csv", "\n\n", "b.csv: holds no point"},
      {"b.csv", "", "b.csv: holds no point"},
      {"b.yaml", "a: 1\n", "b.yaml:1: must be a list"},
      {"b.yaml", "- [1, 2]\n- [1]\n", "b.yaml:2: must be a pair"},
      {"b.yaml", "- [1, 2]\n- [1, [2]]\n", "b.yaml:2: must be a pair"},
      {"b.yaml", "- [1, 2]\n- [1, two]\n", "b.yaml:2: \"two\" is no number"},
      {"b.yaml", "- [1, 2\n- [\n", "b.yaml: is not YAML: line "},
      {"b.yaml", "- &a [1, 2]\n- *a\n", "b.yaml: line 1, column 3: anchors"},
      {"b.csv", "version https://git-lfs.github.com/spec/v1\n", "b.csv: is a Git LFS pointer"},
      {"b.yaml", "<html></html>", "b.yaml: is an HTML page"},
  };
  for (const auto& [name, contents, message] : cases)
    EXPECT_NE(refusal(name, contents).find(message), std::string::npos)
        << contents << refusal(name, contents);
  for (const std::string path : {"/no/such/file.csv", "/", "/dev/null", "/dev/zero"})
    EXPECT_THROW(read_point_file(path), threelink_sim::UsageError) << path;
  std::string many;
  for (std::size_t i = 0; i <= threelink_sim::kMaxPoints; ++i) many += "1,2\n";
  EXPECT_NE(refusal("c.csv", many).find(":10001: more than 10000 points"), std::string::npos);
}

TEST(PointFile, PeersAreToldTheLineAndNotTheContents) {
  const std::vector<std::tuple<std::string, std::string>> cases = {
      {"secret.csv.d", "a secret line\n"}, {"s.csv", "1,2\n12345,67890secret\n"},
      {"s.csv", "1,2\n987654321,1\n"},     {"s.yaml", "secret: 1\n"},
      {"s.yaml", "- [1, secret]\n"},       {"s.yaml", "- [987654321, 1]\n"},
      {"s.yaml", "\"\\secret\"\n"}};
  for (const auto& [name, contents] : cases) {
    try {
      threelink_sim::parse_points(contents, "/path/" + name);
      FAIL() << contents;
    } catch (const threelink_sim::UsageError& error) {
      const std::string& told = error.for_peers();
      EXPECT_EQ(told.rfind("/path/" + name + ":", 0), 0u) << told;
      for (const char* part : {"a secret", "67890", "98765", "secret: ", "secret]"})
        EXPECT_EQ(told.find(part), std::string::npos) << told;
    }
  }
}

}  // namespace
