// SPDX-License-Identifier: BSD-3-Clause
// The seam between the field of a cavity and its rays: the noise of a scene with the table `wave` at several crossover
// angles, on which it must not depend (docs/theory/wave.md, eq. W.21).
#pragma once

#include <string>
#include <vector>

#include "session/session.hpp"

namespace straytrace::session {

struct SeamPoint {
  double crossover = 0;           // rad
  WithError rays, halo, baffles;  // strain ASD at the frequency of the check, 1/sqrt(Hz); baffles: rays and halo
  WithError edges, total;
};
struct Seam {
  double frequency = 0, crossover = 0;  // Hz; rad, of the scene
  std::uint32_t map_draws = 1;          // of the heights of the mirrors
  std::vector<SeamPoint> points;
  std::vector<std::string> warnings;  // angles that could not be computed
  bool complete = true;               // false: interrupted
  // Largest relative change of a curve from that at the crossover angle of the scene, with its standard error; the
  // angles count as independent, although mirrors share heights.
  WithError change(WithError SeamPoint::*curve) const;
};

// At 1/sqrt(2), 1 and sqrt(2) times the crossover angle, each traced as `options` say. The same heights of the mirrors
// below the smallest angle. Ctrl-C ends it with the angles done so far. Leaves the model at the crossover angle of its
// scene.
Seam check_seam(Model&, TraceOptions const&);

std::string seam_text(Seam const&);
std::string seam_json(Seam const&);

}  // namespace straytrace::session
