// SPDX-License-Identifier: BSD-3-Clause
#include "beams/ray_matrix.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include "base/errors.hpp"

namespace straytrace::beams {

RayMatrix both_axes(AxisMatrix const& x, AxisMatrix const& y) {
  RayMatrix m = RayMatrix::Zero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      m(2 * i, 2 * j) = x(i, j);
      m(2 * i + 1, 2 * j + 1) = y(i, j);
    }
  return m;
}

namespace {

constexpr double miss = 1e-7;  // of the distance flown: the curvature is that at the point

RayMatrix ray_flight(double length, double n) {
  AxisMatrix const axis{{1, length / n}, {0, 1}};
  return both_axes(axis, axis);
}

RayMatrix ray_face(FaceMap const& face) {
  Eigen::Matrix2d const from = face.before.inverse(), to = face.after.inverse().transpose();
  RayMatrix m = RayMatrix::Zero();
  m.topLeftCorner<2, 2>() = face.after * from;
  m.bottomLeftCorner<2, 2>() = to * face.power * from;
  m.bottomRightCorner<2, 2>() = to * face.before.transpose();
  return m;
}

}  // namespace

Eigen::Matrix2cd transformed(RayMatrix const& m, Eigen::Matrix2cd const& n_q) {
  Eigen::Matrix2cd const offset = m.topLeftCorner<2, 2>() + m.topRightCorner<2, 2>() * n_q;
  Eigen::Matrix2cd const slope = m.bottomLeftCorner<2, 2>() + m.bottomRightCorner<2, 2>() * n_q;
  return slope * offset.inverse();
}

OpticalElement spherical_mirror(Vec3 point, Vec3 normal, double roc) {
  Frame const f = Frame::around(normal);
  return {point, normal, {f.e1, f.e2, 1 / roc, 0, 1 / roc}, true, 1};
}

std::vector<OpticalElement> mirrors_through(std::span<Vec3 const> points, std::span<double const> roc, bool closed) {
  std::vector<OpticalElement> mirrors;
  std::size_t const n = points.size(), count = closed ? n : n - 2;
  for (std::size_t i = 1; i <= count; ++i) {
    Vec3 const here = points[i % n], before = points[i - 1], after = points[(i + 1) % n];
    mirrors.push_back(spherical_mirror(here, unit(unit(before - here) + unit(after - here)), roc[i % n]));
  }
  return mirrors;
}

BeamPath follow(Mode const& start, double index, std::span<OpticalElement const> elements) {
  BeamPath path;
  path.mode = start;
  path.index = index;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    OpticalElement const& e = elements[i];
    Mode const& from = path.mode;
    double const distance = dot(e.point - from.origin, from.travel);
    double const off = length(e.point - from.origin - distance * from.travel);
    if (!(distance >= 0 && off <= miss * distance))
      throw NumericalError(fmt::format("element {} of the path: the chief ray passes it at {:.3g} m, {:.6g} m on",
                                       i + 1, off, distance));
    path.gouy += gouy(from, distance);
    path.optical_length += path.index * distance;
    Mode arriving = propagated(from, distance);
    arriving.origin = e.point;
    double const after = e.reflects ? path.index : e.index_after;
    FaceMap const face = e.reflects
                             ? mirror_face(from.e1, from.e2, from.travel, e.normal, e.curvature, after)
                             : refracting_face(from.e1, from.e2, from.travel, e.normal, e.curvature, path.index, after);
    path.rays = (ray_face(face) * ray_flight(distance, path.index) * path.rays).eval();
    path.mode = e.reflects ? reflected(arriving, e.normal, e.curvature)
                           : refracted(arriving, e.normal, e.curvature, path.index, after);
    path.index = after;
    path.arriving.push_back(arriving);
  }
  return path;
}

}  // namespace straytrace::beams
