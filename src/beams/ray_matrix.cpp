// SPDX-License-Identifier: BSD-3-Clause
#include "beams/ray_matrix.hpp"

#include <Eigen/LU>

namespace straytrace {

AxisMatrix axis_flight(double length, double n) { return AxisMatrix{{1, length / n}, {0, 1}}; }
AxisMatrix axis_mirror(double roc) { return axis_lens(roc / 2); }
AxisMatrix axis_lens(double focal_length) { return AxisMatrix{{1, 0}, {-1 / focal_length, 1}}; }
AxisMatrix axis_face(double roc, double n_before, double n_after) {
  return AxisMatrix{{1, 0}, {(n_after - n_before) / roc, 1}};
}

RayMatrix both_axes(AxisMatrix const& x, AxisMatrix const& y) {
  RayMatrix m = RayMatrix::Zero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      m(2 * i, 2 * j) = x(i, j);
      m(2 * i + 1, 2 * j + 1) = y(i, j);
    }
  return m;
}

RayMatrix ray_flight(double length, double n) { return both_axes(axis_flight(length, n), axis_flight(length, n)); }

RayMatrix ray_face(FaceMap const& face) {
  Eigen::Matrix2d const from = face.before.inverse(), to = face.after.inverse().transpose();
  RayMatrix m = RayMatrix::Zero();
  m.topLeftCorner<2, 2>() = face.after * from;
  m.bottomLeftCorner<2, 2>() = to * face.power * from;
  m.bottomRightCorner<2, 2>() = to * face.before.transpose();
  return m;
}

BeamParameter transformed(AxisMatrix const& m, BeamParameter q) {
  return (m(0, 0) * q + m(0, 1)) / (m(1, 0) * q + m(1, 1));
}
double beam_radius(BeamParameter q, double wavelength) { return std::sqrt(-wavelength / (pi * std::imag(1.0 / q))); }
double wavefront_curvature(BeamParameter q) { return std::real(1.0 / q); }

Eigen::Matrix2cd transformed(RayMatrix const& m, Eigen::Matrix2cd const& n_q) {
  Eigen::Matrix2cd const offset = m.topLeftCorner<2, 2>() + m.topRightCorner<2, 2>() * n_q;
  Eigen::Matrix2cd const slope = m.bottomLeftCorner<2, 2>() + m.bottomRightCorner<2, 2>() * n_q;
  return slope * offset.inverse();
}

}  // namespace straytrace
