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
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/call_service.hpp"
#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/node/graph.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/peer_types.hpp"
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
      malformed_states_(diagnostics_.refusals("state refused: wrong values")),
      strange_states_(diagnostics_.refusals("state refused: another node")),
      strange_aborts_(diagnostics_.refusals("abort refused: another node")),
      strange_recordings_(diagnostics_.refusals("recording refused: another node")),
      refused_points_(diagnostics_.refusals("clicked point refused")) {
  constexpr bool kLatch = true;
  target_publisher_ = node_.advertise<geometry_msgs::PointStamped>(topics::kTarget, 10, kLatch);
  episode_publisher_ = node_.advertise<Episode>(topics::kEpisode, 10, kLatch);
  path_publisher_ = node_.advertise<nav_msgs::Path>(topics::kTargetPath, 2, kLatch);
  waypoint_publisher_ =
      node_.advertise<visualization_msgs::MarkerArray>(topics::kWaypoints, 2, kLatch);
  ros::NodeHandle lockstep_node;
  lockstep_node.setCallbackQueue(&direct_queue_);
  using threelink_sim::message_size::kSmall;
  state_subscriber_ = threelink_sim::subscribe<threelink_msgs::SwimmerState>(
      lockstep_node, topics::kState, 100, kSmall, &diagnostics_,
      [this](const auto& event) { on_state(event); });
  abort_subscriber_ = threelink_sim::subscribe<threelink_msgs::EpisodeAbort>(
      node_, topics::kAbort, 10, kSmall, &diagnostics_,
      [this](const auto& event) { on_abort(event); });
  recording_subscriber_ =
      threelink_sim::subscribe<Recording>(node_, topics::kRecording, 10, kSmall, &diagnostics_,
                                          [this](const auto& event) { on_recording(event); });
  target_.header.frame_id = threelink_sim::frames::kWorld;
  // The launch files' name for the recorder goes before others, whoever speaks first.
  const std::string usual = node_.resolveName("recorder");
  if (ros::param::has(usual)) recorder_.expect(usual);
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
  if (!start_episode(assignment)) return {};
  std::unique_ptr<PointInput> points;
  if (assignment.task->takes_points()) {
    const double metre = config_.simulator.scales.length;
    const auto take_point = [this, metre](const Eigen::Vector2d& point) {
      threelink_sim::Lock lock(mutex_);
      assignment_.task->take_point(point / metre);
    };
    const Eigen::Vector2d start = [this] {
      threelink_sim::Lock lock(mutex_);
      return first_centroid_;
    }();
    points = std::make_unique<PointInput>(node_, diagnostics_, metre * start, metre, take_point,
                                          [this] { ++refused_points_; });
  }
  while (this->watch(watch))
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kPathPeriod));
  if (config_.record) wait_for(kRecordingTimeout, [this] { return recorded(); });
  threelink_sim::Lock lock(mutex_);
  std::printf("%s\n", line().c_str());
  std::fflush(stdout);
  return PlayedEpisode{episode_, energy_, recording_};
}

bool TaskPlayer::watch(const Watch& watch) {
  threelink_sim::Lock lock(mutex_);
  const double silence = std::chrono::duration<double>(Clock::now() - heard_).count();
  const std::string wanted = watch(episode_);
  if (playing_ && !threelink_sim::running()) {
    end_episode(Episode::ABORTED, "interrupted");
  } else if (playing_ && silence > silence_limit_) {
    const std::string conflict = threelink_sim::other_type_on(node_.resolveName(topics::kState));
    end_episode(Episode::ABORTED,
                fmt::format("no state {} in {:.1f} s: {}", next_step_, silence,
                            conflict.empty() ? "the simulator is silent" : conflict));
  } else if (playing_ && !wanted.empty()) {
    end_episode(Episode::ABORTED, wanted);
  }
  show();
  return playing_;
}

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
  if (config_.record && !wait([this] { return recorder_ready_; })) {
    const std::string topic = recording_subscriber_.getTopic();
    const std::string conflict = threelink_sim::other_type_on(topic);
    throw std::runtime_error(fmt::format(
        "no recorder is ready on {} in {} s: {} (record:=false does without)", topic,
        config_.start_timeout,
        conflict.empty() ? "is recorder_node running, and every topic that it waits for?"
                         : conflict));
  }
  if (config_.record && recording_ && recording_->state == Recording::FAILED &&
      recording_->episode == 0)
    throw threelink_sim::UsageError("the recorder cannot record: " +
                                    threelink_sim::excerpt(recording_->status, 1000));
}

bool TaskPlayer::start_episode(const Assignment& assignment) {
  const Start start = assignment.task->start();
  threelink_msgs::Reset reset;
  reset.request.seed = assignment.seed;
  reset.request.random_start = start.random;
  reset.request.x_1 = {start.x_1.x(), start.x_1.y()};
  reset.request.theta_1 = start.theta_1;
  reset.request.alpha.assign(start.alpha.data(), start.alpha.data() + start.alpha.size());
  if (!reset_.isValid()) {
    constexpr bool kPersistent = true;
    reset_ = node_.serviceClient<threelink_msgs::Reset>(topics::kReset, kPersistent);
  }
  const auto called = threelink_sim::call_service(reset_, reset, config_.start_timeout);
  if (called == threelink_sim::Called::kEnding) return false;
  if (called != threelink_sim::Called::kAnswered) {
    reset_ = {};  // it may believe in a connection that is broken
    throw std::runtime_error(
        fmt::format("the service {} did not answer{}", node_.resolveName(topics::kReset),
                    called == threelink_sim::Called::kTooLate ? " in time (~start_timeout)" : ""));
  }
  if (!reset.response.success)
    throw std::runtime_error("the simulator refused to start: " +
                             threelink_sim::excerpt(reset.response.status, 200));
  const std::string simulator = threelink_sim::node_behind(node_.resolveName(topics::kReset),
                                                           node_.resolveName(topics::kState));
  const threelink_msgs::SwimmerState& state = reset.response.state;
  if (!threelink_sim::well_formed(state))
    throw std::runtime_error("the simulator started from a state that is none");

  threelink_sim::Lock lock(mutex_);
  assignment_ = assignment;
  simulator_.expect(simulator);
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
  recording_.reset();
  answer(state);
  return true;
}

void TaskPlayer::on_state(const Event<threelink_msgs::SwimmerState>& event) {
  const threelink_msgs::SwimmerState& state = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  if (!playing_) return;
  if (!simulator_.may_be(event.getPublisherName())) {
    ++strange_states_;
    return;
  }
  // State 0 comes with the service's answer, too, and latched states may be repeated.
  if (state.episode == episode_.episode && state.step < next_step_) return;
  if (state.episode != episode_.episode || state.step != next_step_) {
    ++refused_states_;
    return;
  }
  if (!threelink_sim::well_formed(state)) {
    ++malformed_states_;
    return;
  }
  simulator_.is(event.getPublisherName());
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

void TaskPlayer::on_abort(const Event<threelink_msgs::EpisodeAbort>& event) {
  const threelink_msgs::EpisodeAbort& message = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  if (!playing_ || message.episode != episode_.episode) return;
  if (simulator_.may_be(event.getPublisherName()))
    end_episode(Episode::ABORTED, threelink_sim::excerpt(message.reason, 1000));
  else
    ++strange_aborts_;
}

void TaskPlayer::on_recording(const Event<Recording>& event) {
  const Recording& message = *event.getConstMessage();
  if (!recorder_.may_be(event.getPublisherName())) {
    ++strange_recordings_;
    return;
  }
  recorder_.is(event.getPublisherName());
  recorder_ready_ = true;
  threelink_sim::Lock lock(mutex_);
  // Episode 0: it cannot record any.
  if ((message.episode == episode_.episode || message.episode == 0) &&
      message.state != Recording::READY)
    recording_ = message;
}

// No target answers the last state: the simulator would take one step more.
void TaskPlayer::end_episode(std::uint8_t status, const std::string& reason) {
  playing_ = false;
  episode_.status = status;
  episode_.reason = reason;
  episode_publisher_.publish(episode_);
}

bool TaskPlayer::recorded() const { return recording_.has_value(); }

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
  const auto path = [](const std::string& name) { return threelink_sim::excerpt(name, 4096); };
  if (!recorded()) return text + ", no bag (the recorder is silent)";
  if (recording_->state == Recording::FAILED)
    return text + fmt::format(", no bag ({})", threelink_sim::excerpt(recording_->status, 1000));
  text += ", bag " + path(recording_->bag);
  if (recording_->status.rfind(kNothingMissing, 0) != 0)
    text += fmt::format(" ({})", threelink_sim::excerpt(recording_->status, 1000));
  return text +
         (recording_->picture.empty() ? ", no picture" : ", picture " + path(recording_->picture));
}

void TaskPlayer::report(threelink_sim::Diagnostics::Status& status, double seconds) {
  threelink_sim::Lock lock(mutex_);
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
