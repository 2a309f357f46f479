#include "learner.hpp"

#include <fmt/format.h>
#include <ros/console.h>
#include <threelink_msgs/Leases.h>
#include <threelink_msgs/PolicyWeights.h>

#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"
#include "training_messages.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;

std::string line_of(const WorkerRoster::Worker& worker, bool alive, Dispatcher::Time now) {
  std::string line = fmt::format(
      "{}, {} on {}, {} threads, {} episodes, heard {:.1f} s ago, {} leases lost, {} batches "
      "refused, started {} times",
      alive                     ? "alive"
      : !worker.refused.empty() ? "refused"
                                : "gone",
      worker.status.instructions, worker.status.host, worker.status.threads, worker.episodes,
      std::chrono::duration<double>(now - worker.heard).count(), worker.leases_lost,
      worker.batches_refused, worker.instances);
  if (!worker.refused.empty()) line += ": " + worker.refused;
  return line;
}

}  // namespace

Learner::Learner(const TrainConfig& config, const RemoteRollouts::Settings& settings)
    : rollouts_(config, settings, *this, [] { return threelink_sim::running(); }),
      diagnostics_("training", "threelink_learner",
                   [this](Diagnostics::Status& status, double) { report(status); }),
      spinner_(1) {
  constexpr bool kLatch = true;
  policy_publisher_ = node_.advertise<threelink_msgs::PolicyWeights>(topics::kPolicy, 1, kLatch);
  leases_publisher_ = node_.advertise<threelink_msgs::Leases>(
      topics::kLeases, 100,
      [this](const ros::SingleSubscriberPublisher& subscriber) {
        rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time) {
          dispatcher.connect(subscriber.getSubscriberName());
        });
      },
      [this](const ros::SingleSubscriberPublisher& subscriber) {
        rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time) {
          dispatcher.disconnect(subscriber.getSubscriberName());
        });
      });
  status_publisher_ =
      node_.advertise<threelink_msgs::TrainingStatus>(topics::kTrainingStatus, 10, kLatch);
  const auto hints = ros::TransportHints().tcpNoDelay();
  worker_subscriber_ = node_.subscribe(topics::kWorkers, 1000, &Learner::on_worker, this, hints);
  episodes_subscriber_ =
      node_.subscribe(topics::kEpisodes, 1000, &Learner::on_episodes, this, hints);
  status_timer_ = node_.createSteadyTimer(
      ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) { publish_status(); });
  spinner_.start();
}

Learner::~Learner() { spinner_.stop(); }

void Learner::send_policy(std::uint64_t version, const std::string& bytes) {
  threelink_msgs::PolicyWeights message;
  message.header.stamp = wall_time();
  message.version = version;
  message.data.assign(bytes.begin(), bytes.end());
  policy_publisher_.publish(message);
}

void Learner::send(std::uint64_t session, const Update& update,
                   const Dispatcher::Sending& sending) {
  threelink_msgs::Leases message;
  message.header.stamp = wall_time();
  message.session = session;
  message.version = update.version;
  message.policy = update.policy;
  for (const Lease& lease : sending.leases) {
    threelink_msgs::Lease& given = message.leases.emplace_back();
    given.id = lease.id;
    given.worker = lease.worker;
    given.first_episode = update.first_episode + lease.first;
    given.episodes = lease.count;
  }
  for (const Refusal& refusal : sending.refusals) {
    threelink_msgs::LeaseRefusal& refused = message.refusals.emplace_back();
    refused.worker = refusal.worker;
    refused.reason = refusal.reason;
  }
  leases_publisher_.publish(message);
}

void Learner::on_worker(const threelink_msgs::WorkerStatus& message) {
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    dispatcher.hear(from_message(message), now);
  });
}

void Learner::on_episodes(const boost::shared_ptr<threelink_msgs::EpisodeBatch>& message) {
  const EpisodeBatch batch = from_message(std::move(*message));
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    const Verdict verdict = dispatcher.deliver(batch, now);
    if (is_fault(verdict))
      ROS_WARN("refused a batch of worker %016lx, lease %lu: %s", batch.worker, batch.lease,
               to_string(verdict));
  });
}

void Learner::on_update(const Trainer& trainer, const UpdateReport* report,
                        const Progress& progress) {
  {
    const TrainConfig& config = trainer.config();
    const std::lock_guard<std::mutex> lock(mutex_);
    status_.updates = config.updates();
    status_.update = trainer.state().update;
    status_.time_left = progress.seconds_left();
    if (report) {
      status_.episodes = report->episodes;
      status_.steps = report->steps;
      status_.steps_per_s = progress.steps_per_s();
      status_.mean_return = report->mean_return;
      status_.policy_loss = report->statistics.policy_loss;
      status_.value_loss = report->statistics.value_loss;
      status_.kl = report->statistics.kl;
      status_.entropy = report->entropy;
    } else {
      status_.episodes = std::uint64_t{config.update.episodes} * trainer.state().update;
      status_.steps = status_.episodes * config.environment.steps;
    }
  }
  publish_status();
}

void Learner::publish_status() {
  std::uint32_t workers = 0;
  rollouts_.with(
      [&](Dispatcher& dispatcher, Dispatcher::Time) { workers = dispatcher.roster().alive(); });
  const std::lock_guard<std::mutex> lock(mutex_);
  if (status_.updates == 0) return;  // the training has not begun
  status_.header.stamp = wall_time();
  status_.workers = workers;
  status_publisher_.publish(status_);
}

void Learner::report(Diagnostics::Status& status) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    status.summaryf(DiagnosticStatus::OK, "update %lu of %lu", status_.update, status_.updates);
  }
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    const WorkerRoster& roster = dispatcher.roster();
    if (roster.alive() == 0) status.mergeSummary(DiagnosticStatus::WARN, "no worker");
    for (const auto& [name, worker] : roster.workers())
      if (!worker.refused.empty())
        status.mergeSummary(DiagnosticStatus::WARN, name + ": " + worker.refused);
    status.add("workers alive", roster.alive());
    status.add("leases given", dispatcher.leases_given());
    status.add("leases lost", dispatcher.leases_lost());
    for (int i = 0; i < kVerdicts; ++i) {
      const auto verdict = static_cast<Verdict>(i);
      status.add(
          fmt::format("batches {}{}", is_fault(verdict) ? "refused: " : "", to_string(verdict)),
          dispatcher.batches(verdict));
    }
    for (const auto& [name, worker] : roster.workers())
      status.add("worker " + name, line_of(worker, roster.alive(worker), now));
  });
}

}  // namespace threelink_agent
