// SPDX-License-Identifier: BSD-3-Clause
// Routes whose static phase is known (docs/theory/spectra.md, "A static phase that is known", eq. N.26).
#pragma once

#include <complex>
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

// The routes that the body of settings.scanned gives its phases; empty where none is scanned. Throws as known_phases,
// and where a stated phase and the scanned body meet on one route.
std::vector<bool> scanned_routes(CouplingTable const&, MotionSet const&, NoiseSettings const&,
                                 ifo::Interferometer const&);

// S'_p/S_p per bin, of modulus 1 at most: exp(2i phi_0) S'/S has as its real part what the static phase takes from Im s
// and adds to Re s, and as its imaginary part the cross spectrum of both over S. It is real where no amplitude moves.
// Of at most `representatives` kept paths, equally many shares of the power of the route in the order of their
// strength.
std::vector<std::complex<double>> phase_relation(PhaseSpectra const&, MotionSet const&, CouplingClass const&);
constexpr std::size_t representatives = 64;

}  // namespace straytrace::noise
