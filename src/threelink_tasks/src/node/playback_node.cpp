// Shows a recorded episode while `rosbag play --clock` plays it: draws anew, from the recorded
// states and targets, what the simulator and the task showed.
//
// Nothing but the states is needed for that. The recorded joint_states and transforms are thinned
// out at high speed, and are not played.
#include <cmath>
#include <string>

#include <geometry_msgs/PointStamped.h>
#include <ros/callback_queue.h>
#include <tf2_ros/transform_broadcaster.h>

#include "../core/bag_reader.hpp"
#include "recorded_swimmer.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/swimmer_view.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;

constexpr char kHelp[] = R"(playback_node: shows a recorded episode while rosbag plays it

usage: rosrun threelink_tasks playback_node _bag:=BAG [ROS remappings] | --help

Used by playback.launch.

subscribes to
  state         threelink_msgs/SwimmerState     as recorded
  target        geometry_msgs/PointStamped      as recorded
publishes
  joint_states  sensor_msgs/JointState          all of these at most 30 times a second of wall time
  /tf           world -> base_link
  markers       visualization_msgs/MarkerArray
  swimmer_path  nav_msgs/Path
  target_path   nav_msgs/Path
parameters
  ~bag          path of the bag that is played: its units are those of the episode
  ~rate  ~loop  how rosbag plays it [1 s of simulation / s of wall time, false]
)";

constexpr double kDisplayPeriod = 1.0 / 30;  // [s] wall time
// [s] wall time around a jump back of /clock in which nothing is shown, so that no listener gets a
// transform of one pass among those of the other: tf2 then warns about every one that follows.
constexpr double kJump = 0.1;

struct PlaybackConfig {
  threelink_sim::SwimmerViewConfig view;  // as the episode was shown
  ros::Time end;                          // of the bag
  double rate = 1;                        // [s of simulation / s of wall time]
  bool loop = false;
};

void read_bag(const std::string& path, PlaybackConfig& config) {
  const BagReader bag(path);
  const auto simulator = recorded_swimmer(bag);
  const BagTime end = bag.messages().back().time;
  config.end = ros::Time(end.seconds, end.nanoseconds);
  config.view = {simulator.scales, simulator.environment.dt, simulator.environment.model.gamma};
}

class Playback {
 public:
  explicit Playback(const PlaybackConfig& config)
      : config_(config),
        diagnostics_("playback", "threelink_playback",
                     [](threelink_sim::Diagnostics::Status&, double) {}),
        refused_states_(diagnostics_.refusals("state refused: wrong values")),
        refused_targets_(diagnostics_.refusals("target refused: wrong values")),
        view_(node_, config.view, [] {}) {
    joint_publisher_ = node_.advertise<sensor_msgs::JointState>(topics::kJointStates, 100);
    path_publisher_ = node_.advertise<nav_msgs::Path>(topics::kTargetPath, 2, true);
    using threelink_sim::message_size::kSmall;
    state_subscriber_ = threelink_sim::subscribe<threelink_msgs::SwimmerState>(
        node_, topics::kState, 1000, kSmall, &diagnostics_,
        [this](const auto& event) { on_state(*event.getConstMessage()); });
    target_subscriber_ = threelink_sim::subscribe<geometry_msgs::PointStamped>(
        node_, topics::kTarget, 1000, kSmall, &diagnostics_,
        [this](const auto& event) { on_target(*event.getConstMessage()); });
  }

  int run() {
    while (threelink_sim::running()) {
      ros::WallDuration(kDisplayPeriod).sleep();
      ros::getGlobalCallbackQueue()->callAvailable();
      if (may_show()) show_latest();
    }
    return threelink_sim::kSuccess;
  }

 private:
  // Whether the latest state is of the pass that /clock is in, and /clock not about to jump.
  bool may_show() {
    const ros::Time now = ros::Time::now();
    if (now < now_) jumped_ = ros::WallTime::now();
    now_ = now;
    if (ros::WallTime::now() - jumped_ < ros::WallDuration(kJump)) return false;
    const ros::Duration ahead(kJump * config_.rate);
    return state_stamp_ < now + ahead && !(config_.loop && now + ahead > config_.end);
  }

  void show_latest() {
    if (state_stamp_ == shown_stamp_) return;
    shown_stamp_ = state_stamp_;
    joint_publisher_.publish(joints_);
    transform_publisher_.sendTransform(transform_);
    view_.draw();
    path_publisher_.publish(target_path_.message());
  }

  void on_state(const threelink_msgs::SwimmerState& state) {
    if (!threelink_sim::well_formed(state)) {
      ++refused_states_;
      return;
    }
    state_stamp_ = state.header.stamp;
    view_.add(state);
    threelink_sim::to_joint_state(state, config_.view.scales, joints_);
    threelink_sim::to_transform(state, config_.view.scales, transform_);
  }

  void on_target(const geometry_msgs::PointStamped& target) {
    const bool finite = std::isfinite(target.point.x) && std::isfinite(target.point.y) &&
                        std::isfinite(target.point.z);
    if (!finite || target.header.frame_id != threelink_sim::frames::kWorld) {
      ++refused_targets_;
      return;
    }
    // Time goes back when the bag starts anew; the last targets may come after the first states.
    if (target.header.stamp <= target_stamp_) {
      target_path_.clear();
      targets_ = 0;
    }
    target_stamp_ = target.header.stamp;
    view_.set_target({target.point.x, target.point.y});
    geometry_msgs::PoseStamped pose;
    pose.header = target.header;
    pose.pose.position = target.point;
    pose.pose.orientation.w = 1;
    target_path_.add(targets_++, pose);
  }

  PlaybackConfig config_;
  ros::NodeHandle node_;
  threelink_sim::Diagnostics diagnostics_;
  threelink_sim::Diagnostics::Counter& refused_states_;
  threelink_sim::Diagnostics::Counter& refused_targets_;
  threelink_sim::SwimmerView view_;
  tf2_ros::TransformBroadcaster transform_publisher_;
  ros::Publisher joint_publisher_, path_publisher_;
  sensor_msgs::JointState joints_;
  geometry_msgs::TransformStamped transform_;
  threelink_sim::ThinnedPath target_path_;
  ros::Time state_stamp_, shown_stamp_, target_stamp_;
  ros::Time now_;              // simulation time
  ros::WallTime jumped_;       // when that went back
  std::uint64_t targets_ = 0;  // since the start
  ros::Subscriber state_subscriber_, target_subscriber_;
};

int run() {
  threelink_sim::Parameters parameters{ros::NodeHandle("~")};
  PlaybackConfig config;
  const std::string bag = parameters.text("bag");
  config.rate = parameters.real("rate", {1e-3, 1e4}, config.rate);
  config.loop = parameters.flag("loop", config.loop);
  parameters.finish();
  try {
    read_bag(bag, config);
  } catch (const std::exception& error) {
    parameters.refuse("bag", error.what());
  }
  return Playback(config).run();
}

}  // namespace
}  // namespace threelink_tasks

int main(int argc, char** argv) {
  return threelink_sim::run_node(argc, argv, {"playback", threelink_tasks::kHelp},
                                 threelink_tasks::run);
}
