// Throughput of the simulation on one core, work integral included.
#include <algorithm>
#include <chrono>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/batch.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/reference/nine_by_nine.hpp"

namespace {

using namespace threelink_sim;

constexpr double kDt = 0.1;
constexpr int kStroke = 64;  // steps between two changes of the rates' sign

// Steps per second of `step`, which advances `lanes` swimmers once: the best of several rounds,
// since whatever else the machine does only ever slows it down.
template <class Step>
double steps_per_second(std::size_t lanes, double seconds, Step step) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 10;
  double best = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = Clock::now();
    std::size_t steps = 0;
    double elapsed = 0;
    while (elapsed < seconds / kRounds) {
      for (int k = 0; k < 2 * kStroke; ++k) step(k < kStroke ? 1.0 : -1.0);
      steps += 2 * kStroke * lanes;
      elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
    }
    best = std::max(best, steps / elapsed);
  }
  return best;
}

double batch_speed(const Model& model, std::size_t lanes, double seconds) {
  Batch batch(model, lanes);
  std::vector<double> rates(lanes * model.hinges());
  Random random(0, Stream::kStart, 0);
  for (double& rate : rates) rate = random.uniform(-0.5, 0.5);
  SwimmerState start;
  start.alpha = HingeVector::Zero(model.hinges());
  for (std::size_t i = 0; i < lanes; ++i) batch.set_state(i, start);
  const int sub = substeps(model, kDt, 1.0);
  return steps_per_second(lanes, seconds, [&](double sign) {
    for (int j = 0; j < model.hinges(); ++j)
      std::transform(rates.begin() + j * lanes, rates.begin() + (j + 1) * lanes, batch.rates(j),
                     [sign](double rate) { return sign * rate; });
    batch.advance(kDt, sub);
  });
}

double nine_by_nine_speed(double gamma, double seconds) {
  reference::State6 state = reference::State6::Zero();
  return steps_per_second(1, seconds, [&](double sign) {
    state = reference::runge_kutta_step(state, gamma, 0.3 * sign, -0.2 * sign, kDt);
  });
}

int bench(bool as_json, double seconds, std::size_t lanes) {
  const Model model;
  const std::string isa = kernels().isa;
  const double batch = batch_speed(model, lanes, seconds);
  const double scalar = batch_speed(model, 1, seconds);
  const double nine = nine_by_nine_speed(model.gamma, seconds);
  if (as_json) {
    const nlohmann::json figures{{"isa", isa},
                                 {"batch_steps_per_s", batch},
                                 {"scalar_steps_per_s", scalar},
                                 {"nine_by_nine_steps_per_s", nine}};
    fmt::print("{}\n", figures.dump());
  } else {
    fmt::print("instruction set                {}\n", isa);
    fmt::print("batch of {:<6}        {:10.2f} M steps/s\n", lanes, batch / 1e6);
    fmt::print("one swimmer            {:10.2f} M steps/s\n", scalar / 1e6);
    fmt::print("paper's 9x9 system, RK4{:10.2f} M steps/s\n", nine / 1e6);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run_tool("bench", [=] {
    bool as_json = false;
    double seconds = 1.0;
    std::size_t lanes = 256;
    CLI::App app(
        "Throughput of the simulation: action steps per second of one core, dt = 0.1, N = 3.");
    app.add_flag("--json", as_json, "print one JSON object");
    app.add_option("--seconds", seconds, "time for each figure [s]")
        ->check(real_number(0.1, 600.0))
        ->capture_default_str();
    app.add_option("--lanes", lanes, "swimmers in the batch")
        ->check(whole_number<std::size_t>(1, 1 << 20))
        ->capture_default_str();
    return parse_command_line(app, argc, argv) ? bench(as_json, seconds, lanes) : 0;
  });
}
