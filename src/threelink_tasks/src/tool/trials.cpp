// rosrun threelink_tasks trials: many episodes of a task in one process.
#include "threelink_tasks/trials.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_agent/evaluate.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/plugins.hpp"
#include "threelink_sim/stroke.hpp"
#include "threelink_sim/yaml.hpp"

namespace {

using namespace threelink_tasks;
using threelink_agent::Policy;
using threelink_sim::yaml_number;

constexpr int kSuccess = 0;
constexpr double kVRatio = 0.5;                                    // of a pursuit
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // null in JSON

struct Options {
  std::string task, policy, waypoints, world, parameters = "{}";
  double v_ratio = 0;
  int max_steps = 0;
  CLI::Option* v_ratio_given = nullptr;  // whether they are
  CLI::Option* max_steps_given = nullptr;
  TrialsConfig trials;
  bool mean = false, sampled = false;  // neither: as the policy says
  bool json = false;
};

// "star" is the task "waypoints" with stars of every size and rotation.
std::string task_name(const Options& options) {
  return options.task == "star" ? "waypoints" : options.task;
}

// The task's parameters: those of --parameters, those that other options give, and the defaults of
// this tool for the rest.
YAML::Node parameters(const Options& options) {
  YAML::Node node;
  try {
    node = threelink_sim::parse_yaml(options.parameters);
  } catch (const threelink_sim::UsageError& error) {
    throw threelink_sim::within(fmt::format("--parameters {}", options.parameters), error);
  }
  if (node.IsNull()) node = YAML::Node(YAML::NodeType::Map);
  if (!node.IsMap())
    throw threelink_sim::UsageError(
        fmt::format("--parameters {}: must be a dictionary, such as '{{threshold: 0.05}}'",
                    options.parameters));
  const auto give = [&](const char* option, const char* key, const YAML::Node& value) {
    if (node[key])
      throw threelink_sim::UsageError(fmt::format("{} {} and --parameters {}: {} is given twice",
                                                  option, value.Scalar(), options.parameters, key));
    node[key] = value;
  };
  if (*options.v_ratio_given)
    give("--v-ratio", "v_ratio", YAML::Node(yaml_number(options.v_ratio)));
  if (*options.max_steps_given) give("--max-steps", "max_steps", YAML::Node(options.max_steps));
  if (!options.waypoints.empty()) {
    YAML::Node file(options.waypoints);
    file.SetTag("!");  // text, even if it looks like a number
    give("--waypoints", "points", file);
  }
  const auto given = [&](std::initializer_list<const char*> keys) {
    return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return node[key]; });
  };
  if (options.task == "pursuit" && !given({"v_ratio"})) node["v_ratio"] = yaml_number(kVRatio);
  if (options.task == "star" && !given({"points", "random_star", "radius", "rotation"}))
    node["random_star"] = true;
  return node;
}

double median(std::vector<double> values) {
  if (values.empty()) return kNaN;
  const std::size_t half = values.size() / 2;
  std::sort(values.begin(), values.end());
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

struct Summary {
  int completed = 0;
  double steps = 0, ratio = 0,
         final_distance = 0;  // medians: of the completed ones, but the last of all
};

// best_step: [L] of a step at the speed of the fastest stroke
Summary summarise(const std::vector<Trial>& trials, double best_step) {
  Summary summary;
  std::vector<double> steps, ratios, distances;
  for (const Trial& trial : trials) {
    distances.push_back(trial.measures.distance);
    if (trial.outcome != Outcome::kCaptured) continue;
    ++summary.completed;
    steps.push_back(static_cast<double>(trial.measures.steps));
    if (trial.path_length > 0) ratios.push_back(steps.back() / (trial.path_length / best_step));
  }
  summary.steps = median(steps);
  summary.ratio = median(ratios);
  summary.final_distance = median(distances);
  return summary;
}

void print(const Options& options, const Summary& summary) {
  if (options.json) {
    const nlohmann::json json = {{"completed", summary.completed},
                                 {"trials", options.trials.trials},
                                 {"median_steps", summary.steps},
                                 {"median_ratio", summary.ratio},
                                 {"final_distance_median", summary.final_distance}};
    fmt::print("{}\n", json.dump());
    return;
  }
  const auto or_dash = [](double value) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.5g}", value);
  };
  fmt::print("completed {} of {}; medians: steps {}, ratio {}, final distance {}\n",
             summary.completed, options.trials.trials, or_dash(summary.steps),
             or_dash(summary.ratio), or_dash(summary.final_distance));
}

int run(const Options& options) {
  threelink_sim::load_plugins();
  const Policy policy = Policy::load(options.policy);
  const double dt = policy.metadata().dt;
  const TaskContext context{dt, threelink_agent::evaluate(policy, 0, 0).speed};
  const YAML::Node values = parameters(options);
  const auto make = [&] {
    threelink_sim::ParameterMap map("parameters", values);
    std::unique_ptr<Task> task = make_task(task_name(options), map, context);
    map.finish();
    return task;
  };
  TrialsConfig config = options.trials;
  if (!options.world.empty()) config.world = threelink_sim::World::load(options.world);
  config.sampled = !options.mean && (options.sampled || policy.metadata().sampled);
  const double fastest = threelink_sim::fastest_speed(policy.metadata().links);
  const double best_speed = std::isnan(fastest) ? context.v_m : fastest;
  print(options, summarise(run_trials(make, policy, config), best_speed * dt));
  return kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("trials", [=] {
    Options options;
    CLI::App app(
        "Plays many episodes of a task in one process. Episode e of seed S is the same, to the "
        "bit,\n"
        "as over topics. Medians are over the completed episodes, that of the final distance over\n"
        "all; ratio = steps / (length of the way through the waypoints / (v dt)), with v the\n"
        "speed of the fastest stroke of so many links: 0.0129154 of three; of more than 8, or of\n"
        "two, the policy's own.\n");
    app.add_option(
           "--task", options.task,
           "star (of any size and rotation, unless --parameters says which), point (distance\n"
           "0.001 to 0.5), pursuit, or another one of docs/tasks.md")
        ->required();
    app.add_option("--policy", options.policy, "policy file (.safetensors)")->required();
    app.add_option("--trials", options.trials.trials, "1 to 1000000 (default 100)")
        ->check(threelink_sim::whole_number<int>(1, 1000000));
    app.add_option("--seed", options.trials.seed, "keys all randomness (default 0)")
        ->check(threelink_sim::whole_number<std::int64_t>(0));
    options.v_ratio_given = app.add_option("--v-ratio", options.v_ratio,
                                           "pursuit: speed of the target / speed of the policy"
                                           " (default 0.5)")
                                ->check(threelink_sim::real_number(0, 100));
    options.max_steps_given =
        app.add_option("--max-steps", options.max_steps, "time-out (default: that of the task)")
            ->check(threelink_sim::whole_number<int>(1));
    auto* mean =
        app.add_flag("--mean", options.mean,
                     "play the mean action (without this and the next: as the policy says)");
    app.add_flag("--sampled", options.sampled, "draw actions from the policy's distribution")
        ->excludes(mean);
    app.add_option("--waypoints", options.waypoints, "star: these points (CSV or YAML) instead");
    app.add_option("--world", options.world,
                   "world file: flow, obstacles, thermal noise (docs/world.md)");
    app.add_option("--parameters", options.parameters,
                   "further parameters of the task, YAML: '{threshold: 0.05}'; none that another\n"
                   "option gives");
    app.add_flag("--json", options.json, "one line of JSON instead of text");
    app.footer("Exit status: 0 played; 1 failed; 2 wrong arguments or file.");
    if (!threelink_sim::parse_command_line(app, argc, argv)) return kSuccess;
    try {
      return run(options);
    } catch (const threelink_agent::PolicyError& error) {
      throw threelink_sim::within("--policy", error);
    }
  });
}
