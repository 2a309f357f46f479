// rosrun threelink_tasks bag_urdf: the robot description of the swimmer in a bag; for
// playback.launch.
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "../node/recorded_swimmer.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/urdf.hpp"

namespace {

using namespace threelink_tasks;

std::string description(const std::string& path) {
  const auto simulator = recorded_swimmer(BagReader(path));
  return threelink_sim::urdf(
      {simulator.environment.model, simulator.scales.length, simulator.scales.time});
}

void run(const std::string& path, bool lenient) {
  try {
    fmt::print("{}", description(path));
  } catch (const std::exception& error) {
    const std::string text = error.what();
    if (!lenient)  // what cannot be opened is named already
      throw threelink_sim::UsageError(text.find(path) == 0 ? text : path + ": " + text);
    fmt::print("{}", threelink_sim::urdf({}));
  }
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("bag_urdf", [=] {
    std::string path;
    bool lenient = false;
    CLI::App app("Prints the URDF of the swimmer whose episode is in a bag: its links and scales");
    app.add_option("bag", path, "bag that the recorder wrote")->required();
    app.add_flag("--lenient", lenient,
                 "for a bag that cannot be read, print that of three links instead of failing: it "
                 "is\nfor others to say what is wrong with it");
    app.footer("Exit status: 0 printed; 1 failed; 2 wrong arguments or file.");
    if (threelink_sim::parse_command_line(app, argc, argv)) run(path, lenient);
    return 0;
  });
}
