// SPDX-License-Identifier: BSD-3-Clause
// THE list of specular interfaces: what a smooth surface reflects and transmits. A new one is one header, its reader,
// its page and its name here. An interface has
//   amplitudes(cos_i, n_in, n_out, front)   field coefficients for light that meets the surface at cos_i in a medium of
//                               index n_in, with n_out behind it; `front`: it comes from the side the normal points to
//   scattered(cos_i)            share it says is scattered; negative: it says nothing, the laws of the material do
//   yields_to_scatter           true: what the laws scatter is missing from the amplitudes' powers
//   (optics/coating/specular.hpp) numbers(f)                  calls f(double) with everything that decides the above,
//   tables included
#pragma once

#include <tuple>

#include "base/memory/storage.hpp"
#include "optics/coating/coating.hpp"
#include "optics/coating/film.hpp"
#include "optics/coating/fresnel.hpp"

namespace straytrace {

using SpecularTypes = std::tuple<Fresnel, Film, Coating>;
using SpecularPool = Pool<SpecularTypes>;

}  // namespace straytrace
