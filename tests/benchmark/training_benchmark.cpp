// Hot paths of playing and learning, for each instruction set that the processor has.
#include <vector>

#include <benchmark/benchmark.h>

#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_agent/mlp.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/fused_update.hpp"
#include "threelink_agent/training/minibatches.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_sim/isa.hpp"

namespace {

using namespace threelink_agent;
using threelink_sim::Isa;

TrainConfig config() {
  TrainConfig config;
  config.episodes = 40;
  config.evaluate_every = 1;
  config.hidden = {64, 64};
  config.symmetry = {Symmetry::kReversal, true};
  config.exploration = {false, 0.6, 0.2, 0.8};
  config.advantage = {0.995, 0.98, true, true};
  config.update = {40, 10, 1000, 0.2, 0, 0.5, 1e-3, 1e-3, 0};
  return config;
}

Mlp actor(Isa isa) { return Mlp(initial_state(config()).parameters.actor, isa); }

void one_observation(benchmark::State& state, Isa isa) {
  const Mlp mlp = actor(isa);
  const float input[4] = {0.6f, -0.8f, 0.5f, -0.5f};
  float output[2];
  for (auto _ : state) {
    mlp.forward(input, output);
    benchmark::DoNotOptimize(output);
  }
  state.SetItemsProcessed(state.iterations());
}

void batch_of_observations(benchmark::State& state, Isa isa) {
  const Mlp mlp = actor(isa);
  const std::size_t n = state.range(0);
  std::vector<float> input(4 * n, 0.5f), output(2 * n);
  for (auto _ : state) mlp.forward(n, input.data(), output.data());
  state.SetItemsProcessed(state.iterations() * n);
}

// A layer of 64 with 64 inputs, a block of samples.
struct Layer {
  Layer() {
    linear.weight.setConstant(64, 64, 0.01f);
    linear.bias.setZero(64);
    layout = packed_layout({linear});
    rows = AlignedFloats(packed_size(layout));
    pack({linear}, layout, rows.data());
  }
  void count(benchmark::State& state) const {
    state.counters["FLOP/s"] = benchmark::Counter(2.0 * kLossBlock * 64 * 64,
                                                  benchmark::Counter::kIsIterationInvariantRate);
  }
  Linear linear;
  std::vector<PackedLayer> layout;
  AlignedFloats rows, x{kLossBlock * 64}, y{kLossBlock * 64};
};

void forward(benchmark::State& state, Isa isa, bool hidden) {
  Layer layer;
  const GradientKernels& kernels = gradient_kernels(isa);
  for (auto _ : state)
    kernels.forward(layer.layout[0], layer.rows.data(), kLossBlock, layer.x.data(), 64, hidden,
                    layer.y.data());
  layer.count(state);
}

void backward(benchmark::State& state, Isa isa) {
  Layer layer;
  const AlignedFloats weights(64 * 64);
  const GradientKernels& kernels = gradient_kernels(isa);
  for (auto _ : state)
    kernels.backward(layer.layout[0], weights.data(), kLossBlock, layer.y.data(), layer.x.data(),
                     64, layer.x.data());
  layer.count(state);
}

void accumulate(benchmark::State& state, Isa isa) {
  Layer layer;
  const GradientKernels& kernels = gradient_kernels(isa);
  for (auto _ : state)
    kernels.accumulate(layer.layout[0], kLossBlock, layer.y.data(), layer.x.data(), 64,
                       layer.rows.data());
  layer.count(state);
}

void policy_loss(benchmark::State& state, Isa isa) {
  const GradientKernels& kernels = gradient_kernels(isa);
  AlignedFloats a(2 * kLossBlock), b(2 * kLossBlock), z(2 * kLossBlock), in(kLossBlock),
      out(3 * kLossBlock);
  const float log_std[] = {-1, -1}, inverse_std[] = {2.7f, 2.7f};
  for (auto _ : state)
    kernels.policy_loss({2, 0.2f, log_std, inverse_std, a.data(), b.data(), in.data(), in.data(),
                         z.data(), out.data(), out.data() + kLossBlock,
                         out.data() + 2 * kLossBlock});
  state.SetItemsProcessed(state.iterations() * kLossBlock);
}

void adam(benchmark::State& state, Isa isa) {
  const std::size_t n = 4608;  // about the parameters of one network
  const GradientKernels& kernels = gradient_kernels(isa);
  AlignedFloats p(n), m(n), v(n), g(n);
  for (auto _ : state) kernels.adam({n, p.data(), m.data(), v.data(), g.data(), 1, 1e-3f, 0.5f});
  state.SetItemsProcessed(state.iterations() * n);
}

Rollout played() {
  const TrainConfig c = config();
  Rollout rollout(c.environment, 40);
  const LearnerTensors start = initial_state(c).parameters;
  collect({c.environment, {}, c.symmetry.canonical, Mlp(start.actor), start.log_std, 0, 0}, 0, 40,
          rollout);
  return rollout;
}

void rollout(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(played());
  state.SetItemsProcessed(state.iterations() * 8000);
}

void advantages(benchmark::State& state) {
  const Rollout r = played();
  const std::vector<float> values(201 * 40, 1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        generalised_advantages(200, 40, r.rewards, r.captured, values, {.995, .98, true}));
  state.SetItemsProcessed(state.iterations() * 8000);
}

void shuffle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(shuffled(8000, 0, 0, 0));
  state.SetItemsProcessed(state.iterations() * 8000);
}

// Ten epochs over 8000 samples; items are environment steps.
void update(benchmark::State& state, Isa isa) {
  FusedUpdate ppo(config(), static_cast<int>(state.range(0)), isa);
  const Rollout r = played();
  Advantages a{std::vector<float>(8000, 0.1f), std::vector<float>(8000, 0.1f)};
  std::uint32_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(ppo.run(r, a, k++, {1e-5, 1e-5}));
  state.SetItemsProcessed(state.iterations() * 8000);
}

}  // namespace

int main(int argc, char** argv) {
  using benchmark::RegisterBenchmark;
  for (Isa isa : threelink_sim::available_isas()) {
    const auto name = [&](const char* what) {
      return what + ("/" + threelink_sim::to_string(isa));
    };
    RegisterBenchmark(name("one_observation").c_str(), one_observation, isa);
    RegisterBenchmark(name("batch_of_observations").c_str(), batch_of_observations, isa)
        ->Arg(40)
        ->Arg(256);
    RegisterBenchmark(name("forward").c_str(), forward, isa, true);
    RegisterBenchmark(name("forward_without_tanh").c_str(), forward, isa, false);
    RegisterBenchmark(name("backward").c_str(), backward, isa);
    RegisterBenchmark(name("accumulate").c_str(), accumulate, isa);
    RegisterBenchmark(name("policy_loss").c_str(), policy_loss, isa);
    RegisterBenchmark(name("adam").c_str(), adam, isa);
    RegisterBenchmark(name("update").c_str(), update, isa)
        ->Arg(1)
        ->Arg(2)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  RegisterBenchmark("rollout", rollout);
  RegisterBenchmark("advantages", advantages);
  RegisterBenchmark("shuffle", shuffle);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
