#include "threelink_sim/batch.hpp"

namespace threelink_sim {

Batch::Batch(const Model& model, std::size_t n, const Kernels& kernels)
    : model_(model),
      kernels_(&kernels),
      n_(n),
      x_(n),
      y_(n),
      heading_(n),
      alpha_(n * model.hinges()),
      rates_(n * model.hinges()),
      displacement_(2 * n),
      work_(n) {
  model.validate();
}

void Batch::set_state(std::size_t i, const SwimmerState& state) {
  validate(model_, state);
  x_[i] = state.centroid.x();
  y_[i] = state.centroid.y();
  heading_[i] = state.heading;
  for (int j = 0; j < model_.hinges(); ++j) alpha_[j * n_ + i] = state.alpha[j];
  work_[i] = 0;
}

SwimmerState Batch::state(std::size_t i) const {
  SwimmerState state;
  state.centroid = {x_[i], y_[i]};
  state.heading = heading_[i];
  state.alpha.resize(model_.hinges());
  for (int j = 0; j < model_.hinges(); ++j) state.alpha[j] = alpha_[j * n_ + i];
  return state;
}

AdvanceArgs Batch::arguments(double dt, int substeps) {
  AdvanceArgs args;
  args.model = kernel_model(model_);
  args.dt = dt;
  args.substeps = substeps;
  args.n = args.stride = n_;
  args.x = x_.data();
  args.y = y_.data();
  args.heading = heading_.data();
  args.alpha = alpha_.data();
  args.rates = rates_.data();
  args.displacement = displacement_.data();
  args.work = work_.data();
  return args;
}

void Batch::advance(double dt, int substeps) { kernels_->advance(arguments(dt, substeps)); }

void Batch::set_pose(std::size_t i, const Eigen::Vector2d& centroid, double heading) {
  x_[i] = centroid.x();
  y_[i] = centroid.y();
  heading_[i] = heading;
}

void Batch::axis_sincos(double* sine, double* cosine) const {
  if (model_.has_middle_link()) {
    kernels_->sincos(n_, heading_.data(), sine, cosine);
    return;
  }
  const double* between = alpha(model_.heading_link() - 1);  // of the two middle links
  for (std::size_t i = 0; i < n_; ++i) cosine[i] = heading_[i] - 0.5 * between[i];
  kernels_->sincos(n_, cosine, sine, cosine);
}

void Batch::look_at_distance(const double* r, double* weight, double* log) const {
  kernels_->distance(n_, r, weight, log);
}

}  // namespace threelink_sim
