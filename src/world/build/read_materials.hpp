// SPDX-License-Identifier: BSD-3-Clause
// Published surface data (docs/reference/library.md) as a material states them with `preset: {brdf: [...], status:
// ...}`. The list behind `preset: NAME` is library/materials. A bracket is the range that the sources leave open.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "base/input/table.hpp"

namespace straytrace::world {

struct MaterialPreset {
  enum class Gives {
    brdf,
    tis,
    tis_75,
    reflect
  };  // constant BRDF in 1/sr; Lambertian total; total at 0 and 75 deg,
      // rest as black paint; specular reflectance only
  std::string name;
  Gives gives = Gives::brdf;
  double values[3] = {};  // low, mid, high; all equal: the sources give no bracket
  double at_75[3] = {};   // with tis_75
  double reflect = 0;     // specular, in addition to the scatter
  double through = 0;     // total scattered to the other side
  std::string wavelength, status, source, note;

  bool has_bracket() const { return values[0] < values[2]; }
};

// The table `preset` of a material; nothing, and a problem, when it is not complete.
std::optional<MaterialPreset> read_preset_numbers(std::string const& name, Node const& table);

std::span<MaterialPreset const> material_presets();  // of the library, in its order

}  // namespace straytrace::world
