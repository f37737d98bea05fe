// SPDX-License-Identifier: BSD-3-Clause
// Speed and accuracy of the time domain (R4.05, R4.08, R4.09).
#pragma once

#include <ostream>

namespace straytrace::bench {

// One JSON line each: phase sum and Welch of 6 s at 32768 Hz with two 5 Hz tones of 1 um, on one thread and on all, the
// phase sum against a loop over the sine and cosine of the library; then new motion on 1e5 paths x 1e5 samples, by the
// table of one coordinate and, where `long_ones`, directly for three.
void time_domain(std::ostream&, bool long_ones);

}  // namespace straytrace::bench
