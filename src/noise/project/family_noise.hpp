// SPDX-License-Identifier: BSD-3-Clause
// A coherent family turned into the spectrum of Im s at its port (docs/theory/ghosts.md, eq. 10.5).
#pragma once

#include "noise/project/route_noise.hpp"
#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace {

// PSD of a class whose records add as fields, their common phase averaged: own terms and cross terms. Exact, without
// replicas. `mean_square_phase`: of its records, rad^2. The two states of polarisation add in power, as their shares
// do.
RouteSpectrum family_spectrum(PhaseSpectra const&, MotionSet const&, CouplingClass const&,
                              std::span<double const> mean_square_phase);

}  // namespace straytrace
