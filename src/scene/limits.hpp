// SPDX-License-Identifier: BSD-3-Clause
// `limits` of a part: what its parameters must keep to, so that its faces fit together.
#pragma once

#include <string>

#include "scene/scene_document.hpp"
#include "scene/scope.hpp"

namespace straytrace {

// False, with a problem at the value in `entry` (or at the entry, when it gives none), for the first parameter that is
// not `above`, `at_least` or `at_most` what the part says; `name` is that of the entry.
bool within_limits(Node const& entry, std::string const& name, Node const& part, std::shared_ptr<Scope const> const&);

}  // namespace straytrace
