#include "agent.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <ros/console.h>

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
      wrong_length_(diagnostics_.refusals("observation refused: wrong length")),
      out_of_range_(diagnostics_.refusals("observation refused: out of range")),
      refused_policies_(diagnostics_.refusals("policies refused")),
      loaded_policies_(diagnostics_.counter("policies loaded")) {
  rates_.policy = policy_.id();
  rates_.rates.resize(policy_.hinges());
  constexpr bool kLatch = true;
  rates_publisher_ = node_.advertise<threelink_msgs::HingeRates>(topics::kHingeRates, 10, kLatch);
  const auto hints = ros::TransportHints().tcpNoDelay();
  ros::NodeHandle direct_node;
  direct_node.setCallbackQueue(&direct_queue_);
  observation_subscriber_ =
      direct_node.subscribe(topics::kObservation, 100, &Agent::on_observation, this, hints);
  policy_subscriber_ = node_.subscribe(topics::kPolicy, 1, &Agent::on_policy, this);
  load_server_ = node_.advertiseService(topics::kLoadPolicy, &Agent::on_load, this);
  if (config_.follow)
    follow_timer_ =
        node_.createSteadyTimer(ros::WallDuration(0.1), [this](const ros::SteadyTimerEvent&) {
          if (const auto weights = std::exchange(newest_, nullptr)) load(*weights);
        });
  ROS_INFO("policy %s from %s", policy_.id().c_str(), source_.c_str());
}

void Agent::on_observation(const ros::MessageEvent<const threelink_msgs::Observation>& event) {
  const auto begin = std::chrono::steady_clock::now();
  const threelink_msgs::Observation& observation = *event.getMessage();
  std::lock_guard<std::mutex> lock(mutex_);
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
  const PolicyMetadata& metadata = policy_.metadata();
  std::string reason = refusal;
  if (!refusal.empty()) {
    ++other_swimmer_;
  } else if (observation.kind != to_string(metadata.observation)) {
    ++wrong_kind_;
    reason = fmt::format(
        "observation \"{}\", but policy {} takes \"{}\"; set the simulator's parameter "
        "observation to that",
        observation.kind, policy_.id(), to_string(metadata.observation));
  } else if (observation.values.size() != static_cast<std::size_t>(policy_.observation_size())) {
    ++wrong_length_;
    reason = fmt::format("observation of {} values, but policy {} takes {} ({} links)",
                         observation.values.size(), policy_.id(), policy_.observation_size(),
                         metadata.links);
  } else {
    for (double value : observation.values) {
      if (std::abs(value) <= kMaxObservation) continue;
      ++out_of_range_;
      reason = fmt::format("observation with the value {}: must be finite and within +-{}", value,
                           kMaxObservation);
      break;
    }
  }
  if (reason != refused_observation_) {
    if (!reason.empty()) ROS_ERROR("refused: %s", reason.c_str());
    refused_observation_ = reason;
  }
  return reason.empty();
}

template <class Load>
bool Agent::replace(const std::string& source, Load load, std::string& status) {
  try {
    Policy policy = load();  // while the old one goes on answering
    std::lock_guard<std::mutex> lock(mutex_);
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
  } catch (const PolicyError& error) {
    ++refused_policies_;
    ROS_ERROR("refused: %s; policy %s from %s stays", error.what(), policy_.id().c_str(),
              source_.c_str());
    refused_policy_ = error.for_peers();
    status =
        fmt::format("refused: {}; policy {} from {} stays", refused_policy_, policy_.id(), source_);
    return false;
  }
  ++loaded_policies_;
  refused_policy_.clear();
  status = config_.follow ? source + " is in use from the next episode on"
                          : fmt::format("policy {} from {} is in use", policy_.id(), source_);
  return true;
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

bool Agent::on_load(threelink_msgs::LoadPolicy::Request& request,
                    threelink_msgs::LoadPolicy::Response& response) {
  response.success = replace(
      request.file, [&] { return Policy::load(request.file); }, response.status);
  response.sha256 = policy_.sha256();
  return true;
}

void Agent::report(Diagnostics::Status& status, double seconds) {
  std::lock_guard<std::mutex> lock(mutex_);
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
