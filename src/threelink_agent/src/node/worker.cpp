#include "worker.hpp"

#include <chrono>
#include <random>
#include <thread>
#include <utility>

#include <boost/make_shared.hpp>
#include <ros/console.h>
#include <ros/this_node.h>
#include <threelink_msgs/EpisodeBatch.h>
#include <threelink_msgs/WorkerStatus.h>
#include <unistd.h>

#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_agent/sha256.hpp"
#include "threelink_sim/isa.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"
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
  const auto hints = ros::TransportHints().tcpNoDelay();
  policy_subscriber_ = node_.subscribe(topics::kPolicy, 1, &Worker::on_policy, this, hints);
  leases_subscriber_ = node_.subscribe(topics::kLeases, 100, &Worker::on_leases, this, hints);
  status_timer_ = node_.createSteadyTimer(
      ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) { publish_status(); });
  spinner_.start();
}

Worker::~Worker() { spinner_.stop(); }

void Worker::publish_status() {
  const std::lock_guard<std::mutex> lock(mutex_);
  // Who is not heard gets no lease.
  if (episodes_publisher_.getNumSubscribers() == 0 || !player_.ready()) return;
  threelink_msgs::WorkerStatus message = to_message(status_);
  message.header.stamp = wall_time();
  status_publisher_.publish(message);
}

void Worker::on_policy(const threelink_msgs::PolicyWeights& message) {
  std::string bytes(message.data.begin(), message.data.end());
  const std::string hash = sha256(bytes);
  const std::lock_guard<std::mutex> lock(mutex_);
  policy_bytes_ = std::move(bytes);
  policy_ = hash;
  changed_.notify_one();
}

void Worker::on_leases(const threelink_msgs::Leases& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (assignment_ && assignment_->session != message.session) {  // from a learner that is gone
    assignment_.reset();
    status_.lease = 0;
  }
  for (const threelink_msgs::LeaseRefusal& refusal : message.refusals) {
    if (refusal.worker != status_.instance || refusal.reason == refused_) continue;
    refused_ = refusal.reason;
    ROS_ERROR("the learner refuses this worker: %s", refused_.c_str());
  }
  for (const threelink_msgs::Lease& lease : message.leases) {
    if (lease.worker != status_.instance) continue;
    refused_.clear();
    assignment_ = Assignment{message.session, message.version,     message.policy, lease.id,
                             lease.worker,    lease.first_episode, lease.episodes};
    status_.session = message.session;
    status_.lease = lease.id;
    changed_.notify_one();
  }
}

std::optional<Assignment> Worker::next() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto ready = [this] { return assignment_ && assignment_->policy == policy_; };
  if (!changed_.wait_for(lock, 50ms, ready)) return {};
  if (!player_.ready_for(*assignment_)) {
    try {
      player_.load(policy_bytes_, "policy");
    } catch (const std::exception& error) {
      ROS_ERROR("%s", error.what());
    }
  }
  return std::exchange(assignment_, std::nullopt);
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
  const std::uint64_t session = batch.session, lease = batch.lease;
  const std::uint32_t episodes = batch.episodes;
  const std::string given_back = batch.given_back;
  if (!given_back.empty()) {
    ROS_WARN("lease %lu goes back to the learner: %s", lease, given_back.c_str());
    ++leases_given_back_;
  }
  auto message = boost::make_shared<threelink_msgs::EpisodeBatch>(to_message(std::move(batch)));
  message->header.stamp = wall_time();
  bool wanted;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wanted = status_.session == session;
    if (wanted) status_.episodes += episodes;
    if (wanted && status_.lease == lease) status_.lease = 0;
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
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!refused_.empty())
    status.summary(DiagnosticStatus::ERROR, "refused by the learner: " + refused_);
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
