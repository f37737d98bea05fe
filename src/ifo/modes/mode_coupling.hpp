// SPDX-License-Identifier: BSD-3-Clause
// Coupling of Hermite-Gauss modes where a beam meets another basis, a tilted or curved mirror or a stop
// (docs/theory/interferometer.md, eq. N.6 to N.11).
#pragma once

#include <Eigen/Core>

#include <array>
#include <complex>

namespace straytrace::ifo {

// Modes u_nm with n + m <= order, by rising n + m, of one sum by rising m: 00, 10, 01, 20, 11, 02, ...
inline int mode_count(int order) { return (order + 1) * (order + 2) / 2; }
inline int mode_index(int n, int m) { return (n + m) * (n + m + 1) / 2 + m; }

// One axis. Complex curvatures 1/RoC + i wavelength/(pi w^2) in 1/m at the surface, for fields that run as
// exp(i k z - i omega t): RoC > 0 diverges.
struct AxisCoupling {
  std::complex<double> in, out;
  double kick =
      0;  // kappa, rad/m: transverse wave number that the surface adds (2 k alpha of a mirror tilted by alpha)
  double shift = 0;  // d, m: of the axis of the incoming basis from that of the outgoing one
};

// K(n, m) for n, m <= order: amplitude of the outgoing mode n for the incoming mode m (N.6). The modes of an axis are
// real but for the curvature of the wavefront: no Gouy phase is in K. `wave_number` in rad/m, in the medium.
// NumericalError unless both curvatures have a positive imaginary part.
Eigen::MatrixXcd axis_coupling(AxisCoupling const&, double wave_number, int order);

// Product of two axes for the modes n + m <= order.
Eigen::MatrixXcd mode_coupling(AxisCoupling const& x, AxisCoupling const& y, double wave_number, int order);

// Stop of radius `radius`, open inside, its centre at `offset` along x and y from the axis of the beam; all in m.
struct CircularStop {
  double radius = 0;
  std::array<double, 2> offset{};
};

// Amplitudes that pass the stop, for radii w of the beam along x and y in m, at the same basis on both sides (N.11).
Eigen::MatrixXd stop_coupling(CircularStop const&, std::array<double, 2> w, int order);

}  // namespace straytrace::ifo
