// SPDX-License-Identifier: BSD-3-Clause
// `straytrace project COUPLING.csv`: a measured coupling times a quiet witness.
#pragma once

#include <string>

#include "cli/data_options.hpp"

namespace straytrace {

struct CouplingProjectionOptions {
  std::string coupling, coupling_unit, witness, target, asd;
  DataOptions data;
};

int project_measured_coupling(CouplingProjectionOptions const&);

}  // namespace straytrace
