// SPDX-License-Identifier: BSD-3-Clause
// Published surface data (interface.md 12): THE list. A bracket holds what the sources leave open.
#pragma once

#include <span>
#include <string_view>

namespace straytrace {

struct MaterialPreset {
  enum class Gives {
    brdf,
    tis,
    tis_75,
    reflect
  };  // constant BRDF in 1/sr; Lambertian total; total at 0 and 75 deg,
      // rest as black paint; specular reflectance only
  std::string_view name;
  Gives gives;
  double low, mid, high;  // low = high: the sources give no bracket
  double at_75[3];        // with tis_75
  double reflect;         // specular, beside the scatter
  double through;         // total scattered to the other side
  std::string_view wavelength, status, source, note;

  bool has_bracket() const { return low < high; }
};

std::span<MaterialPreset const> material_presets();

}  // namespace straytrace
