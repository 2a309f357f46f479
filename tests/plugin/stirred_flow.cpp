// stirred: rigid rotation about the origin that a stirrer drives to and fro, as an example of a
// flow of one's own.
#include <cmath>

#include <pluginlib/class_list_macros.hpp>
#include <threelink_sim/world/flow.hpp>

class StirredFlow : public threelink_sim::Flow {
 public:
  void configure(threelink_sim::ParameterMap& parameters) override {
    rate_ = parameters.real("rate", {0, 1}, 0.01);        // [1/T0], default 0.01
    period_ = parameters.real("period", {1, 1e6}, 200.);  // [T0]
  }

  Eigen::Vector2d velocity(double t, const Eigen::Vector2d& x) const override {
    const double omega = rate_ * std::cos(2 * M_PI * t / period_);
    return {-omega * x.y(), omega * x.x()};
  }

  double steepest() const override { return rate_; }

 private:
  double rate_ = 0, period_ = 0;
};

PLUGINLIB_EXPORT_CLASS(StirredFlow, threelink_sim::Flow)
