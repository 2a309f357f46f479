// waypoints: fixed points, one after the other; the next one once the centroid is within the
// threshold of the present one. Captured means all of them.
//
// Without a list of points they are the paper's star: j = 1 .. 10 around its centre c,
//   x_j = c + R_j (cos(phi + j pi / 5), sin(phi + j pi / 5)),
// with R_j = R at its five tips (j even) and inner_ratio R between them (j odd). The swimmer's
// centroid starts on the last tip, c = x_c(0) - R (cos phi, sin phi), so that its way is the whole
// outline. With random_star each episode has its own R in [0.7, 1.3] and phi, keyed by (seed,
// episode).
#include <algorithm>

#include "builtin_tasks.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/task/basic_task.hpp"
#include "threelink_sim/task/point_file.hpp"

namespace threelink_sim {
namespace {

class WaypointsTask : public BasicTask {
 public:
  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    constexpr bool kTargetMoves = false;
    configure_capture(parameters, kTargetMoves);
    if (parameters.has("points")) {
      points_ = parameters.points("points", kPosition, read_point_file);
      if (points_.empty()) parameters.refuse("points", "must hold at least one");
      return;
    }
    inner_ratio_ = parameters.real("inner_ratio", {0.01, 100}, 0.382);
    random_star_ = parameters.flag("random_star", false);
    if (random_star_) return;
    const double radius = parameters.real("radius", {1e-3, 1e5}, 1.0);
    points_ = star(radius, parameters.real("rotation", {-10, 10}, 0.0));
  }

  std::vector<Eigen::Vector2d> waypoints() const override { return points_; }
  std::uint32_t waypoint() const override { return reached_; }

 private:
  std::vector<Eigen::Vector2d> star(double radius, double rotation) const {
    const Eigen::Vector2d centre = start_centroid() - radius * unit_vector(rotation);
    std::vector<Eigen::Vector2d> points;
    for (int j = 1; j <= 10; ++j)
      points.push_back(centre + (j % 2 == 0 ? radius : inner_ratio_ * radius) *
                                    unit_vector(rotation + j * kPi / 5));
    return points;
  }

  void begin() override {
    if (random_star_) {
      Random random(seed(), Stream::kTarget, episode());
      const double radius = random.uniform(0.7, 1.3);
      points_ = star(radius, random.uniform(-kPi, kPi));
    }
    reached_ = 0;
  }

  bool advance(std::uint32_t /*step*/, const Eigen::Vector2d& centroid) override {
    while (reached_ < points_.size() && capture_.captured(centroid, points_[reached_])) ++reached_;
    target_ = points_[std::min<std::size_t>(reached_, points_.size() - 1)];
    return reached_ == points_.size();
  }

  double inner_ratio_ = 0;
  bool random_star_ = false;
  std::vector<Eigen::Vector2d> points_;  // [L]
  std::uint32_t reached_ = 0;
};

}  // namespace

std::unique_ptr<Task> make_waypoints() { return std::make_unique<WaypointsTask>(); }

}  // namespace threelink_sim
