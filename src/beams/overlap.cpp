// SPDX-License-Identifier: BSD-3-Clause
#include "beams/overlap.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "beams/plane_field.hpp"

namespace straytrace {

std::complex<double> overlap(Mode const& u, Mode const& v) {
  if (std::fabs(u.wavelength / v.wavelength - 1) > 1e-9)
    throw NumericalError(fmt::format(
        "beams of {:.9g} m and {:.9g} m have no overlap: they must be in the same medium, of one wavelength",
        u.wavelength, v.wavelength));
  if (!(dot(u.travel, v.travel) > 0)) return 0;
  Vec3 const normal = unit(u.travel + v.travel), t1 = any_normal(normal);
  Plane const plane{0.5 * (u.origin + v.origin), t1, cross(normal, t1)};
  return product(on_plane(u, plane), on_plane(v, plane)).integral();
}

double power_overlap(Mode const& u, Mode const& v) { return std::norm(overlap(u, v)); }

}  // namespace straytrace
