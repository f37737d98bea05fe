// SPDX-License-Identifier: BSD-3-Clause
// straytrace inspect of a file of measured scatter: what was understood, audit, fits, picture, conversion.
#pragma once

#include <string>
#include <vector>

#include "session/options.hpp"
#include "world/scatter_data/scatter_audit.hpp"
#include "world/scatter_data/scatter_fit.hpp"

namespace straytrace {

struct ScatterRequest : PrintOptions {
  std::string file, beyond = "constant", angles, wavelength,
                    entry;             // as the keys of the law `table`; empty: the file says
  std::string plot, write;             // PNG and SSDD to write; empty: none
  std::vector<std::string> overrides;  // of the scene that holds the material
};
int inspect_scatter(ScatterRequest const&);

// Audit and fits of measured scatter as text.

std::string scatter_text(std::string const& name, ScatterFile const&, ScatterAudit const&,
                         std::vector<ScatterFit> const&, std::string const& beyond);

}  // namespace straytrace
