// SPDX-License-Identifier: BSD-3-Clause
// Specular reflection and transmission of one side of a surface, for every kind of interface.
#pragma once

#include "optics/coating/specular_types.hpp"
#include "optics/optic.hpp"

namespace straytrace::optics {

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
