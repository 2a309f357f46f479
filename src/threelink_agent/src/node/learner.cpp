#include "learner.hpp"

#include <algorithm>
#include <random>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <ros/console.h>
#include <ros/network.h>
#include <sys/resource.h>
#include <threelink_msgs/Leases.h>
#include <threelink_msgs/PolicyWeights.h>

#include "threelink_agent/distributed/fingerprint.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/topics.hpp"
#include "training_messages.hpp"

namespace threelink_agent {
namespace {

namespace topics = threelink_sim::topics;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::TrainingStatus;
using threelink_msgs::WorkerReport;

// Of so many workers at most: those that are alive, and that have played most, go before others.
constexpr std::size_t kMostReports = 200;

std::vector<WorkerReport> reports_of(const WorkerRoster& roster, Dispatcher::Time now) {
  std::vector<const WorkerRoster::Worker*> workers;
  for (const auto& [name, worker] : roster.workers()) workers.push_back(&worker);
  if (workers.size() > kMostReports) {
    const auto rank = [&](const WorkerRoster::Worker* worker) {
      return std::make_tuple(!roster.alive(*worker), -static_cast<double>(worker->episodes),
                             now - worker->heard);
    };
    std::stable_sort(workers.begin(), workers.end(),
                     [&](const auto* a, const auto* b) { return rank(a) < rank(b); });
    workers.resize(kMostReports);
    std::sort(workers.begin(), workers.end(),
              [](const auto* a, const auto* b) { return a->status.name < b->status.name; });
  }
  std::vector<WorkerReport> reports;
  for (const WorkerRoster::Worker* pointer : workers) {
    const WorkerRoster::Worker& worker = *pointer;
    WorkerReport& report = reports.emplace_back();
    report.name = worker.status.name;
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
  settings.dispatcher.replays = given.integer("replay", {0, 1000000}, 1);
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
                   [this](Diagnostics::Status& status, double) { report(status); }),
      strange_statuses_(diagnostics_.refusals("workers refused: another node")),
      refused_statuses_(diagnostics_.refusals("workers refused: wrong values")) {
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
        rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
          dispatcher.disconnect(subscriber.getSubscriberName(), now);
        });
      });
  namespace message_size = threelink_sim::message_size;
  worker_subscriber_ = threelink_sim::subscribe<threelink_msgs::WorkerStatus>(
      node_, topics::kWorkers, 1000, message_size::kSmall, &diagnostics_,
      [this](const auto& event) { on_worker(event); });
  episodes_subscriber_ = threelink_sim::subscribe<threelink_msgs::EpisodeBatch>(
      node_, topics::kEpisodes, 1000, message_size::kArrays, &diagnostics_,
      [this](const auto& event) { on_episodes(event); });
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

// Only the node itself says who it is: what others say in its name has no effect.
void Learner::on_worker(const ros::MessageEvent<threelink_msgs::WorkerStatus const>& event) {
  const threelink_msgs::WorkerStatus& message = *event.getConstMessage();
  if (message.name != event.getPublisherName()) {
    ++strange_statuses_;
    return;
  }
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    const std::uint64_t before = dispatcher.statuses_refused();
    dispatcher.hear(from_message(message), now);
    refused_statuses_ += dispatcher.statuses_refused() - before;
  });
}

void Learner::on_episodes(const ros::MessageEvent<threelink_msgs::EpisodeBatch const>& event) {
  const std::string& publisher = event.getPublisherName();
  const EpisodeBatch batch = from_message(threelink_msgs::EpisodeBatch(*event.getConstMessage()));
  Verdict verdict{};
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    verdict = dispatcher.deliver(batch, publisher, now);
  });
  threelink_sim::QuietLog& log = batch_logs_[static_cast<int>(verdict)];
  if (is_fault(verdict))
    log.warn(fmt::format("refused a batch of {} for worker {:016x}, lease {}: {}", publisher,
                         batch.worker, batch.lease, to_string(verdict)));
  if (verdict == Verdict::kGivenBack)
    log.warn(fmt::format("{} gave lease {} back: {}", publisher, batch.lease,
                         threelink_sim::excerpt(batch.given_back, 200)));
}

void Learner::add_workers(TrainingStatus& status) {
  rollouts_.with([&](Dispatcher& dispatcher, Dispatcher::Time now) {
    status.workers = dispatcher.roster().alive();
    const auto aside = dispatcher.roster().aside();
    if (status.workers == 0 && !aside.empty())
      aside_log_.warn(fmt::format("no worker may play now; {} of those that are there is {}",
                                  aside.front()->status.name, aside.front()->refused));
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
