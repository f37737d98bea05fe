// SPDX-License-Identifier: BSD-3-Clause
// straytrace wave --detuning: the field that the input beam builds up in the cavity. Inside the module.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "wave/modes/driven.hpp"
#include "world/model/world.hpp"

namespace straytrace::cli {

// "-0.5..0.5:1001" or "0,0.1" in free spectral ranges, or with a unit of frequency; in free spectral ranges. Throws one
// InputError with all that is wrong.
std::vector<double> parse_detunings(std::string const&, double round_trip, double wavelength);  // m

// `show`: rows; of more detunings, the resonances.
std::string driven_text(DrivenScan const&, World const&, std::size_t show);
nlohmann::ordered_json driven_json(DrivenScan const&, World const&);
std::string driven_csv(DrivenScan const&, World const&);

}  // namespace straytrace::cli
