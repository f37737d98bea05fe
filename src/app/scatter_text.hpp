// SPDX-License-Identifier: BSD-3-Clause
// Audit and fits of measured scatter as text.
#pragma once

#include <string>
#include <vector>

#include "world/measured/scatter_audit.hpp"
#include "world/measured/scatter_fit.hpp"

namespace straytrace {

std::string scatter_text(std::string const& name, ScatterFile const&, ScatterAudit const&,
                         std::vector<ScatterFit> const&, std::string const& beyond);

}  // namespace straytrace
