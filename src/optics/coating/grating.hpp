// SPDX-License-Identifier: BSD-3-Clause
// Diffraction grating with a stated efficiency of each order (docs/theory/surfaces.md, eq. 3.27). Page:
// docs/reference/interfaces/grating.md.
//
// Order m changes the part of the wave vector along the surface by m K, where K is fixed to the surface: seen from
// either side, and on the way back, an order is the same. With the same efficiency at every angle this is reciprocal.
// An order that does not propagate at an incidence gives its efficiency to absorption, which is reciprocal as well: an
// order exists on a way if and only if it exists on the way back.
#pragma once

#include "base/math/vec3.hpp"
#include "optics/amplitudes.hpp"

namespace straytrace::optics {

struct GratingOrder {
  double order = 0;                  // whole
  double reflect = 0, transmit = 0;  // share of the incident power
};

struct Grating {
  static constexpr int most_orders = 16;
  double density = 0;  // lines per metre across the axis of the shape
  double turn = 0;     // density times the vacuum wavelength: change of n sin by one order
  std::int64_t count = 0;
  GratingOrder order[most_orders];

  static constexpr char const* key = "grating";
  static constexpr bool yields_to_scatter = false;

  // Of order 0.
  STRAY_HD Amplitudes amplitudes(double /*cos_i*/, double /*n_in*/, double /*n_out*/, bool /*front*/) const {
    for (std::int64_t i = 0; i < count; ++i)
      if (order[i].order == 0)
        return unitary_amplitudes(order[i].reflect, order[i].reflect, order[i].transmit, order[i].transmit);
    return {};
  }
  STRAY_HD double scattered(double /*cos_i*/) const { return -1; }
  STRAY_HD double reflectance() const {  // of all orders
    double sum = 0;
    for (std::int64_t i = 0; i < count; ++i) sum += order[i].reflect;
    return sum;
  }
  STRAY_HD double transmittance() const {
    double sum = 0;
    for (std::int64_t i = 0; i < count; ++i) sum += order[i].transmit;
    return sum;
  }
  template <class F>
  void numbers(F&& f) const {
    f(density);
    f(turn);
    for (std::int64_t i = 0; i < count; ++i)
      for (double x : {order[i].order, order[i].reflect, order[i].transmit}) f(x);
  }
};

// Direction of an order, all unit vectors along the travel; `normal` towards the side the light comes from, `along`:
// the change of n times the direction, in the surface. False: the order does not propagate.
STRAY_HD bool diffracted(Vec3 travel, Vec3 normal, Vec3 along, double n_in, double n_after, bool through, Vec3& out) {
  Vec3 const flat = (1 / n_after) * (n_in * (travel - dot(travel, normal) * normal) + along);
  double const square = 1 - length2(flat);
  if (!(square > 0)) return false;
  out = unit(flat + (through ? -std::sqrt(square) : std::sqrt(square)) * normal);
  return true;
}

}  // namespace straytrace::optics
