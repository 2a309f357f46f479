// One swimmer in a world that a test writes down.
#pragma once

#include <memory>
#include <string>

#include "threelink_sim/world/world_stepper.hpp"

namespace threelink_tests {

inline std::shared_ptr<const threelink_sim::World> world_of(const std::string& yaml) {
  return threelink_sim::World::parse(yaml, "world.yaml", ".");
}

// Steps it, and adds up what it does.
class WorldSwimmer {
 public:
  WorldSwimmer(const std::string& yaml, const threelink_sim::Model& model,
               const threelink_sim::SwimmerState& start, threelink_sim::EpisodeKey key = {})
      : batch_(model, 1), stepper_(world_of(yaml), model, 1) {
    stepper_.check_start(start, key);
    stepper_.begin(0, key);
    batch_.set_state(0, start);
  }

  void step(const threelink_sim::HingeVector& rates, double dt = 0.1) {
    for (int j = 0; j < rates.size(); ++j) batch_.rates(j)[0] = rates[j];
    const double fastest = rates.size() > 0 ? rates.cwiseAbs().maxCoeff() : 0;
    stepper_.advance(batch_, dt, threelink_sim::substeps(batch_.model(), dt, fastest));
    work_ += batch_.work()[0];
    dissipation_ += stepper_.dissipation()[0];
  }

  threelink_sim::SwimmerState state() const { return batch_.state(0); }
  double work() const { return work_; }                // [C_perp L^3/T0]
  double dissipation() const { return dissipation_; }  // [C_perp L^3/T0]
  double applied_rate(int hinge) const { return batch_.rates(hinge)[0]; }
  const threelink_sim::WorldStepper& stepper() const { return stepper_; }

 private:
  threelink_sim::Batch batch_;
  threelink_sim::WorldStepper stepper_;
  double work_ = 0, dissipation_ = 0;
};

}  // namespace threelink_tests
