// SPDX-License-Identifier: BSD-3-Clause
// Diffraction at rims between the mirrors of a cavity: light scattered at a small angle by one mirror, clipped by an
// edge, rejoins the mode at the other (docs/theory/diffraction.md, eq. 8.11 to 8.14). The walk does not include it: it
// follows light that a surface absorbs, reflects or scatters. This wave arises because the baffle blocks light, and is
// independent of its material.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "trace/coupling.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::trace {

// Coupling by one rim from footprint `source` to footprint `goal`. `amplitude`: recoupled field over that of the mode,
// its phase against the straight way from mirror to mirror. `gradient`: its derivative by the six coordinates of each
// body and the moment over the delays, as those of a Phase sensitivity.
struct EdgeWave {
  struct Gradient {
    BodyId body;
    std::complex<double> d[6] = {}, moment[6] = {};
  };
  std::complex<double> amplitude;
  std::vector<Gradient> gradient;
  double smooth = 0;              // amplitude of a centred rim without teeth, J0 = 1
  double path_length = 0;         // m, mean over the rim
  double seen = 0;                // part of the rim that both mirrors see
  double patches = 0;             // of speckle around the rim: 2 pi a w/(lambda l), at the mirror where there are more
  std::vector<PathRecord> teeth;  // scattered by random teeth besides the mean field; powers add
};
EdgeWave edge_wave(World const&, std::uint32_t source, std::uint32_t goal, InnerRim const&);

// Appends the records of a wave that stands for `weight` of the coupling: for a small displacement x the field is
// (1 + i J x + A x) times itself, and in the mean over the static phase both quadratures act like a phase.
void add_edge_records(std::vector<PathRecord>&, EdgeWave const&, double weight);
// Power of the wave; where its static field vanishes, that of a displacement by 10 um.
double edge_power(EdgeWave const&);

struct EdgeClasses {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;
};
// As the table `edges` of the scene asks: one class for each group of rims and each direction between two mirrors.
EdgeClasses edge_classes(World const&);

}  // namespace straytrace::trace
