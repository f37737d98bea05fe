// SPDX-License-Identifier: BSD-3-Clause
// Coupling of a whole band, from all the power that rose in it (theory: commissioning.md, C.13).
#pragma once

#include "base/constants.hpp"
#include "signal/cross_spectra.hpp"
#include "signal/welch.hpp"

namespace straytrace {

// H^2 = (sum of y_inj - y_quiet)/(sum of x_inj - x_quiet) over the lines of low to high, Hz; PSDs of target y and
// witness x. Slow motion of the same surface spreads what fast small motion makes over neighbouring lines without
// changing its power, so H is the coupling of small motion where that of single lines is not.
struct BandCoupling {
  double factor = not_a_number,
         sigma = not_a_number;                 // target unit per witness unit; one standard error of the averages
  double witness_ratio = 0, target_ratio = 0;  // injection over quiet, of amplitudes in the whole band
  double share = not_a_number;  // of the power of the quiet target that the quiet witness makes, 1 for all
  bool rises_at_low = false, rises_at_high = false;  // the target has risen at this end too: the band is too narrow
};

// `settings`: of both spectra; how much neighbouring lines share follows from the window. NaN factor where witness or
// target have not risen by three standard errors.
BandCoupling band_coupling(CrossSpectra const& injection, CrossSpectra const& quiet, double low, double high,
                           WelchSettings const& settings);

}  // namespace straytrace
