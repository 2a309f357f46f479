#include "status_publisher.hpp"

#include <limits>
#include <utility>

#include "threelink_sim/node/topics.hpp"
#include "training_messages.hpp"

namespace threelink_agent {

StatusPublisher::StatusPublisher(std::function<void(threelink_msgs::TrainingStatus&)> add_workers)
    : add_workers_(std::move(add_workers)) {
  constexpr bool kLatch = true;
  status_.speed = status_.success_rate = std::numeric_limits<double>::quiet_NaN();
  publisher_ = node_.advertise<threelink_msgs::TrainingStatus>(
      threelink_sim::topics::kTrainingStatus, 10, kLatch);
  timer_ = node_.createSteadyTimer(ros::WallDuration(1.0),
                                   [this](const ros::SteadyTimerEvent&) { publish(); });
}

void StatusPublisher::on_update(const Trainer& trainer, const UpdateReport* report,
                                const Progress& progress) {
  {
    const TrainConfig& config = trainer.config();
    threelink_sim::Lock lock(mutex_);
    status_.updates = config.updates();
    status_.update = trainer.state().update;
    status_.episodes = std::uint64_t{config.update.episodes} * trainer.state().update;
    status_.steps = status_.episodes * config.environment.steps;
    status_.time_left = progress.seconds_left();
    if (report) {
      status_.steps_per_s = progress.steps_per_s();
      status_.mean_return = report->mean_return;
      status_.policy_loss = report->statistics.policy_loss;
      status_.value_loss = report->statistics.value_loss;
      status_.kl = report->statistics.kl;
      status_.entropy = report->entropy;
      if (report->evaluation) {
        status_.speed = report->evaluation->speed;
        if (report->evaluation->trials > 0) status_.success_rate = report->evaluation->success_rate;
      }
    }
  }
  publish();
}

threelink_msgs::TrainingStatus StatusPublisher::status() const {
  threelink_msgs::TrainingStatus status;
  {
    threelink_sim::Lock lock(mutex_);
    status = status_;
  }
  status.header.stamp = wall_time();
  add_workers_(status);
  return status;
}

void StatusPublisher::publish() {
  const threelink_msgs::TrainingStatus now = status();
  if (now.updates > 0) publisher_.publish(now);
}

}  // namespace threelink_agent
