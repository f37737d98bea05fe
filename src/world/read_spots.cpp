// SPDX-License-Identifier: BSD-3-Clause
// Beams that are stated: a spot on a surface, or one that starts in empty space.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "world/read_beams.hpp"
#include "world/spot_place.hpp"

namespace straytrace {
namespace {

Profile read_profile(Node const& beam) {
  static constexpr std::array<std::string_view, 3> profiles = {"gaussian", "even", "point"};
  std::string const profile = beam.choice("profile", profiles, "gaussian");
  return profile == "even" ? Profile::even : profile == "point" ? Profile::point : Profile::gaussian;
}

bool known_place(Vec3 v) { return std::isfinite(length(v)); }

// Linear, along the part of the vector that lies across the travel.
void read_polarisation(Node const& beam, Vec3 travel, World& world, Footprint& f) {
  Node const given = beam["polarisation"];
  if (!given) return;
  auto const vector = read_direction(given);
  if (!vector) return;
  Vec3 const across = *vector - dot(*vector, travel) * travel;
  if (!(length(across) > 1e-6))
    return given.problem("the polarisation lies along the beam", "give a direction across it");
  f.polarisation = {unit(across), 1, 0, 0};
  world.polarised = true;
}

// Radius and curvature of the wavefront where the beam starts; of a Gaussian also from its waist:
// w^2 = w0^2 (1 + z^2/zR^2), 1/R = z/(z^2 + zR^2), zR = pi w0^2/lambda, at z behind the waist (physics.md eq. 0.6).
void read_wavefront(Node const& beam, World const& world, Footprint& f) {
  Node const waist = beam.table("waist");
  if (!waist) {
    f.radius = f.profile == Profile::point ? 0 : beam.number("radius", dim::length, required, 1e-6, 10);
    f.curvature = beam.number("wavefront_curvature", dim::per_metre, 0, -1e3, 1e3);
    return;
  }
  for (char const* key : {"radius", "wavefront_curvature"})
    if (Node const other = beam[key]) other.problem(fmt::format("'waist' and '{}' are both given", key), "keep one");
  if (f.profile != Profile::gaussian) waist.problem("only a Gaussian beam has a waist", "give 'radius' instead");
  double const w0 = waist.number("radius", dim::length, required, 1e-7, 10);
  double const z = -waist.number("ahead", dim::length, 0, -1e6, 1e6);
  waist.refuse_unknown("'waist'");
  double const rayleigh = pi * w0 * w0 / world.wavelength;
  f.radius = w0 * std::hypot(1, z / rayleigh);
  f.curvature = z / (z * z + rayleigh * rayleigh);
}

}  // namespace

// A beam that starts in empty space, at the plane through `from` across `facing`.
void read_free(Node const& beam, Registry const& names, World& world, Lighting const& light) {
  LitWish const lit = read_lit(beam, names);
  Footprint f;
  f.free = true;
  f.receives = false;
  f.beam = light.number;
  f.profile = read_profile(beam);
  f.centre = read_vector(beam["from"], dim::length);
  if (!beam.has("facing"))
    beam.problem(fmt::format("beam '{}' goes nowhere", light.name), "give 'facing', for example [0, 0, 1]");
  auto const facing = read_direction(beam["facing"]);
  f.travel = facing.value_or(Vec3{0, 0, 1});
  read_wavefront(beam, world, f);
  f.share = light.power * beam.number("share", dim::plain, 1, 0, 1);
  read_polarisation(beam, f.travel, world, f);
  if (std::find(world.groups().begin(), world.groups().end(), light.name) != world.groups().end())
    return beam.problem(fmt::format("an entry of 'scene' is called '{}' already", light.name),
                        "routes begin with the name of the beam: choose another");
  if (!facing || !known_place(f.centre)) return;  // all else of the beam has been read
  f.origin = world.add_group(light.name);
  f.emits = !lit.wanted;  // then it is followed as a mode, not as rays
  world.add_footprint(f);
  if (!lit.wanted) return;
  if (f.profile != Profile::gaussian)
    return beam["lit"].problem("only a Gaussian beam can be followed through the scene", "leave 'profile' out");
  light_up(beam, lit, names, world, light);
}

void read_spot(Node const& beam, Registry const& names, World& world, Lighting const& light) {
  if (read_lit(beam, names).wanted)
    beam["lit"].problem("'on' states what the beam lights, so 'lit' finds nothing more",
                        "launch the beam with 'from' and 'facing', or leave 'lit' out");
  Footprint f;
  f.surface = find_surface(beam["on"], names);
  f.profile = read_profile(beam);
  f.radius = f.profile == Profile::point ? 0 : beam.number("radius", dim::length, required, 1e-6, 10);
  auto const travel = beam.has("travel") ? read_direction(beam["travel"]) : Vec3{0, 0, -1};
  f.travel = travel.value_or(Vec3{0, 0, -1});
  f.curvature = beam.number("wavefront_curvature", dim::per_metre, 0, -1e3, 1e3);
  f.share = light.power * beam.number("share", dim::plain, 1, 0, 1);
  read_polarisation(beam, f.travel, world, f);
  f.emits = beam.flag("emits", true);
  f.beam = light.number;
  f.receives = false;
  bool const aimed = beam.has("centre");
  if (aimed) f.centre = read_vector(beam["centre"], dim::length);
  if (!f.surface.valid() || !travel || !known_place(f.centre) || std::isnan(f.radius)) return;
  if (!aimed)
    f.centre =
        world.view().shapes.visit(world.surfaces()[f.surface.value].shape, [](auto const& s) { return s.reference(); });
  place_spot(world, f);
  world.add_footprint(f);
}

}  // namespace straytrace
