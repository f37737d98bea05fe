// SPDX-License-Identifier: BSD-3-Clause
#include "beams/eigenmode.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"

namespace straytrace::beams {

namespace {

constexpr double edge = 1e-12;       // of half the trace to 1, where the two are the same
constexpr double growth = 1e-7;      // of a ray per round trip that rounding can feign, for a pair of equal phases
constexpr double unrelated = 1e-12;  // coupling of the axes, relative, that is rounding
constexpr double repeats = 1e-6;     // relative change of the mode per round trip

double turn_of(std::complex<double> factor) {
  double const angle = std::arg(factor);
  return angle < 0 ? angle + 2 * pi : angle;
}

AxisMatrix one_axis(RayMatrix const& m, int axis) {
  return AxisMatrix{{m(axis, axis), m(axis, axis + 2)}, {m(axis + 2, axis), m(axis + 2, axis + 2)}};
}

// The same rays with offset and slope in units that make them alike in size.
RayMatrix scaled(RayMatrix const& m, double unit_length) {
  Eigen::Vector4d const units{1, 1, 1 / unit_length, 1 / unit_length};
  return units.cwiseInverse().asDiagonal() * m * units.asDiagonal();
}
double unit_length(RayMatrix const& m) {
  double const b = m.topRightCorner<2, 2>().norm(), c = m.bottomLeftCorner<2, 2>().norm();
  return b > 0 && c > 0 ? std::sqrt(b / c) : 1;
}

bool independent_axes(RayMatrix const& m) {
  double coupling = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if ((i + j) % 2) coupling = std::max(coupling, std::fabs(m(i, j)));
  return coupling <= unrelated * m.norm();
}

RayEigenmode coupled_eigenmode(RayMatrix const& round_trip, double size) {
  Eigen::EigenSolver<RayMatrix> const solver(scaled(round_trip, size));
  Eigen::Matrix2cd offset, slope;
  RayEigenmode found;
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    // Of each pair of conjugate rays the one of a beam: Im of offset* slope is positive, as Im Q is.
    Eigen::Vector4cd const ray = solver.eigenvectors().col(i);
    if (!(ray.head<2>().dot(ray.tail<2>()).imag() > 0)) continue;
    if (count == 2) throw NumericalError("the eigenmode of the cavity is not unique: two of its phases are opposite");
    offset.col(count) = ray.head<2>();
    slope.col(count) = ray.tail<2>() / size;
    found.gouy[static_cast<std::size_t>(count++)] = turn_of(solver.eigenvalues()(i));
  }
  if (count != 2) throw NumericalError("the eigenmode of the cavity is not unique: two of its phases are opposite");
  found.n_q = slope * offset.inverse();
  found.n_q = (0.5 * (found.n_q + found.n_q.transpose())).eval();
  return found;
}

}  // namespace

std::string instability(AxisMatrix const& m) {
  double const half_trace = 0.5 * m.trace();
  if (std::fabs(half_trace) < 1 - edge) return {};
  return fmt::format("half the trace of the round-trip matrix is {:.6g}, must lie between -1 and 1", half_trace);
}

std::string instability(RayMatrix const& m) {
  RayMatrix const round_trip = scaled(m, unit_length(m));
  if (independent_axes(round_trip)) {
    for (int axis = 0; axis < 2; ++axis)
      if (auto const why = instability(one_axis(m, axis)); !why.empty())
        return fmt::format("{} axis: {}", axis == 0 ? "first" : "second", why);
    return {};
  }
  Eigen::EigenSolver<RayMatrix> const solver(round_trip, false);
  double const largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  if (largest < 1 + growth) return {};
  return fmt::format("the axes are coupled and a ray grows by a factor of {:.6g} per round trip", largest);
}

AxisEigenmode eigenmode(AxisMatrix const& m) {
  if (auto const why = instability(m); !why.empty()) throw NumericalError("the cavity is unstable: " + why);
  // q = (A q + B)/(C q + D), z_R > 0.
  double const half_trace = 0.5 * m.trace(), root = std::sqrt(1 - half_trace * half_trace);
  BeamParameter const q = BeamParameter(0.5 * (m(0, 0) - m(1, 1)), std::copysign(root, m(1, 0))) / m(1, 0);
  return {q, turn_of({half_trace, std::copysign(root, m(0, 1))})};
}

RayEigenmode eigenmode(RayMatrix const& m) {
  if (auto const why = instability(m); !why.empty()) throw NumericalError("the cavity is unstable: " + why);
  double const size = unit_length(m);
  RayEigenmode found;
  if (independent_axes(scaled(m, size))) {
    AxisEigenmode const x = eigenmode(one_axis(m, 0)), y = eigenmode(one_axis(m, 1));
    found.n_q << std::conj(1.0 / x.q), 0, 0, std::conj(1.0 / y.q);
    found.gouy = {x.gouy, y.gouy};
  } else {
    found = coupled_eigenmode(m, size);
  }
  if (!((transformed(m, found.n_q) - found.n_q).norm() < repeats * found.n_q.norm()))
    throw NumericalError("the eigenmode of the cavity is not unique: the phases of two axes are equal or opposite");
  return found;
}

CavityEigenmode cavity_eigenmode(Mode const& start, double index, std::span<OpticalElement const> elements) {
  Mode any = start;  // of any curvature: only rays are followed
  any.q11 = any.q22 = {0, 1};
  any.q12 = 0;
  BeamPath path = follow(any, index, elements);
  double const off = length(path.mode.origin - start.origin), turned = length(path.mode.travel - start.travel);
  if (!(off <= 1e-7 * path.optical_length && turned < 1e-7))
    throw NumericalError(
        fmt::format("the elements do not close a round trip: the chief ray ends {:.3g} m and {:.3g} rad from its start",
                    off, turned));
  // From the frame that comes back to that of the start.
  Mode const& end = path.mode;
  AxisMatrix const same{{dot(start.e1, end.e1), dot(start.e1, end.e2)}, {dot(start.e2, end.e1), dot(start.e2, end.e2)}};
  RayMatrix turn = RayMatrix::Zero();
  turn.topLeftCorner<2, 2>() = same;
  turn.bottomRightCorner<2, 2>() = same;
  RayEigenmode const found = eigenmode(RayMatrix(turn * path.rays));

  CavityEigenmode cavity;
  cavity.gouy = found.gouy;
  cavity.mode = start;
  cavity.mode.q11 = found.n_q(0, 0) / index;
  cavity.mode.q12 = found.n_q(0, 1) / index;
  cavity.mode.q22 = found.n_q(1, 1) / index;
  path = follow(cavity.mode, index, elements);
  cavity.tem00_gouy = path.gouy;
  cavity.optical_length = path.optical_length;
  return cavity;
}

}  // namespace straytrace::beams
