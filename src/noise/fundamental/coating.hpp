// SPDX-License-Identifier: BSD-3-Clause
// Multilayer coatings: reflection, Brownian and thermo-optic noise. Displacement PSD of one mirror, m^2/Hz, one-sided.
#pragma once

#include <complex>
#include <vector>

#include "noise/fundamental/detector.hpp"

namespace straytrace::noise {
// Thermal noise of substrates: mirrors of finite size under a centred Gaussian beam. Displacement PSD of one mirror,
// m^2/Hz, one-sided; w is the 1/e^2 intensity radius in m.

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

// Alternating layers, low index first, on the substrate. Thickness over the wavelength in the layer.
struct CoatingStack {
  std::vector<double> layers;
  CoatingMaterial low, high;
  SubstrateMaterial substrate;
  double wavelength;  // m, in vacuum

  CoatingMaterial const& material(std::size_t i) const { return i % 2 == 0 ? low : high; }
  double thickness(std::size_t i) const { return layers[i] * wavelength / material(i).index; }  // m
};

// As given, or doublets under a cap whose last layer is trimmed so that the transmission is reached.
CoatingStack coating_stack(Detector const&, CoatedMirror const&);

struct StackReflection {
  std::complex<double> amplitude;               // seen from the vacuum
  std::vector<std::complex<double>> log_slope;  // d ln(amplitude)/d(one-way phase) of each layer
};
StackReflection reflection(CoatingStack const&);

// Hong et al. 2013 with equal losses in bulk and shear and without photo-elastic effect.
double coating_brownian_psd(CoatingStack const&, double w, double hz);
// Evans et al. 2008 (thick coatings), mirrors of finite size after Braginsky and Vyatchanin 2003.
class CoatingThermoOptic {
 public:
  CoatingThermoOptic(CoatingStack const&, MirrorShape, double w);
  double psd(double hz) const;

 private:
  double elastic_, refractive_;  // m/K
  double thickness_, heat_, conductivity_;
  SubstrateMaterial substrate_;
  double w_;
};

}  // namespace straytrace::noise
