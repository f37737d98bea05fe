// SPDX-License-Identifier: BSD-3-Clause
// Audit and fits of measured scatter, for people and for pictures and scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

#include "world/scatter_data/scatter_fit.hpp"

namespace straytrace::results {

// `beyond`: the extrapolation behind the integrals of the audit.
std::string scatter_text(std::string const& name, ScatterFile const&, ScatterAudit const&,
                         std::vector<ScatterFit> const&, std::string const& beyond);
// With every point, and the curves of the fits.
nlohmann::json scatter_json(std::string const& name, ScatterFile const&, ScatterAudit const&,
                            std::vector<ScatterFit> const&);

}  // namespace straytrace::results
