// SPDX-License-Identifier: BSD-3-Clause
#include "beams/closed_axis.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "beams/eigenmode.hpp"

namespace straytrace::beams {
namespace {

constexpr int most_steps = 40;
constexpr double settled = 1e-12;   // step over the length of the way
constexpr double singular = 1e-9;   // smallest pivot over the largest: the axis is not determined
constexpr double collinear = 1e-6;  // sine of the angle between legs below which they have no plane

// A mirror in its own coordinates: x and y from its vertex.
struct Face {
  SphericalMirror mirror;
  Frame frame;

  explicit Face(SphericalMirror const& m) : mirror(m), frame(Frame::around(m.axis)) {}
  double root(double x, double y) const {
    double const square = 1 - mirror.curvature * mirror.curvature * (x * x + y * y);
    if (!(square > 0)) throw NumericalError("no ray closes on itself: it passes beside a mirror");
    return std::sqrt(square);
  }
  Vec3 point(double x, double y) const {
    double const sag = mirror.curvature * (x * x + y * y) / (1 + root(x, y));
    return mirror.vertex + x * frame.e1 + y * frame.e2 + sag * mirror.axis;
  }
  std::array<Vec3, 2> tangents(double x, double y) const {
    double const slope = mirror.curvature / root(x, y);
    return {frame.e1 + (slope * x) * mirror.axis, frame.e2 + (slope * y) * mirror.axis};
  }
};

struct Way {
  std::vector<Face> faces;

  std::vector<Vec3> points(Eigen::VectorXd const& at) const {
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < faces.size(); ++i)
      all.push_back(faces[i].point(at[2 * Eigen::Index(i)], at[2 * Eigen::Index(i) + 1]));
    return all;
  }
  // Of the length of the closed way.
  Eigen::VectorXd gradient(Eigen::VectorXd const& at) const {
    std::vector<Vec3> const p = points(at);
    std::size_t const n = p.size();
    Eigen::VectorXd g(2 * Eigen::Index(n));
    for (std::size_t i = 0; i < n; ++i) {
      auto const k = 2 * Eigen::Index(i);
      Vec3 const both = unit(p[i] - p[(i + n - 1) % n]) + unit(p[i] - p[(i + 1) % n]);
      auto const [along_x, along_y] = faces[i].tangents(at[k], at[k + 1]);
      g[k] = dot(both, along_x);
      g[k + 1] = dot(both, along_y);
    }
    return g;
  }
  double length_of(std::vector<Vec3> const& p) const {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += length(p[(i + 1) % p.size()] - p[i]);
    return sum;
  }
};

// The plane of the two legs that enclose the largest angle.
Vec3 plane_of(std::vector<Vec3> const& legs) {
  Vec3 normal{};
  for (std::size_t i = 0; i < legs.size(); ++i) {
    Vec3 const across = cross(legs[i], legs[(i + 1) % legs.size()]);
    if (length(across) > length(normal)) normal = across;
  }
  if (length(normal) < collinear) {
    Vec3 const up = std::fabs(legs[0].y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    normal = up - dot(up, legs[0]) * legs[0];
  }
  normal = unit(normal);
  double largest = normal.x;
  for (double c : {normal.y, normal.z})
    if (std::fabs(c) > std::fabs(largest)) largest = c;
  return largest < 0 ? -normal : normal;
}

}  // namespace

std::vector<Vec3> closed_axis(std::span<SphericalMirror const> mirrors) {
  Way way;
  for (SphericalMirror const& m : mirrors) way.faces.emplace_back(m);
  auto const unknowns = 2 * Eigen::Index(mirrors.size());
  Eigen::VectorXd at = Eigen::VectorXd::Zero(unknowns);
  double const scale = way.length_of(way.points(at)), step = 1e-5 * scale / double(mirrors.size());
  if (!(scale > 0)) throw NumericalError("the mirrors are all at one place");
  for (int i = 0; i < most_steps; ++i) {
    Eigen::MatrixXd second(unknowns, unknowns);
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      Eigen::VectorXd more = at, less = at;
      more[k] += step;
      less[k] -= step;
      second.col(k) = (way.gradient(more) - way.gradient(less)) / (2 * step);
    }
    Eigen::FullPivLU<Eigen::MatrixXd> const solver(second);
    Eigen::VectorXd const pivots = solver.matrixLU().diagonal().cwiseAbs();
    if (!(pivots.minCoeff() > singular * pivots.maxCoeff()))
      throw NumericalError("no single ray closes on itself: the mirrors do not determine the axis");
    Eigen::VectorXd const change = solver.solve(way.gradient(at));
    if (!change.allFinite()) break;
    at -= change;
    if (change.cwiseAbs().maxCoeff() < settled * scale) return way.points(at);
  }
  throw NumericalError("no ray near the vertices of the mirrors closes on itself");
}

ClosedCavity closed_cavity(std::span<SphericalMirror const> mirrors, double wavelength) {
  std::vector<Vec3> const points = closed_axis(mirrors);
  std::size_t const n = points.size();
  std::vector<double> roc;
  for (SphericalMirror const& m : mirrors) roc.push_back(1 / m.curvature);
  std::vector<Vec3> legs;
  for (std::size_t i = 0; i < n; ++i) legs.push_back(unit(points[(i + 1) % n] - points[i]));
  ClosedCavity cavity;
  cavity.normal = plane_of(legs);
  for (Vec3 const& leg : legs) cavity.out_of_plane = std::fmax(cavity.out_of_plane, std::fabs(dot(leg, cavity.normal)));
  Mode const any = elliptic_mode(points[0], unit(cross(cavity.normal, legs[0])), legs[0], {1, 1}, {0, 0}, wavelength);
  std::vector<OpticalElement> const elements = mirrors_through(points, roc, true);
  CavityEigenmode const found = cavity_eigenmode(any, 1, elements);
  cavity.start = found.mode;
  cavity.gouy = found.gouy;
  cavity.length = found.optical_length;
  cavity.arriving = follow(found.mode, 1, elements).arriving;
  std::rotate(cavity.arriving.begin(), cavity.arriving.end() - 1, cavity.arriving.end());
  return cavity;
}

std::complex<double> curvature_along(Mode const& mode, Vec3 across) {
  double const x = dot(across, mode.e1), y = dot(across, mode.e2);
  return x * x * mode.q11 + 2 * x * y * mode.q12 + y * y * mode.q22;
}

}  // namespace straytrace::beams
