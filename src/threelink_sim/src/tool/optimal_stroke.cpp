// rosrun threelink_sim optimal_stroke: the best strokes that there are, without a ROS master.
#include "threelink_sim/optimal_stroke.hpp"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/stroke_file.hpp"

namespace {

using namespace threelink_sim;
using nlohmann::json;

constexpr int kSuccess = 0;
// More where the rates vary within a stroke, so that holding them costs below 1e-4 of the value.
constexpr int kPieces = 240, kPiecesOfEfficiency = 400;

const std::map<std::string, Objective> kObjectives{{"speed", Objective::kSpeed},
                                                   {"efficiency", Objective::kEfficiency},
                                                   {"energy_aware", Objective::kEnergyAware}};

struct Options {
  std::string objective, out;
  std::vector<double> square;  // low and high angle, or empty
  int pieces = 0;              // 0: as many as the objective wants
  StrokeSearch search;
  bool print_json = false;
};

// A climb as it goes: on a terminal one line that is redrawn, elsewhere one every few seconds; and
// one when it is over.
class Progress {
 public:
  ~Progress() {
    if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
  }

  void show(const Climb& climb) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::milliseconds wait(terminal_ ? 100 : 5000);
    if (now - last_ < wait) return;
    last_ = now;
    shown_ = true;
    const ClimbStep& step = climb.history.back();
    fmt::print(stderr, "{}{} ({} pieces): step {}, value {:.8g}, violation {:.1e}{}",
               terminal_ ? "\r\033[K" : "", climb.name, climb.pieces, step.evaluation, step.value,
               step.violation, terminal_ ? "" : "\n");
    std::fflush(stderr);
  }

  void finish(const Climb& climb) {
    if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
    fmt::print(stderr, "{:<12} {:>4} pieces {:>4} steps {:>7.1f} s  {}\n", climb.name, climb.pieces,
               climb.history.size(), climb.seconds,
               climb.converged ? fmt::format("value {:.8g}", climb.value) : "did not converge");
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO);
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

json climbs_to_json(const std::vector<Climb>& climbs) {
  json list = json::array();
  for (const Climb& climb : climbs) {
    json history = json::array();
    for (const ClimbStep& s : climb.history)
      history.push_back({s.evaluation, s.value, s.violation});
    list.push_back({{"name", climb.name},
                    {"pieces", climb.pieces},
                    {"converged", climb.converged},
                    {"value", climb.value},
                    {"seconds", climb.seconds},
                    {"history", history}});
  }
  return list;
}

// The command that plays the stroke.
std::string swim_command(const json& stroke, const std::string& csv) {
  std::string start;
  for (double value : stroke["start"]["x_1"]) start += fmt::format("{:.17g},", value);
  start += fmt::format("{:.17g}", stroke["start"]["theta_1"].get<double>());
  for (double value : stroke["start"]["alpha"]) start += fmt::format(",{:.17g}", value);
  return fmt::format(
      "rosrun threelink_sim swim --start={} --rates {} --dt {:.17g} --links {} --gamma {:.17g} "
      "--out OUT.csv",
      start, csv, stroke["dt"].get<double>(), stroke["links"].get<int>(),
      stroke["gamma"].get<double>());
}

json found_stroke(const Options& options) {
  StrokeSearch search = options.search;
  search.objective = kObjectives.at(options.objective);
  const bool efficiency = search.objective == Objective::kEfficiency;
  search.pieces = options.pieces > 0 ? options.pieces : efficiency ? kPiecesOfEfficiency : kPieces;
  const auto begin = std::chrono::steady_clock::now();
  Progress progress;
  const OptimalStroke optimum = find_optimal_stroke(
      search, [&](const Climb& climb) { progress.show(climb); },
      [&](const Climb& climb) { progress.finish(climb); });
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  json all = stroke_to_json(optimum.stroke, aligned_start(optimum.stroke));
  all["objective"] = options.objective;
  if (search.objective == Objective::kEnergyAware) {
    all["b"] = search.b;
    all["c"] = search.c;
  }
  all["value"] = optimum.value;
  all["seed"] = search.seed;
  all["climbs"] = climbs_to_json(optimum.climbs);
  all["seconds"] = seconds.count();
  return all;
}

json square(const Options& options) {
  const Stroke stroke = square_stroke(options.search.model, options.square[0], options.square[1],
                                      options.pieces > 0 ? options.pieces : kPieces);
  SwimmerState start;  // centroid and heading 0
  start.alpha = stroke.start;
  json all = stroke_to_json(stroke, start);
  all["objective"] = "square";
  return all;
}

int run(const Options& options) {
  // A folder that is not there is better known before the search.
  const OutputFile csv("--out", options.out + ".csv"), json_file("--out", options.out + ".json");
  json all = options.square.empty() ? found_stroke(options) : square(options);
  all["swim"] = swim_command(all, csv.path());
  csv.write(rates_as_csv(all["rates"]));
  json_file.write(all.dump() + "\n");
  if (options.print_json) {
    fmt::print("{}\n", all.dump());
  } else {
    const auto number = [&](const char* name) { return all[name].get<double>(); };
    fmt::print(
        "speed {:.7f}, efficiency {:.4f} %, period {:.5f}, displacement {:.7f}, rotation {:.2g}\n",
        number("speed"), 100 * number("efficiency"), number("period"), number("displacement"),
        number("rotation"));
    fmt::print("{}\n{}\nplay: {}\n", csv.path(), json_file.path(), all["swim"].get<std::string>());
  }
  return kSuccess;
}

// Declares the options and parses the command line; false if only help was asked for.
bool parse(int argc, char** argv, Options& options) {
  StrokeSearch& search = options.search;
  CLI::App app(
      "Finds the best stroke: periodic hinge rates within [-1, 1], piecewise constant, that do "
      "not\n"
      "turn the swimmer. Direct transcription on the product's physics, climbed by NLopt's SLSQP\n"
      "from random starts. Dimensionless: lengths in L, times in T0.\n");
  auto* objective =
      app.add_option("--objective", options.objective,
                     "what is to be largest: speed; efficiency, gamma v^2 / Phi; energy_aware, "
                     "b v - c Phi")
          ->check(CLI::IsMember(kObjectives));
  auto* square = app.add_option("--square", options.square,
                                "LOW,HIGH [rad]: no search, but Purcell's stroke between these "
                                "angles, one outer hinge at a time")
                     ->check(real_number())
                     ->delimiter(',')
                     ->expected(2)
                     ->excludes(objective);
  app.add_option("--out", options.out, "writes OUT.csv (rates, for swim) and OUT.json (all)")
      ->required();
  auto* b = app.add_option("--b", search.b, "weight of the speed, of energy_aware")
                ->check(real_number())
                ->capture_default_str();
  auto* c = app.add_option("--c", search.c, "weight of the power, likewise")
                ->check(real_number())
                ->capture_default_str();
  app.add_option("--links", search.model.links, "number of links N")
      ->check(whole_number<int>(2, kMaxLinks))
      ->capture_default_str();
  app.add_option("--gamma", search.model.gamma, "drag ratio C_parallel / C_perp")
      ->check(real_number())
      ->capture_default_str();
  app.add_option("--joint-limit", search.model.joint_limit, "[rad] of each hinge angle")
      ->check(real_number())
      ->capture_default_str();
  auto* pieces =
      app.add_option("--pieces", options.pieces,
                     fmt::format("of a period, in which rates are held (default {}; efficiency {})",
                                 kPieces, kPiecesOfEfficiency))
          ->check(whole_number<int>(1, 1000));
  app.add_option("--dt", search.dt,
                 "length of a piece [T0], so that the period is a multiple of it")
      ->check(real_number(1e-3, 1.0))
      ->excludes(pieces)
      ->excludes(square);
  app.add_option("--starts", search.starts, "random starts")
      ->check(whole_number<int>(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", search.seed, "keys the starts")
      ->capture_default_str()
      ->check(whole_number<std::int64_t>(0));
  app.add_flag("--json", options.print_json, "prints the JSON, in one line, instead of text");
  app.footer("Exit status: 0 written; 1 no start converged; 2 wrong arguments or file.");
  if (!parse_command_line(app, argc, argv)) return false;
  if (objective->count() + square->count() == 0)
    throw UsageError("--objective or --square is required");
  if (b->count() + c->count() > 0 && options.objective != "energy_aware")
    throw UsageError("--b, --c: weights of --objective energy_aware only");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  return run_tool("optimal_stroke", [=] {
    Options options;
    return parse(argc, argv, options) ? run(options) : kSuccess;
  });
}
