// SPDX-License-Identifier: BSD-3-Clause
// The list of BSDF models. A new one needs NAME.hpp and NAME.cpp, its page, and its name here, at the end: its place is
// part of the fingerprint of a run. Interface: optics/lobes/bsdf.hpp; parameters: optics/scatter/model_keys.hpp.
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
