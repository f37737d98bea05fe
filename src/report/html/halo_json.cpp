// SPDX-License-Identifier: BSD-3-Clause
// Light of a cavity at small angles on the surfaces of a scene, for the page.
#include <algorithm>

#include "io/markup.hpp"
#include "report/html/page_json.hpp"
#include "report/scene_picture.hpp"
#include "wave/arm/wave_record.hpp"

namespace straytrace::report {
namespace {

// Sector, radii and places along the axis of both ends [m], the places from that of the first, and the irradiance.
std::vector<float> patches_of(HaloSurface const& surface, double place, double power) {
  std::vector<float> values;
  for (HaloPatch const& p : surface.patches)
    for (double const x :
         {double(p.sector), p.inner, p.outer, p.inner_place - place, p.outer_place - place, power * p.irradiance})
      values.push_back(float(x));
  return values;
}

}  // namespace

PageJson halo_json(World const& world, wave::ArmCavity const& arm, wave::WaveRecord const& w) {
  constexpr int most_patches = 60000, fewest_rings = 4, most_rings = 32;
  int const sides = 2 * int(arm.rims.size()), sectors = w.irradiance.of(1, wave::Travel::towards_mirror2).sectors;
  int const rings = std::clamp(most_patches / (sides * sectors), fewest_rings, most_rings);
  std::vector<HaloSurface> const surfaces = HaloLight(world, arm, w.irradiance).surfaces(rings);
  auto const [low, high] = halo_scale(surfaces);
  double const power = w.power > 0 ? w.power : 1;
  auto const vector = [](Vec3 v) { return PageJson{v.x, v.y, v.z}; };
  PageJson list = PageJson::array();
  for (HaloSurface const& s : surfaces) {
    bool const forward = s.travel == wave::Travel::towards_mirror2;
    double const place = s.patches.front().inner_place;
    std::vector<float> const patches = patches_of(s, place, power);
    list.push_back({{"name", world.name_of(s.surface)},
                    {"towards", w.mirrors[forward ? 1 : 0].name},
                    {"forward", forward},
                    {"power", number(power * s.share)},
                    {"place", place},
                    {"patches", base64(patches.data(), patches.size() * sizeof(float))}});
  }
  return {{"beam", w.beam},
          {"in_watts", w.power > 0},
          {"crossover", number(w.crossover)},
          {"low", number(power * low)},
          {"high", number(power * high)},
          {"sectors", sectors},
          {"origin", vector(arm.frame.origin)},
          {"axes", {vector(arm.frame.x), vector(arm.frame.y), vector(arm.frame.z)}},
          {"surfaces", list}};
}

}  // namespace straytrace::report
