// SPDX-License-Identifier: BSD-3-Clause
// What straytrace wave prints: fields of arms, of rings and of driven cavities.
#pragma once

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "wave/arm/arm_waves.hpp"
#include "wave/modes/driven.hpp"
#include "wave/ring/ring_waves.hpp"
#include "world/model/world.hpp"

namespace straytrace::cli {

// What straytrace wave prints. Inside the module.

constexpr double rounding_of_shares = 1e-12;  // of the power; smaller ones are rounding

// W; 0: not stated.
inline double arm_power(World const& world) {
  return world.wave.beam < world.beam_powers.size() ? world.beam_powers[world.wave.beam] : 0;
}
// Turns, without the sign of a phase that is zero to all digits.
inline std::string phase_text(double turns) { return fmt::format("{:+.5f}", std::fabs(turns) < 5e-6 ? 0.0 : turns); }
inline char const* method_of(RimResult const& rim) { return rim.draws.empty() ? "speckle" : "wave"; }
// Of |A| over all draws: across the beam sqrt((|A_x|^2 + |A_y|^2)/2), or along it. The rim is in the grid.
Spread lever_spread(RimResult const&, bool along);

// `show`: rows of the tables of rims.
inline nlohmann::ordered_json number_json(double x) {
  return std::isnan(x) ? nlohmann::ordered_json() : nlohmann::ordered_json(x);
}
std::string wave_text(ArmWaves const&, World const&, std::size_t show);
nlohmann::ordered_json wave_json(ArmWaves const&, World const&);
// `displacement_per_m` and `rotation_per_rad`, three complex numbers each.
void add_levers(nlohmann::ordered_json&, RimLevers const&);
// Of photodiodes.
std::string photodiodes_text(ArmWaves const&, World const&, std::size_t show);  // empty without any
std::string photodiodes_csv(ArmWaves const&, World const&);

// What `straytrace wave` prints of a ring or folded cavity.

std::string ring_text(RingWaves const&, World const&);
nlohmann::ordered_json ring_json(RingWaves const&, World const&);

// straytrace wave --detuning: the field that the input beam builds up in the cavity. Inside the module.

// "-0.5..0.5:1001" or "0,0.1" in free spectral ranges, or with a unit of frequency; in free spectral ranges. Throws one
// InputError with all that is wrong.
std::vector<double> parse_detunings(std::string const&, double round_trip, double wavelength);  // m

// `show`: rows; of more detunings, the resonances.
std::string driven_text(DrivenScan const&, World const&, std::size_t show);
nlohmann::ordered_json driven_json(DrivenScan const&, World const&);
std::string driven_csv(DrivenScan const&, World const&);

}  // namespace straytrace::cli
