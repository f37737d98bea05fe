// SPDX-License-Identifier: BSD-3-Clause
// The converted file: JSON with numbers that read back to the same bits. Format: docs/reference/cad.md.
#pragma once

#include <string>

#include "step/cad_model.hpp"

namespace straytrace::step {

constexpr int format_version = 1;

std::string as_json(Model const&, Settings const&, std::string const& made_by);
std::string summary(Model const&, std::string const& name);  // parts, faces by kind, bounding box in metres; for people

}  // namespace straytrace::step
