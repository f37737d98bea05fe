// SPDX-License-Identifier: BSD-3-Clause
// Eigenmodes of two-mirror cavities: in closed form, and with round openings between the mirrors. Any other:
// beams/eigenmode.hpp.
#pragma once

#include <complex>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::beams {

// Eigenmode of a two-mirror cavity in closed form (docs/theory/beams.md, eq. 6.3). Any other: beams/eigenmode.hpp.

// Two mirrors at distance `length`; RoC > 0 when concave towards each other, infinite when flat. Lengths in m.
struct CavityMode {
  double g1 = 0, g2 = 0;             // 1 - L/RoC
  double w1 = 0, w2 = 0, waist = 0;  // 1/e^2 intensity radii at the mirrors and at the waist, m
  double waist_position = 0;         // m from mirror 1
  double gouy = 0;                   // one-way Gouy phase, rad
  double rayleigh = 0;               // m
};
// eq. 6.3. Throws NumericalError unless 0 < g1 g2 < 1 by 1e-9 at least.
CavityMode cavity_mode(double length, double roc1, double roc2, double wavelength);

// Eigenmodes of a cavity of two round mirrors with round openings between, all on one axis, with the light that their
// rims take: scalar, paraxial, by the Hankel transform of each leg (docs/theory/beams.md, eq. W.8 and W.10).

struct RoundOpening {
  double place = 0;   // m along the axis from mirror 1
  double radius = 0;  // m
};
struct RoundCavity {
  double wavelength = 0;                  // m
  double curvature1 = 0, curvature2 = 0;  // 1/RoC of the mirrors, positive when concave towards each other. 1/m
  std::vector<RoundOpening> openings;     // in order of place; the first and the last are the mirrors

  double length() const { return openings.back().place - openings.front().place; }
};

// A mode that varies as exp(i l phi) about the axis.
struct RoundMode {
  int radial = 0, azimuthal = 0;  // p and l of the Laguerre-Gauss mode that it resembles most
  // Amplitude after a round trip without transmission over that before, without exp(2ikL).
  std::complex<double> eigenvalue;
  double loss() const { return 1 - std::norm(eigenvalue); }  // of power per round trip; rounding is some 1e-13
};

// Largest radius squared over wavelength and length of a leg: the quadrature takes some 6 nodes per unit.
double fresnel_number(RoundCavity const&);
constexpr double largest_fresnel_number = 30;

// The modes p = 0 ... count - 1 of one l >= 0. A cavity whose modes do not resemble Laguerre-Gauss modes (g1 g2 not
// between 0 and 1, or rims too narrow) has them in the order of their loss. NumericalError beyond
// `largest_fresnel_number`.
std::vector<RoundMode> round_modes(RoundCavity const&, int azimuthal, int count);

}  // namespace straytrace::beams
