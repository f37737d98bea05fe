// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/diffuse.hpp"

#include "optics/lobes/lobe_prepare.hpp"
#include "optics/scatter/model_keys.hpp"

namespace straytrace::optics {

ModelKeys<Lambertian> Lambertian::keys() {
  return {{},
          {&Lambertian::reflectance,
           {"brdf", dim::brdf, 0, 1 / pi, "the same, as β = tis/π", [](Lambertian const&, double b) { return pi * b; }},
           {"tis", dim::plain, 0, 1, "total integrated scatter, 0 to 1"}}};
}

void Polynomial::prepare() { lobe.prepare(*this, peak > 0 ? width : 1); }

}  // namespace straytrace::optics
