#include "live_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <ros/names.h>
#include <ros/param.h>
#include <ros/service_client.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/call_service.hpp"
#include "threelink_sim/node/graph.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/parameters.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::Episode;
using namespace std::chrono_literals;

constexpr double kFarAway = 1000;  // [L] the target, whose direction then never changes

double heading_of(const threelink_msgs::SwimmerState& state) {
  return state.theta[state.theta.size() / 2];
}

}  // namespace

LiveLoop::LiveLoop(const LiveLoopConfig& config)
    : config_(config),
      simulator_{},
      diagnostics_("live loop", "threelink_live_loop",
                   [this](Diagnostics::Status& status, double s) { report(status, s); }),
      played_(diagnostics_.counter("episodes played")),
      episodes_given_up_(diagnostics_.refusals("episodes given up")),
      refused_states_(diagnostics_.refusals("state refused: stale")),
      refused_observations_(diagnostics_.refusals("observation refused: stale")),
      strange_states_(diagnostics_.refusals("state refused: another node")),
      strange_observations_(diagnostics_.refusals("observation refused: another node")),
      strange_aborts_(diagnostics_.refusals("abort refused: another node")) {
  constexpr bool kLatch = true;
  target_.header.frame_id = threelink_sim::frames::kWorld;
  target_publisher_ = node_.advertise<geometry_msgs::PointStamped>(topics::kTarget, 10, kLatch);
  rates_publisher_ = node_.advertise<threelink_msgs::HingeRates>(topics::kHingeRates, 10, kLatch);
  episode_publisher_ = node_.advertise<Episode>(topics::kEpisode, 10, kLatch);
  ros::NodeHandle direct_node;
  direct_node.setCallbackQueue(&direct_queue_);
  using threelink_sim::message_size::kSmall;
  state_subscriber_ = threelink_sim::subscribe<threelink_msgs::SwimmerState>(
      direct_node, topics::kState, 100, kSmall, &diagnostics_,
      [this](const auto& event) { on_state(event); });
  observation_subscriber_ = threelink_sim::subscribe<threelink_msgs::Observation>(
      direct_node, topics::kObservation, 100, kSmall, &diagnostics_,
      [this](const auto& event) { on_observation(event); });
  abort_subscriber_ = threelink_sim::subscribe<threelink_msgs::EpisodeAbort>(
      node_, topics::kAbort, 10, kSmall, &diagnostics_,
      [this](const auto& event) { on_abort(event); });
}

bool LiveLoop::ready() {
  return state_subscriber_.getNumPublishers() > 0 &&
         observation_subscriber_.getNumPublishers() > 0 &&
         target_publisher_.getNumSubscribers() > 0 && rates_publisher_.getNumSubscribers() > 0;
}

Rollout LiveLoop::play(const Play& play, int episodes) {
  check_swimmer(play);
  expect_peers();
  Rollout rollout(play.environment, episodes);
  {
    threelink_sim::Lock lock(mutex_);
    rates_.rates.resize(rollout.hinges);
  }
  for (int i = 0; i < episodes; ++i) play_episode(play, i, rollout);
  return rollout;
}

// The swimmer may have been started anew, with other parameters.
void LiveLoop::check_swimmer(const Play& play) {
  if (play.goal.has_target())
    throw NoRollout(
        fmt::format("a topic loop trains directions, not the goal {}", play.goal.kind()));
  const std::string name = ros::names::resolve(config_.simulator);
  if (!ros::param::has(name))
    throw NoRollout(fmt::format("there are no parameters of a node {} (~simulator)", name));
  try {
    threelink_sim::Parameters parameters{ros::NodeHandle(name)};
    simulator_ = threelink_sim::read_simulator_config(parameters);
  } catch (const threelink_sim::UsageError& error) {
    throw NoRollout(error.what());
  }
  const threelink_sim::EnvironmentConfig& is = simulator_.environment;
  const threelink_sim::EnvironmentConfig& wanted = play.environment;
  if ((is.world && !is.world->still()) || (wanted.world && !wanted.world->still()))
    throw NoRollout(
        "a topic loop turns the target instead of the swimmer, which a world does not allow: "
        "train in a world without ~collect");
  const std::string difference = threelink_sim::swimmer_difference(is, wanted);
  if (!difference.empty())
    throw NoRollout(fmt::format("{} is not the swimmer of the training: {}", name, difference));
  const auto check = [&](const char* parameter, double value, double other) {
    if (value != other)
      throw NoRollout(fmt::format("{}/{} is {}, and must be {}", name, parameter, value, other));
  };
  check("reward_b", is.b, wanted.b);
  check("reward_c", is.c, wanted.c);
  if (config_.exact) check("length_scale", simulator_.scales.length, 1);  // else it rounds targets
}

void LiveLoop::play_episode(const Play& play, int i, Rollout& rollout) {
  const threelink_sim::SwimmerState start = start_of(play, i);
  const threelink_msgs::SwimmerState found = reset(start);
  try {
    {
      threelink_sim::Lock lock(mutex_);
      description_ = Episode();
      description_.episode = found.episode;
      description_.task = "training";
      description_.seed = play.seed;
      description_.config =
          fmt::format("task:\n  name: training\n  episode: {}\n", play.first_episode + i);
      given_up_.clear();
      take_start(start, found);
      episode_.emplace(play, i, rollout);
      publish_episode(Episode::STARTED);
      answer(found);
    }
    wait_for_the_end();
    if (config_.exact) {
      const std::string difference = difference_from_collect(play, rollout, i);
      if (!difference.empty())
        throw NoRollout(fmt::format(
            "episode {} is not that of this process: {}; is the simulator another build, or "
            "without fused multiply-adds? (on a robot: ~exact false)",
            play.first_episode + i, difference));
    }
  } catch (const std::exception& error) {
    threelink_sim::Lock lock(mutex_);
    episode_.reset();
    ++episodes_given_up_;
    given_up_ = error.what();
    publish_episode(Episode::ABORTED, given_up_);
    throw;
  }
  ++played_;
}

threelink_msgs::SwimmerState LiveLoop::reset(const threelink_sim::SwimmerState& start) {
  threelink_msgs::Reset service;
  service.request.from_centroid = true;
  service.request.centroid = {start.centroid.x(), start.centroid.y()};
  service.request.heading = start.heading;
  service.request.alpha.assign(start.alpha.data(), start.alpha.data() + start.alpha.size());
  if (!reset_.isValid()) {
    constexpr bool kPersistent = true;
    reset_ = node_.serviceClient<threelink_msgs::Reset>(topics::kReset, kPersistent);
  }
  using threelink_sim::Called;
  const Called called = threelink_sim::call_service(reset_, service, config_.reset_timeout);
  if (called == Called::kEnding) throw Interrupted();
  if (called != Called::kAnswered) {
    reset_ = {};  // it may believe in a connection that is broken
    throw NoRollout(fmt::format("the service {} did not answer{}",
                                node_.resolveName(topics::kReset),
                                called == Called::kTooLate ? " in time (~reset_timeout)" : ""));
  }
  if (!service.response.success)
    throw NoRollout("the swimmer was not reset: " +
                    threelink_sim::excerpt(service.response.status, 200));
  return service.response.state;
}

// The node that serves `reset` speaks on the topics that it publishes; on others whoever is first.
void LiveLoop::expect_peers() {
  const auto speaker = [this](const char* topic) {
    return threelink_sim::node_behind(node_.resolveName(topics::kReset), node_.resolveName(topic));
  };
  const std::string state = speaker(topics::kState), observation = speaker(topics::kObservation),
                    abort = speaker(topics::kAbort);
  threelink_sim::Lock lock(mutex_);
  state_peer_.expect(state);
  observation_peer_.expect(observation);
  abort_peer_.expect(abort);
}

void LiveLoop::take_start(const threelink_sim::SwimmerState& demanded,
                          const threelink_msgs::SwimmerState& found) {
  if (found.alpha.size() != static_cast<std::size_t>(demanded.alpha.size()) ||
      found.theta.size() != found.alpha.size() + 1)
    throw NoRollout(fmt::format("state 0 has {} hinge angles and {} links, and must have {} and {}",
                                found.alpha.size(), found.theta.size(), demanded.alpha.size(),
                                demanded.alpha.size() + 1));
  if (!threelink_sim::well_formed(found))
    throw NoRollout("state 0 has numbers that are not finite, or a wrong number of rates");
  const double tolerance = config_.exact ? 0 : config_.start_tolerance;
  for (std::size_t j = 0; j < found.alpha.size(); ++j)
    if (!(std::abs(found.alpha[j] - demanded.alpha[j]) <= tolerance))
      throw NoRollout(fmt::format("alpha_{} at the start is {}, and must be within {} of {}", j + 1,
                                  found.alpha[j], tolerance, demanded.alpha[j]));
  if (config_.exact && heading_of(found) != demanded.heading)
    throw NoRollout(fmt::format("the heading at the start is {}, and must be {}", heading_of(found),
                                demanded.heading));
  const double turn = heading_of(found) - demanded.heading;
  to_target_ = kFarAway * Eigen::Vector2d(std::cos(turn), std::sin(turn));
}

void LiveLoop::wait_for_the_end() {
  threelink_sim::Lock lock(mutex_);
  const auto over = [this]() REQUIRES(mutex_) { return episode_->done() || !given_up_.empty(); };
  while (!changed_.wait_for(lock, 50ms, over)) {
    const double silence = std::chrono::duration<double>(Clock::now() - heard_).count();
    if (!threelink_sim::running()) throw Interrupted();
    if (!ready())
      give_up("the swimmer is gone: its topics have lost their connections");
    else if (silence > simulator_.silence_limit())
      give_up(fmt::format("nothing after step {} in {:.1f} s: the swimmer is silent",
                          episode_->step(), silence));
  }
  if (!given_up_.empty()) throw NoRollout(given_up_);
  episode_.reset();
  publish_episode(Episode::TIMED_OUT);
}

void LiveLoop::on_state(const Event<threelink_msgs::SwimmerState>& event) {
  const threelink_msgs::SwimmerState& state = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  if (!episode_ || !given_up_.empty()) return;
  if (!state_peer_.may_be(event.getPublisherName())) {
    ++strange_states_;
    return;
  }
  if (state.episode != description_.episode) {
    ++refused_states_;
    return;
  }
  state_peer_.is(event.getPublisherName());
  // State 0 comes with the service's answer, too.
  if (state.step > 0) answer(state);
}

void LiveLoop::answer(const threelink_msgs::SwimmerState& state) {
  // The rest of a state is not for learning, but the next target follows from it.
  const bool good = threelink_sim::well_formed(state);
  const auto verdict =
      good ? episode_->state(state.step, state.alpha, state.hinge_rates, state.reward)
           : LiveEpisode::Verdict::kMalformed;
  if (verdict == LiveEpisode::Verdict::kStale) ++refused_states_;
  if (!accept(verdict, "state", state.step)) return;
  ++steps_;
  description_.header = state.header;
  description_.step = state.step;
  target_.header.stamp = state.header.stamp;
  target_.point.x = (state.centroid[0] + to_target_.x()) * simulator_.scales.length;
  target_.point.y = (state.centroid[1] + to_target_.y()) * simulator_.scales.length;
  target_publisher_.publish(target_);
}

void LiveLoop::on_observation(const Event<threelink_msgs::Observation>& event) {
  const threelink_msgs::Observation& observation = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  if (!episode_ || !given_up_.empty()) return;
  if (!observation_peer_.may_be(event.getPublisherName())) {
    ++strange_observations_;
    return;
  }
  if (observation.episode != description_.episode) {
    ++refused_observations_;
    return;
  }
  observation_peer_.is(event.getPublisherName());
  if (observation.kind != threelink_msgs::Observation::DIRECTION) {
    give_up(fmt::format("observation \"{}\", and must be \"{}\"",
                        threelink_sim::excerpt(observation.kind, 200),
                        threelink_msgs::Observation::DIRECTION));
    return;
  }
  const auto verdict = episode_->observation(observation.step, observation.values);
  if (verdict == LiveEpisode::Verdict::kStale) ++refused_observations_;
  if (!accept(verdict, "observation", observation.step)) return;
  if (episode_->done()) {
    changed_.notify_one();
    return;
  }
  rates_.header.stamp = observation.header.stamp;
  rates_.header.frame_id = observation.header.frame_id;
  rates_.episode = observation.episode;
  rates_.step = observation.step;
  std::copy(episode_->rates().begin(), episode_->rates().end(), rates_.rates.begin());
  rates_publisher_.publish(rates_);
}

bool LiveLoop::accept(LiveEpisode::Verdict verdict, const char* what, std::uint64_t step) {
  using Verdict = LiveEpisode::Verdict;
  if (verdict == Verdict::kAccepted) heard_ = Clock::now();
  if (verdict == Verdict::kFuture)
    give_up(fmt::format("{} {} came after step {}: a step was missed, or taken without an answer",
                        what, step, episode_->step()));
  if (verdict == Verdict::kMalformed)
    give_up(
        fmt::format("{} {} has a wrong number of values, or one that is out of range", what, step));
  if (verdict == Verdict::kNotOurs)
    give_up(
        fmt::format("the step to {} {} was taken with other rates than demanded: was the "
                    "answer late?",
                    what, step));
  return verdict == Verdict::kAccepted;
}

void LiveLoop::on_abort(const Event<threelink_msgs::EpisodeAbort>& event) {
  const threelink_msgs::EpisodeAbort& message = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  if (!episode_ || message.episode != description_.episode) return;
  if (abort_peer_.may_be(event.getPublisherName()))
    give_up(threelink_sim::excerpt(message.reason, 1000));
  else
    ++strange_aborts_;
}

void LiveLoop::give_up(const std::string& reason) {
  if (given_up_.empty()) given_up_ = reason;
  changed_.notify_one();
}

void LiveLoop::publish_episode(std::uint8_t status, const std::string& reason) {
  description_.status = status;
  description_.reason = reason;
  episode_publisher_.publish(description_);
}

void LiveLoop::report(Diagnostics::Status& status, double seconds) {
  threelink_sim::Lock lock(mutex_);
  if (!given_up_.empty())
    status.summary(DiagnosticStatus::WARN, "the last episode was given up: " + given_up_);
  else
    status.summary(DiagnosticStatus::OK, episode_ ? "playing" : "idle");
  status.add("episode", description_.episode);
  status.add("step", description_.step);
  status.addf("steps per second", "%.1f", steps_ / seconds);
  steps_ = 0;
}

}  // namespace threelink_agent
