// Plays prescribed hinge rates on one swimmer, without a ROS master: CSV in, CSV out.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/csv.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/swimmer.hpp"

namespace {

using namespace threelink_sim;

constexpr std::size_t kMaxRateBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxRows = 2'000'000;

SwimmerState read_start(const Model& model, const std::string& text) {
  const std::size_t values = 3 + model.hinges();
  const auto given = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',') + 1);
  if (given != values)
    throw UsageError(
        fmt::format("--start has {} values: {} links need X1,Y1,THETA1 and {} hinge angles", given,
                    model.links, model.hinges()));
  const std::vector<CsvRow> rows = parse_csv(text, "--start", {values, 1});
  if (rows.empty()) throw UsageError("--start: is empty");
  const std::vector<double>& v = rows[0].values;
  const HingeVector alpha = HingeVector::Map(v.data() + 3, model.hinges());
  SwimmerState state = state_from_free_end(model, {v[0], v[1]}, v[2], alpha);
  validate(model, state);
  return state;
}

std::vector<CsvRow> read_rates(const Model& model, const std::string& path) {
  const auto hinges = static_cast<std::size_t>(model.hinges());
  std::vector<CsvRow> rates = parse_csv(read_input(path, kMaxRateBytes), path, {hinges, kMaxRows});
  if (rates.empty()) throw UsageError(fmt::format("{}: has no rows", path));
  return rates;
}

std::string header(const Model& model) {
  std::string text = "t,x1,y1";
  for (int i = 1; i <= model.links; ++i) text += fmt::format(",theta_{}", i);
  return text + ",xc,yc,work\n";
}

std::string row(const Model& model, const SwimmerState& state, double t, double work) {
  const Eigen::Vector2d x_1 = free_end(model, state);
  std::string text = fmt::format("{:.17g},{:.17g},{:.17g}", t, x_1.x(), x_1.y());
  const auto theta = link_angles(model, state);
  for (Eigen::Index i = 0; i < theta.size(); ++i) text += fmt::format(",{:.17g}", theta[i]);
  return text +
         fmt::format(",{:.17g},{:.17g},{:.17g}\n", state.centroid.x(), state.centroid.y(), work);
}

struct Options {
  std::string start, rates, out;
  double dt = 0.1;
  bool clip = false;
  Model model;
};

int swim(const Options& options) {
  const OutputFile out("--out", options.out, {options.rates});
  const Model& model = options.model;
  model.validate();
  if (!(options.dt > 0 && std::isfinite(options.dt)))
    throw UsageError(fmt::format("--dt {}: must be positive", options.dt));
  SwimmerState state = read_start(model, options.start);
  const std::vector<CsvRow> rates = read_rates(model, options.rates);

  double work = 0;
  std::string text = header(model) + row(model, state, 0, work);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const HingeVector wanted = HingeVector::Map(rates[k].values.data(), model.hinges());
    const StepResult step = advance(model, state, wanted, options.dt,
                                    substeps(model, options.dt, wanted.cwiseAbs().maxCoeff()));
    if (!options.clip && step.rates != wanted)
      throw UsageError(
          fmt::format("{}:{}: a hinge would pass the joint limit of {} rad (--clip cuts the rate "
                      "instead)",
                      options.rates, rates[k].line, model.joint_limit));
    work += step.work;
    text += row(model, state, (k + 1) * options.dt, work);
  }
  out.write(text);
  return 0;
}

void declare(CLI::App& app, Options& options) {
  app.add_option("--start", options.start,
                 "X1,Y1,THETA1,ALPHA1[,ALPHA2...]: free end of link 1, its angle, hinge angles "
                 "[rad]")
      ->required();
  app.add_option("--rates", options.rates,
                 "CSV of hinge rates: one row a step, one column a hinge, no header")
      ->required();
  app.add_option("--out", options.out,
                 "CSV to write: t,x1,y1,theta_1..theta_N,xc,yc,work (work since the start); the "
                 "start in its first row")
      ->required();
  app.add_option("--dt", options.dt, "length of a step [T0]")
      ->check(real_number())
      ->capture_default_str();
  app.add_option("--links", options.model.links, "number of links N")
      ->check(whole_number<int>(2, kMaxLinks))
      ->capture_default_str();
  app.add_option("--gamma", options.model.gamma, "drag ratio C_parallel / C_perp")
      ->check(real_number())
      ->capture_default_str();
  app.add_flag("--clip", options.clip,
               "cut rates at the joint limit of 2 pi/3 instead of refusing them");
  app.footer(
      "Exit status: 0 written; 1 failed; 2 wrong arguments or file, and --out is as it was.");
}

}  // namespace

int main(int argc, char** argv) {
  return run_tool("swim", [=] {
    CLI::App app(
        "Plays prescribed hinge rates on the N-link swimmer, dimensionless: lengths in L, times in "
        "T0, work in C_perp L^3/T0.");
    Options options;
    declare(app, options);
    return parse_command_line(app, argc, argv) ? swim(options) : 0;
  });
}
