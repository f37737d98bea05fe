// SPDX-License-Identifier: BSD-3-Clause
// Picture by the camera's own flash, and what shines back, by object.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/render_paint.hpp"

namespace straytrace {
namespace {

// The film: yellow is the brightest scattered light, black four decades below, white one above, where glints are.
constexpr double below = 4;

// From black by red and yellow to white, 0 to 1.
void burn(double x, std::vector<std::uint8_t>& rgb) {
  for (double const from : {0.0, 0.4, 0.8})
    rgb.push_back(std::uint8_t(std::lround(255 * std::clamp((x - from) / (from < 0.8 ? 0.4 : 0.2), 0.0, 1.0))));
}

}  // namespace

Drawn draw_flash(World const& world, Camera const& camera, LookSettings const& settings, Flash const& flash) {
  std::vector<FlashLight> const picture = flash_picture(world.view(), camera, flash, settings);
  double brightest = 0, glint = 0;
  std::map<std::string, Shine> objects;
  Drawn drawn;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    FlashLight const& light = picture[i];
    brightest = std::max(brightest, light.scattered);
    glint = std::max(glint, light.glint);
    if (!light.first.valid()) continue;
    Shine& object = objects[object_of(world.groups()[world.surfaces()[light.first.value].group.value])];
    double const angle = solid_angle(camera, std::uint32_t(i % camera.columns), std::uint32_t(i / camera.columns));
    object.scattered += light.scattered * angle;
    object.glint += light.glint * angle;
  }
  double const yellow = brightest > 0 ? brightest : glint;
  for (FlashLight const& light : picture)
    burn(light.both() > 0 ? 0.8 + 0.8 / below * std::log10(light.both() / yellow) : 0, drawn.rgb);
  for (auto& [name, object] : objects) {
    if (!(object.scattered + object.glint > 0)) continue;
    object.object = name;
    drawn.shine.push_back(object);
  }
  std::stable_sort(drawn.shine.begin(), drawn.shine.end(),
                   [](Shine const& a, Shine const& b) { return a.scattered + a.glint > b.scattered + b.glint; });
  drawn.scale = yellow > 0 ? fmt::format(
                                 "radiance over the intensity of the flash: yellow {:.3g} /m^2, black 1e-{:.0f} of it "
                                 "or less, logarithmic; white: glints, up to {:.3g} /m^2",
                                 yellow, below, glint)
                           : "nothing shines back";
  return drawn;
}

}  // namespace straytrace
