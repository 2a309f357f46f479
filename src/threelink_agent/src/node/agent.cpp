#include "agent.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <ros/console.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/graph.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;

// The swimmer that a policy is for, and the shapes that follow from it.
std::string swimmer(const Policy& policy) {
  const auto& first = policy.actor().layers().front().weight;
  const auto& last = policy.actor().layers().back().weight;
  return fmt::format(
      "observation \"{}\" of {} links: first weight of shape ({}, {}), last of ({}, {})",
      to_string(policy.metadata().observation), policy.metadata().links, first.rows(), first.cols(),
      last.rows(), last.cols());
}

bool same_swimmer(const Policy& a, const Policy& b) {
  return a.metadata().links == b.metadata().links &&
         a.metadata().observation == b.metadata().observation;
}

}  // namespace

Agent::Agent(Policy policy, const std::string& source, const AgentConfig& config)
    : config_(config),
      policy_(std::move(policy)),
      source_(source),
      swimmers_(config.allow_other_swimmer),
      diagnostics_("policy", "threelink_agent",
                   [this](Diagnostics::Status& status, double s) { report(status, s); }),
      other_swimmer_(diagnostics_.refusals("observation refused: of another swimmer")),
      wrong_kind_(diagnostics_.refusals("observation refused: wrong kind")),
      wrong_frame_(diagnostics_.refusals("observation refused: wrong frame")),
      strange_(diagnostics_.refusals("observation refused: another node")),
      wrong_length_(diagnostics_.refusals("observation refused: wrong length")),
      out_of_range_(diagnostics_.refusals("observation refused: out of range")),
      refused_policies_(diagnostics_.refusals("policies refused")),
      loaded_policies_(diagnostics_.counter("policies loaded")) {
  rates_.policy = policy_.id();
  rates_.rates.resize(policy_.hinges());
  constexpr bool kLatch = true;
  rates_publisher_ = node_.advertise<threelink_msgs::HingeRates>(topics::kHingeRates, 10, kLatch);
  ros::NodeHandle direct_node;
  direct_node.setCallbackQueue(&direct_queue_);
  namespace message_size = threelink_sim::message_size;
  observation_subscriber_ = threelink_sim::subscribe<threelink_msgs::Observation>(
      direct_node, topics::kObservation, 100, message_size::kSmall, &diagnostics_,
      [this](const auto& event) { on_observation(event); });
  policy_subscriber_ = threelink_sim::subscribe<threelink_msgs::PolicyWeights>(
      node_, topics::kPolicy, 1, message_size::kFile, &diagnostics_,
      [this](const auto& event) { on_policy(event.getConstMessage()); });
  load_server_ = threelink_sim::advertise_service<threelink_msgs::LoadPolicy>(
      node_, topics::kLoadPolicy, message_size::kSmall, &diagnostics_,
      [this](auto& call) { on_load(call); });
  if (config_.follow)
    follow_timer_ =
        node_.createSteadyTimer(ros::WallDuration(0.1), [this](const ros::SteadyTimerEvent&) {
          if (const auto weights = std::exchange(newest_, nullptr)) load(*weights);
        });
  look_for_the_simulator();
  simulator_timer_ = node_.createSteadyTimer(
      ros::WallDuration(0.5), [this](const ros::SteadyTimerEvent&) { look_for_the_simulator(); });
  ROS_INFO("policy %s from %s", policy_.id().c_str(), source_.c_str());
}

// The node that serves `reset`, if it publishes observations, too: again whenever it is silent.
void Agent::look_for_the_simulator() {
  {
    threelink_sim::Lock lock(mutex_);
    if (std::exchange(heard_, false) && !simulator_.name().empty()) return;
  }
  const std::string found = threelink_sim::node_behind(node_.resolveName(topics::kReset),
                                                       node_.resolveName(topics::kObservation));
  threelink_sim::Lock lock(mutex_);
  simulator_.expect(found);
}

void Agent::on_observation(const ros::MessageEvent<const threelink_msgs::Observation>& event) {
  const auto begin = std::chrono::steady_clock::now();
  const threelink_msgs::Observation& observation = *event.getMessage();
  threelink_sim::Lock lock(mutex_);
  if (!simulator_.may_be(event.getPublisherName())) {
    ++strange_;
    return;
  }
  heard_ = true;
  if (next_ && observation.episode != rates_.episode) {
    put_in_use(std::move(next_->policy), next_->source);
    next_.reset();
  }
  if (!acceptable(observation,
                  swimmers_.refusal(event.getConnectionHeaderPtr(), policy_.metadata())))
    return;
  rates_.header.stamp = observation.header.stamp;
  rates_.header.frame_id = observation.header.frame_id;
  rates_.episode = observation.episode;
  rates_.step = observation.step;
  if (config_.sampled.value_or(policy_.metadata().sampled)) {
    const ActionKey key{config_.seed, observation.episode,
                        static_cast<std::uint32_t>(observation.step)};
    policy_.sample(observation.values.data(), key, rates_.rates.data());
  } else {
    policy_.act(observation.values.data(), rates_.rates.data());
  }
  rates_publisher_.publish(rates_);
  ++answers_;
  latency_.add(std::chrono::steady_clock::now() - begin);
}

bool Agent::acceptable(const threelink_msgs::Observation& observation, const std::string& refusal) {
  constexpr std::size_t kLongestFrame = 64;
  const PolicyMetadata& metadata = policy_.metadata();
  const auto refuse = [this](Diagnostics::Counter& counter, threelink_sim::QuietLog& log,
                             std::string reason) REQUIRES(mutex_) {
    ++counter;
    log.error("refused: " + reason);
    refused_observation_ = std::move(reason);
    return false;
  };
  if (!refusal.empty()) return refuse(other_swimmer_, swimmer_log_, refusal);
  if (observation.kind != to_string(metadata.observation))
    return refuse(
        wrong_kind_, kind_log_,
        fmt::format("observation \"{}\", but policy {} takes \"{}\"; set the simulator's parameter "
                    "observation to that",
                    threelink_sim::excerpt(observation.kind, 200), policy_.id(),
                    to_string(metadata.observation)));
  if (!threelink_sim::is_harmless(observation.header.frame_id, kLongestFrame))
    return refuse(
        wrong_frame_, frame_log_,
        fmt::format("observation in the frame \"{}\": must be a name of {} letters at most",
                    threelink_sim::excerpt(observation.header.frame_id, 200), kLongestFrame));
  if (observation.values.size() != static_cast<std::size_t>(policy_.observation_size()))
    return refuse(wrong_length_, length_log_,
                  fmt::format("observation of {} values, but policy {} takes {} ({} links)",
                              observation.values.size(), policy_.id(), policy_.observation_size(),
                              metadata.links));
  for (double value : observation.values)
    if (!(std::abs(value) <= kMaxObservation))
      return refuse(out_of_range_, range_log_,
                    fmt::format("observation with the value {}: must be finite and within +-{}",
                                value, kMaxObservation));
  refused_observation_.clear();
  return true;
}

template <class Load>
bool Agent::replace(const std::string& source, Load load, std::string& status) {
  try {
    Policy policy = load();  // while the old one goes on answering
    threelink_sim::Lock lock(mutex_);
    if (!same_swimmer(policy, policy_))
      throw PolicyError(fmt::format("{}: it is for {}; the one in use is for {}", source,
                                    swimmer(policy), swimmer(policy_)));
    // One that follows a training has nothing else to play: its observations are refused.
    const std::string refusal = config_.follow ? "" : swimmers_.refusal(policy.metadata());
    if (!refusal.empty()) throw PolicyError(fmt::format("{}: {}", source, refusal));
    if (config_.follow)
      next_ = Successor{std::move(policy), source};
    else
      put_in_use(std::move(policy), source);
    ++loaded_policies_;
    refused_policy_.clear();
    status = config_.follow ? source + " is in use from the next episode on"
                            : fmt::format("policy {} from {} is in use", policy_.id(), source_);
    return true;
  } catch (const std::exception& error) {
    threelink_sim::Lock lock(mutex_);
    ++refused_policies_;
    policy_log_.error(
        fmt::format("refused: {}; policy {} from {} stays", error.what(), policy_.id(), source_));
    refused_policy_ = threelink_sim::excerpt(threelink_sim::text_for_peers(error), 1000);
    status =
        fmt::format("refused: {}; policy {} from {} stays", refused_policy_, policy_.id(), source_);
    return false;
  }
}

void Agent::put_in_use(Policy policy, const std::string& source) {
  policy_ = std::move(policy);
  source_ = source;
  rates_.policy = policy_.id();
  swimmers_.forget_refusals();
  ROS_INFO("policy %s from %s is in use", policy_.id().c_str(), source_.c_str());
}

void Agent::on_policy(const threelink_msgs::PolicyWeights::ConstPtr& weights) {
  if (config_.follow)
    newest_ = weights;
  else
    load(*weights);
}

void Agent::load(const threelink_msgs::PolicyWeights& weights) {
  const std::string source = fmt::format("topic {}, version {}", topics::kPolicy, weights.version);
  std::string status;
  replace(
      source,
      [&] {
        return Policy::parse({weights.data.begin(), weights.data.end()}, source);
      },
      status);
}

void Agent::on_load(threelink_sim::IntakeOfService<threelink_msgs::LoadPolicy>::Event& call) {
  threelink_msgs::LoadPolicy::Response& response = call.getResponse();
  const std::string& file = call.getRequest().file;
  response.success = replace(
      threelink_sim::excerpt(file, 4096), [&] { return Policy::load(file); }, response.status);
  threelink_sim::Lock lock(mutex_);
  response.sha256 = policy_.sha256();
}

void Agent::report(Diagnostics::Status& status, double seconds) {
  threelink_sim::Lock lock(mutex_);
  if (!refused_observation_.empty())
    status.summary(DiagnosticStatus::ERROR, refused_observation_);
  else if (!refused_policy_.empty())
    status.summary(DiagnosticStatus::WARN, "policy refused: " + refused_policy_);
  else
    status.summary(DiagnosticStatus::OK, answers_ > 0 ? "answering" : "idle");
  status.add("policy", source_);
  status.add("policy sha256", policy_.sha256());
  status.addf("answers per second", "%.1f", answers_ / seconds);
  status.addf("latency p50 [us]", "%.1f", latency_.quantile(0.5));
  status.addf("latency p99 [us]", "%.1f", latency_.quantile(0.99));
  answers_ = 0;
  latency_.clear();
}

}  // namespace threelink_agent
