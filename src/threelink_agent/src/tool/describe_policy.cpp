// rosrun threelink_agent describe_policy: what a policy file says of itself.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_agent/policy.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/urdf.hpp"

namespace {

using namespace threelink_agent;

using Fields = std::vector<std::pair<std::string, std::string>>;

Fields fields_of(const Policy& policy) {
  const PolicyMetadata& metadata = policy.metadata();
  std::string layers = std::to_string(policy.observation_size());
  for (const Linear& layer : policy.actor().layers())
    layers += fmt::format(" {}", layer.bias.size());
  std::string std;
  for (Eigen::Index i = 0; i < policy.log_std().size(); ++i)
    std += fmt::format("{}{:.4g}", std.empty() ? "" : " ", std::exp(policy.log_std()[i]));
  return {{"sha256", policy.sha256()},
          {"observation", to_string(metadata.observation)},
          {"sampled", metadata.sampled ? "true" : "false"},
          {"std", std},
          {"links", fmt::format("{}", metadata.links)},
          {"dt", fmt::format("{}", metadata.dt)},
          {"gamma", fmt::format("{}", metadata.gamma)},
          {"joint_limit", fmt::format("{}", metadata.joint_limit)},
          {"symmetry", to_string(metadata.symmetry)},
          {"layers", layers}};
}

void describe(const std::string& path, const std::string& only, bool config, bool urdf) {
  const Policy policy = Policy::load(path);
  if (urdf) {
    fmt::print("{}", threelink_sim::urdf({policy.metadata().environment().model}));
    return;
  }
  if (config) {
    fmt::print("{}", policy.metadata().config);
    return;
  }
  bool found = only.empty();
  for (const auto& [name, value] : fields_of(policy)) {
    if (only.empty()) fmt::print("{}: {}\n", name, value);
    // Without an end of line: roslaunch takes every byte for the value of a parameter.
    if (only == name) fmt::print("{}", value);
    found = found || only == name;
  }
  if (!found)
    throw threelink_sim::UsageError(fmt::format("--field {}: there is no such field", only));
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("describe_policy", [=] {
    std::string path, field;
    bool config = false, urdf = false;
    CLI::App app(
        "Checks a policy file and prints what it says of itself: hash of the numbers, "
        "observation,\n"
        "whether its actions are to be sampled (else their mean is played) and with what standard\n"
        "deviation [1/T0], the swimmer that it is for, widths of the network.\n");
    app.add_option("file", path, "policy file (.safetensors)")->required();
    auto* only = app.add_option("--field", field, "print only the value of this field");
    app.add_flag("--config", config, "print the configuration with which it was trained")
        ->excludes(only);
    app.add_flag("--urdf", urdf, "print the robot description of the swimmer that it is for")
        ->excludes(only)
        ->excludes("--config");
    app.footer("Exit status: 0 it is a policy; 1 failed; 2 it is none, or wrong arguments.");
    if (threelink_sim::parse_command_line(app, argc, argv)) describe(path, field, config, urdf);
    return 0;
  });
}
