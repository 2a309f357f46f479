/// @file
/// The reinforcement-learning problem on top of the swimmer: observation, reward, start, time
/// limit.
///
/// A vector of environments in lock-step: lane i is one episode. The simulator node runs it with
/// one lane; a single episode and many have one implementation and agree to the bit.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "threelink_sim/batch.hpp"
#include "threelink_sim/observation.hpp"
#include "threelink_sim/world/world_stepper.hpp"

namespace threelink_sim {

/// The swimmer, its reward and its world.
struct EnvironmentConfig {
  Model model;
  double dt = 0.1;
  double b = 6.0;
  double c = 0.0;
  std::uint32_t steps = 200;
  ObservationKind observation = ObservationKind::kDirection;
  std::shared_ptr<const World> world;  ///< null: still water, as an empty world

  /// Fields of the swimmer and its action step.
  template <class Self, class Visit>
  static void swimmer_fields(Self& self, Visit&& visit) {
    Model::fields(self.model, visit);
    visit("dt", self.dt, Range<double>{1e-3, 1}, "[T0] for which an action is held");
  }
  /// The reward of a step, b dx.p - c W; `b` and `c` are the names of its weights.
  template <class Self, class Visit>
  static void reward_fields(Self& self, Visit&& visit, const char* b = "b", const char* c = "c") {
    visit(b, self.b, Range<double>{1e-6, 1e6}, "weight of the progress");
    visit(c, self.c, Range<double>{0, 1e6}, "weight of the work; 0: only speed counts");
  }
  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    swimmer_fields(self, visit);
    reward_fields(self, visit);
    visit("steps", self.steps, Range<std::uint32_t>{1, 1'000'000},
          "N_s, actions in an episode: the time limit");
  }

  /// Throws std::invalid_argument that names field, value and bound.
  void validate() const;
};

/// The difference between two swimmers or their action steps: "gamma = 0.5 instead of 0.9, dt = 0.1
/// instead of 0.2"; empty if they are equal. A policy that was trained for one may fail with the
/// other.
std::string swimmer_difference(const EnvironmentConfig& found, const EnvironmentConfig& wanted);

/// A state and the results of the step that led to it.
struct StepRecord {
  SwimmerState state;
  HingeVector hinge_rates;  ///< [1/T0] (N-1) applied in that step, after the joint limit
  double power = 0;   ///< [C_perp L^3/T0^2] rate of the hinges' work for these rates in this state
  double work = 0;    ///< [C_perp L^3/T0] of the hinges in that step; a flow may do some of it
  double reward = 0;  ///< [1] b dx.p - c max(W, 0) of that step
  double dissipation = 0;  ///< [C_perp L^3/T0] of that step; the work, in still water
  ContactRecord contact;   ///< with obstacles
};

/// One episode in each lane.
class Environment {
 public:
  Environment(const EnvironmentConfig& config, std::size_t lanes,
              const Kernels& kernels = threelink_sim::kernels());

  const EnvironmentConfig& config() const { return config_; }
  std::size_t lanes() const { return batch_.size(); }
  int observation_size() const {
    return threelink_sim::observation_size(config_.observation, config_.model);
  }
  const Batch& batch() const { return batch_; }

  /// Starts an episode in lane i, with a target at infinity in the direction p = (1, 0) until
  /// another is set. The key is of the world's noise and time. Throws std::invalid_argument if the
  /// state overlaps an obstacle of the world.
  void reset(std::size_t i, const SwimmerState& state, const EpisodeKey& key = {});

  /// Continues an episode in lane i from the state of that step. Throws std::invalid_argument for
  /// an invalid state.
  void resume(std::size_t i, const SwimmerState& state, const EpisodeKey& key, std::uint32_t step);

  /// Sets the target of lane i, relative to its current position, for the observation and the next
  /// step's reward: a point [L], fixed frame.
  void aim(std::size_t i, const Eigen::Vector2d& target);
  /// Sets a target at infinity in the direction of the unit vector p [1].
  void set_direction(std::size_t i, const Eigen::Vector2d& p);
  Eigen::Vector2d direction(std::size_t i) const { return {px_[i], py_[i]}; }               ///< p
  Eigen::Vector2d centroid(std::size_t i) const { return {batch_.x()[i], batch_.y()[i]}; }  ///< [L]
  double distance(std::size_t i) const { return distance_[i]; }  ///< [L] when it was set

  /// The observation of every lane, component k of lane i at out[k * lanes() + i], with
  ///   cos theta_d = c p_x + s p_y,  sin theta_d = s p_x - c p_y,  (c, s) of the axis.
  void observe(double* out) const;

  /// Takes one action step. rates [1/T0], hinge j of lane i at [j * lanes() + i], must be finite;
  /// they are clipped to [-1, 1] and at the joint limit. rewards()[i] is then b dx.p - c max(W, 0)
  /// of the step: work that the flow does on the hinges is not rewarded.
  void step(const double* rates);
  const double* rewards() const { return reward_.data(); }
  double effort(std::size_t i) const;  ///< [C_perp L^3/T0] max(W, 0) of lane i

  /// Whether lane i has left the grid of the world's flow, which ends its episode.
  bool left_grid(std::size_t i) const { return world_ && world_->left_grid(i); }

  /// [L/T0] of the world's flow at the centroid of lane i.
  Eigen::Vector2d flow(std::size_t i) const;
  double time(std::size_t i) const { return world_ ? world_->time(i, config_.dt) : 0; }  ///< [T0]
  /// Whether there is anything around the swimmer but still water.
  bool has_world() const { return world_.has_value(); }

  /// The record of lane i. After reset() no step has led to its state; rates, power, work and
  /// reward are 0.
  StepRecord record(std::size_t i) const;

 private:
  EnvironmentConfig config_;
  int substeps_;
  Batch batch_;
  std::optional<WorldStepper> world_;  ///< none for still water
  std::vector<double> px_, py_, distance_, reward_;
  mutable std::vector<double> sine_, cosine_, clipped_;
};

/// A random start: centroid at the origin, heading uniform in (-pi, pi), hinge
/// angles uniform within the joint limit; keyed by (seed, episode).
SwimmerState random_start(const Model& model, std::uint64_t seed, std::uint32_t episode);
/// The same among obstacles: drawn again, up to a thousand times, while it touches one. Throws
/// std::invalid_argument if none of them is free.
SwimmerState random_start(const EnvironmentConfig& config, std::uint64_t seed,
                          std::uint32_t episode);

}  // namespace threelink_sim
