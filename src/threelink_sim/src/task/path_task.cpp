// path: a target that moves along a curve at a steady speed v_ratio v_m.
//
// Every curve is a chain of straight pieces, and the target is at arc length k v_T dt of it in
// state k: on a closed curve it goes round and round, on an open one it stops at the end.
//   circle        c + R (cos t, sin t), t = 0 .. 2 pi        (1000 pieces: within 5e-6 R of it)
//   figure_eight  c + R (sin t, sin t cos t), t = 0 .. 2 pi  (likewise)
//   points        those given
#include <algorithm>
#include <cmath>

#include "builtin_tasks.hpp"
#include "threelink_sim/task/basic_task.hpp"
#include "threelink_sim/task/point_file.hpp"

namespace threelink_sim {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr int kPieces = 1000;

Points circle(const Eigen::Vector2d& centre, double radius) {
  Points points;
  for (int i = 0; i < kPieces; ++i)
    points.push_back(centre + radius * unit_vector(i * 2 * kPi / kPieces));
  return points;
}

Points figure_eight(const Eigen::Vector2d& centre, double radius) {
  Points points = circle({0, 0}, 1);
  for (Eigen::Vector2d& p : points) p = centre + radius * Eigen::Vector2d(p.y(), p.y() * p.x());
  return points;
}

// Vertices, and the arc length at each.
class Chain {
 public:
  Chain() = default;
  Chain(const Points& points, bool closed) : points_(points), closed_(closed) {
    if (closed) points_.push_back(points_.front());
    lengths_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i)
      lengths_.push_back(lengths_.back() + (points_[i] - points_[i - 1]).norm());
  }

  double length() const { return lengths_.back(); }

  Eigen::Vector2d at(double s) const {
    s = closed_ ? std::fmod(s, length()) : std::min(s, length());
    const auto end = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
    const std::size_t i = end - lengths_.begin();
    const double piece = lengths_[i] - lengths_[i - 1];
    const double along = piece > 0 ? (s - lengths_[i - 1]) / piece : 1;
    return points_[i - 1] + along * (points_[i] - points_[i - 1]);
  }

 private:
  Points points_;
  bool closed_ = false;
  std::vector<double> lengths_;
};

class PathTask : public BasicTask {
 public:
  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    step_length_ = parameters.real("v_ratio", {0, 100}, 0.5) * context.v_m * context.dt;
    chain_ = read_chain(parameters);
    ends_at_capture_ = parameters.flag("ends_at_capture", true);
    configure_capture(parameters, step_length_ > 0);
  }

 private:
  static Chain read_chain(ParameterMap& parameters) {
    if (parameters.has("points")) {
      const Points points = parameters.points("points", kPosition, read_point_file);
      Chain chain(points.empty() ? Points(1) : points, parameters.flag("closed", false));
      if (points.size() < 2 || !(chain.length() > 0))
        parameters.refuse("points", "must hold two different ones at least");
      return chain;
    }
    const std::string curve =
        parameters.choice("curve", {"circle", "figure_eight"}, std::string("circle"));
    const double radius = parameters.real("radius", {1e-3, 1e5}, 0.5);
    const Eigen::Vector2d centre = read_point(parameters, "center", {1.5, 1.0});
    return {curve == "circle" ? circle(centre, radius) : figure_eight(centre, radius), true};
  }

  bool advance(std::uint32_t step, const Eigen::Vector2d& centroid) override {
    target_ = chain_.at(step * step_length_);
    return capture_.captured(centroid, target_) && ends_at_capture_;
  }

  Chain chain_;
  double step_length_ = 0;  // [L]
  bool ends_at_capture_ = true;
};

}  // namespace

std::unique_ptr<Task> make_path() { return std::make_unique<PathTask>(); }

}  // namespace threelink_sim
