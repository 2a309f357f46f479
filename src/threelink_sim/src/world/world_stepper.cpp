#include "threelink_sim/world/world_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace threelink_sim {
namespace {

// Rates at which a jammed swimmer is tried, as parts of the wanted ones.
constexpr double kParts[] = {0.5, 0.25, 0.125, 0};

AdvanceArgs part_of(AdvanceArgs args, std::size_t first, std::size_t count) {
  args.n = count;
  for (double** block :
       {&args.x, &args.y, &args.heading, &args.alpha, &args.rates, &args.displacement, &args.work})
    *block += first;
  return args;
}

HingeVector rates_of(const Batch& batch, std::size_t i) {
  HingeVector rates(batch.model().hinges());
  for (int j = 0; j < rates.size(); ++j) rates[j] = batch.rates(j)[i];
  return rates;
}

// Rates that would pass the joint limit within dt end exactly on it, as in the kernels.
void cut_at_limit(const AdvanceArgs& args, double dt) {
  const double limit = args.model.joint_limit;
  for (int j = 0; j < args.model.links - 1; ++j)
    for (std::size_t i = 0; i < args.n; ++i) {
      const double alpha = args.alpha[j * args.stride + i];
      double& rate = args.rates[j * args.stride + i];
      const double wanted = alpha + rate * dt;
      const double final_alpha = std::clamp(wanted, -limit, limit);
      if (final_alpha != wanted) rate = (final_alpha - alpha) / dt;
    }
}

}  // namespace

WorldStepper::WorldStepper(std::shared_ptr<const World> world, const Model& model,
                           std::size_t lanes, const Kernels& still_kernels,
                           const WorldKernels& kernels)
    : world_(std::move(world)),
      kernels_(&kernels),
      still_kernels_(&still_kernels),
      model_(model),
      contacts_(*world_, model),
      key_(lanes),
      steps_(lanes),
      time_(lanes),
      dissipation_(lanes),
      gap_(lanes),
      contact_(lanes),
      left_grid_(lanes),
      normals_(3 * lanes),
      drawn_(4 * lanes),
      counters_(2 * lanes),
      step_start_(lanes),
      substep_start_(lanes),
      kick_(lanes),
      wanted_(lanes),
      sum_(4 * lanes) {}

bool WorldStepper::within_grids(const SwimmerState& state, double t) const {
  if (!world_->has_grid()) return true;
  const LinkVector theta = link_angles(model_, state);
  Eigen::Vector2d joint = free_end(model_, state);
  for (int i = 0; i < model_.links; ++i) {
    if (!world_->within_grids(t, joint)) return false;
    double s, c;
    kernels().sincos(1, &theta[i], &s, &c);
    joint += model_.link_length() * Eigen::Vector2d(c, s);
  }
  return world_->within_grids(t, joint);
}

void WorldStepper::check_start(const SwimmerState& state, const EpisodeKey& key) {
  contacts_.check_free(state);
  if (!within_grids(state, key.time))
    throw std::invalid_argument(fmt::format(
        "the swimmer at ({:.4g}, {:.4g}) L, at {:.4g} T0, is not within the flow's grid",
        state.centroid.x(), state.centroid.y(), key.time));
}

void WorldStepper::begin(std::size_t i, const EpisodeKey& key, std::uint32_t step) {
  key_[i] = key;
  steps_[i] = step;
  dissipation_[i] = 0;
  contact_[i] = ContactRecord();
  left_grid_[i] = 0;
}

void WorldStepper::free_step(const AdvanceArgs& args, Lanes lanes) {
  const AdvanceArgs part = part_of(args, lanes.first, lanes.count);
  double* dissipation = dissipation_.data() + lanes.first;
  if (world_->has_flow()) {
    kernels_->drift(
        {part, &world_->flows(), world_->flow_sweeps(), time_.data() + lanes.first, dissipation});
  } else {
    still_kernels_->advance(part);
    std::copy_n(part.work, lanes.count, dissipation);
  }
}

void WorldStepper::draw_normals(Lanes lanes) {
  for (std::size_t i = lanes.first; i < lanes.first + lanes.count; ++i)
    for (std::uint32_t draw : {0, 1})
      counters_[2 * i + draw] = {draw, steps_[i], key_[i].episode,
                                 static_cast<std::uint32_t>(Stream::kThermal)};
  // One call for all lanes of a seed.
  for (std::size_t i = lanes.first; i < lanes.first + lanes.count;) {
    std::size_t end = i + 1;
    while (end < lanes.first + lanes.count && key_[end].seed == key_[i].seed) ++end;
    const std::uint32_t seed[] = {static_cast<std::uint32_t>(key_[i].seed),
                                  static_cast<std::uint32_t>(key_[i].seed >> 32)};
    still_kernels_->normals(2 * (end - i), seed, &counters_[2 * i].draw, &drawn_[4 * i]);
    i = end;
  }
  const std::size_t n = key_.size();
  for (std::size_t i = lanes.first; i < lanes.first + lanes.count; ++i)
    for (int k = 0; k < 3; ++k) normals_[k * n + i] = drawn_[4 * i + k];
}

void WorldStepper::shake(const AdvanceArgs& args, Lanes lanes, double dt) {
  if (world_->thermal_noise() == 0) return;
  draw_normals(lanes);
  const AdvanceArgs part = part_of(args, lanes.first, lanes.count);
  kernels_->shake({part.model, world_->thermal_noise(), dt, part.n, part.stride, part.alpha,
                   normals_.data() + lanes.first, part.x, part.y, part.heading, part.displacement});
}

void WorldStepper::touch(Batch& batch, std::size_t i, double h) {
  const SwimmerState free = batch.state(i);
  ContactStep step = contacts_.step(substep_start_[i], free, kick_[i], h);
  gap_[i] = step.gap;
  contact_[i] = step.record;
  if (step.record.contacts == 0) return;
  if (world_->has_flow()) {
    // What the hinges pay for being carried against the obstacles: delta . K_c z_drift.
    const FlowMotion drift = motion(free, HingeVector::Zero(model_.hinges()), time_[i] + h);
    const Eigen::Vector2d velocity = Eigen::Rotation2Dd(free.heading) * drift.body.velocity;
    const double power = step.record.force.dot(velocity) + step.record.torque * drift.body.spin;
    step.work += h * power;
    contact_[i].power += power;
  }
  const std::size_t n = key_.size();
  const Eigen::Vector2d moved = step.state.centroid - free.centroid;
  batch.set_pose(i, step.state.centroid, step.state.heading);
  sum_[i] += moved.x();
  sum_[n + i] += moved.y();
  sum_[2 * n + i] += step.work;
  sum_[3 * n + i] += step.dissipation;
}

void WorldStepper::advance_lanes(Batch& batch, Lanes lanes, double dt, int substeps) {
  const std::size_t n = key_.size(), end = lanes.first + lanes.count;
  const double h = dt / substeps;
  const AdvanceArgs args = batch.arguments(h, 1);
  if (substeps > 1) cut_at_limit(part_of(args, lanes.first, lanes.count), dt);
  for (int k = 0; k < 4; ++k)
    std::fill(&sum_[k * n + lanes.first], &sum_[k * n + lanes.first] + lanes.count, 0.0);
  for (int substep = 0; substep < substeps; ++substep) {
    for (std::size_t i = lanes.first; i < end; ++i) {
      substep_start_[i] = batch.state(i);
      time_[i] = time(i, dt) + substep * h;
    }
    free_step(args, lanes);
    for (std::size_t i = lanes.first; i < end; ++i)
      kick_[i] = -Eigen::Vector3d(args.x[i], args.y[i], args.heading[i]);
    if (substep == substeps - 1) shake(args, lanes, dt);
    for (std::size_t i = lanes.first; i < end; ++i) {
      kick_[i] += Eigen::Vector3d(args.x[i], args.y[i], args.heading[i]);
      sum_[i] += args.displacement[i];
      sum_[n + i] += args.displacement[n + i];
      sum_[2 * n + i] += args.work[i];
      sum_[3 * n + i] += dissipation_[i];
      touch(batch, i, h);
    }
  }
  for (std::size_t i = lanes.first; i < end; ++i) {
    args.displacement[i] = sum_[i];
    args.displacement[n + i] = sum_[n + i];
    args.work[i] = sum_[2 * n + i];
    dissipation_[i] = sum_[3 * n + i];
  }
}

void WorldStepper::free_jammed_lane(Batch& batch, std::size_t i, double dt, int substeps) {
  const double deepest = -0.25 * world_->link_radius();
  for (const double part : kParts) {
    if (gap_[i] >= deepest) return;
    batch.set_state(i, step_start_[i]);
    for (int j = 0; j < model_.hinges(); ++j) batch.rates(j)[i] = part * wanted_[i][j];
    advance_lanes(batch, {i, 1}, dt, substeps);
  }
}

void WorldStepper::advance(Batch& batch, double dt, int substeps) {
  const std::size_t n = key_.size();
  if (world_->obstacles().empty()) {
    for (std::size_t i = 0; i < n; ++i) time_[i] = time(i, dt);
    const AdvanceArgs args = batch.arguments(dt, substeps);
    free_step(args, {0, n});
    shake(args, {0, n}, dt);
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      step_start_[i] = batch.state(i);
      wanted_[i] = rates_of(batch, i);
    }
    advance_lanes(batch, {0, n}, dt, substeps);
    for (std::size_t i = 0; i < n; ++i) free_jammed_lane(batch, i, dt, substeps);
  }
  for (std::size_t i = 0; i < n; ++i) {
    ++steps_[i];
    if (world_->has_grid() && !left_grid_[i])
      left_grid_[i] = !within_grids(batch.state(i), time(i, dt));
  }
}

WorldStepper::FlowMotion WorldStepper::motion(const SwimmerState& state, const HingeVector& rates,
                                              double t) const {
  FlowMotion motion;
  FlowMotionArgs args;
  args.shape.model = kernel_model(model_);
  args.shape.n = args.shape.stride = 1;
  args.shape.alpha = state.alpha.data();
  args.shape.rates = rates.data();
  args.shape.velocity = motion.body.velocity.data();
  args.shape.spin = &motion.body.spin;
  args.shape.power = &motion.body.power;
  args.flows = &world_->flows();
  args.time = &t;
  args.x = &state.centroid.x();
  args.y = &state.centroid.y();
  args.heading = &state.heading;
  args.dissipation = &motion.dissipation;
  kernels_->motion(args);
  return motion;
}

double WorldStepper::power(const Batch& batch, std::size_t i, double dt) const {
  const SwimmerState state = batch.state(i);
  const HingeVector rates = rates_of(batch, i);
  const double free = world_->has_flow() ? motion(state, rates, time(i, dt)).body.power
                                         : body_motion(model_, state.alpha, rates).power;
  return free + contact_[i].power;
}

}  // namespace threelink_sim
