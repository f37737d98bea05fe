// SPDX-License-Identifier: BSD-3-Clause
// Specular reflection and transmission of one side of a surface, for every kind of interface.
#pragma once

#include <tuple>

#include "base/math/vec3.hpp"
#include "base/memory/storage.hpp"
#include "optics/coating/coating.hpp"
#include "optics/coating/film.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/optic.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::optics {

// Diffraction grating with a stated efficiency of each order (docs/theory/surfaces.md, eq. 3.27). Page:
// docs/reference/interfaces/grating.md.
//
// Order m changes the part of the wave vector along the surface by m K, where K is fixed to the surface: seen from
// either side, and on the way back, an order is the same. With the same efficiency at every angle this is reciprocal.
// An order that does not propagate at an incidence gives its efficiency to absorption, which is reciprocal as well: an
// order exists on a way if and only if it exists on the way back.

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

// The list of specular interfaces: reflection and transmission of a smooth surface. A new one is one header, its
// reader, its page and its name here. An interface has
//   amplitudes(cos_i, n_in, n_out, front)   field coefficients for light that meets the surface at cos_i in a medium of
//                               index n_in, with n_out behind it; `front`: it comes from the side the normal points to
//   scattered(cos_i)            share that it scatters; negative: the BSDF models of the material decide
//   yields_to_scatter           true: scattered light is subtracted from its powers (optics/coating/specular.hpp)
//   numbers(f)                  calls f(double) with everything that determines the above, tables included

using SpecularTypes = std::tuple<Fresnel, Film, Coating, Grating>;
using SpecularPool = Pool<SpecularTypes>;

// Field coefficients for light that meets the surface at cos_i > 0 in a medium of index n_in, with n_out behind it;
// `front`: it comes from the side the normal points to.
STRAY_HD Amplitudes specular_amplitudes(SpecularPool const& pool, Optic const& optic, double cos_i, double n_in,
                                        double n_out, bool front) {
  if (!optic.has_interface) return unitary_amplitudes(optic.reflect, optic.reflect, optic.transmit, optic.transmit);
  return pool.visit(optic.interface, [&](auto const& i) { return i.amplitudes(cos_i, n_in, n_out, front); });
}

// Share of the light that the interface itself scatters at this incidence; negative: the BSDF models decide.
STRAY_HD double prescribed_scatter(SpecularPool const& pool, Optic const& optic, double cos_i) {
  return optic.has_interface ? pool.visit(optic.interface, [&](auto const& i) { return i.scattered(cos_i); }) : -1;
}

// Factor on the specular light, of share `specular`, when the models scatter `scattered`. Computed interfaces (Fresnel,
// film) are lossless, so scatter reduces reflection and transmission; stated powers stay, but the sum never exceeds 1.
STRAY_HD double specular_remainder(SpecularPool const& pool, Optic const& optic, double specular, double scattered) {
  if (!optic.has_interface) return 1;
  double const free = std::fmax(0.0, 1 - scattered);
  if (pool.visit(optic.interface, [](auto const& i) { return i.yields_to_scatter; })) return free;
  return specular > free ? free / specular : 1;
}

STRAY_HD Grating const& grating_of(SpecularPool const& pool, Optic const& optic) {
  return std::get<View<Grating const>>(pool.arrays)[optic.interface.index];
}

struct SpecularShares {
  double reflect = 0, transmit = 0;  // of the power of unpolarised light; of a grating, in all its orders
};
// `scattered`: share that the models of this optic scatter at this incidence (scatter_albedo).
STRAY_HD SpecularShares specular_shares(SpecularPool const& pool, Optic const& optic, double cos_i, double n_in,
                                        double n_out, bool front, double scattered = 0) {
  if (!optic.has_interface) return {optic.reflect, optic.transmit};
  if (optic.diffracts) {
    Grating const& grating = grating_of(pool, optic);
    return {grating.reflectance(), grating.transmittance()};
  }
  Amplitudes const a = specular_amplitudes(pool, optic, cos_i, n_in, n_out, front);
  double const left = specular_remainder(pool, optic, a.reflectance() + a.transmittance(), scattered);
  return {left * a.reflectance(), left * a.transmittance()};
}

}  // namespace straytrace::optics
