// SPDX-License-Identifier: BSD-3-Clause
// Effect of uncertain scatter and uncertain motion on the total (docs/theory/errors.md).
#pragma once

#include "noise/noise.hpp"

namespace straytrace::noise {

// Uncertainty of a material, as ratios to the traced value, and the groups that have it.
struct MaterialSpread {
  std::string name, status;
  double low = 1, high = 1;  // bracket: a range
  double factor = 1;         // one standard deviation of the logarithm
  bool of_reflection = false;
  std::vector<GroupId> groups;
};

// Number of scatters of a route on the material (of reflections, for its reflectance).
int scatters_on(MaterialSpread const&, std::vector<PathStep> const& steps);

// Factor on the coupling of a class when the BRDF of the material is `ratio` times the traced value: ratio^scatters.
// For a row `other` or a coherent family: the mean over its named routes by coupling; `ratio` when none has a name.
double coupling_factor(MaterialSpread const&, CouplingClass const&, double ratio);
// Whether that is also the factor on its noise. A row `other` names its largest routes by coupling, while fainter ones
// on moving surfaces may make its noise: it is known only where all its routes scatter equally often on the material.
bool composition_known(MaterialSpread const&, CouplingClass const&);
// Share of the PSD from which rows of unknown composition leave the effect of a material on the total unknown.
constexpr double composition_limit = 0.1;

// Fills the input band of the total and of each route, its sources and `taken_as_exact`. Brackets of all materials go
// to their low ends together and to their high ends together; standard deviations of materials and of motions combine
// in quadrature of their logarithms. Motion is projected anew with each uncertain body at its low and high end. NaN in
// rows of unknown composition, and in the total where these exceed composition_limit.
void add_input_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&, NoiseSettings const&,
                    std::vector<MaterialSpread> const&);

}  // namespace straytrace::noise
