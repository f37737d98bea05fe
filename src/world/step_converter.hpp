// SPDX-License-Identifier: BSD-3-Clause
// Starts straytrace-step on a STEP file and keeps what it makes, by content, in the cache of the user.
#pragma once

#include <string>

#include "world/mesh_file.hpp"

namespace straytrace {

struct StepConversion {
  std::string text;  // a *.cad.json; empty: see fault
  MeshFault fault;
};

// `name` for messages. The converter is STRAYTRACE_STEP, or straytrace-step beside this program or in PATH. Cache:
// straytrace/step in XDG_CACHE_HOME or ~/.cache; without either nothing is kept.
StepConversion convert_step(std::string const& name, std::string const& bytes);

}  // namespace straytrace
