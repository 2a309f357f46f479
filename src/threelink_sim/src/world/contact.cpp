#include "threelink_sim/world/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace threelink_sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// No point of the swimmer is farther from the centroid: the mean distance along the chain from an
// end is 1/2.
constexpr double kReach = 0.5;  // [L]
constexpr int kNewtonSteps = 4, kSweeps = 8;

Vector2d quarter_turn(const Vector2d& v) { return {-v.y(), v.x()}; }
double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Places s, t in [0, 1] on the segments p + s d and q + t e that are nearest to each other
// (Ericson, "Real-time collision detection", section 5.1.9). A segment may be a point.
std::pair<double, double> nearest_places(const Vector2d& p, const Vector2d& d, const Vector2d& q,
                                         const Vector2d& e) {
  const auto clamp = [](double place) { return std::clamp(place, 0.0, 1.0); };
  const Vector2d r = p - q;
  const double a = d.squaredNorm(), c = d.dot(r), f = e.dot(r), g = e.squaredNorm();
  if (g == 0) return {clamp(-c / a), 0};
  const double b = d.dot(e), denominator = a * g - b * b;
  double s = denominator > 1e-14 * a * g ? clamp((b * f - c * g) / denominator) : 0;
  double t = (b * s + f) / g;
  if (t < 0) {
    t = 0;
    s = clamp(-c / a);
  } else if (t > 1) {
    t = 1;
    s = clamp((b - c) / a);
  }
  // Segments that cross have the distance 0 there, which the ends alone may miss.
  return {s, t};
}

}  // namespace

ContactSolver::ContactSolver(const World& world, const Model& model)
    : world_(&world), model_(model) {}

ContactSolver::Links ContactSolver::links_of(const SwimmerState& state) const {
  const int n = model_.links;
  LinkVector sine(n), cosine(n);
  const LinkVector theta = link_angles(model_, state);
  kernels().sincos(n, theta.data(), sine.data(), cosine.data());
  Links links;
  links.joint[0].setZero();
  Vector2d centroid = Vector2d::Zero();
  for (int i = 0; i < n; ++i) {
    links.tangent[i] = {cosine[i], sine[i]};
    links.joint[i + 1] = links.joint[i] + model_.link_length() * links.tangent[i];
    centroid += (links.joint[i] + links.joint[i + 1]) * (0.5 / n);
  }
  for (int i = 0; i <= n; ++i) links.joint[i] += state.centroid - centroid;
  return links;
}

ContactSolver::Nearest ContactSolver::nearest(const Links& links, const Pair& pair) const {
  const double rho = world_->link_radius();
  if (pair.half_plane) {
    const HalfPlane& plane = world_->obstacles().half_planes()[pair.obstacle];
    const Vector2d& joint = links.joint[pair.part];
    return {plane.normal.dot(joint - plane.point) - rho, plane.normal, joint};
  }
  const Capsule& capsule = world_->obstacles().capsules()[pair.obstacle];
  const Vector2d &from = links.joint[pair.part], &to = links.joint[pair.part + 1];
  const auto [s, t] = nearest_places(from, to - from, capsule.a, capsule.b - capsule.a);
  const Vector2d point = from + s * (to - from);
  const Vector2d apart = point - (capsule.a + t * (capsule.b - capsule.a));
  double distance = apart.norm();
  // On the axis itself, and beyond it since the start of the substep, the way out is the way in.
  Vector2d normal = distance > 1e-12 ? Vector2d(apart / distance) : pair.side;
  if (normal.dot(pair.side) < 0) {
    normal = -normal;
    distance = -distance;
  }
  return {distance - capsule.radius - rho, normal, point};
}

void ContactSolver::find_pairs(const Links& links, const Vector2d& centroid, double reach) {
  pairs_.clear();
  const Obstacles& obstacles = world_->obstacles();
  const auto add_if_near = [&](Pair pair) {
    const Nearest place = nearest(links, pair);
    if (place.gap > reach) return;
    pair.side = place.normal;
    pair.gap = place.gap;
    pairs_.push_back(pair);
  };
  // Of a link and a capsule whose axes coincide somewhere, any side will do.
  obstacles.near(centroid, kReach + world_->link_radius() + reach, near_);
  for (const int k : near_)
    for (int i = 0; i < model_.links; ++i) {
      const Vector2d across = quarter_turn(links.tangent[i]);
      Pair pair{false, i, k, across, 0};
      // Whichever side the nearest point is on.
      const Capsule& capsule = obstacles.capsules()[k];
      if (across.dot(links.joint[i] - capsule.a) < 0) pair.side = -across;
      const auto [s, t] = nearest_places(links.joint[i], links.joint[i + 1] - links.joint[i],
                                         capsule.a, capsule.b - capsule.a);
      const Vector2d apart = links.joint[i] + s * (links.joint[i + 1] - links.joint[i]) -
                             capsule.a - t * (capsule.b - capsule.a);
      if (apart.norm() > 1e-12) pair.side = apart.normalized();
      add_if_near(pair);
    }
  for (std::size_t k = 0; k < obstacles.half_planes().size(); ++k) {
    const HalfPlane& plane = obstacles.half_planes()[k];
    if (plane.normal.dot(centroid - plane.point) > kReach + world_->link_radius() + reach) continue;
    for (int i = 0; i <= model_.links; ++i)
      add_if_near({true, i, static_cast<int>(k), plane.normal, 0});
  }
}

// About the centroid, fixed frame.
Eigen::Matrix3d ContactSolver::resistance(const Links& links, const Vector2d& centroid) const {
  const double l = model_.link_length();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < model_.links; ++i) {
    const Vector2d t = links.tangent[i], n = quarter_turn(t);
    const Eigen::Matrix2d drag = model_.gamma * t * t.transpose() + n * n.transpose();
    const Vector2d spun = quarter_turn(0.5 * (links.joint[i] + links.joint[i + 1]) - centroid);
    const Vector2d coupling = drag * spun;
    sum.topLeftCorner<2, 2>() += l * drag;
    sum.topRightCorner<2, 1>() += l * coupling;
    sum.bottomLeftCorner<1, 2>() += l * coupling.transpose();
    sum(2, 2) += l * spun.dot(coupling) + l * l * l / 12;
  }
  return sum;
}

ContactStep ContactSolver::step(const SwimmerState& from, const SwimmerState& free,
                                const Vector3d& kick, double h) {
  ContactStep result;
  result.state = free;
  result.gap = kInfinity;
  // Nothing of the swimmer is faster than 0.6 L/T0 and what thermal motion adds.
  const double reach = 0.6 * h + 0.01 + 6 * std::sqrt(6 * world_->thermal_noise() * h);
  find_pairs(links_of(from), from.centroid, reach);
  if (pairs_.empty()) return result;
  nearest_.resize(pairs_.size());
  pressing_.assign(pairs_.size(), 0);

  const double kappa = world_->contact_stiffness();
  Links links = links_of(free);
  const auto row = [&](const Nearest& place) {
    const Vector2d arm = place.point - result.state.centroid;
    return Vector3d(place.normal.x(), place.normal.y(), cross(arm, place.normal));
  };
  const auto find_gaps = [&] {
    result.gap = kInfinity;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      nearest_[k] = nearest(links, pairs_[k]);
      result.gap = std::min(result.gap, nearest_[k].gap);
    }
  };
  find_gaps();
  if (result.gap >= 0) return result;

  const Eigen::Matrix3d free_resistance = resistance(links, free.centroid);
  Vector3d delta = Vector3d::Zero();
  double contact_work = 0;
  for (int iteration = 0; iteration < kNewtonSteps; ++iteration) {
    Vector3d next = delta;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      Eigen::Matrix3d system = free_resistance;
      Vector3d load = Vector3d::Zero();
      bool settled = sweep > 0;
      for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const Vector3d j = row(nearest_[k]);
        const bool presses = nearest_[k].gap + h * j.dot(next - delta) < 0;
        settled = settled && presses == (pressing_[k] != 0);
        pressing_[k] = presses;
        if (!presses) continue;
        system += kappa * h * j * j.transpose();
        load -= kappa * (nearest_[k].gap - h * j.dot(delta)) * j;
      }
      if (settled) break;
      next = system.ldlt().solve(load);
    }
    // The forces of this linearisation are those that move it.
    result.record = ContactRecord();
    contact_work = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      if (!pressing_[k]) continue;
      const Vector3d j = row(nearest_[k]);
      const double gap = nearest_[k].gap + h * j.dot(next - delta), force = -kappa * gap;
      ++result.record.contacts;
      result.record.force += force * nearest_[k].normal;
      result.record.torque += force * j[2];
      contact_work += force * (gap - pairs_[k].gap - j.dot(kick));
    }
    delta = next;
    result.state.centroid = free.centroid + h * delta.head<2>();
    result.state.heading = free.heading + h * delta[2];
    links = links_of(result.state);
    find_gaps();
  }
  result.dissipation = h * delta.dot(free_resistance * delta);
  result.work = result.dissipation - contact_work;
  result.record.power = result.work / h;
  return result;
}

double ContactSolver::gap(const SwimmerState& state, double reach) {
  const Links links = links_of(state);
  find_pairs(links, state.centroid, reach);
  double smallest = kInfinity;
  for (const Pair& pair : pairs_) smallest = std::min(smallest, nearest(links, pair).gap);
  return smallest;
}

void ContactSolver::check_free(const SwimmerState& state) {
  const Links links = links_of(state);
  find_pairs(links, state.centroid, 0);
  for (const Pair& pair : pairs_) {
    const Nearest place = nearest(links, pair);
    if (place.gap < 0)
      throw std::invalid_argument(fmt::format(
          "link {} is within an obstacle at ({:.4g}, {:.4g}) L: its gap is {:.4g} L and must not "
          "be "
          "negative",
          std::min(pair.part + 1, model_.links), place.point.x(), place.point.y(), place.gap));
  }
  for (const OccupancyMap& map : world_->obstacles().maps())
    for (int i = 0; i <= model_.links; ++i)
      if (map.blocks(links.joint[i]))
        throw std::invalid_argument(
            fmt::format("the swimmer is within a blocked cell of the map at ({:.4g}, {:.4g}) L",
                        links.joint[i].x(), links.joint[i].y()));
}

}  // namespace threelink_sim
