// pendulum: a target that swings to and fro above the start, as an example of a task of one's own.
#include <cmath>

#include <pluginlib/class_list_macros.hpp>
#include <threelink_tasks/basic_task.hpp>

class PendulumTask : public threelink_tasks::BasicTask {
 public:
  void configure(threelink_sim::ParameterMap& parameters,
                 const threelink_tasks::TaskContext& context) override {
    BasicTask::configure(parameters, context);
    amplitude_ = parameters.real("amplitude", {0, 10}, 0.5);  // [L], default 0.5
    period_ = parameters.real("period", {1, 1e6}, 500.0);     // [T0]
    configure_capture(parameters, true);                      // threshold; the target moves
  }

 private:
  bool advance(std::uint32_t step, const Eigen::Vector2d& centroid) override {
    const double phase = 2 * M_PI * step * context_.dt / period_;
    target_ = start_centroid() + Eigen::Vector2d(amplitude_ * std::sin(phase), 0.5);
    return capture_.captured(centroid, target_);
  }

  double amplitude_ = 0, period_ = 0;
};

PLUGINLIB_EXPORT_CLASS(PendulumTask, threelink_tasks::Task)
