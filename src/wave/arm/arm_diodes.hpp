// SPDX-License-Identifier: BSD-3-Clause
// What the photodiodes of a table `wave` are expected to receive, over mirrors whose heights are not known
// (docs/theory/wave.md, eq. W.17, W.40 to W.43).
#pragma once

#include <Eigen/Core>

#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/diodes/halo.hpp"

namespace straytrace::wave {

// Puts those of the table into the frame of a cavity with its mirrors and edges; their planes are to hold the light
// that meets them, and without a stated crossover angle the grid as well. A problem where their screen is not between
// the mirrors.
void place_diodes(WaveSettings const&, ArmCavity&);

// Of the light that reaches the farthest point of a diode from the mirror that it comes from, rad. The grid holds it up
// to the crossover angle.
double diode_angle(ArmCavity const&, Photodiode const&);

struct DiodeExpectation {
  std::vector<Photodiode> diodes;
  Eigen::VectorXd smooth;  // without the light that unknown heights scatter; over the power of the mode
  HaloStatistics halo;
};
// Solves the cavity with its stated heights alone. Throws as arm_cavity, and InputError where it has no mode.
DiodeExpectation expected_on_diodes(World const&, WaveSettings const&, HaloMoments, Computing);

}  // namespace straytrace::wave
