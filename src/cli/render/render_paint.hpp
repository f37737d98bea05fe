// SPDX-License-Identifier: BSD-3-Clause
// Colours of pictures, and what they mean.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "results/text/image.hpp"
#include "trace/camera/flash_camera.hpp"
#include "world/model/world.hpp"

namespace straytrace::cli {

struct LegendEntry {
  std::string colour, name, what;  // "#1f77b4", "blue", "tube"
};
// What comes back to the eye from an object by the light of a flash: irradiance over the intensity of the flash, 1/m^2.
struct Shine {
  std::string object;  // what a ray meets first
  double scattered = 0, glint = 0;
};
struct Drawn {
  std::vector<std::uint8_t> rgb;  // three bytes per pixel, row by row
  std::vector<LegendEntry> legend;
  std::vector<Shine> shine;      // of a flash: most first
  std::string scale;             // what shades mean, in words; empty: nothing to say
  std::optional<ColourBar> bar;  // added below the picture
};

// Colours by object: the first part of a group's name, "lens_1" of "lens_1/front". The same name gets the same colour
// in every scene, unless two names of a scene would share one.
Drawn draw_shaded(World const&, Camera const&, LookSettings const&);
Drawn draw_ids(World const&, Camera const&, LookSettings const&);      // one flat colour per group
Drawn draw_normals(World const&, Camera const&, LookSettings const&);  // in the frame of the camera
Drawn draw_depths(World const&, Camera const&, LookSettings const&);   // near white, far black, logarithmic
// Adjoint of the steering tables (docs/theory/sampling.md): where light must not go.
// `kept`: of a run of this scene; null: made anew.
Drawn draw_importance(World&, Camera const&, LookSettings const&, ImportanceMap const* kept);
// Logarithmic; what is more than the brightest scattered light is white (cli/render/render.cpp).
Drawn draw_flash(World const&, Camera const&, LookSettings const&, Flash const&);

std::string object_of(std::string const& group);

}  // namespace straytrace::cli
