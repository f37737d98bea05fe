// SPDX-License-Identifier: BSD-3-Clause
// Field coefficients of a smooth interface for the two polarisations.
#pragma once

#include "base/host_device.hpp"

namespace straytrace {

struct Complex {  // std::complex is host-only
  double re = 0, im = 0;
};
STRAY_HD double norm(Complex a) { return a.re * a.re + a.im * a.im; }

// s: field across the plane of incidence, p: in it. Transmission is scaled to power: |t|^2 = transmitted over incident
// power, so |r|^2 + |t|^2 = 1 without loss. Signs: r_s, r_p of physics.md eq. 3.25 (equal at normal incidence up to the
// sign of r_p, whose field is taken along k x s of each wave).
struct Amplitudes {
  Complex rs, rp, ts, tp;
  STRAY_HD double reflectance() const { return 0.5 * (norm(rs) + norm(rp)); }  // of unpolarised light
  STRAY_HD double transmittance() const { return 0.5 * (norm(ts) + norm(tp)); }
};

}  // namespace straytrace
