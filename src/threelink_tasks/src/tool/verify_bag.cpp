// Proof by replay of a recorded episode, without a ROS master.
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ros/package.h>

#include "bag_verifier.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/plugins.hpp"

namespace threelink_tasks {
namespace {

enum ExitStatus { kProven = 0, kNotProven = 1 };

struct Options {
  std::string bag;
  std::vector<std::string> policies;
  bool json = false;
};

// What the user gave must be there; what the bag names, or holds, or the package ships may be.
KnownPolicies find_policies(const Options& options, const RecordedBag& bag) {
  KnownPolicies policies;
  for (const std::string& path : options.policies) policies.add_file(path);
  if (bag.episodes.first()) policies.try_file(bag.episodes.first()->policy_file);
  for (const auto& policy : bag.policies.all())
    policies.try_bytes({policy->data.begin(), policy->data.end()});
  policies.try_folder(ros::package::getPath("threelink_tasks") + "/config/policies");
  return policies;
}

void print_json(const RecordedBag& bag, const Verdict& verdict) {
  nlohmann::json json = {{"ok", !verdict.difference},
                         {"whole", verdict.whole},
                         {"agreed", verdict.agreed},
                         {"actions_proven", verdict.actions_proven},
                         {"targets_proven", verdict.targets_proven},
                         {"watchdog_steps", verdict.watchdog_steps},
                         {"not_compared", bag.others},
                         {"difference", nullptr}};
  if (bag.episodes.first()) json["episode"] = bag.episodes.first()->episode;
  if (verdict.difference)
    json["difference"] = {{"step", verdict.difference->step},
                          {"field", verdict.difference->what.field},
                          {"recorded", verdict.difference->what.recorded},
                          {"replayed", verdict.difference->what.replayed}};
  fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string listed(const std::map<std::string, std::uint64_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text.empty() ? "nothing" : text;
}

// Whatever bytes a damaged bag holds: none reaches the terminal as it is.
std::string printable(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes)
    text += byte == '\n' || (byte >= ' ' && byte <= '~')
                ? std::string(1, byte)
                : fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
  return text;
}

std::string report(const RecordedBag& bag, const Verdict& verdict) {
  std::string text;
  const auto* start = bag.episodes.first();
  const std::string episode =
      start ? fmt::format("episode {} of {}, seed {}", start->episode, start->task, start->seed)
            : "no episode";
  if (verdict.difference) {
    const FieldDifference& what = verdict.difference->what;
    text += fmt::format("NOT PROVEN: {}, step {}, {}\n  recorded: {}\n  replayed: {}\n", episode,
                        verdict.difference->step, what.field, what.recorded, what.replayed);
    if (!verdict.whole)
      text += fmt::format(
          "this bag is not whole: its recorder did not close it; up to there it agrees\n");
  } else {
    const auto* end = bag.episodes.last();
    text += fmt::format("OK: {}, {} steps{}\n", episode, end->step,
                        end->reason.empty() ? "" : ", aborted: " + end->reason);
  }
  text += fmt::format("equal to the bit: {}\n", listed(verdict.agreed));
  const auto rates = verdict.agreed.find("hinge_rates");
  const std::uint64_t actions = rates == verdict.agreed.end() ? 0 : rates->second;
  text += fmt::format(
      "recomputed: {} of {} actions{}; {}\n", verdict.actions_proven, actions,
      verdict.actions_proven < actions ? " (the policy is not at hand)" : "",
      verdict.targets_proven ? "targets from the seed" : "targets are taken as recorded");
  if (verdict.watchdog_steps > 0)
    text +=
        fmt::format("taken with zero rates by the watchdog: {} steps\n", verdict.watchdog_steps);
  if (!bag.others.empty())
    text += fmt::format("held to the recorder's checksums only: {}\n", listed(bag.others));
  return text;
}

std::pair<RecordedBag, Verdict> verify(const Options& options) {
  try {
    threelink_sim::load_plugins();
    RecordedBag bag = read_bag(options.bag);
    Verdict verdict = BagVerifier(bag, find_policies(options, bag)).verify();
    return {std::move(bag), std::move(verdict)};
  } catch (const threelink_sim::UsageError& error) {
    throw threelink_sim::UsageError(printable(error.what()));
  } catch (const std::exception& error) {  // whatever is wrong with it, it is not a difference
    throw threelink_sim::UsageError(printable(fmt::format("{}: {}", options.bag, error.what())));
  }
}

int run(const Options& options) {
  const auto [bag, verdict] = verify(options);
  if (options.json) {
    print_json(bag, verdict);
  } else {
    fmt::print("{}", printable(report(bag, verdict)));
  }
  return verdict.difference ? kNotProven : kProven;
}

}  // namespace
}  // namespace threelink_tasks

int main(int argc, char** argv) {
  using namespace threelink_tasks;
  return threelink_sim::run_tool("verify_bag", [=] {
    Options options;
    CLI::App app(
        "Replays a recorded episode: whether every state, observation, target, action, power and\n"
        "reward in the bag follows, to the bit, from its seed, configuration and hinge rates.\n");
    app.add_option("BAG", options.bag, "a bag of the recorder")->required();
    app.add_option(
        "--policy", options.policies,
        "policy file; those that the bag names or holds, and those in config/policies, are "
        "found without it");
    app.add_flag("--json", options.json, "one line of JSON");
    app.footer(
        "Says OK with counts, or the first difference: step, field, the recorded value and the\n"
        "replayed one. Exit status: 0 the bag proves itself; 1 it does not; 2 wrong arguments, or "
        "the\n"
        "file cannot be read, is damaged or no bag of the recorder.");
    return threelink_sim::parse_command_line(app, argc, argv) ? run(options) : int{kProven};
  });
}
