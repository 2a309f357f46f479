#include "threelink_sim/model.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "threelink_sim/fields.hpp"

namespace threelink_sim {

void Model::validate() const { check_fields(*this); }

int substeps(const Model& model, double dt, double max_rate) {
  // The slack keeps 0.1 * 1 at one substep in spite of rounding.
  constexpr double kSlack = 1e-9;
  constexpr double kAngle = 0.1;      // [rad] hinge angle a substep
  constexpr double kLinkAngle = 0.6;  // [rad] bound on links * hinge angle a substep
  const double angle = dt * max_rate;
  const double wanted = std::max(angle / kAngle, angle * model.links / kLinkAngle);
  if (!(wanted < 1e6))
    throw std::invalid_argument(
        fmt::format("dt * rate = {} rad: too far for one action step", angle));
  return std::max(1, static_cast<int>(std::ceil(wanted - kSlack)));
}

KernelModel kernel_model(const Model& model) {
  return {model.links, model.gamma, model.joint_limit};
}

}  // namespace threelink_sim
