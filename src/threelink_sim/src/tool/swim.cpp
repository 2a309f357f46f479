// Plays prescribed hinge rates on one swimmer, in still water or in a world, without a ROS master:
// CSV in, CSV out.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/command_line.hpp"
#include "threelink_sim/csv.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/plugins.hpp"
#include "threelink_sim/swimmer.hpp"
#include "threelink_sim/world/world_stepper.hpp"

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
  return text + ",xc,yc,work,dissipation\n";
}

// What has been done since the start. [C_perp L^3/T0]
struct Energy {
  double work = 0, dissipation = 0;
};

std::string row(const Model& model, const SwimmerState& state, double t, const Energy& energy) {
  const Eigen::Vector2d x_1 = free_end(model, state);
  std::string text = fmt::format("{:.17g},{:.17g},{:.17g}", t, x_1.x(), x_1.y());
  const auto theta = link_angles(model, state);
  for (Eigen::Index i = 0; i < theta.size(); ++i) text += fmt::format(",{:.17g}", theta[i]);
  return text + fmt::format(",{:.17g},{:.17g},{:.17g},{:.17g}\n", state.centroid.x(),
                            state.centroid.y(), energy.work, energy.dissipation);
}

struct Options {
  std::string start, rates, out, world;
  double dt = 0.1, t0 = 0;
  std::uint64_t seed = 0;
  bool clip = false;
  Model model;
};

// The swimmer, stepped in what surrounds it.
class Swimmer {
 public:
  Swimmer(const Options& options, const SwimmerState& start)
      : model_(options.model), dt_(options.dt), batch_(options.model, 1) {
    batch_.set_state(0, start);
    if (options.world.empty()) return;
    world_ = World::load(options.world);
    stepper_.emplace(world_, model_, 1);
    const EpisodeKey key{options.seed, 0, options.t0};
    stepper_->check_start(start, key);
    stepper_->begin(0, key);
  }

  SwimmerState state() const { return batch_.state(0); }
  const Energy& energy() const { return energy_; }
  double time() const { return stepper_ ? stepper_->time(0, dt_) : steps_ * dt_; }

  // Returns the rates that were applied.
  HingeVector step(const HingeVector& wanted) {
    const int count = substeps(model_, dt_, wanted.cwiseAbs().maxCoeff());
    for (int j = 0; j < wanted.size(); ++j) batch_.rates(j)[0] = wanted[j];
    if (stepper_) {
      world_->check_step(dt_, count);
      stepper_->advance(batch_, dt_, count);
      if (stepper_->left_grid(0))
        throw UsageError(
            fmt::format("step {}: the swimmer has left the grid of the flow", steps_ + 1));
    } else {
      batch_.advance(dt_, count);
    }
    ++steps_;
    energy_.work += batch_.work()[0];
    energy_.dissipation += stepper_ ? stepper_->dissipation()[0] : batch_.work()[0];
    HingeVector applied(wanted.size());
    for (int j = 0; j < wanted.size(); ++j) applied[j] = batch_.rates(j)[0];
    return applied;
  }

 private:
  Model model_;
  double dt_;
  Batch batch_;
  std::shared_ptr<const World> world_;
  std::optional<WorldStepper> stepper_;
  Energy energy_;
  int steps_ = 0;
};

int swim(const Options& options) {
  const OutputFile out("--out", options.out, {options.rates});
  const Model& model = options.model;
  model.validate();
  if (!(options.dt > 0 && std::isfinite(options.dt)))
    throw UsageError(fmt::format("--dt {}: must be positive", options.dt));
  Swimmer swimmer(options, read_start(model, options.start));
  const std::vector<CsvRow> rates = read_rates(model, options.rates);

  std::string text = header(model) + row(model, swimmer.state(), swimmer.time(), swimmer.energy());
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const HingeVector wanted = HingeVector::Map(rates[k].values.data(), model.hinges());
    const HingeVector applied = swimmer.step(wanted);
    if (!options.clip && applied != wanted)
      throw UsageError(fmt::format(
          "{}:{}: a hinge would pass the joint limit of {} rad{} (--clip cuts the rate instead)",
          options.rates, rates[k].line, model.joint_limit,
          options.world.empty() ? "" : ", or a link is jammed between obstacles"));
    text += row(model, swimmer.state(), swimmer.time(), swimmer.energy());
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
  app.add_option(
         "--out", options.out,
         "CSV to write: t,x1,y1,theta_1..theta_N,xc,yc,work,dissipation (these two since the "
         "start); the start in its first row")
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
  app.add_option("--world", options.world,
                 "world file: flow, obstacles, thermal noise (docs/world.md)");
  app.add_option("--t0", options.t0, "time of the flow at the start [T0]")
      ->check(real_number())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the thermal noise")
      ->check(whole_number<std::int64_t>(0))
      ->capture_default_str();
  app.add_flag("--clip", options.clip,
               "cut rates at the joint limit of 2 pi/3 instead of refusing them");
  app.footer(
      "Exit status: 0 written; 1 failed; 2 wrong arguments or file, and --out is as it was.");
}

}  // namespace

int main(int argc, char** argv) {
  return run_tool("swim", [=] {
    load_plugins();  // as flows of the world
    CLI::App app(
        "Plays prescribed hinge rates on the N-link swimmer, dimensionless: lengths in L, times in "
        "T0, work in C_perp L^3/T0.");
    Options options;
    declare(app, options);
    return parse_command_line(app, argc, argv) ? swim(options) : 0;
  });
}
