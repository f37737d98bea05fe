// SPDX-License-Identifier: BSD-3-Clause
// The seam between the field of a cavity and its rays: the noise of a scene with the table `wave` at several crossover
// angles, on which it must not depend (docs/theory/wave.md, eq. W.21).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "session/session.hpp"

namespace straytrace::session {

// The noise of some routes at one angle, at the frequency of the check.
struct SeamCurve {
  WithError strain;     // ASD, 1/sqrt(Hz)
  double variance = 0;  // of the PSD without the terms below, 1/Hz^2
  // Terms of the PSD, 1/Hz, that are independent samples over random mirrors: of the halo by parts of the azimuth
  // (CouplingClass::azimuth_parts), of edges by draws. Empty: not random.
  std::vector<double> halo, edges;
};
struct SeamPoint {
  double crossover = 0;                  // rad
  SeamCurve rays, halo, baffles, edges;  // baffles: rays and halo
  SeamCurve total;
};
struct Seam {
  double frequency = 0, crossover = 0;  // Hz; rad, of the scene
  bool one_draw = false;                // of random mirrors
  std::vector<SeamPoint> points;
  std::vector<std::string> warnings;  // angles that could not be computed
  bool complete = true;               // false: interrupted
  // Largest relative change of a curve from that at the crossover angle of the scene, with its standard error. The
  // field at both angles is that of the same mirrors, so that its error is that of the difference, term by term.
  WithError change(SeamCurve SeamPoint::*curve) const;
};

// At 1/sqrt(2), 1 and sqrt(2) times the crossover angle, each traced as `options` say. The same heights of the mirrors
// below the smallest angle. Ctrl-C ends it with the angles done so far. Leaves the model at the crossover angle of its
// scene.
Seam check_seam(Model&, TraceOptions const&);

// Whether a model has waves beside its rays, and noise.
bool has_seam(Model const&);
// Of a run: its noise and that of fewer histories at 1/sqrt(2) times its crossover angle, on its grid and with its
// heights. `again`: its model, read anew. Nothing without has_seam() and after Ctrl-C; a
// warning where the other angle cannot be computed.
std::shared_ptr<SeamCheck const> check_seam(Model again, TraceResult const&, TraceOptions const&);
std::uint64_t histories_of_seam(std::uint64_t of_run);

std::string seam_text(Seam const&);
std::string seam_json(Seam const&);

}  // namespace straytrace::session
