// SPDX-License-Identifier: BSD-3-Clause
// Effect of uncertain scatter and uncertain motion on the total (docs/theory/errors.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "noise/bands/composition.hpp"

namespace straytrace::noise {

// Fills the input band of the total and of each route, its sources and `taken_as_exact`. Brackets of all materials go
// to their low ends together and to their high ends together; standard deviations of materials and of motions combine
// in quadrature of their logarithms. Motion is projected anew with each uncertain body at its low and high end. NaN
// where routes of unknown composition exceed composition_limit: of a row, or of the total.
void add_input_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&, NoiseSettings const&,
                    std::vector<MaterialSpread> const&);

// Inputs of motion that move the same bodies: they come from one measurement and are varied together.
struct MotionCause {
  std::string name;                 // "motion of tube, tower"
  std::vector<std::size_t> inputs;  // of the motion set
  double uncertainty = 1;           // largest of them: one sigma, factor on the ASD
};
std::vector<MotionCause> motion_causes(MotionSet const&);
// The ASD of each input of a cause times `factor` of its own uncertainty.
MotionSet with_scaled_inputs(MotionSet const&, MotionCause const&,
                             std::function<double(double uncertainty)> const& factor);

}  // namespace straytrace::noise
