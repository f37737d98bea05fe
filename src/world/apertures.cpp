// SPDX-License-Identifier: BSD-3-Clause
#include "world/apertures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <type_traits>

namespace straytrace {
namespace {

// A straight stretch of the chief ray and the wave at its start.
struct Stretch {
  std::uint32_t beam;
  Vec3 start, travel;
  double length, radius, curvature;  // m, m, 1/m; positive when diverging

  // Q = curvature + i lambda/(pi w^2) goes over to Q/(1 + z Q).
  BeamInPlane at(double z, double wavelength) const {
    std::complex<double> const q{curvature, wavelength / (pi * radius * radius)}, there = q / (1.0 + z * q);
    return {std::sqrt(wavelength / (pi * there.imag())), there.real(), wavelength};
  }
};

// x across the beam points to the centre of the opening, or along e1 of the rim.
Vec3 x_axis(Vec3 offset, Vec3 otherwise) { return length(offset) > 0 ? unit(offset) : otherwise; }

// Rims whose opening the chief ray goes through.
void add_rims(World const& world, Stretch const& s, std::vector<BeamAperture>& all) {
  std::vector<BeamAperture> found;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    auto const rim = rim_of(world, {id});
    if (!rim || std::fabs(dot(rim->axis, s.travel)) < 1e-6) continue;
    double const z = dot(rim->centre - s.start, rim->axis) / dot(s.travel, rim->axis);
    Vec3 const offset = rim->centre - (s.start + z * s.travel);
    if (!(z > 1e-9 && z < s.length) || length(offset) > rim->radius) continue;
    BeamAperture a{s.beam, world.surfaces()[id].group, {id}, false, z, s.at(z, world.wavelength), {}};
    a.opening.radius = rim->radius + 0.5 * rim->tooth_depth;
    a.opening.tooth_height = rim->tooth_depth;
    a.opening.teeth = unsigned(rim->teeth);
    a.opening.x = length(offset);
    Vec3 const x = x_axis(offset, rim->e1), y = cross(s.travel, x);
    Vec3 const tip = std::cos(rim->phase) * rim->e1 + std::sin(rim->phase) * rim->e2;
    a.opening.phase = std::atan2(dot(tip, y), dot(tip, x));
    found.push_back(a);
  }
  std::sort(found.begin(), found.end(), [](auto const& a, auto const& b) { return a.along < b.along; });
  all.insert(all.end(), found.begin(), found.end());
}

// The rim of the disk or cap that a footprint lies on; the mirror turns the curvature round.
void add_mirror(World const& world, Footprint const& f, double along, std::vector<BeamAperture>& all) {
  world.view().shapes.visit(world.surfaces()[f.surface.value].shape, [&](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) {
      double roc = 0;
      if constexpr (std::is_same_v<Shape, Cap>) roc = s.curvature;
      bool const concave = dot(s.axis, f.travel) < 0;
      BeamAperture a{f.beam, world.surfaces()[f.surface.value].group, f.surface, true, along, {}, {}};
      a.at = {f.radius, f.curvature - 2 * (concave ? roc : -roc), world.wavelength};
      a.opening.radius = s.outer_radius;
      Vec3 const offset = s.reference() - f.centre;
      a.opening.x = length(offset - dot(offset, f.travel) * f.travel);
      all.push_back(a);
    }
  });
}

}  // namespace

std::vector<BeamAperture> apertures_of(World const& world) {
  std::vector<BeamAperture> all;
  auto const& spots = world.footprints();
  for (std::size_t i = 0; i < spots.size(); ++i) {
    Footprint const& f = spots[i];
    if (f.profile != Profile::gaussian) continue;
    if (f.free) {
      Hit const end = world.view().closest(Ray{f.centre, f.travel}, {});
      add_rims(world, {f.beam, f.centre, f.travel, end.distance, f.radius, f.curvature}, all);
      continue;
    }
    bool const pair = f.standing && i + 1 < spots.size() && spots[i + 1].standing && spots[i + 1].beam == f.beam;
    bool const second = f.standing && i > 0 && spots[i - 1].standing && spots[i - 1].beam == f.beam;
    double const along = second ? length(f.centre - spots[i - 1].centre) : 0;
    add_mirror(world, f, along, all);
    if (!pair) continue;
    double const span = length(spots[i + 1].centre - f.centre);
    add_rims(world, {f.beam, f.centre, -f.travel, span * (1 - 1e-9), f.radius, -f.curvature}, all);
  }
  return all;
}

}  // namespace straytrace
