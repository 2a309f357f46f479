// Plays prescribed hinge rates on one swimmer, without a ROS master: CSV in, CSV out.
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "threelink_sim/swimmer.hpp"

namespace {

using namespace threelink_sim;

// A finite number, all of `text`; throws std::invalid_argument that begins with `where`.
double number(const std::string& text, const std::string& where) {
  std::size_t used = 0;
  double value = NAN;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  while (used < text.size() && std::isspace(static_cast<unsigned char>(text[used]))) ++used;
  if (used != text.size() || !std::isfinite(value))
    throw std::invalid_argument(fmt::format("{}: \"{}\" is not a finite number", where, text));
  return value;
}

std::vector<double> numbers(const std::string& row, const std::string& where) {
  std::vector<double> values;
  std::stringstream cells(row);
  for (std::string cell; std::getline(cells, cell, ',');)
    values.push_back(number(cell, fmt::format("{}, column {}", where, values.size() + 1)));
  return values;
}

SwimmerState read_start(const Model& model, const std::string& text) {
  const std::vector<double> v = numbers(text, "--start");
  if (static_cast<int>(v.size()) != 3 + model.hinges())
    throw std::invalid_argument(
        fmt::format("--start has {} values: {} links need X1,Y1,THETA1 and {} hinge angles",
                    v.size(), model.links, model.hinges()));
  const HingeVector alpha = HingeVector::Map(v.data() + 3, model.hinges());
  const SwimmerState state = state_from_free_end(model, {v[0], v[1]}, v[2], alpha);
  validate(model, state);
  return state;
}

std::vector<HingeVector> read_rates(const Model& model, const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::invalid_argument(fmt::format("{}: cannot be read", path));
  std::vector<HingeVector> rates;
  for (std::string row; std::getline(file, row);) {
    const std::string where = fmt::format("{}, row {}", path, rates.size() + 1);
    const std::vector<double> v = numbers(row, where);
    if (static_cast<int>(v.size()) != model.hinges())
      throw std::invalid_argument(fmt::format("{}: {} values, {} links have {} hinges", where,
                                              v.size(), model.links, model.hinges()));
    rates.push_back(HingeVector::Map(v.data(), model.hinges()));
  }
  if (rates.empty()) throw std::invalid_argument(fmt::format("{}: has no rows", path));
  return rates;
}

void write_header(std::ostream& out, const Model& model) {
  out << "t,x1,y1";
  for (int i = 1; i <= model.links; ++i) out << ",theta_" << i;
  out << ",xc,yc,work\n";
}

void write_row(std::ostream& out, const Model& model, const SwimmerState& state, double t,
               double work) {
  const Eigen::Vector2d x_1 = free_end(model, state);
  out << fmt::format("{:.17g},{:.17g},{:.17g}", t, x_1.x(), x_1.y());
  const auto theta = link_angles(model, state);
  for (Eigen::Index i = 0; i < theta.size(); ++i) out << fmt::format(",{:.17g}", theta[i]);
  out << fmt::format(",{:.17g},{:.17g},{:.17g}\n", state.centroid.x(), state.centroid.y(), work);
}

struct Options {
  std::string start, rates, out;
  double dt = 0.1;
  bool clip = false;
  Model model;
};

void swim(const Options& options) {
  const Model& model = options.model;
  model.validate();
  if (!(options.dt > 0 && std::isfinite(options.dt)))
    throw std::invalid_argument(fmt::format("--dt {}: must be positive", options.dt));
  SwimmerState state = read_start(model, options.start);
  const std::vector<HingeVector> rates = read_rates(model, options.rates);

  std::ofstream out(options.out);
  if (!out) throw std::invalid_argument(fmt::format("{}: cannot be written", options.out));
  write_header(out, model);
  double work = 0;
  write_row(out, model, state, 0, work);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const double max_rate = rates[k].cwiseAbs().maxCoeff();
    const StepResult step =
        advance(model, state, rates[k], options.dt, substeps(model, options.dt, max_rate));
    if (!options.clip && step.rates != rates[k])
      throw std::invalid_argument(
          fmt::format("{}, row {}: a hinge would pass the joint limit of {} rad (--clip cuts the "
                      "rate instead)",
                      options.rates, k + 1, model.joint_limit));
    work += step.work;
    write_row(out, model, state, (k + 1) * options.dt, work);
  }
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: writing failed", options.out));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Plays prescribed hinge rates on the N-link swimmer, dimensionless: lengths in L, times in "
      "T0, work in C_perp L^3/T0.");
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
  app.add_option("--dt", options.dt, "length of a step [T0]")->capture_default_str();
  app.add_option("--links", options.model.links, "number of links N")->capture_default_str();
  app.add_option("--gamma", options.model.gamma, "drag ratio C_parallel / C_perp")
      ->capture_default_str();
  app.add_flag("--clip", options.clip,
               "cut rates at the joint limit of 2 pi/3 instead of refusing them");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    swim(options);
  } catch (const std::invalid_argument& error) {
    std::cerr << "swim: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "swim: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
