// SPDX-License-Identifier: BSD-3-Clause
// Routes whose static phase is known (docs/theory/spectra.md, "A static phase that is known", eq. N.26).
#pragma once

#include <optional>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Static phase of each route, rad; nothing where it is random. A body with a stated phase gives it to every route whose
// phase its motion changes. Throws InputError where two such bodies move a route, and for a port of several copies.
// Computed routes (edges, halo, ghosts whose fields add) keep random phases.
std::vector<std::optional<double>> known_phases(CouplingTable const&, MotionSet const&, std::vector<StaticPhase> const&,
                                                ifo::Interferometer const&);

// S'_p/S_p per bin, between -1 and 1: what the static phase takes from Im s and adds to Re s, times cos 2 phi_0. Of at
// most `representatives` kept paths, equally many shares of the power of the route in the order of their strength.
std::vector<double> phase_relation(PhaseSpectra const&, MotionSet const&, CouplingClass const&);
constexpr std::size_t representatives = 64;

}  // namespace straytrace::noise
