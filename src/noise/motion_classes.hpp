// SPDX-License-Identifier: BSD-3-Clause
// Independent inputs of the motion grouped by the shape of their spectrum: the phase of a path then depends on its
// levers through one number per class.
#pragma once

#include <span>
#include <vector>

#include "motion/motion.hpp"

namespace straytrace {

// The phase of a path has the PSD kappa * reference from this class; for a tone its square peak amplitude is
// z^2 = kappa (physics.md eq. 1.10, 7.11).
struct MotionClass {
  Spectrum reference;                                   // m^2/Hz
  double tone_frequency = 0;                            // Hz; > 0: a tone
  std::vector<std::pair<std::size_t, double>> members;  // input, its PSD over the reference

  // Mean-square phase per unit of kappa.
  double variance() const { return tone_frequency > 0 ? 0.5 : reference.total(); }
};

std::vector<MotionClass> group_by_shape(MotionSet const&);

// One number per class. Equal levers of two bodies on one input cancel or add here, before anything is squared.
std::vector<double> kappa_of(MotionSet const&, std::vector<MotionClass> const&, std::span<Lever const>);

}  // namespace straytrace
