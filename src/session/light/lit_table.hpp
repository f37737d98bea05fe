// SPDX-License-Identifier: BSD-3-Clause
// Surfaces illuminated by propagated beams, for `straytrace check`.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "session/model.hpp"

namespace straytrace::session {

std::string lit_table(Model const&);            // empty when no beam has `lit`
nlohmann::ordered_json lit_json(Model const&);  // a list

}  // namespace straytrace::session
