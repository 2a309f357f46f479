// Both peers of the simulator's lock-step in one small node: the target is a fixed point, and the
// first and the last hinge make Purcell's stroke, each in turn from one angle to the other.
#include <cmath>

#include <geometry_msgs/PointStamped.h>
#include <ros/ros.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/Reset.h>
#include <threelink_msgs/SwimmerState.h>

#include "threelink_sim/model.hpp"
#include "threelink_sim/node/direct_queue.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_sim {
namespace {

constexpr char kHelp[] = R"(stroke_node: moves the simulator's swimmer without task and agent

usage: rosrun threelink_sim stroke_node [ROS remappings] | --help

Starts one episode and answers every state with a fixed target, and every observation with the rates
of Purcell's stroke: the outer hinges swing between -amplitude and +amplitude, one after the other.

publishes      target        geometry_msgs/PointStamped
               hinge_rates   threelink_msgs/HingeRates
subscribes to  state         threelink_msgs/SwimmerState
               observation   threelink_msgs/Observation
calls          reset         threelink_msgs/Reset
parameters     ~amplitude [pi/3 rad]  ~target_x [2 m]  ~target_y [0.5 m]
)";

class Stroke {
 public:
  explicit Stroke(Parameters& parameters)
      : amplitude_(parameters.real("amplitude", {0.01, kPi}, kPi / 3)) {
    target_.point.x = parameters.real("target_x", {-1e6, 1e6}, 2.0);
    target_.point.y = parameters.real("target_y", {-1e6, 1e6}, 0.5);
    parameters.finish();
    target_.header.frame_id = frames::kWorld;

    constexpr bool kLatch = true;
    const auto hints = ros::TransportHints().tcpNoDelay();
    target_publisher_ = node_.advertise<geometry_msgs::PointStamped>(topics::kTarget, 10, kLatch);
    rates_publisher_ = node_.advertise<threelink_msgs::HingeRates>(topics::kHingeRates, 10, kLatch);
    node_.setCallbackQueue(&direct_queue_);
    state_subscriber_ = node_.subscribe(topics::kState, 10, &Stroke::on_state, this, hints);
    observation_subscriber_ =
        node_.subscribe(topics::kObservation, 10, &Stroke::on_observation, this, hints);
  }

  void start() {
    auto client = node_.serviceClient<threelink_msgs::Reset>(topics::kReset);
    while (!client.waitForExistence(ros::Duration(0.5)) && running()) {
    }
    threelink_msgs::Reset reset;
    reset.request.x_1 = {1.0, 0.0};
    if (running() && (!client.call(reset) || !reset.response.success))
      throw std::runtime_error("reset failed: " + reset.response.status);
  }

 private:
  void on_state(const threelink_msgs::SwimmerState& state) {
    target_.header.stamp = state.header.stamp;
    target_publisher_.publish(target_);
  }

  void on_observation(const threelink_msgs::Observation& observation) {
    constexpr std::size_t kFirstHinge = 2;  // after cos theta_d, sin theta_d
    const std::size_t hinges = observation.values.size() - kFirstHinge;
    rates_.header.stamp = observation.header.stamp;
    rates_.episode = observation.episode;
    rates_.step = observation.step;
    rates_.rates.assign(hinges, 0.0);
    // Quarter q of the stroke moves one hinge up (q = 0, 1) or down (q = 2, 3): last, first, ...
    const double direction = quarter_ < 2 ? 1 : -1;
    const std::size_t hinge = quarter_ % 2 == 0 ? hinges - 1 : 0;
    rates_.rates[hinge] = direction;
    rates_publisher_.publish(rates_);
    constexpr double kStep = 0.05;  // [rad] within half a step of the corner is at it
    if (direction * observation.values[kFirstHinge + hinge] > amplitude_ - kStep)
      quarter_ = (quarter_ + 1) % 4;
  }

  double amplitude_;  // [rad]
  int quarter_ = 0;
  geometry_msgs::PointStamped target_;
  threelink_msgs::HingeRates rates_;
  DirectQueue direct_queue_;
  ros::NodeHandle node_;
  ros::Publisher target_publisher_, rates_publisher_;
  ros::Subscriber state_subscriber_, observation_subscriber_;
};

int run() {
  Parameters parameters{ros::NodeHandle("~")};
  Stroke stroke(parameters);
  stroke.start();
  return spin();
}

}  // namespace
}  // namespace threelink_sim

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"stroke", threelink_sim::kHelp}, threelink_sim::run);
}
