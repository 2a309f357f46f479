#include "worker.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>
#include <utility>

#include <boost/make_shared.hpp>
#include <fmt/format.h>
#include <ros/console.h>
#include <ros/this_node.h>
#include <threelink_msgs/EpisodeBatch.h>
#include <threelink_msgs/WorkerStatus.h>
#include <unistd.h>

#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/sha256.hpp"
#include "training_messages.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;
using namespace std::chrono_literals;

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof(name) - 1);
  return name;
}

WorkerStatus first_status(int threads) {
  std::random_device device;
  WorkerStatus status;
  status.name = ros::this_node::getName();
  status.instance = (std::uint64_t{device()} << 32 | device()) | 1;  // not 0
  status.host = host_name();
  status.protocol = kProtocol;
  status.fingerprint = fingerprint();
  status.instructions = threelink_sim::to_string(threelink_sim::isa_in_use());
  status.threads = threads;
  return status;
}

void sleep_until(std::chrono::steady_clock::time_point end) {
  for (auto now = std::chrono::steady_clock::now(); now < end && threelink_sim::running();
       now = std::chrono::steady_clock::now())
    std::this_thread::sleep_until(std::min(end, now + 50ms));
}

}  // namespace

Worker::Worker(std::unique_ptr<RolloutSource> source, int threads, const std::string& learner,
               double step_cost)
    : player_(std::move(source)),
      step_cost_(step_cost),
      status_(first_status(threads)),
      node_(learner),
      diagnostics_("worker", "threelink_worker",
                   [this](Diagnostics::Status& status, double s) { report(status, s); }),
      leases_given_back_(diagnostics_.refusals("leases given back")),
      spinner_(1) {
  // A learner hears of this worker only when it hears its episodes too, so that none gets lost.
  const auto on_connect = [this](const ros::SingleSubscriberPublisher&) { publish_status(); };
  episodes_publisher_ =
      node_.advertise<threelink_msgs::EpisodeBatch>(topics::kEpisodes, 10, on_connect);
  status_publisher_ =
      node_.advertise<threelink_msgs::WorkerStatus>(topics::kWorkers, 10, on_connect);
  namespace message_size = threelink_sim::message_size;
  policy_subscriber_ = threelink_sim::subscribe<threelink_msgs::PolicyWeights>(
      node_, topics::kPolicy, 10, message_size::kFile, &diagnostics_,
      [this](const auto& event) { on_policy(event); });
  leases_subscriber_ = threelink_sim::subscribe<threelink_msgs::Leases>(
      node_, topics::kLeases, 100, message_size::kSmall, &diagnostics_,
      [this](const auto& event) { on_leases(event); });
  status_timer_ = node_.createSteadyTimer(
      ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) { publish_status(); });
  spinner_.start();
}

Worker::~Worker() { spinner_.stop(); }

void Worker::publish_status() {
  threelink_sim::Lock lock(mutex_);
  // Who is not heard gets no lease.
  if (episodes_publisher_.getNumSubscribers() == 0 || !player_.ready()) return;
  threelink_msgs::WorkerStatus message = to_message(status_);
  message.header.stamp = wall_time();
  status_publisher_.publish(message);
}

Worker::Learner& Worker::learner(const std::string& name) {
  constexpr std::size_t kMost = 32;
  if (learners_.size() >= kMost && learners_.count(name) == 0) {
    const auto rank = [](const auto& entry) {
      return std::make_pair(entry.second.played, entry.second.heard);
    };
    learners_.erase(
        std::min_element(learners_.begin(), learners_.end(),
                         [&](const auto& a, const auto& b) { return rank(a) < rank(b); }));
  }
  Learner& learner = learners_[name];
  learner.heard = Clock::now();
  return learner;
}

// Among those that are ready, the one that has waited longest.
std::map<std::string, Worker::Learner>::iterator Worker::next_learner() {
  auto next = learners_.end();
  for (auto it = learners_.begin(); it != learners_.end(); ++it)
    if (it->second.ready() && (next == learners_.end() || it->second.played < next->second.played))
      next = it;
  return next;
}

void Worker::tell_what_is_held() {
  const auto next = next_learner();
  const Assignment* held = playing_                  ? &*playing_
                           : next != learners_.end() ? &*next->second.assignment
                                                     : nullptr;
  status_.lease = held ? held->lease : 0;
  if (held) status_.session = held->session;
}

void Worker::on_policy(const ros::MessageEvent<threelink_msgs::PolicyWeights const>& event) {
  const threelink_msgs::PolicyWeights& message = *event.getConstMessage();
  std::string bytes(message.data.begin(), message.data.end());
  const std::string hash = threelink_sim::sha256(bytes);
  threelink_sim::Lock lock(mutex_);
  Learner& from = learner(event.getPublisherName());
  from.policy_bytes = std::move(bytes);
  from.policy = hash;
  tell_what_is_held();
  changed_.notify_one();
}

void Worker::on_leases(const ros::MessageEvent<threelink_msgs::Leases const>& event) {
  const threelink_msgs::Leases& message = *event.getConstMessage();
  threelink_sim::Lock lock(mutex_);
  Learner& from = learner(event.getPublisherName());
  if (from.session != message.session) from.assignment.reset();  // from a learner that is gone
  from.session = message.session;
  for (const threelink_msgs::LeaseRefusal& refusal : message.refusals) {
    if (refusal.worker != status_.instance) continue;
    const std::string reason = threelink_sim::excerpt(refusal.reason, 200);
    if (reason == from.refused) continue;
    from.refused = reason;
    refused_log_.error(fmt::format("the learner refuses this worker: {}", reason));
  }
  for (const threelink_msgs::Lease& lease : message.leases) {
    if (lease.worker != status_.instance) continue;
    from.refused.clear();
    from.assignment = Assignment{message.session, message.version,     message.policy, lease.id,
                                 lease.worker,    lease.first_episode, lease.episodes};
  }
  tell_what_is_held();
  changed_.notify_one();
}

std::optional<Assignment> Worker::next() {
  threelink_sim::Lock lock(mutex_);
  const auto ready = [this]() REQUIRES(mutex_) { return next_learner() != learners_.end(); };
  if (!changed_.wait_for(lock, 50ms, ready)) return {};
  const auto next = next_learner();
  playing_for_ = next->first;
  Learner& from = next->second;
  from.played = Clock::now();
  if (!player_.ready_for(*from.assignment)) {
    try {
      player_.load(from.policy_bytes, "policy");
    } catch (const std::exception& error) {
      load_log_.error(error.what());
    }
  }
  playing_ = std::exchange(from.assignment, std::nullopt);
  tell_what_is_held();
  return playing_;
}

EpisodeBatch Worker::play(const Assignment& assignment) {
  const auto begin = std::chrono::steady_clock::now();
  EpisodeBatch batch = player_.play(assignment);
  if (step_cost_ > 0) {
    const double cost = step_cost_ * batch.steps * batch.episodes;
    sleep_until(begin + std::chrono::microseconds(static_cast<std::int64_t>(cost)));
  }
  return batch;
}

void Worker::hand_in(EpisodeBatch&& batch) {
  const std::uint64_t session = batch.session;
  const std::uint32_t episodes = batch.episodes;
  const std::string given_back = batch.given_back;
  if (!given_back.empty()) {
    given_back_log_.warn(
        fmt::format("lease {} goes back to the learner: {}", batch.lease, given_back));
    ++leases_given_back_;
  }
  auto message = boost::make_shared<threelink_msgs::EpisodeBatch>(to_message(std::move(batch)));
  message->header.stamp = wall_time();
  bool wanted;
  {
    threelink_sim::Lock lock(mutex_);
    const auto learner = learners_.find(playing_for_);
    wanted = learner != learners_.end() && learner->second.session == session;
    if (wanted) status_.episodes += episodes;
    playing_.reset();
    tell_what_is_held();
    given_back_ = given_back;
  }
  if (wanted) episodes_publisher_.publish(message);
}

int Worker::run() {
  try {
    while (threelink_sim::running())
      if (const auto assignment = next()) hand_in(play(*assignment));
  } catch (const Interrupted&) {
  }
  return threelink_sim::kSuccess;
}

void Worker::report(Diagnostics::Status& status, double) {
  threelink_sim::Lock lock(mutex_);
  const auto gives_leases = [](const auto& entry) {
    return entry.second.refused.empty() && entry.second.played != Clock::time_point();
  };
  const auto refuses = [](const auto& entry) { return !entry.second.refused.empty(); };
  const auto refused = std::find_if(learners_.begin(), learners_.end(), refuses);
  if (refused != learners_.end() && std::none_of(learners_.begin(), learners_.end(), gives_leases))
    status.summary(DiagnosticStatus::ERROR, "refused by the learner: " + refused->second.refused);
  else if (episodes_publisher_.getNumSubscribers() == 0)
    status.summary(DiagnosticStatus::WARN, "no learner");
  else if (!given_back_.empty())
    status.summary(DiagnosticStatus::WARN, "the last lease was given back: " + given_back_);
  else if (!player_.ready())
    status.summary(DiagnosticStatus::WARN, "there is nothing to play with");
  else
    status.summary(DiagnosticStatus::OK, status_.lease != 0 ? "playing" : "idle");
  status.add("episodes", status_.episodes);
  status.add("instructions", status_.instructions);
  status.add("fingerprint", status_.fingerprint);
}

}  // namespace threelink_agent
