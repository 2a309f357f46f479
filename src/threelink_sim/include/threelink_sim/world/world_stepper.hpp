// Steps a batch of swimmers in a world.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "threelink_sim/batch.hpp"
#include "threelink_sim/kernel/world.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/world/contact.hpp"
#include "threelink_sim/world/world.hpp"

namespace threelink_sim {

// By what all that is random in an episode is keyed, and when it begins.
struct EpisodeKey {
  std::uint64_t seed = 0;
  std::uint32_t episode = 0;
  double time = 0;  // [T0] of the flow at step 0
};

class WorldStepper {
 public:
  WorldStepper(std::shared_ptr<const World> world, const Model& model, std::size_t lanes,
               const Kernels& still_kernels = threelink_sim::kernels(),
               const WorldKernels& kernels = world_kernels());

  // Throws std::invalid_argument if a link of that state touches an obstacle, or is not within a
  // grid of the flow.
  void check_start(const SwimmerState& state, const EpisodeKey& key);
  // Begins an episode in lane i, or goes on with it from that step.
  void begin(std::size_t i, const EpisodeKey& key, std::uint32_t step = 0);

  // One action step of all lanes of the batch, as Batch::advance(). Where rates would jam a link
  // between obstacles, all rates of that lane are cut by the same factor.
  void advance(Batch& batch, double dt, int substeps);

  // What the last advance() did, besides what the batch knows.
  const double* dissipation() const { return dissipation_.data(); }  // [C_perp L^3/T0]
  const ContactRecord& contact(std::size_t i) const { return contact_[i]; }
  // Whether lane i has left the grids of the flow, which know nothing of where it is.
  bool left_grid(std::size_t i) const { return left_grid_[i] != 0; }

  double time(std::size_t i, double dt) const { return key_[i].time + steps_[i] * dt; }  // [T0]

  // [C_perp L^3/T0^2] power of the hinges in the state of lane i, for the rates of the last step.
  double power(const Batch& batch, std::size_t i, double dt) const;

  // Of a swimmer in the flow, which there must be.
  struct FlowMotion {
    BodyMotion body;     // its power is that of the hinges
    double dissipation;  // [C_perp L^3/T0^2]
  };
  FlowMotion motion(const SwimmerState& state, const HingeVector& rates, double t) const;

 private:
  // Lanes first .. first + count - 1.
  struct Lanes {
    std::size_t first, count;
  };
  void advance_lanes(Batch& batch, Lanes lanes, double dt, int substeps);
  void free_step(const AdvanceArgs& args, Lanes lanes);
  void shake(const AdvanceArgs& args, Lanes lanes, double dt);
  void touch(Batch& batch, std::size_t i, double h);
  void free_jammed_lane(Batch& batch, std::size_t i, double dt, int substeps);
  void draw_normals(Lanes lanes);
  bool within_grids(const SwimmerState& state, double t) const;

  std::shared_ptr<const World> world_;
  const WorldKernels* kernels_;
  const Kernels* still_kernels_;
  Model model_;
  ContactSolver contacts_;
  std::vector<EpisodeKey> key_;
  std::vector<std::uint32_t> steps_;    // since the episode began
  std::vector<double> time_;            // [T0] of this substep
  std::vector<double> dissipation_;     // of the step
  std::vector<double> gap_;             // [L] the smallest one at its end
  std::vector<ContactRecord> contact_;  // at its end
  std::vector<char> left_grid_;
  std::vector<double> normals_;          // (3, lanes)
  std::vector<double> drawn_;            // (lanes, 4), as they come
  std::vector<RandomCounter> counters_;  // (lanes, 2)
  std::vector<SwimmerState> step_start_, substep_start_;
  std::vector<Eigen::Vector3d> kick_;  // (x, y, turn) of thermal motion in the substep
  std::vector<HingeVector> wanted_;    // [1/T0] rates of the step
  std::vector<double> sum_;            // (4, lanes) displacement x and y, work, dissipation
};

}  // namespace threelink_sim
