// SPDX-License-Identifier: BSD-3-Clause
// Motion of a rim in the main beam as noise (docs/theory/diffraction.md, eq. N.21): a real stray field
// s = -d (1 - first . x - 1/2 sum over second of +-(second . x)^2), no static phase to average over.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "motion/motion.hpp"
#include "noise/project/route_noise.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

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
