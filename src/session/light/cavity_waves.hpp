// SPDX-License-Identifier: BSD-3-Clause
// Fields of the cavity that the table `wave` of a scene names, light at its moving rims, and the seam to traced light.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "scene/scene.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "session/session.hpp"
#include "trace/deterministic/moving_rims.hpp"
#include "wave/arm/arm_waves.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/ring/ring_record.hpp"

namespace straytrace::session {

// The field of the cavity that the table `wave` of a scene names.

// Gives the model the plan of its field, with problems at the keys that cause them; none without the table or in a
// scene with errors.
void plan_waves(Model&);
// Crossover angle, grid and memory, for `straytrace check`; empty without a plan.
std::string wave_line(Model const&);
nlohmann::ordered_json wave_json(Model const&);  // null without a plan
// Threads and, with the backend "cuda", the device of fields. InputError where there is none.
Computing computing(TraceOptions const&);
// With progress on stderr.
ArmWaves solve_waves(Model const&, Computing const&, PrintOptions const&, ArmOptions = {});
// Of a cavity of three mirrors or more.
RingWaves solve_ring_waves(Model const&, Computing const&, PrintOptions const&, ArmOptions = {});

// Of its mirrors, in their order; for an arm, the interferometer has the transmissions where the table `wave` has none.
// InputError where neither has.
std::vector<MirrorCoating> mirror_coatings(Model const&);
// The field that the input beam builds up in it; with the split by order up to `highest_order`.
struct DrivePlan {
  std::vector<double> detunings;  // free spectral ranges
  std::vector<MirrorCoating> coatings;
};
DrivenScan drive_waves(Model const&, ArmWaves const&, DrivePlan const&, Computing const&, PrintOptions const&,
                       int highest_order);
DrivenScan drive_waves(Model const&, RingWaves const&, DrivePlan const&, PrintOptions const&, int highest_order);

// What the field depends on besides surfaces, materials and modes: the table `wave` with the content of its maps; grid
// and crossover angle, which `wave --seam` varies.
std::vector<std::string> wave_inputs(Model const&);
// From the earlier run that the model knows, where that is of the same cavity and program; otherwise solved. Leaves the
// record for the run file in the model.
ArmWaves solved_or_known(Model&, unsigned threads, PrintOptions const&);
void keep_waves(Model&, ArmWaves const&);
void keep_waves(Model&, RingWaves const&);
// The same for pictures of its light on baffles; `as_traced`: the field that the model has is taken without a look at
// its key. InputError where the model has no such light.
WaveRecord const& waves_to_show(Model&, bool as_traced, unsigned threads, PrintOptions const&);
// Whether light below the crossover angle falls on baffles.
bool starts_in_field(Model const&);
// Gives the world the light below the crossover angle on its baffles, in which paths start and end: before steer().
// Nothing without it.
void light_halo(Model&, bool as_traced, unsigned threads, PrintOptions const&);

// The key `rims` of a scene: motion of rims in the main beam (docs/theory/diffraction.md, eq. N.21).

bool counts_rims(Scene const&);

// A problem at `rims` for a port whose response to the amplitude of its main beam the interferometer does not know.
void check_rims(Scene const&, World const&, Interferometer const&);

// The seam between the field of a cavity and its rays: the noise of a scene with the table `wave` at several crossover
// angles, on which it must not depend (docs/theory/wave.md, eq. W.21).

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
