#include "learner.hpp"

#include <random>
#include <utility>

#include <fmt/format.h>
#include <ros/console.h>
#include <ros/network.h>
#include <sys/resource.h>
#include <threelink_msgs/Leases.h>
#include <threelink_msgs/PolicyWeights.h>

#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_sim/node/topics.hpp"
#include "training_messages.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::TrainingStatus;
using threelink_msgs::WorkerReport;

std::vector<WorkerReport> reports_of(const WorkerRoster& roster, Dispatcher::Time now) {
  std::vector<WorkerReport> reports;
  for (const auto& [name, worker] : roster.workers()) {
    WorkerReport& report = reports.emplace_back();
    report.name = name;
    report.state = roster.alive(worker)     ? WorkerReport::ALIVE
                   : worker.refused.empty() ? WorkerReport::GONE
                                            : WorkerReport::REFUSED;
    report.reason = worker.refused;
    report.host = worker.status.host;
    report.instructions = worker.status.instructions;
    report.threads = worker.status.threads;
    report.silence = std::chrono::duration<double>(now - worker.heard).count();
    report.episodes = worker.episodes;
    report.leases_lost = worker.leases_lost;
    report.batches_refused = worker.batches_refused;
    report.instances = worker.instances;
  }
  return reports;
}

const char* to_string(const WorkerReport& worker) {
  return worker.state == WorkerReport::ALIVE  ? "alive"
         : worker.state == WorkerReport::GONE ? "gone"
                                              : "refused";
}

std::string line_of(const WorkerReport& worker) {
  std::string line = fmt::format(
      "{}, {} on {}, {} threads, {} episodes, heard {:.1f} s ago, {} leases lost, {} batches "
      "refused, started {} times",
      to_string(worker), worker.instructions, worker.host, worker.threads, worker.episodes,
      worker.silence, worker.leases_lost, worker.batches_refused, worker.instances);
  if (!worker.reason.empty()) line += ": " + worker.reason;
  return line;
}

std::uint64_t draw_session() {
  std::random_device device;
  return (std::uint64_t{device()} << 32 | device()) | 1;  // not 0
}

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(s * 1e9));
}

RemoteRollouts::Settings of_this_learner(RemoteRollouts::Settings settings) {
  settings.dispatcher.roster.session = draw_session();
  settings.dispatcher.roster.fingerprint = fingerprint();
  return settings;
}

}  // namespace

RemoteRollouts::Settings read_remote_settings(threelink_sim::Parameters& given) {
  RemoteRollouts::Settings settings;
  settings.worker_timeout = seconds(given.real("worker_timeout", {0.1, 1e6}, 30));
  settings.dispatcher.lease_time = seconds(given.real("lease_timeout", {0.1, 1e6}, 60));
  settings.dispatcher.lease_episodes = given.integer("lease_episodes", {1, 1000000}, 256);
  return settings;
}

void allow_many_connections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

void log_reach() {
  const std::string& host = ros::network::getHost();
  if (host == "localhost" || host.rfind("127.", 0) == 0)
    ROS_INFO(
        "workers of this machine can connect; those of others cannot, since this node's "
        "address is %s (lan:=true of train.launch, ROS_IP)",
        host.c_str());
  else
    ROS_WARN(
        "workers of every machine that reaches %s can connect: ROS 1 neither encrypts nor "
        "asks who it is",
        host.c_str());
}

Learner::Learner(const TrainConfig& config, const RemoteRollouts::Settings& settings,
                 std::function<bool()> keep_going)
    : rollouts_(config, of_this_learner(settings), *this, std::move(keep_going)),
      status_publisher_([this](TrainingStatus& status) { add_workers(status); }),
      diagnostics_("training", "threelink_learner",
                   [this](Diagnostics::Status& status, double) { report(status); }) {
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
  const auto hints = ros::TransportHints().tcpNoDelay();
  worker_subscriber_ = node_.subscribe(topics::kWorkers, 1000, &Learner::on_worker, this, hints);
  episodes_subscriber_ =
      node_.subscribe(topics::kEpisodes, 1000, &Learner::on_episodes, this, hints);
}

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
    if (verdict == Verdict::kGivenBack)
      ROS_WARN("worker %016lx gave lease %lu back: %s", batch.worker, batch.lease,
               batch.given_back.c_str());
  });
}

void Learner::add_workers(TrainingStatus& status) {
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    status.workers = dispatcher.roster().alive();
    status.worker_reports = reports_of(dispatcher.roster(), now);
  });
}

void Learner::report(Diagnostics::Status& status) {
  const TrainingStatus training = status_publisher_.status();
  status.summaryf(DiagnosticStatus::OK, "update %lu of %lu", training.update, training.updates);
  if (training.workers == 0) status.mergeSummary(DiagnosticStatus::WARN, "no worker");
  for (const WorkerReport& worker : training.worker_reports)
    if (!worker.reason.empty())
      status.mergeSummary(DiagnosticStatus::WARN, worker.name + ": " + worker.reason);
  status.add("workers alive", training.workers);
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time) {
    status.add("leases given", dispatcher.leases_given());
    status.add("leases lost", dispatcher.leases_lost());
    for (int i = 0; i < kVerdicts; ++i) {
      const auto verdict = static_cast<Verdict>(i);
      status.add(
          fmt::format("batches {}{}", is_fault(verdict) ? "refused: " : "", to_string(verdict)),
          dispatcher.batches(verdict));
    }
  });
  for (const WorkerReport& worker : training.worker_reports)
    status.add("worker " + worker.name, line_of(worker));
}

}  // namespace threelink_agent
