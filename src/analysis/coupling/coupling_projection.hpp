// SPDX-License-Identifier: BSD-3-Clause
// A measured coupling times the quiet level of its witness (R6.08).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/coupling/coupling.hpp"

namespace straytrace {

struct ProjectedPoint {
  double hz = 0;
  double asd = not_a_number, sigma = not_a_number;  // of the target; an upper limit has no error
  CouplingFlag flag = CouplingFlag::no_data;
};

struct ProjectedCoupling {
  std::string witness, target;
  std::vector<ProjectedPoint> points;
};

// ASD of the witness where nothing was injected.
struct QuietWitness {
  std::string unit;  // "m": of the amplitude whose density this is
  std::vector<double> hz, asd, sigma;
};

// At each frequency of the witness: factor times level, errors in quadrature. Between two couplings of one kind the
// factor runs straight in log-log; limits stay limits, and next to an unknown is unknown. Frequencies that the coupling
// does not reach have no data. Throws InputError when the units do not fit, and where the coupling is not linear:
// fringe wrapping is projected in the time domain.
ProjectedCoupling project_coupling(CouplingFunction const&, QuietWitness const&);

}  // namespace straytrace
