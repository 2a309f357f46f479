// World files: what is read, and what is refused, with which words.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_world.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;
using testing::HasSubstr;

std::string file_of(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

// What is said of a world that is refused.
std::string refusal(const std::string& yaml) {
  try {
    world_of(yaml);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "taken";
}

TEST(WorldFile, UnknownKeysAndKindsNameTheNearest) {
  EXPECT_THAT(refusal("flows: []"), HasSubstr("flow"));
  EXPECT_THAT(refusal("flow: [{kind: taylor_gren, u0: 0.1, k: 1.0}]"),
              HasSubstr("the nearest one is taylor_green"));
  EXPECT_THAT(refusal("flow: [{kind: taylor_green, u0: 0.1, k: 1.0, fase: [0, 0]}]"),
              HasSubstr("world.yaml/flow[0]/phase"));
  EXPECT_THAT(refusal("obstacles: [{kind: disk, center: [0, 0], radius: 1.0}]"),
              HasSubstr("the nearest one is disc"));
  EXPECT_THAT(refusal("hydrodynamics: {kind: bead}"), HasSubstr("resistive_force"));
}

TEST(WorldFile, MissingWrongAndUnboundedValuesAreNamed) {
  EXPECT_THAT(refusal("flow: [{kind: taylor_green, k: 1.0}]"), HasSubstr("flow[0]/u0 is missing"));
  EXPECT_THAT(refusal("flow: [{kind: taylor_green, u0: .nan, k: 1.0}]"),
              HasSubstr("must be finite"));
  EXPECT_THAT(refusal("flow: [{kind: taylor_green, u0: fast, k: 1.0}]"),
              HasSubstr("u0 = \"fast\" (string): must be a number"));
  EXPECT_THAT(refusal("flow: [{kind: uniform, U: [1.0]}]"),
              HasSubstr("must be a list of 2 numbers"));
  EXPECT_THAT(refusal("flow: [{kind: linear, A: [1.0, 2.0]}]"), HasSubstr("must be a list of 2"));
  EXPECT_THAT(refusal("flow: {kind: uniform}"), HasSubstr("must be a list"));
  EXPECT_THAT(refusal("flow: [uniform]"), HasSubstr("flow[0]: must be a map"));
  EXPECT_THAT(refusal("link_radius: 0.0"), HasSubstr("must be in [0.0001, 0.1]"));
  EXPECT_THAT(refusal("thermal_noise: -1.0"), HasSubstr("must be in [0, 0.1]"));
  EXPECT_THAT(refusal("flow_points: 9"), HasSubstr("must be in [1, 8]"));
  EXPECT_THAT(refusal("obstacles: [{kind: half_plane, point: [0, 0], normal: [0, 0]}]"),
              HasSubstr("must point to a side"));
  EXPECT_THAT(refusal("obstacles: [{kind: disc, center: [0, 0], radius: 0}]"), HasSubstr("radius"));
}

TEST(WorldFile, GridsThatAreNotRegularAreNamedByTheirLine) {
  const auto refused = [](const std::string& rows) {
    return refusal("flow: [{kind: grid, file: " + file_of("grid.csv", rows) + "}]");
  };
  std::string rows = "x,y,u,v\n";
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) rows += std::to_string(i) + "," + std::to_string(j) + ",0.01,0\n";
  EXPECT_EQ(refused(rows), "taken");
  EXPECT_EQ(refused("\xef\xbb\xbf" + rows + "\n"), "taken");
  EXPECT_THAT(refused(rows + "1,1,0,0\n"), HasSubstr("grid.csv:18: the place of line 7 once more"));
  EXPECT_THAT(refused(rows.substr(0, rows.rfind("3,3"))),
              HasSubstr("has a hole: no row for x = 3, y = 3"));
  EXPECT_THAT(refused(rows + "3.4,3,0,0\n"), HasSubstr("not on a regular grid"));
  EXPECT_THAT(refused(rows + "5,nan,0,0\n"), HasSubstr("grid.csv:18: \"nan\" is no finite number"));
  EXPECT_THAT(refused(rows + "5,3,0\n"), HasSubstr("grid.csv:18: 3 columns"));
  EXPECT_THAT(refused("x y u v\n"), HasSubstr("holds no rows"));
  EXPECT_THAT(refused("0 0 0 0\n1 0 0 0\n0 1 0 0\n1 1 0 0\n"), HasSubstr("must be at least 4"));
  EXPECT_THAT(refusal("flow: [{kind: grid, file: /nowhere/grid.csv}]"),
              HasSubstr("/nowhere/grid.csv"));
}

TEST(WorldFile, GridsTakeOtherUnitsAndTimes) {
  std::string rows = "# a comment\nx y t u v\n";
  for (int m = 0; m < 4; ++m)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        rows += std::to_string(i) + "\t" + std::to_string(j) + "\t" + std::to_string(m) + "\t" +
                std::to_string(m) + "\t0\n";
  const auto world = world_of("flow: [{kind: grid, file: " + file_of("timed.csv", rows) +
                              ", length: 2.0, time: 10.0}]");
  // u = t of the file's units: 2 / 10 a unit of speed, at 10 T0 a unit of time.
  EXPECT_NEAR(world->flow(15, {1, 1}).x(), 1.5 * 0.2, 1e-15);
  EXPECT_TRUE(world->within_grids(30, {6, 6}));
  EXPECT_FALSE(world->within_grids(31, {6, 6}));
  EXPECT_FALSE(world->within_grids(30, {6.1, 6}));
}

TEST(WorldFile, SteepFlowsAreRefusedBeforeTheFirstStep) {
  EnvironmentConfig config;
  config.world =
      world_of("flow: [{kind: uniform, U: [0.1, 0]}, {kind: linear, A: [[0, 30], [0, 0]]}]");
  try {
    config.validate();
    FAIL() << "taken";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("world.yaml/flow[1]"));
    EXPECT_THAT(error.what(), HasSubstr("4 sweeps"));
  }
  config.world = world_of("flow: [{kind: linear, A: [[0, 1], [0, 0]]}]");
  EXPECT_NO_THROW(config.validate());
}

TEST(WorldFile, EffectiveYamlReadsBackToTheSameWorld) {
  const std::string grid = [] {
    std::string rows;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) rows += std::to_string(i) + " " + std::to_string(j) + " 0.01 0\n";
    return file_of("again.csv", rows);
  }();
  const auto world =
      world_of("flow: [{kind: vortex, Gamma: 0.1, epsilon: 0.3}, {kind: grid, file: " + grid +
               "}]\nthermal_noise: 1.0e-05\n");
  EXPECT_THAT(world->yaml(), HasSubstr("sha256: "));
  const auto again = World::parse(world->yaml(), "again", "/");
  EXPECT_EQ(world->yaml(), again->yaml());
  EXPECT_EQ(world_difference(world.get(), again.get()), "");
  EXPECT_THAT(world_difference(world.get(), nullptr), HasSubstr("instead of nothing"));
  EXPECT_EQ(world->flow(0, {1, 2}), again->flow(0, {1, 2}));
  // The file is another one now.
  std::ofstream(grid, std::ios::app) << "# changed\n";
  EXPECT_THROW(World::parse(world->yaml(), "again", "/"), UsageError);
}

TEST(WorldFile, MapsBlockWhatIsNotFree) {
  // 4 x 3 pixels: a wall on the left, unknown (grey) above right, free elsewhere.
  const std::string picture(
      "P5\n# by hand\n4 3\n255\n\x00\xfe\xfe\x80\x00\xfe\xfe\xfe\x00\xfe\xfe\xfe", 33);
  const std::string pgm = file_of("map.pgm", picture);
  const std::string yaml =
      file_of("map.yaml",
              "image: map.pgm\nresolution: 0.5\norigin: [-1.0, -1.0, 0.0]\nnegate: 0\n"
              "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const auto world = world_of("obstacles: [{kind: map, file: " + yaml + "}]");
  ASSERT_EQ(world->obstacles().maps().size(), 1U);
  const OccupancyMap& map = world->obstacles().maps()[0];
  EXPECT_TRUE(map.blocks({-0.75, 0.0}));
  EXPECT_FALSE(map.blocks({-0.25, 0.25}));
  EXPECT_TRUE(map.blocks({0.75, 0.25}));  // unknown, in the upper right corner
  EXPECT_FALSE(map.blocks({0.75, -0.25}));
  EXPECT_FALSE(map.blocks({9, 9}));
  EXPECT_GT(world->obstacles().capsules().size(), 3U);

  const auto refused = [](const std::string& text) {
    return refusal("obstacles: [{kind: map, file: " + file_of("bad.yaml", text) + "}]");
  };
  EXPECT_THAT(refused("image: map.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 1.0]\n"),
              HasSubstr("must have no turn"));
  EXPECT_THAT(refused("image: map.pgm\norigin: [0.0, 0.0, 0.0]\n"),
              HasSubstr("resolution is missing"));
  EXPECT_THAT(refused("image: none.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 0.0]\n"),
              HasSubstr("none.pgm"));
  file_of("short.pgm", picture.substr(0, picture.size() - 1));
  EXPECT_THAT(refused("image: short.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 0.0]\n"),
              HasSubstr("bytes of pixels: must be 12"));
  file_of("no.pgm", "GIF89a");
  EXPECT_THAT(refused("image: no.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 0.0]\n"),
              HasSubstr("neither a PGM nor a PNG"));
}

}  // namespace
}  // namespace threelink_tests
