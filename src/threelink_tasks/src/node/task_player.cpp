#include "task_player.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <threelink_msgs/Reset.h>
#include <visualization_msgs/MarkerArray.h>

#include "point_input.hpp"
#include "recording_words.hpp"
#include "revision.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_tasks/episode.hpp"
#include "waypoint_markers.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::Episode;
using threelink_msgs::Recording;

constexpr double kRecordingTimeout = 60;   // [s] for the bag and the picture of an episode
constexpr double kLastWordsTimeout = 1.5;  // [s] for anything once the node has to end
constexpr double kPathPeriod = 0.05;       // [s] wall time, of target_path

}  // namespace

TaskPlayer::TaskPlayer(const PlayerConfig& config)
    : config_(config),
      silence_limit_(config.simulator.silence_limit()),
      diagnostics_("task", "threelink_task",
                   [this](threelink_sim::Diagnostics::Status& status, double seconds) {
                     report(status, seconds);
                   }),
      refused_states_(diagnostics_.refusals("state refused: out of order")),
      refused_points_(diagnostics_.refusals("clicked point refused")) {
  constexpr bool kLatch = true;
  target_publisher_ = node_.advertise<geometry_msgs::PointStamped>(topics::kTarget, 10, kLatch);
  episode_publisher_ = node_.advertise<Episode>(topics::kEpisode, 10, kLatch);
  path_publisher_ = node_.advertise<nav_msgs::Path>(topics::kTargetPath, 2, kLatch);
  waypoint_publisher_ =
      node_.advertise<visualization_msgs::MarkerArray>(topics::kWaypoints, 2, kLatch);
  ros::NodeHandle lockstep_node;
  lockstep_node.setCallbackQueue(&direct_queue_);
  state_subscriber_ = lockstep_node.subscribe(topics::kState, 100, &TaskPlayer::on_state, this,
                                              ros::TransportHints().tcpNoDelay());
  abort_subscriber_ = node_.subscribe(topics::kAbort, 10, &TaskPlayer::on_abort, this);
  recording_subscriber_ = node_.subscribe(topics::kRecording, 10, &TaskPlayer::on_recording, this);
  target_.header.frame_id = threelink_sim::frames::kWorld;
}

bool TaskPlayer::wait_for(double seconds, const std::function<bool()>& condition) {
  const auto after = [](double s) { return Clock::now() + std::chrono::duration<double>(s); };
  auto deadline = after(seconds);
  bool ending = false;
  while (!condition()) {
    if (!ending && !threelink_sim::running()) {
      ending = true;
      deadline = std::min(deadline, after(kLastWordsTimeout));
    }
    if (Clock::now() > deadline || !ros::ok()) return false;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
  }
  return true;
}

std::optional<PlayedEpisode> TaskPlayer::play(const Assignment& assignment, const Watch& watch) {
  wait_until_ready();
  if (!threelink_sim::running()) return {};
  assignment_ = assignment;
  start_episode();
  std::unique_ptr<PointInput> points;
  if (assignment_.task->takes_points()) {
    const double metre = config_.simulator.scales.length;
    const auto take_point = [this, metre](const Eigen::Vector2d& point) {
      std::lock_guard<std::mutex> lock(mutex_);
      assignment_.task->take_point(point / metre);
    };
    points = std::make_unique<PointInput>(node_, metre * first_centroid_, metre, take_point,
                                          [this] { ++refused_points_; });
  }
  while (this->watch(watch))
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kPathPeriod));
  if (config_.record) wait_for(kRecordingTimeout, [this] { return recorded(); });
  std::printf("%s\n", line().c_str());
  std::fflush(stdout);
  return PlayedEpisode{episode_, energy_, recorded() ? recording_ : std::nullopt};
}

bool TaskPlayer::watch(const Watch& watch) {
  std::lock_guard<std::mutex> lock(mutex_);
  const double silence = std::chrono::duration<double>(Clock::now() - heard_).count();
  const std::string wanted = watch(episode_);
  if (playing_ && !threelink_sim::running()) {
    end_episode(Episode::ABORTED, "interrupted");
  } else if (playing_ && silence > silence_limit_) {
    end_episode(Episode::ABORTED, fmt::format("no state {} in {:.1f} s: the simulator is silent",
                                              next_step_, silence));
  } else if (playing_ && !wanted.empty()) {
    end_episode(Episode::ABORTED, wanted);
  }
  show();
  return playing_;
}

// Callers hold the mutex.
void TaskPlayer::show() {
  path_publisher_.publish(target_path_.message());
  if (shown_waypoint_ == episode_.waypoint) return;
  shown_waypoint_ = episode_.waypoint;
  waypoint_publisher_.publish(waypoint_markers(assignment_.task->waypoints(), episode_.waypoint,
                                               config_.simulator.scales.length,
                                               episode_.header.stamp));
}

void TaskPlayer::wait_until_ready() {
  const auto wait = [this](const std::function<bool()>& condition) {
    return wait_for(config_.start_timeout,
                    [&] { return !threelink_sim::running() || condition(); });
  };
  const std::string reset = node_.resolveName(topics::kReset);
  if (!wait([&] { return ros::service::exists(reset, false); }))
    throw std::runtime_error(fmt::format("no service {} in {} s: is simulator_node running?", reset,
                                         config_.start_timeout));
  if (config_.record && !wait([this] { return recording_.has_value(); }))
    throw std::runtime_error(
        fmt::format("no recorder is ready on {} in {} s: is recorder_node running, and every topic "
                    "that it waits for? (record:=false does without)",
                    recording_subscriber_.getTopic(), config_.start_timeout));
  if (config_.record && recording_ && recording_->state == Recording::FAILED &&
      recording_->episode == 0)
    throw threelink_sim::UsageError("the recorder cannot record: " + recording_->status);
}

void TaskPlayer::start_episode() {
  const Start start = assignment_.task->start();
  threelink_msgs::Reset reset;
  reset.request.seed = assignment_.seed;
  reset.request.random_start = start.random;
  reset.request.x_1 = {start.x_1.x(), start.x_1.y()};
  reset.request.theta_1 = start.theta_1;
  reset.request.alpha.assign(start.alpha.data(), start.alpha.data() + start.alpha.size());
  if (!reset_.isValid()) {
    constexpr bool kPersistent = true;
    reset_ = node_.serviceClient<threelink_msgs::Reset>(topics::kReset, kPersistent);
  }
  if (!reset_.call(reset))
    throw std::runtime_error("the service " + reset_.getService() + " did not answer");
  if (!reset.response.success)
    throw std::runtime_error("the simulator refused to start: " + reset.response.status);

  std::lock_guard<std::mutex> lock(mutex_);
  const threelink_msgs::SwimmerState& state = reset.response.state;
  first_centroid_ = {state.centroid[0], state.centroid[1]};
  assignment_.task->reset(assignment_.seed, state.episode);
  target_path_.clear();
  shown_waypoint_.reset();
  energy_ = 0;
  next_step_ = 0;
  playing_ = true;

  episode_ = Episode();
  episode_.header = state.header;
  episode_.episode = state.episode;
  episode_.status = Episode::STARTED;
  episode_.task = assignment_.name;
  episode_.seed = assignment_.seed;
  episode_.config = config_.yaml(assignment_);
  episode_.policy_file = assignment_.policy.file;
  episode_.policy_sha256 = assignment_.policy.sha256;
  episode_.revision = kRevision;
  answer(state);
}

void TaskPlayer::on_state(const threelink_msgs::SwimmerState& state) {
  std::lock_guard<std::mutex> lock(mutex_);
  // State 0 comes with the service's answer, too, and latched states may be repeated.
  if (!playing_ || (state.episode == episode_.episode && state.step < next_step_)) return;
  if (state.episode != episode_.episode || state.step != next_step_) {
    ++refused_states_;
    return;
  }
  answer(state);
}

void TaskPlayer::answer(const threelink_msgs::SwimmerState& state) {
  heard_ = Clock::now();
  ++next_step_;
  ++steps_;
  energy_ += state.work;
  const Eigen::Vector2d centroid(state.centroid[0], state.centroid[1]);
  const Outcome outcome = assignment_.task->observe(centroid);
  const EpisodeMeasures measures = measure(state.step, config_.simulator.environment.dt,
                                           first_centroid_, centroid, assignment_.task->target());
  episode_.header.stamp = state.header.stamp;
  episode_.step = state.step;
  episode_.waypoint = assignment_.task->waypoint();
  episode_.time = measures.time;
  episode_.distance = measures.distance;
  episode_.mean_speed = measures.mean_speed;
  if (state.step == 0) episode_publisher_.publish(episode_);
  if (outcome == Outcome::kRunning) publish_target(state.header.stamp);
  if (outcome == Outcome::kCaptured) end_episode(Episode::CAPTURED);
  if (outcome == Outcome::kTimedOut) end_episode(Episode::TIMED_OUT);
}

void TaskPlayer::publish_target(const ros::Time& stamp) {
  const Eigen::Vector2d metres = assignment_.task->target() * config_.simulator.scales.length;
  target_.header.stamp = stamp;
  target_.point.x = metres.x();
  target_.point.y = metres.y();
  target_publisher_.publish(target_);
  geometry_msgs::PoseStamped pose;
  pose.header = target_.header;
  pose.pose.position = target_.point;
  pose.pose.orientation.w = 1;
  target_path_.add(episode_.step, pose);
}

void TaskPlayer::on_abort(const threelink_msgs::EpisodeAbort& message) {
  if (playing_ && message.episode == episode_.episode)
    end_episode(Episode::ABORTED, message.reason);
}

// No target answers the last state: the simulator would take one step more.
void TaskPlayer::end_episode(std::uint8_t status, const std::string& reason) {
  playing_ = false;
  episode_.status = status;
  episode_.reason = reason;
  episode_publisher_.publish(episode_);
}

bool TaskPlayer::recorded() const {
  return recording_ && recording_->episode == episode_.episode &&
         recording_->state != Recording::READY;
}

std::string TaskPlayer::line() const {
  std::string figures = fmt::format("t = {:.6g}, distance {:.3g}, mean speed {:.3g}", episode_.time,
                                    episode_.distance, episode_.mean_speed);
  const std::size_t waypoints = assignment_.task->waypoints().size();
  if (waypoints > 1) figures += fmt::format(", {} of {} waypoints", episode_.waypoint, waypoints);
  std::string text = fmt::format("episode {}: ", episode_.episode);
  if (episode_.status == Episode::CAPTURED) {
    text += fmt::format("captured after {} steps ({})", episode_.step, figures);
  } else if (episode_.status == Episode::TIMED_OUT) {
    text += fmt::format("not captured (time-out after {} steps), {}", episode_.step, figures);
  } else {
    text +=
        fmt::format("aborted ({}) after {} steps ({})", episode_.reason, episode_.step, figures);
  }
  if (!config_.record) return text;
  if (!recorded()) return text + ", no bag (the recorder is silent)";
  if (recording_->state == Recording::FAILED)
    return text + fmt::format(", no bag ({})", recording_->status);
  text += ", bag " + recording_->bag;
  if (recording_->status.rfind(kNothingMissing, 0) != 0)
    text += fmt::format(" ({})", recording_->status);
  return text + (recording_->picture.empty() ? ", no picture" : ", picture " + recording_->picture);
}

void TaskPlayer::report(threelink_sim::Diagnostics::Status& status, double seconds) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (episode_.status == Episode::ABORTED) {
    status.summary(DiagnosticStatus::ERROR, "aborted: " + episode_.reason);
  } else {
    status.summary(DiagnosticStatus::OK, playing_ ? "playing" : "waiting");
  }
  status.add("episode", episode_.episode);
  status.add("step", episode_.step);
  status.add("waypoint", episode_.waypoint);
  status.add("distance", episode_.distance);
  status.addf("steps per second", "%.1f", steps_ / seconds);
  steps_ = 0;
}

}  // namespace threelink_tasks
