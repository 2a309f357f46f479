// The swimmer in ambient flows: figures computed elsewhere, and exact laws.
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reference_data.hpp"
#include "small_world.hpp"
#include "threelink_sim/environment.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

Model model_of(int links, double gamma = 0.5) {
  Model model;
  model.links = links;
  model.gamma = gamma;
  return model;
}

HingeVector vector_of(const nlohmann::json& numbers) {
  HingeVector vector(static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) vector[i] = numbers[i].get<double>();
  return vector;
}

// Largest difference of pose, work and dissipation at the end of a reference run.
double reference_difference(const nlohmann::json& run, const std::string& numerics) {
  Model model = model_of(run["links"], run["gamma"]);
  model.joint_limit = kPi;
  const nlohmann::json& start = run["start"];
  const SwimmerState from =
      state_from_free_end(model, {start["x1"].get<double>(), start["y1"].get<double>()},
                          start["theta1"], vector_of(start["alpha"]));
  // JSON is YAML.
  WorldSwimmer swimmer("flow: [" + run["flow"].dump() + "]\n" + numerics, model, from,
                       {0, 0, run["t0"].get<double>()});
  for (const auto& rates : run["rates"]) swimmer.step(vector_of(rates), run["dt"]);
  const nlohmann::json& end = run["final"];
  const SwimmerState state = swimmer.state();
  const LinkVector theta = link_angles(model, state);
  double difference =
      std::max({std::abs(state.centroid.x() - end["xc"].get<double>()),
                std::abs(state.centroid.y() - end["yc"].get<double>()),
                std::abs(swimmer.work() - end["work"].get<double>()),
                std::abs(swimmer.dissipation() - end["dissipation"].get<double>())});
  for (int i = 0; i < model.links; ++i)
    difference = std::max(difference, std::abs(theta[i] - end["theta"][i].get<double>()));
  return difference;
}

TEST(Flow, ReferenceRunsWithManyPoints) {
  for (const auto& run : reference("ambient_flow", "runs")) {
    const bool vortex =
        run["flow"]["kind"] == "vortex";  // the only one that is not smooth to 6 points
    const double difference = reference_difference(run, "flow_points: 6\nflow_sweeps: 5\n");
    EXPECT_LT(difference, vortex ? 1e-9 : 1e-10) << run["name"];
    RecordProperty(run["name"].get<std::string>() + "_6_points", fmt::format("{:.2g}", difference));
  }
}

TEST(Flow, ReferenceRunsWithTheDefaults) {
  for (const auto& run : reference("ambient_flow", "runs")) {
    const std::string kind = run["flow"]["kind"];
    const double difference = reference_difference(run, "");
    EXPECT_LT(difference, kind == "linear" || kind == "poiseuille" ? 2e-9 : 1e-6) << run["name"];
    RecordProperty(run["name"].get<std::string>() + "_defaults", fmt::format("{:.2g}", difference));
  }
}

SwimmerState bent(const Model& model) {
  SwimmerState state;
  state.centroid = {0.4, -0.3};
  state.heading = 0.7;
  state.alpha = HingeVector::Constant(model.hinges(), 0.4);
  return state;
}

HingeVector some_rates(const Model& model, int step) {
  HingeVector rates(model.hinges());
  for (int j = 0; j < rates.size(); ++j) rates[j] = std::sin(0.1 * step + 2 * j);
  return rates;
}

TEST(Flow, UniformFlowAddsItsWayAlone) {
  const Model model = model_of(3);
  WorldSwimmer carried("flow: [{kind: uniform, U: [0.02, -0.01]}]", model, bent(model));
  SwimmerState still = bent(model);
  double work = 0;
  for (int k = 0; k < 100; ++k) {
    carried.step(some_rates(model, k));
    work += advance(model, still, some_rates(model, k), 0.1, 1).work;
  }
  const Eigen::Vector2d way = Eigen::Vector2d(0.02, -0.01) * 100 * 0.1;
  EXPECT_LT((carried.state().centroid - still.centroid - way).norm(), 1e-13);
  EXPECT_NEAR(carried.state().heading, still.heading, 1e-13);
  EXPECT_NEAR(carried.work(), work, 1e-13);
  EXPECT_NEAR(carried.dissipation(), work, 1e-13);
}

TEST(Flow, RotationTurnsTheMotionAndNothingElse) {
  const Model model = model_of(3);
  const double omega = 0.02;
  WorldSwimmer turned("flow: [{kind: linear, A: [[0, -0.02], [0.02, 0]], x0: [1.0, 0.5]}]", model,
                      bent(model));
  SwimmerState still = bent(model);
  double work = 0;
  for (int k = 0; k < 100; ++k) {
    turned.step(some_rates(model, k));
    work += advance(model, still, some_rates(model, k), 0.1, 1).work;
  }
  const Eigen::Vector2d x0(1.0, 0.5);
  const Eigen::Vector2d expected = x0 + Eigen::Rotation2Dd(omega * 10) * (still.centroid - x0);
  EXPECT_LT((turned.state().centroid - expected).norm(), 1e-13);
  EXPECT_NEAR(turned.state().heading, still.heading + omega * 10, 1e-13);
  EXPECT_NEAR(turned.work(), work, 1e-13);
}

// Jeffery orbits: the period 4 pi / (G sqrt(1 - B^2)) of rigid shapes in a shear G, with B as
// tabulated in docs/world.md for N = 3 and gamma = 1/2.
TEST(Flow, RigidShapesTurnInShearWithJefferysPeriod) {
  const Model model = model_of(3);
  const double G = 0.05;
  struct Shape {
    double alpha_1, alpha_2, B;
  };
  for (const Shape& shape : {Shape{1, 1, 0.5988143737}, Shape{kPi / 2, kPi / 2, 1.0 / 9},
                             Shape{2 * kPi / 3, 2 * kPi / 3, 0.0}}) {
    SwimmerState start;
    start.alpha = HingeVector(2);
    start.alpha << shape.alpha_1, shape.alpha_2;
    WorldSwimmer swimmer("flow: [{kind: linear, A: [[0, 0.05], [0, 0]]}]\nflow_sweeps: 6\n", model,
                         start);
    const HingeVector none = HingeVector::Zero(2);
    // Whole steps up to the turn by 2 pi, then the rest of a step by Newton's method.
    const double period = 4 * kPi / (G * std::sqrt(1 - shape.B * shape.B));
    const int steps = static_cast<int>(period / 0.1);
    for (int k = 0; k < steps; ++k) swimmer.step(none);
    const double before = swimmer.state().heading;
    WorldSwimmer last = swimmer;
    last.step(none, period - 0.1 * steps);
    // B is given to ten digits, of which the period takes over nine.
    EXPECT_NEAR(last.state().heading, -2 * kPi, 1e-8) << shape.alpha_1;
    EXPECT_GT(before, last.state().heading);
    EXPECT_EQ(last.work(), 0) << "the hinges are locked";
    EXPECT_GT(last.dissipation(), 0);
  }
}

TEST(Flow, StraightLockedSwimmerNeverPassesTheShearsDirection) {
  // cot theta(t) = cot theta_0 + G t in u = (G y, 0).
  const Model model = model_of(3);
  SwimmerState start;
  start.heading = 1.2;
  start.alpha = HingeVector::Zero(2);
  WorldSwimmer swimmer("flow: [{kind: linear, A: [[0, 0.05], [0, 0]]}]\nflow_sweeps: 6\n", model,
                       start);
  for (int k = 0; k < 1000; ++k) swimmer.step(HingeVector::Zero(2));
  const double cotangent = 1 / std::tan(1.2) + 0.05 * 100;
  EXPECT_NEAR(swimmer.state().heading, std::atan2(1, cotangent), 1e-9);
}

TEST(Flow, StraightLockedSwimmerInPoiseuilleFlow) {
  const Model model = model_of(3);
  for (const double heading : {0.0, kPi / 2}) {
    SwimmerState start;
    start.heading = heading;
    start.alpha = HingeVector::Zero(2);
    WorldSwimmer swimmer("flow: [{kind: poiseuille, U: 0.02, H: 1.5}]", model, start);
    for (int k = 0; k < 100; ++k) swimmer.step(HingeVector::Zero(2));
    const double drift = heading == 0 ? 0.02 : 0.02 * (1 - 1 / (12 * 1.5 * 1.5));
    EXPECT_NEAR(swimmer.state().centroid.x(), drift * 10, 1e-9);
    EXPECT_NEAR(swimmer.state().heading, heading, 1e-12);
  }
}

TEST(Flow, TaylorGreenVorticesRepeat) {
  const Model model = model_of(3);
  const std::string world = "flow: [{kind: taylor_green, u0: 0.02, k: 2.0}]";
  SwimmerState there = bent(model);
  there.centroid += Eigen::Vector2d(kPi, -2 * kPi);
  WorldSwimmer here_swimmer(world, model, bent(model)), there_swimmer(world, model, there);
  for (int k = 0; k < 50; ++k) {
    here_swimmer.step(some_rates(model, k));
    there_swimmer.step(some_rates(model, k));
  }
  EXPECT_LT((there_swimmer.state().centroid - here_swimmer.state().centroid -
             Eigen::Vector2d(kPi, -2 * kPi))
                .norm(),
            1e-13);
}

TEST(Flow, VortexIsTheSameFromAllSides) {
  const Model model = model_of(3);
  const std::string world = "flow: [{kind: vortex, Gamma: 0.1, epsilon: 0.5, x0: [0.2, -0.1]}]";
  const Eigen::Vector2d x0(0.2, -0.1);
  SwimmerState turned = bent(model);
  turned.centroid = x0 + Eigen::Rotation2Dd(1.0) * (turned.centroid - x0);
  turned.heading += 1.0;
  WorldSwimmer a(world, model, bent(model)), b(world, model, turned);
  for (int k = 0; k < 50; ++k) {
    a.step(some_rates(model, k));
    b.step(some_rates(model, k));
  }
  const Eigen::Vector2d expected = x0 + Eigen::Rotation2Dd(1.0) * (a.state().centroid - x0);
  EXPECT_LT((b.state().centroid - expected).norm(), 1e-13);
}

TEST(Flow, DoubleGyreFlowsAlongItsWalls) {
  const auto world =
      world_of("flow: [{kind: double_gyre, A: 0.01, epsilon: 0.25, omega: 0.2, size: 2.0}]");
  for (const double t : {0.0, 3.0, 17.0})
    for (const double place : {0.1, 0.9, 1.7}) {
      EXPECT_NEAR(world->flow(t, {0, place}).x(), 0, 1e-16);
      EXPECT_NEAR(world->flow(t, {4, place}).x(), 0, 1e-16);
      EXPECT_NEAR(world->flow(t, {2 * place, 0}).y(), 0, 1e-16);
      EXPECT_NEAR(world->flow(t, {2 * place, 2}).y(), 0, 1e-16);
    }
}

TEST(Flow, RandomModesHaveNoDivergenceAndTheirSpeed) {
  const auto world = world_of(
      "flow: [{kind: random_modes, u0: 0.02, modes: 64, wavelength: 3.0, correlation_time: 50.0, "
      "seed: 4}]");
  Random random(1, Stream::kStart, 0);
  double squares = 0, covariance = 0;
  const int places = 20'000;
  for (int k = 0; k < places; ++k) {
    const Eigen::Vector2d x(random.uniform(-500, 500), random.uniform(-500, 500));
    const double h = 1e-4;
    const double divergence =
        (world->flow(1, {x.x() + h, x.y()}).x() - world->flow(1, {x.x() - h, x.y()}).x() +
         world->flow(1, {x.x(), x.y() + h}).y() - world->flow(1, {x.x(), x.y() - h}).y()) /
        (2 * h);
    EXPECT_NEAR(divergence, 0, 1e-8);  // of gradients of 0.04; differences round
    squares += world->flow(1, x).squaredNorm() / places;
    covariance += world->flow(1, x).dot(world->flow(26, x)) / places;
  }
  // Standard error of the mean square over independent places: about u0^2 / sqrt(places).
  EXPECT_NEAR(squares, 0.02 * 0.02, 4 * 0.02 * 0.02 / std::sqrt(places));
  // exp(-25 / 50), with the scatter of 64 modes.
  EXPECT_NEAR(covariance / squares, std::exp(-0.5), 0.15);
}

// --- Grids ---------------------------------------------------------------------------------------

// A file of that flow at the nodes of a grid.
template <class Velocity>
std::string grid_file(const std::string& name, int nodes, double extent, Velocity velocity) {
  const std::string path = testing::TempDir() + name;
  std::ofstream file(path);
  file << "# x y u v\n";
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i) {
      const double x = -extent + 2 * extent * i / (nodes - 1);
      const double y = -extent + 2 * extent * j / (nodes - 1);
      const Eigen::Vector2d u = velocity(x, y);
      file << fmt::format("{:.17g}\t{:.17g}\t{:.17g}\t{:.17g}\n", x, y, u.x(), u.y());
    }
  return path;
}

TEST(Flow, GridOfACubicIsExact) {
  const auto cubic = [](double x, double y) {
    return Eigen::Vector2d(x * x * x - 2 * y * y * x, 0.5 * y * y * y + x - 1);
  };
  const auto world =
      world_of("flow: [{kind: grid, file: " + grid_file("cubic.csv", 9, 2.0, cubic) + "}]\n");
  Random random(3, Stream::kStart, 0);
  for (int k = 0; k < 100; ++k) {
    const double x = random.uniform(-2, 2), y = random.uniform(-2, 2);
    EXPECT_LT((world->flow(0, {x, y}) - cubic(x, y)).norm(), 1e-13);
  }
}

TEST(Flow, ErrorOfAGridFallsAsTheFourthPowerOfItsSpacing) {
  const auto vortices = [](double x, double y) {
    return Eigen::Vector2d(0.02 * std::sin(2 * x) * std::cos(2 * y),
                           -0.02 * std::cos(2 * x) * std::sin(2 * y));
  };
  const auto largest_error = [&](int nodes) {
    const auto world = world_of(
        "flow: [{kind: grid, file: " + grid_file("vortices.csv", nodes, 2.0, vortices) + "}]\n");
    Random random(3, Stream::kStart, 0);
    double largest = 0;
    for (int k = 0; k < 2000; ++k) {
      const double x = random.uniform(-2, 2), y = random.uniform(-2, 2);
      largest = std::max(largest, (world->flow(0, {x, y}) - vortices(x, y)).norm());
    }
    return largest;
  };
  const double coarse = largest_error(21), fine = largest_error(41);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.4);
}

TEST(Flow, SwimmerThatLeavesAGridIsTold) {
  const auto along_x = [](double, double) { return Eigen::Vector2d(0.05, 0); };
  const Model model = model_of(3);
  SwimmerState start;
  start.alpha = HingeVector::Zero(2);
  WorldSwimmer swimmer(
      "flow: [{kind: grid, file: " + grid_file("along.csv", 5, 1.0, along_x) + "}]", model, start);
  int steps = 0;
  while (!swimmer.stepper().left_grid(0) && steps < 1000) {
    swimmer.step(HingeVector::Zero(2));
    ++steps;
  }
  EXPECT_NEAR(steps, 0.5 / 0.005, 2);  // its end is 0.5 from its centroid
  start.centroid.x() = 0.6;
  EXPECT_THROW(
      WorldSwimmer("flow: [{kind: grid, file: " + grid_file("along.csv", 5, 1.0, along_x) + "}]",
                   model, start),
      std::invalid_argument);
}

// --- Instruction sets ----------------------------------------------------------------------------

TEST(Flow, AllInstructionSetsAndLanesAgreeToTheBit) {
  const std::string yaml =
      "flow:\n"
      "  - {kind: taylor_green, u0: 0.02, k: 1.5}\n"
      "  - {kind: vortex, Gamma: 0.05, epsilon: 0.4, x0: [1.0, 1.0]}\n"
      "  - {kind: double_gyre, A: 0.01, epsilon: 0.25, omega: 0.2, size: 2.0}\n"
      "  - {kind: random_modes, u0: 0.01, modes: 5, wavelength: 3.0, correlation_time: 20.0}\n"
      "  - {kind: poiseuille, U: 0.01, H: 3.0}\n"
      "  - {kind: linear, A: [[0.01, 0.02], [0.0, -0.01]]}\n"
      "obstacles:\n"
      "  - {kind: disc, center: [0.9, 0.2], radius: 0.3}\n"
      "  - {kind: half_plane, point: [0.0, -0.8], normal: [0.0, 1.0]}\n"
      "thermal_noise: 1.0e-4\n";
  for (const int links : {2, 3, 5}) {
    EnvironmentConfig config;
    config.model = model_of(links);
    config.world = world_of(yaml);
    constexpr std::size_t kLanes = 21;
    for (const Isa isa : available_isas()) {
      if (isa == Isa::kBaseline) continue;  // it has no fused multiply-add
      Environment many(config, kLanes, kernels(isa));
      std::vector<std::unique_ptr<Environment>> alone;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const auto episode = static_cast<std::uint32_t>(i);
        const SwimmerState start = random_start(config, 7, episode);
        many.reset(i, start, {7, episode});
        alone.push_back(std::make_unique<Environment>(config, 1));
        alone.back()->reset(0, start, {7, episode});
      }
      for (int step = 0; step < 60; ++step) {
        std::vector<double> rates(kLanes * config.model.hinges());
        for (std::size_t i = 0; i < kLanes; ++i)
          for (int j = 0; j < config.model.hinges(); ++j)
            rates[j * kLanes + i] = std::sin(0.3 * step + static_cast<double>(i) + j);
        many.step(rates.data());
        for (std::size_t i = 0; i < kLanes; ++i) {
          std::vector<double> of_lane(config.model.hinges());
          for (int j = 0; j < config.model.hinges(); ++j) of_lane[j] = rates[j * kLanes + i];
          alone[i]->step(of_lane.data());
        }
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        const StepRecord a = many.record(i), b = alone[i]->record(0);
        EXPECT_EQ(a.state.centroid, b.state.centroid) << to_string(isa) << " lane " << i;
        EXPECT_EQ(a.state.heading, b.state.heading);
        EXPECT_EQ(a.work, b.work);
        EXPECT_EQ(a.dissipation, b.dissipation);
        EXPECT_EQ(a.power, b.power);
        EXPECT_EQ(a.contact.force, b.contact.force);
      }
    }
  }
}

TEST(Flow, AnEmptyWorldIsStillWaterToTheBit) {
  EnvironmentConfig still, empty;
  empty.world = world_of("");
  EXPECT_TRUE(empty.world->still());
  Environment a(still, 3), b(empty, 3);
  std::vector<double> rates(6, 0.7);
  for (int k = 0; k < 20; ++k) {
    a.step(rates.data());
    b.step(rates.data());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(a.record(i).state.centroid, b.record(i).state.centroid);
    EXPECT_EQ(a.record(i).work, b.record(i).dissipation);
  }
}

}  // namespace
}  // namespace threelink_tests
