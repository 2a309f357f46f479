// The action run_episode: episodes that clients ask for, one at a time.
#pragma once

#include <actionlib/server/simple_action_server.h>
#include <threelink_msgs/RunEpisodeAction.h>

#include "task_player.hpp"
#include "threelink_sim/node/quiet_log.hpp"

namespace threelink_tasks {

class EpisodeServer {
 public:
  // The policy of `assignment` is the one that the agent has, and that goals without one get.
  EpisodeServer(TaskPlayer& player, const TaskNodeConfig& config);

  // Plays what is asked for until the node has to end; returns the exit status.
  int run();

 private:
  using Result = threelink_msgs::RunEpisodeResult;

  void play(const threelink_msgs::RunEpisodeGoal& goal);
  // Throws std::runtime_error that says what is wrong with the goal.
  Assignment assignment(const threelink_msgs::RunEpisodeGoal& goal) const;
  void load_policy(const PolicyInfo& policy);
  std::string watch(const threelink_msgs::Episode& episode);
  Result result(const PlayedEpisode& played) const;

  TaskPlayer& player_;
  TaskNodeConfig config_;
  std::string agents_policy_;  // sha256 of what the agent has
  threelink_sim::QuietLog log_;
  actionlib::SimpleActionServer<threelink_msgs::RunEpisodeAction> server_;
};

}  // namespace threelink_tasks
