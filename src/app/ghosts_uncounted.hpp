// SPDX-License-Identifier: BSD-3-Clause
// Ghosts that a scene does not count.
#pragma once

#include "app/model.hpp"

namespace straytrace {

// A scene that says nothing of `ghosts` while some come back to a port: a warning with the power and the strain that
// a quick search finds. `ghosts: off` says that it is known.
void warn_of_uncounted_ghosts(Model const&);

}  // namespace straytrace
