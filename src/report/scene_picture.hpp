// SPDX-License-Identifier: BSD-3-Clause
// Pictures of a scene as a camera sees it, and lines of its beams.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "results/text/picture.hpp"
#include "trace/camera/camera.hpp"
#include "trace/deterministic/halo_light.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

// Pictures of a scene as a camera sees it: their colours, and their meaning.

struct LegendEntry {
  std::string colour, name, what;  // "#1f77b4", "blue", "tube"
};
// Light returned to the eye by an object from a flash: irradiance over the intensity of the flash, 1/m^2.
struct Shine {
  std::string object;  // the first hit of a ray
  double scattered = 0, glint = 0;
};
// Power that an object takes of the light at small angles.
struct HaloOn {
  std::string object;
  double power = 0;  // W; over that of the mode where that is not stated
};
struct Drawn {
  std::vector<std::uint8_t> rgb;  // three bytes per pixel, row by row
  std::vector<LegendEntry> legend;
  std::vector<Shine> shine;  // of a flash: most first
  std::vector<HaloOn> halo;  // on all objects of the scene: most first
  bool halo_in_watts = false;
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
// Irradiance of the light of a cavity at small angles (docs/theory/wave.md); `power` of its mode [W], 0: not stated.
Drawn draw_halo(World const&, Camera const&, LookSettings const&, HaloLight const&, double power);
// By the camera's own flash, logarithmic; values above the brightest scattered light are white.
Drawn draw_flash(World const&, Camera const&, LookSettings const&, Flash const&);

std::string object_of(std::string const& group);
// Ends of a logarithmic scale of the irradiance on these surfaces, over the power of the mode, 1/m^2; 0: all dark.
struct HaloScale {
  double low = 0, high = 0;
};
HaloScale halo_scale(std::vector<HaloSurface> const&);

// Main beams of a scene in its pictures.

struct BeamLine {
  Vec3 from, to;  // m, of the chief ray
};
// Modes of cavities between their mirrors, and every launched beam at order 0 (world/ghosts/beam_tree.hpp), up to where
// it ends; light that leaves the scene ends at its box.
std::vector<BeamLine> beam_lines(World const&);

// Draws them into a picture of the scene, red, dotted behind what hides them, and adds them to the legend.
void draw_beams(Drawn&, World const&, Camera const&, LookSettings const&, std::vector<BeamLine> const&);

}  // namespace straytrace::report
