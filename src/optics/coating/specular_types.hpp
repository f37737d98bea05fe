// SPDX-License-Identifier: BSD-3-Clause
// The list of specular interfaces: reflection and transmission of a smooth surface. A new one is one header, its
// reader, its page and its name here. An interface has
//   amplitudes(cos_i, n_in, n_out, front)   field coefficients for light that meets the surface at cos_i in a medium of
//                               index n_in, with n_out behind it; `front`: it comes from the side the normal points to
//   scattered(cos_i)            share that it scatters; negative: the BSDF models of the material decide
//   yields_to_scatter           true: scattered light is subtracted from its powers (optics/coating/specular.hpp)
//   numbers(f)                  calls f(double) with everything that determines the above, tables included
#pragma once

#include <tuple>

#include "base/memory/storage.hpp"
#include "optics/coating/coating.hpp"
#include "optics/coating/film.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/coating/grating.hpp"

namespace straytrace::optics {

using SpecularTypes = std::tuple<Fresnel, Film, Coating, Grating>;
using SpecularPool = Pool<SpecularTypes>;

}  // namespace straytrace::optics
