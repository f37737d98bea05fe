// SPDX-License-Identifier: BSD-3-Clause
// THE list of BSDF models. A new one is NAME.hpp and NAME.cpp, its page and its name here, at the end: the fingerprint
// of a run holds its place. What a model offers: optics/lobes/bsdf.hpp; its parameters: optics/scatter/model_keys.hpp.
#pragma once

#include <tuple>

#include "base/memory/storage.hpp"
#include "optics/scatter/diffuse.hpp"
#include "optics/scatter/dust.hpp"
#include "optics/scatter/facets.hpp"
#include "optics/scatter/measured.hpp"
#include "optics/scatter/roughness.hpp"
#include "optics/scatter/shift_invariant.hpp"

namespace straytrace::optics {

using LawTypes =
    std::tuple<Lambertian, PowerLaw, Abg, Harvey, Gaussian, Polynomial, Roughness, Dust, Measured, Microfacet, Grooves>;
using LawPool = Pool<LawTypes>;

}  // namespace straytrace::optics
