// rosrun threelink_agent evaluate: the paper's measures of a policy file.
#include "threelink_agent/evaluate.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"

namespace {

using namespace threelink_agent;

double degrees(double radians) { return radians * 180 / threelink_sim::kPi; }

std::string or_dash(double value, int digits, const char* unit) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f} {}", value, digits, unit);
}

// NaN, what is not defined, becomes null.
void print_json(const Evaluation& evaluation) {
  nlohmann::json starts = nlohmann::json::array();
  for (const StartResult& start : evaluation.starts)
    starts.push_back({{"theta2", start.theta_2},
                      {"speed", start.speed},
                      {"efficiency", start.efficiency},
                      {"period_steps", start.period_steps},
                      {"theta_s_deg", degrees(start.theta_s)},
                      {"steering_steps", start.steering_steps}});
  const nlohmann::json json = {{"starts", starts},
                               {"speed", evaluation.speed},
                               {"efficiency", evaluation.efficiency},
                               {"success_rate", evaluation.success_rate},
                               {"theta_s_deg", degrees(evaluation.theta_s)},
                               {"trials", evaluation.trials}};
  fmt::print("{}\n", json.dump());
}

void print_table(const Policy& policy, const Evaluation& evaluation) {
  fmt::print("policy {}\n", policy.sha256());
  fmt::print("{:>12}{:>12}{:>14}{:>16}{:>15}{:>18}\n", "theta_2", "speed", "efficiency", "period",
             "theta_s", "steering");
  for (const StartResult& start : evaluation.starts)
    fmt::print("{:>8.1f} deg{:>12.6f}{:>12.4f} %{:>16}{:>15}{:>12} steps\n", degrees(start.theta_2),
               start.speed, 100 * start.efficiency, or_dash(start.period_steps, 2, "steps"),
               or_dash(degrees(start.theta_s), 3, "deg"), start.steering_steps);
  fmt::print("{:>12}{:>12.6f}{:>12.4f} %\n", "mean", evaluation.speed, 100 * evaluation.efficiency);
  if (evaluation.trials > 0)
    fmt::print("success: {:.1f} % of {} random starts, mean |theta_s| {}\n",
               100 * evaluation.success_rate, evaluation.trials,
               or_dash(degrees(evaluation.theta_s), 3, "deg"));
}

std::string tracks_as_csv(const Policy& policy) {
  const threelink_sim::Model model = policy.metadata().environment().model;
  std::string text = fmt::format("start,t,xc,yc,theta_{}", model.heading_link() + 1);
  for (int j = 1; j <= model.hinges(); ++j) text += fmt::format(",alpha_{}", j);
  text += ",work\n";
  const std::vector<Track> tracks = straight_tracks(policy);
  for (std::size_t start = 0; start < tracks.size(); ++start) {
    const Track& track = tracks[start];
    for (std::size_t k = 0; k < track.x.size(); ++k) {
      text += fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g}", start, k * policy.metadata().dt,
                          track.x[k], track.y[k], track.heading[k]);
      for (int j = 0; j < model.hinges(); ++j)
        text += fmt::format(",{:.17g}", track.alpha(j, static_cast<Eigen::Index>(k)));
      text += fmt::format(",{:.17g}\n", track.work[k]);
    }
  }
  return text;
}

Policy load(const std::string& path) {
  try {
    return Policy::load(path);
  } catch (const PolicyError& error) {
    throw PolicyError(std::string("--policy ") + error.what());
  }
}

struct Options {
  std::string policy, trajectory;
  int trials = 100;
  std::uint64_t seed = 0;
  bool straight = false, json = false;
};

void run(const Options& options) {
  std::optional<threelink_sim::OutputFile> trajectory;
  if (!options.trajectory.empty())
    trajectory.emplace("--trajectory", options.trajectory,
                       std::vector<std::string>{options.policy});
  const Policy policy = load(options.policy);
  const Evaluation evaluation =
      evaluate(policy, options.trials, options.seed,
               options.straight ? RandomStarts::kStraight : RandomStarts::kBent);
  if (trajectory) trajectory->write(tracks_as_csv(policy));
  options.json ? print_json(evaluation) : print_table(policy, evaluation);
}

bool parse(int argc, char** argv, Options& options) {
  CLI::App app(
      "Measures a policy as the paper does, with its mean action: 1500 steps towards theta_T = 0 "
      "from\n"
      "straight starts with theta_2 = 0, pi/3 and pi/2, and the share of random starts, of any\n"
      "heading and shape, from which it comes to swim within 2.5 degrees of that direction.\n");
  app.add_option("--policy", options.policy, "policy file (.safetensors)")->required();
  app.add_option("--trials", options.trials, "random starts, 0 to 1000000 (default 100)")
      ->check(threelink_sim::whole_number<int>(0, 1000000));
  app.add_option("--seed", options.seed, "of the random starts (default 0)")
      ->check(threelink_sim::whole_number<std::int64_t>(0));
  app.add_flag("--straight", options.straight,
               "random starts are straight; only the heading is random");
  app.add_option("--trajectory", options.trajectory,
                 "CSV to write of the three straight starts, a row a state:\n"
                 "start,t,xc,yc,theta_2,alpha_1,alpha_2,work (start 0 to 2; xc, yc from 0;\n"
                 "work since the start); of N links alpha_1 to alpha_{N-1}, and the angle of link\n"
                 "N/2 + 1, rounded down, instead of theta_2");
  app.add_flag("--json", options.json, "one line of JSON instead of a table");
  app.footer(
      "Units: speed in L/T0, efficiency gamma v^2 / Phi, steps of the policy's dt.\n"
      "Exit status: 0 measured; 1 failed; 2 wrong arguments or file.");
  return threelink_sim::parse_command_line(app, argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("evaluate", [=] {
    Options options;
    if (parse(argc, argv, options)) run(options);
    return 0;
  });
}
