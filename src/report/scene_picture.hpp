// SPDX-License-Identifier: BSD-3-Clause
// Pictures of a scene as a camera sees it: their colours, and their meaning.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "results/text/image.hpp"
#include "trace/camera/camera.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

struct LegendEntry {
  std::string colour, name, what;  // "#1f77b4", "blue", "tube"
};
// Light returned to the eye by an object from a flash: irradiance over the intensity of the flash, 1/m^2.
struct Shine {
  std::string object;  // the first hit of a ray
  double scattered = 0, glint = 0;
};
struct Drawn {
  std::vector<std::uint8_t> rgb;  // three bytes per pixel, row by row
  std::vector<LegendEntry> legend;
  std::vector<Shine> shine;      // of a flash: most first
  std::string scale;             // meaning of the shades, in words; may be empty
  std::optional<ColourBar> bar;  // added below the picture
};

// Colours by object: the first part of a group's name, "lens_1" of "lens_1/front". The same name gets the same colour
// in every scene, unless two names of a scene would share one.
Drawn draw_shaded(World const&, Camera const&, LookSettings const&);
Drawn draw_ids(World const&, Camera const&, LookSettings const&);      // one flat colour per group
Drawn draw_normals(World const&, Camera const&, LookSettings const&);  // in the frame of the camera
Drawn draw_depths(World const&, Camera const&, LookSettings const&);   // near white, far black, logarithmic
// Adjoint of the steering tables that the world has (docs/theory/sampling.md): surfaces that light must not reach.
Drawn draw_importance(World const&, Camera const&, LookSettings const&);
// By the camera's own flash, logarithmic; values above the brightest scattered light are white.
Drawn draw_flash(World const&, Camera const&, LookSettings const&, Flash const&);

std::string object_of(std::string const& group);

}  // namespace straytrace::report
