#include "episode_server.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <threelink_msgs/LoadPolicy.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/node/call_service.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {

namespace topics = threelink_sim::topics;
using threelink_msgs::Episode;
using threelink_msgs::RunEpisodeGoal;

EpisodeServer::EpisodeServer(TaskPlayer& player, const TaskNodeConfig& config)
    : player_(player),
      config_(config),
      agents_policy_(config.assignment.policy.sha256),
      server_(ros::names::resolve(topics::kRunEpisode), false) {
  server_.start();
}

int EpisodeServer::run() {
  while (threelink_sim::running()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    if (server_.isNewGoalAvailable()) play(*server_.acceptNewGoal());
  }
  return threelink_sim::kSuccess;
}

void EpisodeServer::play(const RunEpisodeGoal& goal) {
  Result failed;
  failed.outcome = Result::ABORTED;
  try {
    const Assignment wanted = assignment(goal);
    load_policy(wanted.policy);
    const auto played =
        player_.play(wanted, [this](const Episode& episode) { return watch(episode); });
    if (!played) throw std::runtime_error("interrupted");
    const Result done = result(*played);
    if (done.outcome != Result::ABORTED) {
      server_.setSucceeded(done);
    } else if (server_.isPreemptRequested()) {
      server_.setPreempted(done, done.reason);
    } else {
      server_.setAborted(done, done.reason);
    }
  } catch (const std::exception& error) {
    log_.error(error.what());
    failed.reason = threelink_sim::excerpt(threelink_sim::text_for_peers(error), 1000);
    server_.setAborted(failed, failed.reason);
  }
}

Assignment EpisodeServer::assignment(const RunEpisodeGoal& goal) const {
  constexpr std::size_t kLongest = 1 << 16;  // [bytes]
  if (std::max({goal.task.size(), goal.parameters.size(), goal.policy.size()}) > kLongest)
    throw std::runtime_error(
        fmt::format("a text of the goal is longer than {} bytes, which is the most", kLongest));
  Assignment wanted = config_.assignment;
  wanted.seed = goal.seed;
  if (!goal.policy.empty()) {
    wanted.policy = PolicyInfo::of(goal.policy);
    config_.player.require_swimmer_of(wanted.policy);
  }
  threelink_sim::ParameterMap parameters =
      threelink_sim::parse_parameters("parameters", goal.parameters);
  assign_task(goal.task, parameters, config_.player.simulator.environment.dt, wanted);
  return wanted;
}

void EpisodeServer::load_policy(const PolicyInfo& policy) {
  if (policy.sha256 == agents_policy_) return;
  threelink_msgs::LoadPolicy load;
  load.request.file = policy.file;
  constexpr double kPatience = 30;  // [s]
  ros::ServiceClient client =
      ros::NodeHandle().serviceClient<threelink_msgs::LoadPolicy>(topics::kLoadPolicy);
  const auto called = threelink_sim::call_service(client, load, kPatience);
  if (called == threelink_sim::Called::kEnding) throw std::runtime_error("interrupted");
  if (called != threelink_sim::Called::kAnswered)
    throw std::runtime_error(fmt::format("policy {}: the agent's service {} does not answer",
                                         policy.file, ros::names::resolve(topics::kLoadPolicy)));
  agents_policy_ = load.response.sha256;
  if (!load.response.success) throw std::runtime_error(load.response.status);
}

std::string EpisodeServer::watch(const Episode& episode) {
  threelink_msgs::RunEpisodeFeedback feedback;
  feedback.episode = episode.episode;
  feedback.step = episode.step;
  feedback.distance = episode.distance;
  feedback.waypoint = episode.waypoint;
  server_.publishFeedback(feedback);
  return server_.isPreemptRequested() ? "cancelled" : "";
}

EpisodeServer::Result EpisodeServer::result(const PlayedEpisode& played) const {
  const Episode& episode = played.episode;
  Result result;
  result.outcome = episode.status;
  result.reason = episode.reason;
  result.episode = episode.episode;
  result.steps = episode.step;
  result.time = episode.time;
  result.distance = episode.distance;
  result.waypoint = episode.waypoint;
  result.energy = played.energy;
  result.mean_speed = episode.mean_speed;
  const double gamma = config_.player.simulator.environment.model.gamma;
  if (played.energy > 0)
    result.efficiency =
        gamma * episode.mean_speed * episode.mean_speed * episode.time / played.energy;
  if (played.recording) result.bag = played.recording->bag;
  return result;
}

}  // namespace threelink_tasks
