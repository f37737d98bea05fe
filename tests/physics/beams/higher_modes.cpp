// SPDX-License-Identifier: BSD-3-Clause
// Hermite- and Laguerre-Gauss modes (R2.11): orthonormal to 1e-9 up to order 30, Gouy phases against
// the diffraction integral, and Gaussian beams expanded in them against eq. 5.1-5.3.
#include <Eigen/Core>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <gtest/gtest.h>

#include <functional>

#include "base/errors.hpp"
#include "beams/overlap.hpp"
#include "support/beams_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_higher_modes {
namespace {

using testing::Dice;
constexpr double nd_yag = 1.064e-6;  // m
constexpr Vec3 along_z{0, 0, 1};
constexpr int highest = 30;

// u_nm [1/m] at a point of space, of order n along e1 and m along e2. The phase lags by (n + 1/2) and (m + 1/2) times
// the Gouy phases of the axes.
std::complex<double> hermite_field(Mode const& basis, int n, int m, Vec3 p) {
  double const z = dot(p - basis.origin, basis.travel), k = basis.wave_number();
  Mode const here = propagated(basis, z);
  auto const lag = axis_gouy(basis, z);
  Vec3 const r = p - here.origin;
  double const x = dot(r, basis.e1), y = dot(r, basis.e2);
  double const sx = std::sqrt(k * here.q11.imag()), sy = std::sqrt(k * here.q22.imag());  // sqrt(2)/w
  double const size = std::sqrt(sx * sy) * hermite_function(n, sx * x) * hermite_function(m, sy * y);
  double const bend = 0.5 * k * (here.q11.real() * x * x + here.q22.real() * y * y);
  return std::polar(1.0, k * z + bend - (n + 0.5) * lag[0] - (m + 0.5) * lag[1]) * size;
}

// u_pl [1/m]: 2p + |l| is the order, exp(i l phi) with phi from e1 towards e2. The phase lags by 2p + |l| + 1 times the
// Gouy phase.
std::complex<double> laguerre_field(Mode const& basis, int p, int l, Vec3 point) {
  double const z = dot(point - basis.origin, basis.travel), k = basis.wave_number();
  Mode const here = propagated(basis, z);
  Vec3 const r = point - here.origin;
  double const x = dot(r, basis.e1), y = dot(r, basis.e2), rho2 = x * x + y * y, scale = k * here.q11.imag();  // 2/w^2
  double const size = std::sqrt(scale / pi) * laguerre_function(p, std::abs(l), scale * rho2);
  double const lag = (2 * p + std::abs(l) + 1) * gouy(basis, z), bend = 0.5 * k * here.q11.real() * rho2;
  return std::polar(1.0, k * z + bend - lag + l * std::atan2(y, x)) * size;
}

LaguerreCoefficients laguerre_coefficients(Mode const& beam, Mode const& basis, int order) {
  return LaguerreCoefficients(hermite_coefficients(beam, basis, order));
}

// Integrals over the whole axis of smooth functions that vanish at both ends: equal steps are exact to rounding.
TEST(hermite, functions_are_orthonormal_to_order_30) {
  double worst = 0, worst_control = 0;
  for (int n = 0; n <= highest; ++n)
    for (int m = 0; m <= n; ++m) {
      double sum = 0, control = 0, step = 0.05;
      for (int i = -280; i <= 280; ++i) {
        double const x = i * step, product = hermite_function(n, x) * hermite_function(m, x);
        sum += product;
        control += hermite_function(n, x) * hermite_function(m, 1.001 * x);  // of a beam 0.1 % smaller
      }
      worst = std::max(worst, std::fabs(sum * step - (n == m)));
      worst_control = std::max(worst_control, std::fabs(control * step - (n == m)));
    }
  EXPECT_LT(worst, 1e-12);
  EXPECT_GT(worst_control, 1e-3);
  EXPECT_EQ(hermite_function(30, 60), 0);
  EXPECT_NEAR(hermite_function(2, 0.7), (4 * 0.49 - 2) * std::exp(-0.245) / std::sqrt(8 * std::sqrt(pi)), 1e-15);
}

// In pieces of 4 over 0 < x < 120, each by a rule that is exact for polynomials of order 46.
double radial_product(int p, int l, int q, int k) {
  double sum = 0;
  for (int piece = 0; piece < 30; ++piece)
    sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        [&](double x) { return laguerre_function(p, l, x) * laguerre_function(q, k, x); }, 4 * piece, 4 * piece + 4, 0);
  return sum;
}

TEST(laguerre, functions_are_orthonormal_to_order_30) {
  double worst = 0;
  for (int l = 0; l <= highest; ++l)
    for (int p = 0; 2 * p + l <= highest; ++p)
      for (int q = 0; q <= p; ++q) worst = std::max(worst, std::fabs(radial_product(p, l, q, l) - (p == q)));
  EXPECT_LT(worst, 1e-11);
  EXPECT_GT(std::fabs(radial_product(3, 2, 2, 4)), 0.1);  // orders of two l are not orthogonal but for exp(i l phi)
  EXPECT_NEAR(laguerre_function(1, 0, 0.3), (1 - 0.3) * std::exp(-0.15), 1e-15);
  EXPECT_EQ(laguerre_function(3, 0, 0), 1);
  EXPECT_EQ(laguerre_function(3, 2, 0), 0);
}

// All products of the fields of order up to 20, on a plane behind the waist: 1e-9.
constexpr int top = 20;
Mode const basis_of_test = circular_mode({}, along_z, 1e-3, 0.4, nd_yag);
Eigen::MatrixXcd gram(std::function<std::complex<double>(int, Vec3)> const& mode, int count, double plane) {
  constexpr int half = 75;
  double const w = spot(propagated(basis_of_test, plane)).major, step = 0.1 * w;
  Eigen::MatrixXcd values(count, (2 * half + 1) * (2 * half + 1));
  for (int i = -half, column = 0; i <= half; ++i)
    for (int j = -half; j <= half; ++j, ++column)
      for (int k = 0; k < count; ++k) values(k, column) = step * mode(k, {i * step, j * step, plane});
  return values * values.adjoint();
}

TEST(hermite, fields_are_orthonormal) {
  std::vector<std::pair<int, int>> orders;
  for (int n = 0; n <= top; ++n)
    for (int m = 0; n + m <= top; ++m) orders.emplace_back(n, m);
  int const count = static_cast<int>(orders.size());
  auto const one = Eigen::MatrixXcd::Identity(count, count);
  auto const u = [&](int k, Vec3 p) { return hermite_field(basis_of_test, orders[k].first, orders[k].second, p); };
  EXPECT_LT((gram(u, count, 0.7) - one).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(laguerre, fields_are_orthonormal) {
  std::vector<std::pair<int, int>> orders;
  for (int l = -top; l <= top; ++l)
    for (int p = 0; 2 * p + std::abs(l) <= top; ++p) orders.emplace_back(p, l);
  int const count = static_cast<int>(orders.size());
  auto const one = Eigen::MatrixXcd::Identity(count, count);
  auto const u = [&](int k, Vec3 p) { return laguerre_field(basis_of_test, orders[k].first, orders[k].second, p); };
  EXPECT_LT((gram(u, count, 0.7) - one).cwiseAbs().maxCoeff(), 1e-9);
  auto const control = [&](int k, Vec3 p) {
    return laguerre_field(basis_of_test, orders[k].first, 0, p);
  };  // no exp(i l phi)
  EXPECT_GT((gram(control, count, 0.7) - one).cwiseAbs().maxCoeff(), 0.1);
}

// Laguerre modes are sums of Hermite modes of their order, at any distance: LG(0, +-1) = (HG10 +- i HG01)/sqrt(2),
// LG10 = -(HG20 + HG02)/sqrt(2). This holds only when all lag alike.
TEST(laguerre, fields_are_sums_of_hermite_fields) {
  std::complex<double> const i{0, 1};
  for (Vec3 p : {Vec3{3e-4, 5e-4, 0}, {3e-4, 5e-4, 2.5}, {-7e-4, 2e-4, -4.0}}) {
    auto const hg = [&](int n, int m) { return hermite_field(basis_of_test, n, m, p); };
    auto const lg = [&](int n, int l) { return laguerre_field(basis_of_test, n, l, p); };
    double const size = std::abs(hg(0, 0)), half = std::sqrt(0.5);
    EXPECT_LT(std::abs(lg(0, 1) - half * (hg(1, 0) + i * hg(0, 1))), 1e-8 * size);
    EXPECT_LT(std::abs(lg(0, -1) - half * (hg(1, 0) - i * hg(0, 1))), 1e-8 * size);
    EXPECT_LT(std::abs(lg(1, 0) + half * (hg(2, 0) + hg(0, 2))), 1e-8 * size);
    EXPECT_GT(std::abs(lg(0, 1) - half * (hg(1, 0) - i * hg(0, 1))), 1e-2 * size);  // the other sense of turn
  }
}

// Free flight by the Fresnel integral along x, u(x, z) = sqrt(k/(2 pi i z)) int u(x', 0) exp(i k (x - x')^2 / 2z) dx':
// sizes and phases of every order. The other axis is at its middle, where both sides have the same known factor.
std::complex<double> fresnel(Mode const& basis, int n, double x, double z) {
  double const k = basis.wave_number(), step = 1e-6;
  std::complex<double> sum = 0;
  for (int i = -8000; i <= 8000; ++i) {
    double const from = i * step;
    sum += hermite_field(basis, n, 0, {from, 0, 0}) * std::polar(1.0, 0.5 * k * (x - from) * (x - from) / z);
  }
  return sum * step * std::polar(std::sqrt(k / (2 * pi * z)), -pi / 4);
}

TEST(hermite, flight_agrees_with_the_diffraction_integral) {
  Mode const basis = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 1.5e-3}, {-0.8, 0.3}, nd_yag);
  double const z = 2;
  Mode const far = propagated(basis, z);
  // Of the order 0 along y: its middle falls with the root of the size and lags by half its Gouy phase.
  auto const lag = axis_gouy(basis, z);
  auto const across =
      std::polar(std::pow(far.q22.imag() / basis.q22.imag(), 0.25), basis.wave_number() * z - 0.5 * lag[1]);
  for (int n : {0, 1, 2, 7, 20})
    for (double x : {0.3e-3, 1.7e-3}) {
      auto const exact = fresnel(basis, n, x, z) * across, found = hermite_field(basis, n, 0, {x, 0, z});
      double const size = std::sqrt(std::sqrt(far.q11.imag() * far.q22.imag()) * basis.wave_number());
      EXPECT_LT(std::abs(found - exact), 1e-7 * size) << n;
      if (n > 0) {
        EXPECT_GT(std::abs(found * std::polar(1.0, n * lag[0]) - exact), 1e-2 * std::abs(exact)) << n;
      }
    }
}

// A tilted, shifted, mismatched and twisted beam in the modes of another: powers sum to 1, every amplitude is the
// overlap integral, and eq. 5.1-5.3 are the squares of the first.
TEST(hermite, coefficients_of_simple_beams_are_eq_5_1_to_5_3) {
  double const w = 10e-3, l = nd_yag;
  Mode const basis = elliptic_mode({}, {1, 0, 0}, along_z, {w, w}, {0, 0}, l);
  auto const tilted = hermite_coefficients(circular_mode({}, {std::sin(3e-5), 0, std::cos(3e-5)}, w, 0, l), basis, 20);
  auto const shifted = hermite_coefficients(circular_mode({0, 5e-3, 0}, along_z, w, 0, l), basis, 20);
  auto const smaller = hermite_coefficients(circular_mode({}, along_z, 0.5 * w, 0, l), basis, 60);
  EXPECT_NEAR(std::norm(tilted(0, 0)), 0.4562934, 1e-7);
  EXPECT_NEAR(std::norm(shifted(0, 0)), 0.7788008, 1e-7);
  EXPECT_NEAR(std::norm(smaller(0, 0)), 0.64, 1e-12);
  EXPECT_NEAR(tilted.power(), 1, 1e-9);
  EXPECT_NEAR(shifted.power(), 1, 1e-9);
  EXPECT_NEAR(smaller.power(), 1, 1e-9);
  // First order: i pi w alpha/lambda and d/w of the fundamental amplitude; the tilt is in quadrature.
  auto const t = tilted(1, 0) / tilted(0, 0), s = shifted(0, 1) / shifted(0, 0);
  EXPECT_LT(std::abs(t - std::complex<double>(0, pi * w * 3e-5 / l)), 1e-8);
  EXPECT_LT(std::abs(s - 0.5), 1e-12);
  EXPECT_LT(std::abs(smaller(1, 0)), 1e-15);
  EXPECT_NEAR(std::norm(smaller(2, 0) / smaller(0, 0)), 0.5 * 0.36, 1e-12);  // ((w1^2 - w2^2)/(w1^2 + w2^2))^2 / 2
}

TEST(hermite, coefficients_are_overlap_integrals) {
  Dice dice(8);
  Mode const basis = elliptic_mode({}, {1, 0, 0}, along_z, {1e-3, 1.3e-3}, {0.3, -0.2}, nd_yag);
  Mode const beam = testing::twisted_mode(dice, {3e-4, -2e-4, 0.4}, dice.near(along_z, 2e-4), 1.2e-3, nd_yag);
  auto const c = hermite_coefficients(beam, basis, 60);
  EXPECT_NEAR(c.power(), 1, 1e-9);
  EXPECT_LT(std::abs(c(0, 0) - overlap(beam, basis)), 1e-7);
  double const step = 1e-4;
  for (auto [n, m] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}, {3, 2}, {2, 5}}) {
    std::complex<double> sum = 0;
    for (int i = -60; i <= 60; ++i)
      for (int j = -60; j <= 60; ++j) {
        Vec3 const p{i * step, j * step, 0};
        sum += field(beam, p) * std::conj(hermite_field(basis, n, m, p));
      }
    EXPECT_LT(std::abs(sum * step * step - c(n, m)), 1e-6) << n << m;
    if (n != m) {
      EXPECT_GT(std::abs(sum * step * step - c(m, n)), 1e-3);
    }
  }
  Mode turned = basis;
  turned.q12 = 0.1;
  EXPECT_THROW(hermite_coefficients(beam, turned, 3), NumericalError);
}

TEST(laguerre, coefficients_are_overlap_integrals) {
  Dice dice(8);
  Mode const beam = testing::twisted_mode(dice, {3e-4, -2e-4, 0.4}, dice.near(along_z, 2e-4), 1.2e-3, nd_yag);
  auto const c = laguerre_coefficients(beam, basis_of_test, 40);
  auto const same = hermite_coefficients(beam, basis_of_test, 40);
  EXPECT_NEAR(c.power(), same.power(), 1e-12);
  double const step = 1e-4;
  for (auto [p, l] : {std::pair{0, 0}, {0, 1}, {0, -1}, {1, 0}, {2, -3}, {1, 4}}) {
    std::complex<double> sum = 0;
    for (int i = -60; i <= 60; ++i)
      for (int j = -60; j <= 60; ++j) {
        Vec3 const at{i * step, j * step, 0};
        sum += field(beam, at) * std::conj(laguerre_field(basis_of_test, p, l, at));
      }
    EXPECT_LT(std::abs(sum * step * step - c(p, l)), 1e-6) << p << l;
    if (l != 0) {
      EXPECT_GT(std::abs(sum * step * step - c(p, -l)), 1e-3);
    }
  }
}

// The amplitude of a mismatched beam in LG_p0 depends on the mismatch alone, by powers of one number (R2.11).
TEST(laguerre, mismatch_makes_a_geometric_series) {
  auto const c = laguerre_coefficients(circular_mode({}, along_z, 5e-3, 0, nd_yag),
                                       circular_mode({}, along_z, 10e-3, 0, nd_yag), 30);
  for (int p = 0; p < 8; ++p) {
    EXPECT_NEAR(std::norm(c(p, 0)), 0.64 * std::pow(0.36, p), 1e-12);
    EXPECT_LT(std::abs(c(p, 2)), 1e-15);
  }
}

}  // namespace
}  // namespace straytrace::beams_higher_modes
