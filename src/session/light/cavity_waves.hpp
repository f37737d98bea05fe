// SPDX-License-Identifier: BSD-3-Clause
// The field of the cavity that the table `wave` of a scene names.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

#include "session/model.hpp"
#include "session/options.hpp"
#include "wave/arm/driven_arm.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/ring/ring_record.hpp"

namespace straytrace::session {

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

}  // namespace straytrace::session
