// SPDX-License-Identifier: BSD-3-Clause
// Coupling of higher modes: docs/theory/interferometer.md, eq. N.6 to N.11.
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "beams/overlap.hpp"
#include "ifo/mode_bases.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_mode_coupling {
namespace {

using namespace straytrace::ifo;

using Complex = std::complex<double>;
constexpr double lambda = 1064e-9, k = 2 * pi / lambda;

Complex curvature(double w, double roc) { return {1 / roc, lambda / (pi * w * w)}; }

// N.6 as a sum over points across the beam.
Complex integral(AxisCoupling const& axis, int n, int m) {
  double const s1 = std::sqrt(k * axis.in.imag()), s2 = std::sqrt(k * axis.out.imag());
  double const reach = 14 / s2, step = reach / 4000;
  Complex sum = 0;
  for (double x = -reach; x <= reach; x += step) {
    double const x1 = x - axis.shift;
    double const phase = axis.kick * x + 0.5 * k * (axis.in.real() * x1 * x1 - axis.out.real() * x * x);
    sum += std::polar(beams::hermite_function(n, s2 * x) * beams::hermite_function(m, s1 * x1), phase);
  }
  return sum * step * std::sqrt(s1 * s2);
}

double largest_error(AxisCoupling const& axis, AxisCoupling const& truth) {
  Eigen::MatrixXcd const coupling = axis_coupling(axis, k, 6);
  double worst = 0;
  for (int n = 0; n <= 6; ++n)
    for (int m = 0; m <= 6; ++m) worst = std::max(worst, std::abs(coupling(n, m) - integral(truth, n, m)));
  return worst;
}

// Mismatch of size and wavefront, tilt and shift at once. Negative controls: the other sign of the shift, and of the
// tilt.
TEST(ModeCoupling, RecursionIsTheIntegralN6) {
  AxisCoupling const axis{curvature(1.1e-3, 3), curvature(1.4e-3, -20), 900, 0.3e-3};
  EXPECT_LT(largest_error(axis, axis), 1e-10);
  AxisCoupling shifted = axis, tilted = axis;
  shifted.shift *= -1;
  tilted.kick *= -1;
  EXPECT_GT(largest_error(shifted, axis), 0.1);
  EXPECT_GT(largest_error(tilted, axis), 0.1);
}

// Nothing is lost but to modes above the order; without mismatch K is unity.
TEST(ModeCoupling, KeepsPowerN9) {
  AxisCoupling const x{curvature(1e-3, 5), curvature(1.05e-3, 4), 200, 0.05e-3};
  AxisCoupling const y{curvature(1e-3, 5), curvature(0.95e-3, 5), 0, 0};
  double before = 1;
  for (int const order : {2, 4, 8, 16}) {
    double const missing = 1 - mode_coupling(x, y, k, order).col(0).squaredNorm();
    EXPECT_GT(missing, -1e-12);
    EXPECT_LT(missing, before / 5);
    before = std::max(missing, 1e-9);
  }
  EXPECT_LT(before, 1e-8);
  AxisCoupling const same{x.in, x.in};
  EXPECT_LT((mode_coupling(same, same, k, 4) - Eigen::MatrixXcd::Identity(15, 15)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_THROW(axis_coupling({x.in, 0.2}, k, 2), NumericalError);
}

// 1 W onto M1 (T 2 %, RoC 1420 m), 3000 m, M2 (T 0.4 %, RoC 1683 m), in the eigenmode of this cavity, with the
// fundamental mode on resonance where nothing is tilted or mismatched.
struct ArmOfModes {
  double length = 3000, t1 = std::sqrt(0.02), r1 = std::sqrt(0.98), r2 = std::sqrt(0.996);
  double g1 = 1 - length / 1420, g2 = 1 - length / 1683;
  double w1 = std::sqrt(lambda * length / pi * std::sqrt(g2 / (g1 * (1 - g1 * g2))));
  double w2 = std::sqrt(lambda * length / pi * std::sqrt(g1 / (g2 * (1 - g1 * g2))));
  double psi = std::acos(-std::sqrt(g1 * g2));

  struct Light {
    Eigen::VectorXcd inside, reflected;
  };
  // `input` and `end` are K at M1 on transmission and at M2 on reflection. The parity of N.10 acts twice and cancels.
  Light solve(Eigen::MatrixXcd const& input, Eigen::MatrixXcd const& end, int order) const {
    int const size = mode_count(order);
    Eigen::VectorXcd flight(size);
    for (int sum = 0; sum <= order; ++sum)
      for (int m = 0; m <= sum; ++m) flight(mode_index(sum - m, m)) = std::polar(1.0, -sum * psi);
    Eigen::MatrixXcd const back = r2 * flight.asDiagonal() * end * flight.asDiagonal();
    Eigen::VectorXcd const b = input.col(0);
    Light light;
    light.inside = (Eigen::MatrixXcd::Identity(size, size) - r1 * back).partialPivLu().solve(t1 * b);
    light.reflected = r1 * b - t1 * back * light.inside;
    return light;
  }
  Light mismatched(double size, int order) const {
    AxisCoupling const axis{curvature(size * w1, -1420), curvature(w1, -1420)};
    int const count = mode_count(order);
    return solve(mode_coupling(axis, axis, k, order), Eigen::MatrixXcd::Identity(count, count), order);
  }
  Light tilted(double kick, int order) const {
    AxisCoupling const still{curvature(w2, -1683), curvature(w2, -1683)};
    AxisCoupling const turned{still.in, still.out, kick, 0};
    int const count = mode_count(order);
    return solve(Eigen::MatrixXcd::Identity(count, count), mode_coupling(still, turned, k, order), order);
  }
};

// Input 1.1 times too wide; reference values of FINESSE 3. Negative control: a waist wrong by a root of 2.
TEST(ModeCoupling, MismatchedCavityN9) {
  ArmOfModes const arm;
  EXPECT_NEAR(arm.w1, 48.679177e-3, 1e-8);
  EXPECT_NEAR(arm.mismatched(1.1, 0).inside.squaredNorm(), 136.8948367, 1.4e-7);
  EXPECT_NEAR(arm.mismatched(1.1, 2).inside.squaredNorm(), 136.8949372, 1.4e-7);
  EXPECT_NEAR(arm.mismatched(1.1, 4).inside.squaredNorm(), 136.8949376, 1.4e-7);
  EXPECT_NEAR(std::norm(arm.mismatched(1.1, 4).inside(mode_index(2, 0))), 5.0275965e-5, 5e-12);
  EXPECT_NEAR(arm.mismatched(1.1, 8).reflected.squaredNorm(), 0.452420249, 4.5e-7);
  EXPECT_GT(std::fabs(arm.mismatched(1.1 * std::sqrt(2), 4).inside.squaredNorm() - 136.8949376), 1);
}

// M2 tilted by 0.1 urad, nothing realigned; reference values of FINESSE 3. Negative control: a beam that turns by the
// tilt only.
TEST(ModeCoupling, MisalignedCavityN6) {
  ArmOfModes const arm;
  double const kick = 2 * k * 0.1e-6;
  EXPECT_NEAR(arm.tilted(kick, 1).inside.squaredNorm(), 135.6346956, 1.4e-7);
  EXPECT_NEAR(arm.tilted(kick, 2).inside.squaredNorm(), 135.6767721, 1.4e-7);
  EXPECT_NEAR(arm.tilted(kick, 4).inside.squaredNorm(), 135.6768345, 1.4e-7);
  auto const light = arm.tilted(kick, 6);
  EXPECT_NEAR(light.inside.squaredNorm(), 135.6768345, 1.4e-7);
  EXPECT_NEAR(std::norm(light.inside(mode_index(0, 1))), 0.3049579497, 3e-10);
  EXPECT_NEAR(light.reflected.squaredNorm(), 0.4572926619, 4.6e-10);
  EXPECT_GT(std::fabs(arm.tilted(kick / 2, 6).inside.squaredNorm() - 135.6768345), 1);
}

// w 1 mm, stop of 1.2 mm at 0.5 mm, and centred. The slope is its closed form. Negative control: the Gaussian of the
// field.
TEST(ModeCoupling, StopsN11) {
  double const w = 1e-3, a = 1.2e-3, d = 0.5e-3, v = 2 * a * a / (w * w), h = 1e-7;
  auto const passed = [&](double offset, int order = 2) { return stop_coupling({a, {offset, 0}}, {w, w}, order); };
  Eigen::MatrixXd const offset = passed(d), centred = passed(0);
  EXPECT_NEAR(offset(0, 0), 0.8557401455, 1e-9);
  double const slope =
      -4 * a / (w * w) * std::exp(-2 * (a * a + d * d) / (w * w)) * std::cyl_bessel_i(1.0, 4 * a * d / (w * w));
  EXPECT_NEAR(slope, -375.57728, 1e-5);
  EXPECT_NEAR((passed(d + h)(0, 0) - passed(d - h)(0, 0)) / (2 * h), slope, 4e-5);
  EXPECT_NEAR(offset(mode_index(1, 0), 0), -0.5 * w * slope, 1e-9);
  EXPECT_NEAR(centred(0, 0), 1 - std::exp(-v), 1e-12);
  EXPECT_NEAR(centred(mode_index(2, 0), 0), -v * std::exp(-v) / std::sqrt(2), 1e-12);
  EXPECT_NEAR(centred(mode_index(1, 0), mode_index(1, 0)), 1 - std::exp(-v) * (1 + v), 1e-12);
  EXPECT_GT(std::fabs(centred(0, 0) - (1 - std::exp(-v / 2))), 0.1);
  // A stop much wider than the beam passes all of every mode.
  Eigen::MatrixXd const open = stop_coupling({12e-3, {}}, {w, 1.3 * w}, 6);
  EXPECT_LT((open - Eigen::MatrixXd::Identity(28, 28)).cwiseAbs().maxCoeff(), 1e-12);
}

// The rim of a stop a million times wider than the beam is a straight edge: of 00, (1 + erf(sqrt(2) d/w))/2 passes at a
// distance d inside it. An integral over the whole stop would take hours.
TEST(ModeCoupling, StopsMuchWiderThanTheBeam) {
  double const w = 1e-3, a = 1e3;
  auto const passed = [&](double x, double y) { return stop_coupling({a, {x, y}}, {w, w}, 4); };
  Eigen::MatrixXd const one = Eigen::MatrixXd::Identity(15, 15);
  EXPECT_LT((passed(0, 0) - one).cwiseAbs().maxCoeff(), 1e-15);
  for (double const d : {-0.4e-3, 0.0, 0.7e-3}) {
    double const straight = 0.5 * (1 + std::erf(std::sqrt(2) * d / w));
    EXPECT_NEAR(passed(a - d, 0)(0, 0), straight, 2e-6) << d;
    EXPECT_NEAR(passed(0, -a + d)(0, 0), straight, 2e-6) << d;
  }
  EXPECT_EQ(passed(0, a + 1).cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(std::fabs(passed(a - 0.7e-3, 0)(0, 0) - passed(a, 0)(0, 0)), 0.3) << "control: another distance";
}

}  // namespace
}  // namespace straytrace::ifo_mode_coupling
