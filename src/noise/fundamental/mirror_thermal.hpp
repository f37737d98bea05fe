// SPDX-License-Identifier: BSD-3-Clause
// Thermal noise of substrates: mirrors of finite size under a centred Gaussian beam. Displacement PSD of one mirror,
// m^2/Hz, one-sided; w is the 1/e^2 intensity radius in m.
#pragma once

#include "noise/fundamental/detector.hpp"

namespace straytrace {

struct MirrorShape {
  double radius, thickness;  // m
};

// Strain energy per force squared of a static Gaussian pressure, J/N^2 (Bondu, Hello and Vinet 1998; Liu and Thorne
// 2000): S_x = 8 kT phi U/w; half space for a radius and thickness much larger than w: eq. 12.7.
double strain_energy(SubstrateMaterial const&, MirrorShape, double w);
double substrate_brownian_psd(SubstrateMaterial const&, MirrorShape, double w, double hz);
// Liu and Thorne 2000, eq. 46; heat that flows away during a period as in a half space (Cerdonio et al. 2001): cold
// crystals.
double substrate_thermoelastic_psd(SubstrateMaterial const&, MirrorShape, double w, double hz);
// Optical path of one pass through the substrate, m^2/Hz (Braginsky and Vyatchanin 2004, eq. E7): at all frequencies.
double substrate_thermorefractive_psd(SubstrateMaterial const&, double thickness, double w, double hz);

// Zeros of the Bessel function J1, ascending, and J0 there.
struct BesselZeros {
  std::vector<double> zero, j0;
};
BesselZeros const& bessel_zeros();

}  // namespace straytrace
