// SPDX-License-Identifier: BSD-3-Clause
// Effect of uncertain scatter and uncertain motion on the total (docs/theory/errors.md).
#pragma once

#include "noise/bands/composition.hpp"

namespace straytrace::noise {

// Fills the input band of the total and of each route, its sources and `taken_as_exact`. Brackets of all materials go
// to their low ends together and to their high ends together; standard deviations of materials and of motions combine
// in quadrature of their logarithms. Motion is projected anew with each uncertain body at its low and high end. NaN
// where routes of unknown composition exceed composition_limit: of a row, or of the total.
void add_input_band(NoiseBudget&, CouplingTable const&, MotionSet const&, Interferometer const&, NoiseSettings const&,
                    std::vector<MaterialSpread> const&);

}  // namespace straytrace::noise
