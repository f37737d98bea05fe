// SPDX-License-Identifier: BSD-3-Clause
// How much of one beam is in the mode of another: tilt, shift, mismatch and astigmatism in one closed form
// (physics.md section 5, eq. 5.1-5.3 are special cases).
#pragma once

#include <complex>

#include "beams/mode.hpp"

namespace straytrace {

// Integral of u1 conj(u2) over a plane across both beams, each field with phase zero at its own origin. The origins may
// lie anywhere and the chief rays need not be parallel nor meet; the value does not depend on the plane. Zero when the
// beams run apart by a right angle or more. Both in the same medium: NumericalError when the wavelengths differ.
std::complex<double> overlap(Mode const&, Mode const&);
// Share of the power of one beam in the mode of the other: |overlap|^2.
double power_overlap(Mode const&, Mode const&);
// Its natural logarithm, also where the share is too small for a number; minus infinity when the beams run apart by a
// right angle or more.
double log_power_overlap(Mode const&, Mode const&);

}  // namespace straytrace
