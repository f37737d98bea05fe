// SPDX-License-Identifier: BSD-3-Clause
#include "beams/cavity_mode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/math/gauss_points.hpp"
#include "base/math/linear_algebra.hpp"
#include "beams/overlap.hpp"

namespace straytrace::beams {
namespace {

constexpr double margin = 1e-9;  // of g1 g2 to 0 and 1: nearer, the spots are decided by rounding

}  // namespace

CavityMode cavity_mode(double length, double roc1, double roc2, double wavelength) {
  CavityMode m;
  m.g1 = 1 - length / roc1;
  m.g2 = 1 - length / roc2;
  double const product = m.g1 * m.g2;
  if (!(product > 0 && product < 1))
    throw NumericalError(fmt::format("the cavity is unstable: g1 g2 = {:.6g}, must lie between 0 and 1", product));
  if (product < margin || product > 1 - margin)
    throw NumericalError(fmt::format("the cavity is at the edge of stability: g1 g2 = {:.12g} is {} but for {:g}",
                                     product, product < 0.5 ? 0 : 1, margin));
  double const scale = wavelength * length / pi, sum = m.g1 + m.g2 - 2 * product;
  m.w1 = std::sqrt(scale * std::sqrt(m.g2 / (m.g1 * (1 - product))));
  m.w2 = std::sqrt(scale * std::sqrt(m.g1 / (m.g2 * (1 - product))));
  m.waist = std::sqrt(scale * std::sqrt(product * (1 - product) / (sum * sum)));
  m.waist_position = length * m.g2 * (1 - m.g1) / sum;
  m.gouy = std::acos(std::copysign(std::sqrt(product), m.g1));
  m.rayleigh = pi * m.waist * m.waist / wavelength;
  return m;
}

namespace {

using Complex = std::complex<double>;

// Radii of the nodes on an opening [m], and the square roots of radius times weight [m]: with these in it, the field is
// a vector whose norm squared is the power over 2 pi.
struct Nodes {
  Eigen::ArrayXd r, root;
  Nodes(RoundOpening const& opening, GaussPoints const& gauss) : r(gauss.at.size()), root(gauss.at.size()) {
    for (std::size_t i = 0; i < gauss.at.size(); ++i) {
      r[Eigen::Index(i)] = opening.radius * gauss.at[i];
      root[Eigen::Index(i)] = std::sqrt(r[Eigen::Index(i)] * opening.radius * gauss.weight[i]);
    }
  }
};

// eq. W.10: (-i)^(l+1) (k/z) J_l(k r1 r2/z) exp(ik (r1^2 + r2^2)/2z) between the nodes.
Eigen::MatrixXcd leg(Nodes const& from, Nodes const& to, double k, double distance, int l) {
  constexpr std::array<Complex, 4> turns{Complex{1, 0}, {0, -1}, {-1, 0}, {0, 1}};  // (-i)^n
  Eigen::MatrixXcd kernel(to.r.size(), from.r.size());
  for (Eigen::Index j = 0; j < kernel.cols(); ++j)
    for (Eigen::Index i = 0; i < kernel.rows(); ++i) {
      double const r1 = from.r[j], r2 = to.r[i];
      kernel(i, j) = turns[std::size_t(l + 1) % 4] *
                     (k / distance * from.root[j] * to.root[i] * bessel_j(l, k * r1 * r2 / distance)) *
                     std::polar(1.0, k * (r1 * r1 + r2 * r2) / (2 * distance));
    }
  return kernel;
}

Eigen::VectorXcd mirror(Nodes const& nodes, double k, double curvature) {
  return nodes.r.unaryExpr([&](double r) { return std::polar(1.0, -k * r * r * curvature / 2); });
}

// Half of the round trip, from the middle of the reflection by mirror 1 to that by mirror 2: the way back is its
// transpose, and the field of a Gaussian mode is real up to a constant at both ends.
Eigen::MatrixXcd half_trip(RoundCavity const& cavity, GaussPoints const& gauss, int l) {
  double const k = 2 * pi / cavity.wavelength;
  Nodes at(cavity.openings.front(), gauss);
  Eigen::MatrixXcd half = mirror(at, k, cavity.curvature1).asDiagonal();
  for (std::size_t j = 1; j < cavity.openings.size(); ++j) {
    Nodes const next(cavity.openings[j], gauss);
    half = leg(at, next, k, cavity.openings[j].place - cavity.openings[j - 1].place, l) * half;
    at = next;
  }
  return mirror(at, k, cavity.curvature2).asDiagonal() * half;
}

struct Eigenpair {
  Complex value;
  Eigen::VectorXcd vector;  // of norm 1
};

// The mode of the round trip next to `start`, by Rayleigh quotient iteration, which converges cubically. The quotient
// is bilinear, without conjugation, because the matrix is symmetric and not Hermitian.
Eigenpair next_to(Eigen::MatrixXcd const& round, Eigen::VectorXcd const& start) {
  auto const quotient = [&](Eigen::VectorXcd const& v) {
    return Complex((v.transpose() * (round * v)).value()) / Complex((v.transpose() * v).value());
  };
  Eigenpair pair{quotient(start), start};
  for (int step = 0; step < 12; ++step) {
    Eigen::MatrixXcd shifted = round;
    shifted.diagonal().array() -= pair.value;
    Eigen::VectorXcd const v = solve(shifted, pair.vector);
    if (!v.allFinite()) break;  // the shift is the eigenvalue
    Complex const before = pair.value;
    pair = {quotient(v.normalized()), v.normalized()};
    if (std::abs(pair.value - before) < 1e-15) break;
  }
  return pair;
}

// The modes p = 0, 1, ... next to the Laguerre-Gauss modes; empty if one shares less than half of its power with its
// own.
std::vector<Complex> near_gaussian(RoundCavity const& cavity, Eigen::MatrixXcd const& round, Nodes const& nodes, int l,
                                   int count) {
  double const L = cavity.length(), g1 = 1 - L * cavity.curvature1, g2 = 1 - L * cavity.curvature2;
  if (!(g1 * g2 > 1e-6 && g1 * g2 < 1 - 1e-6)) return {};
  double const w = cavity_mode(L, 1 / cavity.curvature1, 1 / cavity.curvature2, cavity.wavelength).w1;
  std::vector<Complex> values;
  for (int p = 0; p < count; ++p) {
    Eigen::VectorXd const shape =
        (nodes.root * nodes.r.unaryExpr([&](double r) { return laguerre_function(p, l, 2 * r * r / (w * w)); }))
            .matrix()
            .normalized();
    Eigenpair const mode = next_to(round, shape.cast<Complex>());
    if (std::abs(mode.vector.dot(shape.cast<Complex>())) < std::sqrt(0.5)) return {};
    values.push_back(mode.value);
  }
  return values;
}

// In the order of their loss.
std::vector<Complex> least_loss(Eigen::MatrixXcd const& round) {
  Eigen::VectorXcd const all = complex_eigenvalues(round);
  std::vector<Complex> values(all.begin(), all.end());
  std::ranges::sort(values, std::ranges::greater{}, [](Complex z) { return std::abs(z); });
  return values;
}

}  // namespace

double fresnel_number(RoundCavity const& cavity) {
  double largest = 0;
  for (std::size_t j = 1; j < cavity.openings.size(); ++j) {
    auto const &a = cavity.openings[j - 1], &b = cavity.openings[j];
    double const radius = std::max(a.radius, b.radius);
    largest = std::max(largest, radius * radius / (cavity.wavelength * (b.place - a.place)));
  }
  return largest;
}

std::vector<RoundMode> round_modes(RoundCavity const& cavity, int azimuthal, int count) {
  double const fresnel = fresnel_number(cavity);
  if (!(fresnel <= largest_fresnel_number))
    throw NumericalError(
        fmt::format("the Fresnel number of a leg is {:.3g}, more than {:g}", fresnel, largest_fresnel_number));
  GaussPoints const gauss(40 + int(std::ceil(2 * pi * fresnel)));  // the phases of legs and mirrors, to rounding
  Eigen::MatrixXcd const half = half_trip(cavity, gauss, azimuthal), round = half.transpose() * half;
  std::vector<Complex> values = near_gaussian(cavity, round, {cavity.openings.front(), gauss}, azimuthal, count);
  if (values.empty()) values = least_loss(round);
  std::vector<RoundMode> modes;
  for (int p = 0; p < count; ++p) modes.push_back({p, azimuthal, values[std::size_t(p)]});
  return modes;
}

}  // namespace straytrace::beams
