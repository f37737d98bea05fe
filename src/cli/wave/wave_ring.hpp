// SPDX-License-Identifier: BSD-3-Clause
// What `straytrace wave` prints of a ring or folded cavity.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

#include "wave/ring/ring_waves.hpp"
#include "world/model/world.hpp"

namespace straytrace::cli {

std::string ring_text(RingWaves const&, World const&);
nlohmann::ordered_json ring_json(RingWaves const&, World const&);

}  // namespace straytrace::cli
