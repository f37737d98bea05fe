// SPDX-License-Identifier: BSD-3-Clause
// Readers of the BSDF models of a material (docs/reference/scatter). Each records its problems in the scene and appends
// its models; most append one.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "world/build/read_parts.hpp"

namespace straytrace::world {

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

}  // namespace straytrace::world
