// SPDX-License-Identifier: BSD-3-Clause
// What the page of a network shows (straytrace.plots.ifo_page). Inside the module.
#pragma once

#include <nlohmann/json.hpp>

#include <vector>

#include "results/text/sheets.hpp"
#include "session/light/optical_network.hpp"

namespace straytrace::cli {

// Suppression and gain of the loops, and the noise of the strain, over a band; of a model with strain.
std::vector<Sheet> page_curves(NetworkModel const&, std::vector<double> const& band);

// Components, spaces with their powers, and all tables that need no further words; `loops`, `curves`: empty without
// strain.
nlohmann::ordered_json page_json(OpticalNetwork const&, std::vector<double> const& at, std::vector<Sheet> const& loops,
                                 std::vector<Sheet> const& curves);

}  // namespace straytrace::cli
