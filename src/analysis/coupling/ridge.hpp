// SPDX-License-Identifier: BSD-3-Clause
// Coupling along the ridge of a sweep (R6.03).
#pragma once

#include <vector>

#include "analysis/coupling/coupling.hpp"
#include "spectra/series.hpp"

namespace straytrace {

struct RidgePoint {
  double time = 0;                // GPS s, middle of the window
  double witness = 0;             // rms of the witness along the ridge in this window, its unit
  double modulus = 0, sigma = 0;  // |H| and the error of each quadrature, whatever the flag
  double level = 0, lines = 0;    // |line|^2 of the target beside the ridge, and of how many independent lines
  CouplingPoint coupling;         // hz: centre of the ridge; coherence: share of the target's power there
};

struct RidgeSettings {
  double low = 0, high = 0;   // Hz, where the drive is looked for
  double window = 2;          // s
  double witness_ratio = 10;  // amplitude of the ridge over the witness beside it; below: thresholds not met
  double significance = 3;    // of the target; below: an upper limit
};

// Each half-overlapping window: the strongest line of the witness and its width by chirp; there H = <conj(x)
// y>/<|x|^2>. |H| with its error from the target beside the ridge; upper limits at 95 %. Both series on equal samples.
std::vector<RidgePoint> ridge_coupling(TimeSeries const& witness, TimeSeries const& target, RidgeSettings const&);

// One coupling function from all windows: those of a bin of `resolution` Hz are judged together (C.12), whatever each
// alone would say. Upper limits at 95 %.
CouplingFunction coupling_of_ridge(std::vector<RidgePoint> const&, TimeSeries const& witness, TimeSeries const& target,
                                   double resolution, double significance);

}  // namespace straytrace
