// point: one fixed target at a random place, from a random start.
//
// The swimmer starts with its centroid at the origin, in any heading and shape; the target lies at
// a log-uniform distance in [min_distance, max_distance] and any bearing. All of it is keyed by
// (seed, episode).
#include <cmath>

#include "builtin_tasks.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/task/basic_task.hpp"

namespace threelink_sim {
namespace {

class PointTask : public BasicTask {
 public:
  PointTask() { start_.random = true; }

  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    min_distance_ = parameters.real("min_distance", {1e-9, 1e6}, 0.001);
    max_distance_ = parameters.real("max_distance", {1e-9, 1e6}, 0.5);
    if (max_distance_ < min_distance_)
      parameters.refuse("max_distance", "must not be less than min_distance");
    constexpr bool kTargetMoves = false;
    configure_capture(parameters, kTargetMoves);
  }

  std::vector<Eigen::Vector2d> waypoints() const override { return {target_}; }
  std::uint32_t waypoint() const override { return reached_; }

 private:
  void begin() override {
    Random random(seed(), Stream::kTarget, episode());
    const double distance =
        std::exp(random.uniform(std::log(min_distance_), std::log(max_distance_)));
    target_ = distance * unit_vector(random.uniform(-kPi, kPi));
    reached_ = 0;
  }

  bool advance(std::uint32_t /*step*/, const Eigen::Vector2d& centroid) override {
    reached_ = capture_.captured(centroid, target_) ? 1 : 0;
    return reached_ > 0;
  }

  double min_distance_ = 0, max_distance_ = 0;  // [L]
  std::uint32_t reached_ = 0;
};

}  // namespace

std::unique_ptr<Task> make_point() { return std::make_unique<PointTask>(); }

}  // namespace threelink_sim
