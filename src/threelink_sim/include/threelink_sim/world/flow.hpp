// The base of ambient flows that are code of the user's: plug-ins of pluginlib.
//
//   class Stirred : public threelink_sim::Flow {
//     void configure(ParameterMap& parameters) override { .. }
//     Eigen::Vector2d velocity(double t, const Eigen::Vector2d& x) const override { .. }
//     double steepest() const override { .. }
//   };
//   PLUGINLIB_EXPORT_CLASS(Stirred, threelink_sim::Flow)
//
// docs/world.md shows the whole of one.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <Eigen/Core>

#include "threelink_sim/parameter_map.hpp"

namespace threelink_sim {

class Flow {
 public:
  virtual ~Flow() = default;

  // Takes the keys that stand beside `kind` in the world file; the caller refuses all others.
  virtual void configure(ParameterMap& parameters) = 0;

  // [L/T0] at the time t [T0] and the place x [L]. The same arguments must always give the same
  // bits, in any thread: episodes are proven by replaying them.
  virtual Eigen::Vector2d velocity(double t, const Eigen::Vector2d& x) const = 0;

  // [1/T0] a bound of |grad u|, by which the number of sweeps of a step is judged.
  virtual double steepest() const = 0;
};

// Adds a kind of flow to those of this package, whose names stay theirs.
using FlowMaker = std::function<std::unique_ptr<Flow>()>;
void register_flow(const std::string& kind, const FlowMaker& make);
// Whether a kind is of this package or registered; what a source has is not asked for.
bool has_flow(const std::string& kind);

// Where other flows come from: `find` is called once, as soon as a kind is asked for that is not
// there, and registers what it finds.
void register_flow_source(const std::function<void()>& find);

}  // namespace threelink_sim
