// SPDX-License-Identifier: BSD-3-Clause
// Deterministic classes: light that no walk of rays finds, computed once and put into the coupling table beside the
// scattered light (docs/theory/diffraction.md).
#pragma once

#include "trace/coupling.hpp"

namespace straytrace {

// A class without a Monte-Carlo error. The weights of the records, all positive, sum to its coupling, which counts the
// ordered path alone; `reverse` is C_rev (docs/theory/path_integral.md, eq. 1.5). The hash names kind, steps and port.
CouplingClass deterministic_class(ClassKind, std::vector<PathStep> steps, PortId, double reverse,
                                  std::vector<PathRecord>, std::string statement);

// Keeps the order by hash. Throws NumericalError when two classes have one hash.
void add_beside(CouplingTable&, std::vector<CouplingClass> const&);

}  // namespace straytrace
