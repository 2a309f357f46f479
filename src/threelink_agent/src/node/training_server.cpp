#include "training_server.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <ros/console.h>

#include "learner.hpp"
#include "threelink_agent/training/run_lock.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_agent {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::TrainFeedback;
using threelink_msgs::TrainGoal;
using threelink_msgs::TrainResult;
using threelink_sim::excerpt;

TrainResult result(std::uint8_t outcome, const std::string& reason) {
  TrainResult result;
  result.outcome = outcome;
  result.reason = reason;
  return result;
}

}  // namespace

TrainingServer::TrainingServer(int threads, bool plot, const RemoteRollouts::Settings& remote)
    : threads_(threads),
      plot_(plot),
      remote_(remote),
      diagnostics_("training server", "threelink_training_server",
                   [this](Diagnostics::Status& status, double) { report(status); }),
      spinner_(1, &queue_) {
  ros::NodeHandle node;
  node.setCallbackQueue(&queue_);  // so that a goal is answered while a training runs
  server_.emplace(
      node, threelink_sim::topics::kTrain, [this](const Goal& goal) { on_goal(goal); },
      [this](const Goal& goal) { on_cancel(goal); }, false);
  server_->start();
  spinner_.start();
}

void TrainingServer::on_goal(Goal goal) {
  threelink_sim::Lock lock(mutex_);
  const auto reject = [&](const std::string& reason) {
    rejected_log_.warn("goal rejected: " + reason);
    goal.setRejected(result(Result::REJECTED, reason), reason);
  };
  if (goal_)
    return reject(fmt::format("a training into {} runs; cancel it first",
                              excerpt(goal_->getGoal()->out, 200)));
  constexpr std::size_t kLongest = 4096;  // [bytes] of a path
  if (std::max(goal.getGoal()->config.size(), goal.getGoal()->out.size()) > kLongest)
    return reject(
        fmt::format("config or out is longer than {} bytes, which is the most", kLongest));
  goal_ = goal;
  cancelled_ = false;
  changed_.notify_one();
}

void TrainingServer::on_cancel(const Goal& goal) {
  threelink_sim::Lock lock(mutex_);
  if (goal_ && *goal_ == goal) cancelled_ = true;
}

bool TrainingServer::keep_going() {
  threelink_sim::Lock lock(mutex_);
  return threelink_sim::running() && !cancelled_;
}

std::optional<TrainingServer::Goal> TrainingServer::next() {
  threelink_sim::Lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::milliseconds(50),
                    [this]() REQUIRES(mutex_) { return goal_.has_value(); });
  return goal_;
}

int TrainingServer::run() {
  while (threelink_sim::running()) {
    if (const auto goal = next()) {
      const std::function<void()> tell = train(*goal);
      {
        threelink_sim::Lock lock(mutex_);
        goal_.reset();
      }
      tell();  // the client may answer with the next goal
    }
  }
  return threelink_sim::kSuccess;
}

RunSettings TrainingServer::settings_of(const TrainGoal& goal) const {
  if (goal.out.empty()) throw ConfigError("out is required");
  RunSettings settings;
  settings.prefix = "";
  settings.config = goal.config;
  settings.out = goal.out;
  if (goal.own_seed) settings.seed = goal.seed;
  if (goal.episodes > 0) settings.episodes = goal.episodes;
  settings.resume = goal.resume;
  settings.threads = threads_;
  settings.plot = plot_;
  return settings;
}

std::function<void()> TrainingServer::train(Goal goal) {
  bool accepted = false;
  const auto fail = [&](const std::string& prefix, const std::exception& error) {
    failed_log_.error(prefix + error.what());
    const std::string reason =
        prefix + threelink_sim::excerpt(threelink_sim::text_for_peers(error), 2000);
    return [goal, accepted, reason]() mutable {
      if (accepted) {
        goal.setAborted(result(Result::FAILED, reason), reason);
      } else {
        goal.setRejected(result(Result::REJECTED, reason), reason);
      }
    };
  };

  StatusPublisher* status = nullptr;  // of the source, or of this training
  std::optional<StatusPublisher> own_status;
  RunHooks hooks;
  hooks.keep_going = [this] { return keep_going(); };
  hooks.make_source = [&](const TrainConfig& config) -> std::unique_ptr<RolloutSource> {
    goal.setAccepted();
    accepted = true;
    if (!goal.getGoal()->workers) {
      status = &own_status.emplace([](threelink_msgs::TrainingStatus&) {});
      return std::make_unique<LocalRollouts>(threads_);
    }
    auto learner = std::make_unique<Learner>(config, remote_, hooks.keep_going);
    status = &learner->status();
    return learner;
  };
  hooks.on_update = [&](const Trainer& trainer, const UpdateReport* report,
                        const Progress& progress) {
    status->on_update(trainer, report, progress);
    TrainFeedback feedback;
    feedback.status = status->status();
    goal.publishFeedback(feedback);
  };

  try {
    const RunOutcome outcome = run_training(settings_of(*goal.getGoal()), hooks);
    Result ended = result(Result::FINISHED, "");
    ended.policy = outcome.policy;
    ended.sha256 = outcome.sha256;
    if (outcome.finished) return [goal, ended]() mutable { goal.setSucceeded(ended); };
    const bool by_client = threelink_sim::running();
    ended.outcome = by_client ? Result::CANCELLED : Result::FAILED;
    ended.reason = fmt::format("{}; a checkpoint is in {}, and resume goes on from it",
                               by_client ? "cancelled" : "the server was ended",
                               excerpt(goal.getGoal()->out, 200));
    return [goal, ended, by_client]() mutable {
      if (by_client) {
        goal.setCanceled(ended, ended.reason);
      } else {
        goal.setAborted(ended, ended.reason);
      }
    };
  } catch (const RunFolderError& error) {
    return fail("out ", error);
  } catch (const std::exception& error) {
    return fail("", error);
  }
}

void TrainingServer::report(Diagnostics::Status& status) {
  threelink_sim::Lock lock(mutex_);
  status.summary(DiagnosticStatus::OK, goal_
                                           ? "training into " + excerpt(goal_->getGoal()->out, 200)
                                           : "waits for a goal");
}

}  // namespace threelink_agent
