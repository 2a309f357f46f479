#include "simulator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <rosgraph_msgs/Clock.h>
#include <threelink_msgs/EpisodeAbort.h>

#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/peer_types.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_sim {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using std::chrono::steady_clock;

// [1/s] of wall time: above it, /clock, joint_states and pose skip steps. At full speed they go at
// the display rate, so that thousands of steps a second do not wake up every node of the graph for
// each.
constexpr double kStandardRate = 200;

// Bounds of a start state; far beyond any use, and well within what the arithmetic bears.
constexpr double kMaxStart = 1e6;  // [L] |x_1|, |y_1|
constexpr double kMaxAngle = 1e4;  // [rad] |theta_1|

ros::Time from_nanoseconds(std::uint64_t stamp) { return ros::Time().fromNSec(stamp); }

}  // namespace

Simulator::Refusals::Refusals(Diagnostics& diagnostics, const std::string& topic,
                              const std::vector<Verdict>& reasons) {
  for (Verdict reason : reasons)
    counters_[reason] = &diagnostics.refusals(topic + " refused: " + to_string(reason));
}

bool Simulator::Refusals::accept(Verdict verdict) {
  if (verdict == Verdict::kAccepted) return true;
  ++*counters_.at(verdict);
  return false;
}

Simulator::Simulator(const SimulatorConfig& config)
    : config_(config),
      environment_(config.environment, 1),
      lockstep_(config.lockstep()),
      diagnostics_("simulation", "threelink_simulator",
                   [this](Diagnostics::Status& status, double s) { report(status, s); }),
      refused_rates_(diagnostics_, topics::kHingeRates,
                     {Verdict::kWrongLength, Verdict::kNotFinite, Verdict::kOutOfRange,
                      Verdict::kStale, Verdict::kFuture}),
      refused_targets_(diagnostics_, topics::kTarget,
                       {Verdict::kNotFinite, Verdict::kStale, Verdict::kFuture}),
      foreign_frames_(diagnostics_.refusals("target refused: wrong frame")),
      strange_targets_(diagnostics_.refusals("target refused: another node")),
      strange_rates_(diagnostics_.refusals("hinge_rates refused: another node")),
      strange_ends_(diagnostics_.refusals("episode refused: another node")),
      refused_resets_(diagnostics_.refusals("reset refused")),
      watchdog_steps_(diagnostics_.counter("watchdog steps")),
      aborts_(diagnostics_.counter("episodes aborted")),
      view_(node_, {config.scales, config.environment.dt, config.environment.model.gamma},
            [this] {
              Lock lock(mutex_);
              display_throttle_.request();
            }),
      standard_throttle_(config.realtime_factor > 0 ? kStandardRate : config.display_rate),
      display_throttle_(config.display_rate) {
  constexpr bool kLatch = true;
  clock_publisher_ = node_.advertise<rosgraph_msgs::Clock>(topics::kClock, 1, kLatch);
  state_publisher_ = node_.advertise<threelink_msgs::SwimmerState>(topics::kState, 10, kLatch);
  if (environment_.has_world()) {
    world_state_publisher_ =
        node_.advertise<threelink_msgs::WorldState>(topics::kWorldState, 10, kLatch);
    world_view_.emplace(node_, config.environment.world, config.scales);
  }
  observation_publisher_ =
      node_.advertise<threelink_msgs::Observation>(topics::kObservation, 10, kLatch);
  joint_publisher_ = node_.advertise<sensor_msgs::JointState>(topics::kJointStates, 10);
  pose_publisher_ = node_.advertise<geometry_msgs::PoseStamped>(topics::kPose, 10);
  abort_publisher_ = node_.advertise<threelink_msgs::EpisodeAbort>(topics::kAbort, 10);

  publish_clock();
  observation_.kind = to_string(config.environment.observation);
  observation_.values.resize(environment_.observation_size());

  ros::NodeHandle lockstep_node;
  if (config.realtime_factor == 0) lockstep_node.setCallbackQueue(&direct_queue_);
  using message_size::kSmall;
  target_subscriber_ = subscribe<geometry_msgs::PointStamped>(
      lockstep_node, topics::kTarget, 100, kSmall, &diagnostics_,
      [this](const auto& event) { on_target(event); });
  rates_subscriber_ = subscribe<threelink_msgs::HingeRates>(
      lockstep_node, topics::kHingeRates, 100, kSmall, &diagnostics_,
      [this](const auto& event) { on_rates(event); });
  episode_subscriber_ =
      subscribe<threelink_msgs::Episode>(node_, topics::kEpisode, 10, kSmall, &diagnostics_,
                                         [this](const auto& event) { on_episode(event); });
  reset_server_ = advertise_service<threelink_msgs::Reset>(
      node_, topics::kReset, kSmall, &diagnostics_, [this](auto& call) { on_reset(call); });
}

int Simulator::run() {
  // To notice the end of the node, and deadlines that the network thread has set.
  constexpr auto kPatience = std::chrono::milliseconds(20);
  while (running()) {
    std::chrono::duration<double> wait{};
    {
      Lock lock(mutex_);
      act();
      const Time now = steady_clock::now();
      wait = std::min(deadline(), now + kPatience) - now;
    }
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(std::max(wait.count(), 0.0)));
  }
  return kSuccess;
}

Lockstep::Time Simulator::deadline() const {
  return std::min(
      {lockstep_.deadline(), standard_throttle_.deadline(), display_throttle_.deadline()});
}

void Simulator::act() {
  const Time now = steady_clock::now();
  const Lockstep::Action action = lockstep_.poll(now);
  if (action == Lockstep::Action::kStep) step(now);
  if (action == Lockstep::Action::kAbort) abort_for_silence();
  if (standard_throttle_.take(now)) publish_standard();
  if (display_throttle_.take(now)) {
    if (transform_.header.stamp != state_.header.stamp) {
      to_transform(state_, config_.scales, transform_);
      transform_publisher_.sendTransform(transform_);
    }
    view_.draw();
    if (world_view_) world_view_->draw(state_, world_state_, environment_.time(0));
  }
}

SwimmerState Simulator::start_state(const threelink_msgs::Reset::Request& request) const {
  const Model& model = config_.environment.model;
  if (request.random_start)
    return random_start(config_.environment, request.seed, lockstep_.episode() + 1);
  const bool centroid = request.from_centroid;
  const auto& position = centroid ? request.centroid : request.x_1;
  const double angle = centroid ? request.heading : request.theta_1;
  for (double x : position)
    if (!(std::abs(x) <= kMaxStart))
      throw std::invalid_argument(fmt::format("{} = ({}, {}): must be within [-{}, {}] L",
                                              centroid ? "centroid" : "x_1", position[0],
                                              position[1], kMaxStart, kMaxStart));
  if (!(std::abs(angle) <= kMaxAngle))
    throw std::invalid_argument(fmt::format("{} = {}: must be within [-{}, {}] rad",
                                            centroid ? "heading" : "theta_1", angle, kMaxAngle,
                                            kMaxAngle));
  HingeVector alpha = HingeVector::Zero(model.hinges());
  if (!request.alpha.empty()) {
    if (request.alpha.size() != static_cast<std::size_t>(model.hinges()))
      throw std::invalid_argument(fmt::format("alpha has {} values: {} links have {} hinges",
                                              request.alpha.size(), model.links, model.hinges()));
    std::copy(request.alpha.begin(), request.alpha.end(), alpha.data());
  }
  SwimmerState state;
  state.alpha = alpha;
  validate(model, state);
  if (!centroid) return state_from_free_end(model, {position[0], position[1]}, angle, alpha);
  state.centroid = {position[0], position[1]};
  state.heading = angle;
  return state;
}

bool Simulator::taken(const std::string& caller) const {
  return announced_ && caller != owner_ && lockstep_.phase() != Lockstep::Phase::kIdle;
}

void Simulator::on_reset(IntakeOfService<threelink_msgs::Reset>::Event& call) {
  Lock lock(mutex_);
  threelink_msgs::Reset::Response& response = call.getResponse();
  const std::string& caller = call.getCallerName();
  try {
    if (taken(caller))
      throw std::invalid_argument(fmt::format(
          "episode {} of {} runs; it ends by that node's message `episode`, or {} s after its last "
          "target",
          lockstep_.episode(), owner_, config_.peer_timeout));
    environment_.reset(0, start_state(call.getRequest()),
                       {call.getRequest().seed, lockstep_.episode() + 1});
  } catch (const std::invalid_argument& error) {
    ++refused_resets_;
    response.success = false;
    response.status = error.what();
    return;
  }
  abort_reason_.clear();
  owner_ = caller;
  announced_ = false;
  task_ = agent_ = Peer();
  lockstep_.start(steady_clock::now());
  publish_state();
  response.success = true;
  response.status = fmt::format("episode {} started", lockstep_.episode());
  response.state = state_;
}

void Simulator::on_target(const Event<geometry_msgs::PointStamped>& event) {
  const geometry_msgs::PointStamped& message = *event.getConstMessage();
  Lock lock(mutex_);
  if (message.header.frame_id != frames::kWorld) {
    ++foreign_frames_;
    return;
  }
  if (!task_.may_be(event.getPublisherName())) {
    ++strange_targets_;
    return;
  }
  const Eigen::Vector2d metres(message.point.x, message.point.y);
  const Eigen::Vector2d target = metres / config_.scales.length;
  const Verdict verdict =
      lockstep_.target(message.header.stamp.toNSec(), target.x(), target.y(), steady_clock::now());
  if (!refused_targets_.accept(verdict)) return;
  task_.is(event.getPublisherName());
  environment_.aim(0, target);
  publish_observation();
  view_.set_target(metres);
}

void Simulator::on_rates(const Event<threelink_msgs::HingeRates>& event) {
  const threelink_msgs::HingeRates& message = *event.getConstMessage();
  Lock lock(mutex_);
  if (!agent_.may_be(event.getPublisherName()))
    ++strange_rates_;
  else if (refused_rates_.accept(lockstep_.rates(message.episode, message.step,
                                                 message.rates.data(), message.rates.size())))
    agent_.is(event.getPublisherName());
  act();
}

void Simulator::on_episode(const Event<threelink_msgs::Episode>& event) {
  const threelink_msgs::Episode& message = *event.getConstMessage();
  Lock lock(mutex_);
  const bool started = message.status == threelink_msgs::Episode::STARTED;
  if (message.episode != lockstep_.episode()) return;  // the latched one of an earlier episode
  if (event.getPublisherName() != owner_) {
    ++strange_ends_;
    return;
  }
  if (started)
    announced_ = true;
  else
    lockstep_.end();
}

void Simulator::step(Time now) {
  environment_.step(lockstep_.command().data());
  lockstep_.stepped(now);
  if (lockstep_.watchdog_tripped()) ++watchdog_steps_;
  ++steps_;
  publish_state();
  if (environment_.left_grid(0))
    abort("", fmt::format("step {} of episode {}: the swimmer has left the grid of the flow, at "
                          "({:.4g}, {:.4g}) L",
                          lockstep_.step(), lockstep_.episode(), state_.centroid[0],
                          state_.centroid[1]));
}

void Simulator::abort_for_silence() {
  const bool task = lockstep_.phase() == Lockstep::Phase::kAwaitTarget;
  const std::string peer = task ? topics::kTarget : topics::kHingeRates;
  std::string reason = fmt::format("no {} for step {} of episode {} in {} s: the {} is silent",
                                   peer, lockstep_.step(), lockstep_.episode(),
                                   config_.peer_timeout, task ? "task" : "agent");
  const std::string conflict = other_type_on(node_.resolveName(peer));
  if (!conflict.empty()) reason += ": " + conflict;
  abort(peer, reason);
}

void Simulator::abort(const std::string& peer, const std::string& reason) {
  threelink_msgs::EpisodeAbort message;
  message.header.stamp = state_.header.stamp;
  message.episode = lockstep_.episode();
  message.step = lockstep_.step();
  message.peer = peer;
  message.reason = reason;
  ROS_ERROR("%s", message.reason.c_str());
  abort_publisher_.publish(message);
  abort_reason_ = message.reason;
  ++aborts_;
  lockstep_.end();
}

void Simulator::publish_state() {
  state_.header.stamp = from_nanoseconds(lockstep_.stamp());
  state_.header.frame_id = frames::kWorld;
  state_.episode = lockstep_.episode();
  state_.step = lockstep_.step();
  const StepRecord record = environment_.record(0);
  to_message(config_.environment.model, record, state_);
  state_publisher_.publish(state_);
  if (world_view_) {
    world_state_.header = state_.header;
    world_state_.episode = state_.episode;
    world_state_.step = state_.step;
    to_message(environment_, record, world_state_);
    world_state_publisher_.publish(world_state_);
    steps_in_contact_ += world_state_.contacts > 0;
  }

  // The rest while the task works out its answer.
  standard_throttle_.request();
  display_throttle_.request();
  view_.add(state_);
}

void Simulator::publish_observation() {
  observation_.header.stamp = state_.header.stamp;
  observation_.episode = state_.episode;
  observation_.step = state_.step;
  to_message(environment_, observation_);
  observation_publisher_.publish(observation_);
}

void Simulator::publish_standard() {
  publish_clock();
  to_joint_state(state_, config_.scales, joints_);
  joint_publisher_.publish(joints_);
  to_pose(state_, config_.scales, pose_);
  pose_publisher_.publish(pose_);
}

void Simulator::publish_clock() {
  rosgraph_msgs::Clock clock;
  clock.clock = from_nanoseconds(lockstep_.stamp());
  clock_publisher_.publish(clock);
}

void Simulator::report(Diagnostics::Status& status, double seconds) {
  Lock lock(mutex_);
  using Phase = Lockstep::Phase;
  if (!abort_reason_.empty()) {
    status.summary(DiagnosticStatus::ERROR, abort_reason_);
  } else if (lockstep_.phase() == Phase::kIdle) {
    status.summary(DiagnosticStatus::OK, "idle: waiting for a reset");
  } else if (lockstep_.watchdog_tripped()) {
    status.summary(DiagnosticStatus::WARN, "watchdog: hinge rates are late, steps with zero rates");
  } else {
    status.summary(DiagnosticStatus::OK, "running");
  }
  status.add("episode", lockstep_.episode());
  status.add("step", lockstep_.step());
  status.addf("steps per second", "%.1f", steps_ / seconds);
  status.addf("real-time ratio", "%.3f", steps_ * config_.step_time() / seconds);
  steps_ = 0;
  if (!world_view_) return;
  status.add("contacts", world_state_.contacts);
  status.addf("contact force [C_perp L^2/T0]", "%.4g",
              std::hypot(world_state_.contact_force[0], world_state_.contact_force[1]));
  status.add("steps in contact since the last report", steps_in_contact_);
  steps_in_contact_ = 0;
}

}  // namespace threelink_sim
