// Hot paths of the simulation, for each instruction set that the processor has.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "threelink_sim/batch.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/reference/nine_by_nine.hpp"

namespace {

using namespace threelink_sim;

constexpr double kDt = 0.1;

// lanes and links are the benchmark's arguments. Rates are zero-mean over the batch and keep the
// swimmers off their limits by turning round every 64 steps.
void advance_batch(benchmark::State& state, Isa isa) {
  Model model;
  const std::size_t lanes = state.range(0);
  model.links = state.range(1);
  Batch batch(model, lanes, kernels(isa));
  Random random(0, Stream::kStart, 0);
  std::vector<double> rates(lanes * model.hinges());
  for (double& rate : rates) rate = random.uniform(-0.3, 0.3);
  SwimmerState start;
  start.alpha = HingeVector::Zero(model.hinges());
  for (std::size_t i = 0; i < lanes; ++i) batch.set_state(i, start);
  int step = 0;
  for (auto _ : state) {
    if (++step % 64 == 0)
      for (double& rate : rates) rate = -rate;
    std::copy(rates.begin(), rates.end(), batch.rates(0));
    batch.advance(kDt, substeps(model, kDt, 1.0));
  }
  state.SetItemsProcessed(state.iterations() * lanes);
}

void normals(benchmark::State& state, Isa isa) {
  constexpr std::size_t kPairs = 1024;
  std::vector<std::uint32_t> counters(4 * kPairs);
  for (std::size_t i = 0; i < kPairs; ++i) counters[4 * i] = i;
  std::vector<double> out(2 * kPairs);
  const std::uint32_t key[2] = {0, 0};
  for (auto _ : state) {
    kernels(isa).normals(kPairs, key, counters.data(), out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 2 * kPairs);
}

void environment_step(benchmark::State& state) {
  const std::size_t lanes = state.range(0);
  Environment environment(EnvironmentConfig{}, lanes);
  std::vector<double> rates(2 * lanes, 0.1), observations(4 * lanes);
  int step = 0;
  for (auto _ : state) {
    if (++step % 64 == 0)
      for (double& rate : rates) rate = -rate;
    environment.step(rates.data());
    environment.observe(observations.data());
  }
  state.SetItemsProcessed(state.iterations() * lanes);
}
BENCHMARK(environment_step)->Arg(1)->Arg(40)->Arg(256);

// The same swimmers and rates in still water and in a world, whose ratio docs/performance.md has.
void world_step(benchmark::State& state, const std::string& world) {
  constexpr std::size_t kLanes = 256;
  EnvironmentConfig config;
  if (!world.empty()) config.world = World::parse(world, "world", ".");
  Environment environment(config, kLanes);
  Random random(0, Stream::kStart, 0);
  std::vector<double> rates(2 * kLanes);
  for (double& rate : rates) rate = random.uniform(-0.3, 0.3);
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  for (std::size_t i = 0; i < kLanes; ++i) environment.reset(i, start, {0, std::uint32_t(i + 1)});
  int step = 0;
  for (auto _ : state) {
    if (++step % 64 == 0)
      for (double& rate : rates) rate = -rate;
    environment.step(rates.data());
  }
  state.SetItemsProcessed(state.iterations() * kLanes);
}
BENCHMARK_CAPTURE(world_step, still, "");
BENCHMARK_CAPTURE(world_step, taylor_green,
                  "flow: [{kind: taylor_green, u0: 0.0129, k: 1.5707963}]");
BENCHMARK_CAPTURE(world_step, thermal_noise, "thermal_noise: 1.0e-12");
// Five discs within reach of every swimmer, at rates that bring it near without cease.
BENCHMARK_CAPTURE(world_step, five_obstacles, R"(obstacles:
  - {kind: disc, center: [0.0, 0.3], radius: 0.25}
  - {kind: disc, center: [0.0, -0.3], radius: 0.25}
  - {kind: disc, center: [0.7, 0.0], radius: 0.1}
  - {kind: disc, center: [-0.7, 0.0], radius: 0.1}
  - {kind: disc, center: [0.6, 0.4], radius: 0.1}
)");

void nine_by_nine(benchmark::State& state) {
  reference::State6 swimmer = reference::State6::Zero();
  double sign = 1;
  for (auto _ : state) {
    swimmer = reference::runge_kutta_step(swimmer, 0.5, 0.3 * sign, -0.2 * sign, kDt);
    sign = -sign;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(nine_by_nine);

}  // namespace

int main(int argc, char** argv) {
  for (Isa isa : available_isas()) {
    benchmark::RegisterBenchmark(("advance_batch/" + to_string(isa)).c_str(), advance_batch, isa)
        ->ArgNames({"lanes", "links"})
        ->Args({1, 3})
        ->Args({256, 3})
        ->Args({256, 8});
    benchmark::RegisterBenchmark(("normals/" + to_string(isa)).c_str(), normals, isa);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
