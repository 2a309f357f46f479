// Throughput of playing and learning, of this machine.
#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_agent/packed.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/output.hpp"
#if defined(THREELINK_LIBTORCH)
#include "threelink_agent/training/blas.hpp"
#endif

namespace {

using namespace threelink_agent;

constexpr int kWidth = 64;  // of the hidden layers
constexpr int kEpisodes = 40, kSteps = 200, kEpochs = 10, kMinibatch = 1000;

// Calls of `call` a second: the best of several rounds, since whatever else the machine does only
// ever slows it down.
template <class Call>
double calls_per_second(double seconds, Call&& call) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 5;
  double best = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = Clock::now();
    double elapsed = 0;
    int calls = 0;
    while (elapsed < seconds / kRounds) {
      call();
      ++calls;
      elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
    }
    best = std::max(best, calls / elapsed);
  }
  return best;
}

TrainConfig config() {
  TrainConfig config;
  config.episodes = 40000000;  // a million updates: without end, as far as this program goes
  config.environment.steps = kSteps;
  config.hidden = {kWidth, kWidth};
  config.symmetry = {Symmetry::kReversal, true};
  config.exploration = {false, 0.6, 0.2, 0.8};
  config.advantage = {0.995, 0.98, true, true};
  config.update = {kEpisodes, kEpochs, kMinibatch, 0.2, 0, 0.5, 1e-3, 1e-3, 0};
  config.evaluate_every = config.updates();
  return config;
}

// Multiplications and additions a second of the products that the update is made of.
double gemm_flops(double seconds) {
  Linear linear;
  linear.weight.setConstant(kWidth, kWidth, 0.01f);
  linear.bias.setZero(kWidth);
  const std::vector<PackedLayer> layout = packed_layout({linear});
  AlignedFloats rows(packed_size(layout)), x(kLossBlock * kWidth), y(kLossBlock * kWidth);
  pack({linear}, layout, rows.data());
  const GradientKernels& kernels = gradient_kernels(threelink_sim::isa_in_use());
  constexpr int kCalls = 100;
  return 2.0 * kLossBlock * kWidth * kWidth * kCalls * calls_per_second(seconds, [&] {
           for (int i = 0; i < kCalls; ++i)
             kernels.forward(layout[0], rows.data(), kLossBlock, x.data(), kWidth, false, y.data());
         });
}

Policy untrained_policy() {
  const TrainConfig c = config();
  const LearnerTensors start = initial_state(c).parameters;
  return Policy(policy_metadata(c), Mlp(start.actor), start.log_std);
}

double actor_latency(double seconds) {  // [s]
  const Policy policy = untrained_policy();
  const double observation[] = {0.6, -0.8, 0.5, -0.5};
  double rates[2];
  constexpr int kCalls = 1000;
  return 1 / (kCalls * calls_per_second(seconds, [&] {
                for (int i = 0; i < kCalls; ++i) policy.act(observation, rates);
              }));
}

double rollout_speed(double seconds) {  // [steps/s]
  const TrainConfig c = config();
  const Policy policy = untrained_policy();
  Play play{c.environment, c.goal, c.symmetry.canonical, policy.actor(), policy.log_std(), 0, 0};
  Rollout rollout(c.environment, kEpisodes);
  return kEpisodes * kSteps * calls_per_second(seconds, [&] {
           collect(play, 0, kEpisodes, rollout);
           play.first_episode += kEpisodes;
         });
}

std::optional<double> train_speed(Backend backend, int threads, double seconds) {  // [steps/s]
  if (!available(backend)) return {};
  Trainer trainer(config(), make_ppo_update(backend, config(), threads),
                  std::make_unique<LocalRollouts>(threads));
  trainer.update();  // the first one allocates
  return kEpisodes * kSteps * calls_per_second(seconds, [&] { trainer.update(); });
}

std::string blas_name() {
#if defined(THREELINK_LIBTORCH)
  return blas_in_use().name();
#else
  return "none";
#endif
}

nlohmann::json measure(double seconds) {
  nlohmann::json figures;
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  figures["isa"] = threelink_sim::to_string(threelink_sim::isa_in_use());
  figures["blas"] = blas_name();
  figures["gemm_gflops"] = gemm_flops(seconds) / 1e9;
  figures["actor_latency_us"] = actor_latency(seconds) * 1e6;
  figures["rollout_steps_per_s"] = rollout_speed(seconds);
  figures["train_steps_per_s_1_thread"] = number(train_speed(Backend::kFused, 1, seconds));
  figures["train_steps_per_s_2_threads"] = number(train_speed(Backend::kFused, 2, seconds));
  figures["libtorch_train_steps_per_s"] = number(train_speed(Backend::kLibtorch, 1, seconds));
  return figures;
}

void print(const nlohmann::json& figures) {
  const auto text = [&](const char* key, double unit, const char* name) {
    return figures[key].is_null()
               ? std::string("not in this build")
               : fmt::format("{:.4g} {}", figures[key].get<double>() / unit, name);
  };
  fmt::print("instruction set            {}\n", figures["isa"].get<std::string>());
  fmt::print("BLAS of LibTorch           {}\n", figures["blas"].get<std::string>());
  fmt::print("products of 64x64 matrices {}\n", text("gemm_gflops", 1, "GFLOP/s"));
  fmt::print("one observation, one actor {}\n", text("actor_latency_us", 1, "us"));
  fmt::print("rollout with noise         {}\n", text("rollout_steps_per_s", 1e6, "M steps/s"));
  fmt::print("training, one thread       {}\n",
             text("train_steps_per_s_1_thread", 1e3, "k steps/s"));
  fmt::print("training, two threads      {}\n",
             text("train_steps_per_s_2_threads", 1e3, "k steps/s"));
  fmt::print("training, LibTorch         {}\n",
             text("libtorch_train_steps_per_s", 1e3, "k steps/s"));
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("bench", [=] {
    bool as_json = false;
    double seconds = 2.0;
    CLI::App app(fmt::format(
        "Throughput of playing and learning: networks 4-{0}-{0}, {1} episodes of {2} steps for "
        "each\n"
        "update, {3} epochs, minibatches of {4}; environment steps per second.",
        kWidth, kEpisodes, kSteps, kEpochs, kMinibatch));
    app.add_flag("--json", as_json, "print one JSON object");
    app.add_option("--seconds", seconds, "time for each figure [s]")
        ->check(threelink_sim::real_number(0.1, 600.0))
        ->capture_default_str();
    if (!threelink_sim::parse_command_line(app, argc, argv)) return 0;
    const nlohmann::json figures = measure(seconds);
    if (as_json)
      fmt::print("{}\n", figures.dump());
    else
      print(figures);
    return 0;
  });
}
