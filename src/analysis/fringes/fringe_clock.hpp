// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/fringes/fringe_search.hpp"

namespace straytrace {

// Whether the clock of the witness is right (docs/theory/fit.md, clocks): searches the delay within settings.clock of
// that of the fit. `found`: amplitudes of the fit, with their errors.
ClockCheck clock_check(FringeProblem const&, RefinedFit const&, FringeFit const& found);

}  // namespace straytrace
