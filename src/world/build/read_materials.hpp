// SPDX-License-Identifier: BSD-3-Clause
// Readers of materials: BSDF models, and published surface data.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/table.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {

// Published surface data (docs/reference/library.md) as a material states them with `preset: {brdf: [...], status:
// ...}`. The list behind `preset: NAME` is library/materials. A bracket is the range that the sources leave open.

// Readers of the BSDF models of a material (docs/reference/scatter). Each records its problems in the scene and appends
// its models; most append one.

struct LawReading {
  World& world;
  std::string material;
  std::vector<PoolRef> laws;    // results
  Optic* optic = nullptr;       // of the material
  ScatterSpread spread = {};    // of a preset, around the case that is taken
  std::string wavelength = {};  // stated by the file of the model now read
  Registry const* names = nullptr;

  template <class Law>
  void add(Law const& law) {
    laws.push_back(world.add_law(law));
  }
  void note(std::string text) { world.notes.push_back("material " + material + ": " + std::move(text)); }
};

// Models by their name, the key `model`.
struct LawReader {
  std::string_view model;
  void (*read)(Node const&, LawReading&);
};
std::span<LawReader const> law_readers();

void read_measured(Node const&, LawReading&);                 // the model `table`
std::vector<MeasuredPoint> measured_points(Node const& law);  // of such a model, as its file has them

// Models of a preset with its reflectance where the material gives no `specular` (docs/reference/scatter/presets.md).
LawInfo read_preset(Node const& material, LawReading&, Optic&);

// Wavelength at which a model is evaluated: the key `wavelength`, or that of the scene.
double law_wavelength(Node const& law, World const&);

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
