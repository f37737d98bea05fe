// SPDX-License-Identifier: BSD-3-Clause
// Pictures computed by rays from a camera, to check the geometry of a scene (R3.36). No light
// is simulated: a headlight shows shapes. Page: docs/reference/render.md.
#pragma once

#include <functional>
#include <vector>

#include "world/model/view.hpp"

namespace straytrace::trace {

struct Camera {
  // perspective: pinhole. flat: parallel rays, with scales of its own along both sides. fisheye: the angle from the
  // middle grows evenly along the picture's radius.
  enum class Lens : std::uint8_t { perspective, flat, fisheye } lens = Lens::perspective;
  Vec3 eye, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  // m; orthonormal
  std::uint32_t columns = 800, rows = 600;
  double half_width = 1, half_height = 1;  // of the picture: tangents, m (flat), rad (fisheye)
  Departure from;                          // surface on which the eye stands, if any

  // Through a point of the picture in pixels from the upper left corner; pixel (i, j) has its centre at i + 0.5,
  // j + 0.5. t_max is 0 where a fisheye picture has no direction.
  Ray ray(double column, double row) const;
  double focal_length() const { return 0.5 * rows / half_height; }  // pixels per unit of half_height
};

// `field`: full angle from the lower to the upper edge, rad. Only the part of `up` across the direction of view counts.
Camera looking_at(Vec3 eye, Vec3 target, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows);
// Round picture of all directions within field/2 of `look`; `up` as above.
Camera fisheye_at(Vec3 eye, Vec3 target, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows);

// Half space that is not drawn: points with dot(p, normal) > offset.
struct Cut {
  Vec3 normal;
  double offset = 0;  // m
};

// A view in which everything in the box is seen.
struct Framing {
  Camera camera;
  std::vector<Cut> cuts;
};
Box bounds_of(WorldView const&, std::function<bool(SurfaceId)> const& wanted);
// From above, from the side and from the front; anything nearer than the box is cut away. Flat when the box is more
// than `longest_aspect` times as long as wide: the half beyond the axis, each side of the picture with its own scale.
constexpr double longest_aspect = 12;
bool is_long(Box const&);
Framing framing(Box const&, double field, std::uint32_t columns, std::uint32_t rows);
Framing section(Box const&, std::uint32_t columns, std::uint32_t rows);

enum class Look : std::uint8_t {
  solid,
  glass,  // bounds a medium and transmits: a tint over the surfaces behind, no refraction
  open    // carries no material on this side, but does on the other: not drawn
};
std::vector<Look> looks_of(WorldView const&);  // two per surface: front, back

struct Seen {
  SurfaceId surface;
  std::uint32_t piece = 0;
  double distance = infinity;  // m from where the ray starts
  Vec3 point, normal;          // m; towards the eye
  bool front = true;
};
struct Sight {
  static constexpr int most_glass = 8;
  Seen solid;              // invalid surface: nothing
  Seen glass[most_glass];  // before it, from the eye on
  int panes = 0;
};
struct LookSettings {
  std::vector<Cut> cuts;
  std::vector<Look> looks;  // empty: all solid
  unsigned threads = 0;     // 0: all cores
};
Sight sight(WorldView const&, Ray, Departure from, LookSettings const&);

// One per pixel centre, row by row.
std::vector<Seen> seen_by(WorldView const&, Camera const&, LookSettings const&);

struct Rgb {
  double r = 0, g = 0, b = 0;  // 0 to 1
};
using Paint = std::function<Rgb(Seen const&)>;
// Three bytes per pixel, row by row; headlight, dark edges, four rays per pixel. `visible`, one flag per surface, is
// set for those in the picture. `edge_on`: brightness of surfaces seen edge-on; 1: colours as painted.
std::vector<std::uint8_t> shaded(WorldView const&, Camera const&, LookSettings const&, Paint const&,
                                 std::vector<bool>& visible, double edge_on = 0.35);

// The view of a camera with its own flash: scattered light and glints, as in photographs taken to find retro-reflecting
// surfaces (R3.36). Page: docs/reference/render.md.

// A small sphere around the eye shines equally in all directions, with the radiant intensity I [W/sr].
struct Flash {
  double radius = 5e-3;    // m, of the sphere; its radiance is I/(pi radius^2)
  int most_mirrors = 6;    // reflections and transmissions on a path
  double faintest = 1e-7;  // remaining share of the light, below which a path is not followed
};

// Radiance towards the eye over I, 1/m^2, along one ray. Of a surface at the distance d, seen by way of mirrors and
// glass that pass the share T one way: T^2 BRDF cos(theta)/d^2 with the BRDF [1/sr] for light that goes back where it
// came from. d is the length of the way: a surface seen in a curved mirror or through a lens has the brightness of a
// flat one. A way that comes back to the sphere sees it: T/(pi radius^2), exact for mirrors of any shape.
struct FlashLight {
  double scattered = 0, glint = 0;
  SurfaceId first;  // that the ray meets; invalid: none
  double both() const { return scattered + glint; }
};
// `open`: two flags per surface, front and back, of transparent sides (Look::open); empty: none.
FlashLight flash_along(WorldView const&, Ray, Departure from, Vec3 eye, Flash const&, std::vector<Look> const& looks);

// One per pixel, row by row: mean of 3 x 3 rays.
std::vector<FlashLight> flash_picture(WorldView const&, Camera const&, Flash const&, LookSettings const&);

// Solid angle of a pixel, sr; its radiance times this is the irradiance at the eye.
double solid_angle(Camera const&, std::uint32_t column, std::uint32_t row);

}  // namespace straytrace::trace
