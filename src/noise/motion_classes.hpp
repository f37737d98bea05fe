// SPDX-License-Identifier: BSD-3-Clause
// Independent inputs of the motion grouped by the shape of their spectrum: the phase of a path then depends on its
// levers through one number per class.
#pragma once

#include <span>
#include <vector>

#include "motion/motion.hpp"

namespace straytrace {

// The phase of a path has the PSD kappa * reference from this class, kappa of either sign as long as that of all
// classes together is a PSD; for a tone its square peak amplitude is z^2 = kappa (physics.md eq. 1.10, 7.11); for a
// drift kappa is the square of its steady rate [rad^2/s^2].
struct MotionClass {
  Spectrum reference;                                   // m^2/Hz
  double tone_frequency = 0;                            // Hz; > 0: a tone
  std::vector<std::pair<std::size_t, double>> members;  // input, its PSD over the reference
  bool drift = false;                                   // constant velocity

  // Mean-square phase per unit of kappa; a drift is no motion about a mean.
  double variance() const { return drift ? 0 : tone_frequency > 0 ? 0.5 : reference.total(); }
};

std::vector<MotionClass> group_by_shape(MotionSet const&);

// One number per class. Equal levers of two bodies on one input cancel or add here, before anything is squared.
std::vector<double> kappa_of(MotionSet const&, std::vector<MotionClass> const&, std::span<Lever const>);

}  // namespace straytrace
