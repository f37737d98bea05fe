// SPDX-License-Identifier: BSD-3-Clause
#include "beams/overlap.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "beams/plane_field.hpp"

namespace straytrace {

namespace {

std::complex<double> log_overlap(Mode const& u, Mode const& v) {
  if (std::fabs(u.wavelength / v.wavelength - 1) > 1e-9)
    throw NumericalError(fmt::format(
        "beams of {:.9g} m and {:.9g} m have no overlap: they must be in the same medium, of one wavelength",
        u.wavelength, v.wavelength));
  if (!(dot(u.travel, v.travel) > 0)) return -infinity;
  Vec3 const normal = unit(u.travel + v.travel), t1 = any_normal(normal);
  Plane const plane{0.5 * (u.origin + v.origin), t1, cross(normal, t1)};
  return product(on_plane(u, plane), on_plane(v, plane)).log_integral();
}

}  // namespace

std::complex<double> overlap(Mode const& u, Mode const& v) { return std::exp(log_overlap(u, v)); }
double power_overlap(Mode const& u, Mode const& v) { return std::exp(log_power_overlap(u, v)); }
double log_power_overlap(Mode const& u, Mode const& v) { return 2 * log_overlap(u, v).real(); }

}  // namespace straytrace
