// SPDX-License-Identifier: BSD-3-Clause
// Readers of the scatter laws of a material (docs/reference/scatter). Each records its problems in the scene and
// appends the laws it made; most make one.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "world/build/read_parts.hpp"

namespace straytrace {

struct LawReading {
  World& world;
  std::string material;
  std::vector<PoolRef> laws;    // what was read
  Optic* optic = nullptr;       // of the material
  ScatterSpread spread = {};    // of a preset, around the case that is taken
  std::string wavelength = {};  // that the file of the law now read says

  template <class Law>
  void add(Law const& law) {
    laws.push_back(world.add_law(law));
  }
  void note(std::string text) { world.notes.push_back("material " + material + ": " + std::move(text)); }
};

void read_lambertian(Node const&, LawReading&);
void read_power_law(Node const&, LawReading&);
void read_abg(Node const&, LawReading&);
void read_harvey(Node const&, LawReading&);
void read_gaussian(Node const&, LawReading&);
void read_polynomial(Node const&, LawReading&);
void read_microfacet(Node const&, LawReading&);
void read_grooves(Node const&, LawReading&);
void read_defects(Node const&, LawReading&);
void read_dust(Node const&, LawReading&);
void read_k_correlation(Node const&, LawReading&);
void read_psd(Node const&, LawReading&);
void read_harvey_shack(Node const&, LawReading&);
void read_measured(Node const&, LawReading&);
std::vector<MeasuredPoint> measured_points(Node const& law);  // of such a law, as its file has them

// The laws by the name of their key `model`.
struct LawReader {
  std::string_view model;
  void (*read)(Node const&, LawReading&);
};
inline constexpr std::array law_readers{LawReader{"lambertian", read_lambertian},
                                        LawReader{"power-law", read_power_law},
                                        LawReader{"abg", read_abg},
                                        LawReader{"harvey", read_harvey},
                                        LawReader{"gaussian", read_gaussian},
                                        LawReader{"polynomial", read_polynomial},
                                        LawReader{"microfacet", read_microfacet},
                                        LawReader{"grooves", read_grooves},
                                        LawReader{"k-correlation", read_k_correlation},
                                        LawReader{"psd", read_psd},
                                        LawReader{"harvey-shack", read_harvey_shack},
                                        LawReader{"table", read_measured},
                                        LawReader{"dust", read_dust},
                                        LawReader{"defects", read_defects}};

// Laws of a preset with its reflectance where the material gives no `specular` (docs/reference/scatter/presets.md).
LawInfo read_preset(Node const& material, LawReading&, Optic&);

// Wavelength at which a law is evaluated: the key `wavelength`, or that of the scene.
double law_wavelength(Node const& law, World const&);

}  // namespace straytrace
