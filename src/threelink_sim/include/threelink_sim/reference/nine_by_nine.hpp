/// @file
/// The paper's 9x9 system H (X', Y', Theta') = q for three links, term by term from its supplement.
///
/// An independent formulation of the physics for tests and for comparison of speed. The simulation
/// uses the reduced system of the kernels. (The printed velocity constraints write l theta' without
/// its index i, and call q "nearly" zero where it is exactly zero.)
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

namespace threelink_sim {
namespace reference {

/// A 9x9 matrix.
using Matrix9d = Eigen::Matrix<double, 9, 9>;
/// Velocities or right-hand side of the system.
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// The paper's coordinates x_1..x_3, y_1..y_3 [L] of the links' left ends and theta_1..theta_3
/// [rad].
struct LeftEnds {
  Eigen::Vector3d x, y, theta;
};

/// The links' left ends for x_1, y_1 [L] and theta_1 [rad] of link 1 and the hinge angles [rad].
inline LeftEnds left_ends(double x_1, double y_1, double theta_1, double alpha_1, double alpha_2) {
  LeftEnds e;
  e.theta << theta_1, theta_1 + alpha_1, theta_1 + alpha_1 + alpha_2;
  e.x[0] = x_1;
  e.y[0] = y_1;
  for (int i = 0; i < 2; ++i) {
    e.x[i + 1] = e.x[i] + std::cos(e.theta[i]) / 3;
    e.y[i + 1] = e.y[i] + std::sin(e.theta[i]) / 3;
  }
  return e;
}

/// The matrix H.
inline Matrix9d h_matrix(const LeftEnds& e, double gamma) {
  Matrix9d h = Matrix9d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double c = std::cos(e.theta[i]), s = std::sin(e.theta[i]);
    const double c2 = std::cos(2 * e.theta[i]), s2 = std::sin(2 * e.theta[i]);
    const double x = e.x[i], y = e.y[i];
    h(0, i) = -(gamma * c * c + s * s) / 3;
    h(0, i + 3) = (1 - gamma) * s2 / 6;
    h(0, i + 6) = s / 18;
    h(1, i) = (1 - gamma) * s2 / 6;
    h(1, i + 3) = -(c * c + gamma * s * s) / 3;
    h(1, i + 6) = -c / 18;
    h(2, i) = s / 18 + (1 - gamma) * x * s2 / 6 + (1 + gamma) * y / 6 - (1 - gamma) * y * c2 / 6;
    h(2, i + 3) =
        -(c / 18 + (1 - gamma) * y * s2 / 6 + (1 + gamma) * x / 6 + (1 - gamma) * x * c2 / 6);
    h(2, i + 6) = -(1.0 / 81 + x * c / 18 + y * s / 18);
  }
  h(3, 0) = h(4, 1) = h(5, 3) = h(6, 4) = h(7, 6) = h(8, 7) = -1;
  h(3, 1) = h(4, 2) = h(5, 4) = h(6, 5) = h(7, 7) = h(8, 8) = 1;
  h(3, 6) = std::sin(e.theta[0]) / 3;
  h(4, 7) = std::sin(e.theta[1]) / 3;
  h(5, 6) = -std::cos(e.theta[0]) / 3;
  h(6, 7) = -std::cos(e.theta[1]) / 3;
  return h;
}

/// (X', Y', Theta') under the hinge rates [1/T0].
inline Vector9d velocities(const LeftEnds& e, double gamma, double rate_1, double rate_2) {
  Vector9d q = Vector9d::Zero();
  q[7] = rate_1;
  q[8] = rate_2;
  return h_matrix(e, gamma).partialPivLu().solve(q);
}

/// Power Phi: for each link the integral over s in [0, 1/3] of -f . u, with u = x' + s theta' n.
inline double power(const LeftEnds& e, double gamma, const Vector9d& v) {
  constexpr double l = 1.0 / 3;
  double phi = 0;
  for (int i = 0; i < 3; ++i) {
    const double c = std::cos(e.theta[i]), s = std::sin(e.theta[i]);
    const double along = c * v[i] + s * v[i + 3], across = -s * v[i] + c * v[i + 3];
    const double spin = v[i + 6];
    phi += l * gamma * along * along +
           l * (across * across + across * spin * l + spin * spin * l * l / 3);
  }
  return phi;
}

/// State of one swimmer for the integration below: x_1, y_1, theta_1, alpha_1, alpha_2 and work.
using State6 = Eigen::Matrix<double, 6, 1>;

/// Time derivative of the state under constant hinge rates [1/T0].
inline State6 derivative(const State6& s, double gamma, double rate_1, double rate_2) {
  const LeftEnds e = left_ends(s[0], s[1], s[2], s[3], s[4]);
  const Vector9d v = velocities(e, gamma, rate_1, rate_2);
  State6 d;
  d << v[0], v[3], v[6], rate_1, rate_2, power(e, gamma, v);
  return d;
}

/// One classical Runge-Kutta step of length dt [T0].
inline State6 runge_kutta_step(const State6& s, double gamma, double rate_1, double rate_2,
                               double dt) {
  const State6 k1 = derivative(s, gamma, rate_1, rate_2);
  const State6 k2 = derivative(s + 0.5 * dt * k1, gamma, rate_1, rate_2);
  const State6 k3 = derivative(s + 0.5 * dt * k2, gamma, rate_1, rate_2);
  const State6 k4 = derivative(s + dt * k3, gamma, rate_1, rate_2);
  return s + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

}  // namespace reference
}  // namespace threelink_sim
