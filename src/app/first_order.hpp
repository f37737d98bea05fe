// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/options.hpp"

namespace straytrace {

// straytrace paths FILE --first-order: what is lit, what is seen, and both. Returns the exit code.
int print_first_order(Options const&);

}  // namespace straytrace
