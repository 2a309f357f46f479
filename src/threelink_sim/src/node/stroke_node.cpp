// Both peers of the simulator's lock-step in one small node: the target is a fixed point, and the
// hinges follow a stroke: Purcell's, or one from a file.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <geometry_msgs/PointStamped.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/Reset.h>
#include <threelink_msgs/SwimmerState.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/call_service.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/simulator_config.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/stroke_file.hpp"

namespace threelink_sim {
namespace {

constexpr char kHelp[] = R"(stroke_node: moves the simulator's swimmer without task and agent

usage: rosrun threelink_sim stroke_node [ROS remappings] | --help

Starts one episode, with the centroid in the origin, and answers every state with a fixed target and
every observation with the mean rates of a stroke until the next one. At steps as long as the stroke's
pieces these are its own rates; else its corners are cut. Without a file the stroke is Purcell's: the
outer hinges swing between -amplitude and +amplitude, one after the other.

publishes      target        geometry_msgs/PointStamped
               hinge_rates   threelink_msgs/HingeRates
subscribes to  state         threelink_msgs/SwimmerState
               observation   threelink_msgs/Observation
calls          reset         threelink_msgs/Reset
parameters     ~file [none], as optimal_stroke writes it (JSON)  ~amplitude [pi/3 rad]
               ~target_x [2 m]  ~target_y [0.5 m]  ~simulator [simulator], whose parameters are read
)";

struct Config {
  Stroke stroke;
  geometry_msgs::Point target;  // [m]
  double dt = 0;                // [T0] of the simulator
};

Config read_config(Parameters& parameters) {
  Parameters of_simulator{ros::NodeHandle(parameters.text("simulator", "simulator"))};
  const EnvironmentConfig environment = read_simulator_config(of_simulator).environment;
  const Model& model = environment.model;
  const std::string file = parameters.text("file", "");
  const double amplitude =
      parameters.real("amplitude", {0.01, model.joint_limit}, std::min(kPi / 3, model.joint_limit));
  Config config;
  config.target.x = parameters.real("target_x", {-1e6, 1e6}, 2.0);
  config.target.y = parameters.real("target_y", {-1e6, 1e6}, 0.5);
  parameters.finish();
  config.dt = environment.dt;
  if (file.empty()) {
    constexpr int kPieces = 4;
    config.stroke = square_stroke(model, -amplitude, amplitude, kPieces);
  } else {
    config.stroke = load_stroke(file);
    if (config.stroke.model.links != model.links || config.stroke.model.gamma != model.gamma)
      throw UsageError(fmt::format("{}: is for links = {}, gamma = {}; the simulator has {}, {}",
                                   file, config.stroke.model.links, config.stroke.model.gamma,
                                   model.links, model.gamma));
    config.stroke.model = model;  // its joint limit is the one that counts
    try {
      config.stroke.validate();
    } catch (const std::invalid_argument& error) {
      throw UsageError(fmt::format("{}: {}", file, error.what()));
    }
  }
  return config;
}

class StrokePlayer {
 public:
  explicit StrokePlayer(const Config& config)
      : stroke_(config.stroke),
        angles_(hinge_angles(stroke_)),
        dt_(config.dt),
        diagnostics_("stroke", "threelink_stroke", [](Diagnostics::Status&, double) {}),
        refused_observations_(diagnostics_.refusals("observation refused: wrong values")) {
    target_.point = config.target;
    target_.header.frame_id = frames::kWorld;

    constexpr bool kLatch = true;
    target_publisher_ = node_.advertise<geometry_msgs::PointStamped>(topics::kTarget, 10, kLatch);
    rates_publisher_ = node_.advertise<threelink_msgs::HingeRates>(topics::kHingeRates, 10, kLatch);
    node_.setCallbackQueue(&direct_queue_);
    using message_size::kSmall;
    state_subscriber_ = subscribe<threelink_msgs::SwimmerState>(
        node_, topics::kState, 10, kSmall, &diagnostics_,
        [this](const auto& event) { on_state(*event.getConstMessage()); });
    observation_subscriber_ = subscribe<threelink_msgs::Observation>(
        node_, topics::kObservation, 10, kSmall, &diagnostics_,
        [this](const auto& event) { on_observation(*event.getConstMessage()); });
  }

  void start() {
    constexpr double kPatience = 30;  // [s]
    auto client = node_.serviceClient<threelink_msgs::Reset>(topics::kReset);
    while (!client.exists() && running())
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    const SwimmerState start = aligned_start(stroke_);
    const Eigen::Vector2d x_1 = free_end(stroke_.model, start);
    threelink_msgs::Reset reset;
    reset.request.x_1 = {x_1.x(), x_1.y()};
    reset.request.theta_1 = link_angles(stroke_.model, start)[0];
    reset.request.alpha.assign(start.alpha.data(), start.alpha.data() + start.alpha.size());
    if (!running()) return;
    const Called called = call_service(client, reset, kPatience);
    if (called != Called::kEnding && (called != Called::kAnswered || !reset.response.success))
      throw std::runtime_error("reset failed: " + excerpt(reset.response.status, 200));
  }

 private:
  void on_state(const threelink_msgs::SwimmerState& state) {
    target_.header.stamp = state.header.stamp;
    target_publisher_.publish(target_);
  }

  void on_observation(const threelink_msgs::Observation& observation) {
    const std::size_t hinges = stroke_.model.hinges();
    const auto finite = [](double value) { return std::isfinite(value); };
    if (observation.values.size() < 2 + hinges ||
        !std::all_of(observation.values.begin(), observation.values.end(), finite)) {
      ++refused_observations_;
      log_.error(
          fmt::format("refused an observation of {} values: {} links have {} at least, and all "
                      "are finite",
                      observation.values.size(), stroke_.model.links, 2 + hinges));
      return;
    }
    const double* alpha = observation.values.data() + 2;  // of either kind (observation.hpp)
    const HingeVector next = angles_at((observation.step + 1) * dt_);
    rates_.header.stamp = observation.header.stamp;
    rates_.episode = observation.episode;
    rates_.step = observation.step;
    rates_.rates.resize(hinges);
    for (std::size_t j = 0; j < hinges; ++j)
      rates_.rates[j] = std::clamp((next[j] - alpha[j]) / dt_, -1.0, 1.0);
    rates_publisher_.publish(rates_);
  }

  // [rad] of the stroke at a time [T0] since its start.
  HingeVector angles_at(double time) const {
    const double pieces = std::fmod(time / stroke_.dt, stroke_.pieces());
    const int whole = static_cast<int>(pieces);
    return angles_[whole] + (pieces - whole) * (angles_[whole + 1] - angles_[whole]);
  }

  Stroke stroke_;
  std::vector<HingeVector> angles_;
  double dt_;  // [T0]
  geometry_msgs::PointStamped target_;
  threelink_msgs::HingeRates rates_;
  DirectQueue direct_queue_;
  Diagnostics diagnostics_;
  Diagnostics::Counter& refused_observations_;
  QuietLog log_;
  ros::NodeHandle node_;
  ros::Publisher target_publisher_, rates_publisher_;
  ros::Subscriber state_subscriber_, observation_subscriber_;
};

int run() {
  Parameters parameters{ros::NodeHandle("~")};
  StrokePlayer player(read_config(parameters));
  player.start();
  return spin();
}

}  // namespace
}  // namespace threelink_sim

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"stroke", threelink_sim::kHelp}, threelink_sim::run);
}
