// direction: straight on, towards a target so far away that its direction never changes.
//   x_T(k) = x_c(k) + 1000 (cos phi, sin phi)
// Nothing is captured; the episode ends after max_steps.
#include "builtin_tasks.hpp"
#include "threelink_sim/task/basic_task.hpp"

namespace threelink_sim {
namespace {

constexpr double kFarAway = 1000;  // [L]

class DirectionTask : public BasicTask {
 public:
  DirectionTask() : BasicTask(1500) {}

  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    far_away_ = kFarAway * unit_vector(parameters.real("direction", {-10, 10}, 0.0));
  }

 private:
  bool advance(std::uint32_t /*step*/, const Eigen::Vector2d& centroid) override {
    target_ = centroid + far_away_;
    return false;
  }

  Eigen::Vector2d far_away_;  // [L]
};

}  // namespace

std::unique_ptr<Task> make_direction() { return std::make_unique<DirectionTask>(); }

}  // namespace threelink_sim
