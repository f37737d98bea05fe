// SPDX-License-Identifier: BSD-3-Clause
// STEP AP203, AP214 and AP242: parts with names, colours and placements, through OpenCASCADE.
#pragma once

#include <string>

#include "step/cad_model.hpp"

namespace straytrace::step {

// Throws Refused.
Model read_step(std::string const& file, Settings const&);

}  // namespace straytrace::step
