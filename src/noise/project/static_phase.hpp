// SPDX-License-Identifier: BSD-3-Clause
// Stray fields whose static phase is known: routes, and rims in the main beam.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "motion/motion.hpp"
#include "noise/noise.hpp"
#include "noise/project/route_noise.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Routes whose static phase is known (docs/theory/spectra.md, "A static phase that is known", eq. N.26).

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

// Motion of a rim in the main beam as noise (docs/theory/diffraction.md, eq. N.21): a real stray field
// s = -d (1 - first . x - 1/2 sum over second of +-(second . x)^2), no static phase to average over.

// One-sided PSD of Re s [1/Hz] per bin, both orders; `linear`: the first. Im s is zero. Motion is Gaussian or tones;
// what drifts moves no power.
RouteSpectrum rim_spectrum(PhaseSpectra const&, MotionSet const&, CouplingClass const&);

// PSD per bin of 1/2 sum over directions of sign y^2, y = direction . x: 1/4 sum_ab sign_a sign_b (S_ab * S_ab), with
// the one-sided cross spectra S_ab of y_a and y_b and their convolution over frequencies of both signs. The square of a
// tone alone has half of that.
Bins squared_motion(PhaseSpectra const&, MotionSet const&, std::span<std::vector<PhaseSensitivity> const> directions,
                    std::span<double const> signs);

// The terms of s in the records of a class.
struct RimTerms {
  PathRecord const* first = nullptr;  // its weight is d^2
  std::vector<PathRecord const*> second;
  std::vector<double> sign;
};
RimTerms rim_terms(CouplingClass const&);

// Of rims in the main beam of a port whose response to the amplitude of that beam is not known.
InputError without_passing_amplitude(std::string const& port);

}  // namespace straytrace::noise
