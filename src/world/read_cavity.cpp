// SPDX-License-Identifier: BSD-3-Clause
// Cavities: their modes are computed, not typed (physics.md eq. 6.3).
#include <fmt/format.h>

#include <cmath>

#include "base/message.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/clipping.hpp"
#include "world/read_beams.hpp"

namespace straytrace {
namespace {

struct Mirror {
  SurfaceId id;
  Vec3 vertex, axis;
  double curvature = 0, radius = 0;
};

// A cap or disk can be a cavity mirror.
bool read_mirror(Node const& node, Registry const& names, World const& world, Mirror& mirror) {
  mirror.id = find_surface(node, names);
  if (!mirror.id.valid()) return false;
  return world.view().shapes.visit(world.surfaces()[mirror.id.value].shape, [&](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) {
      mirror.vertex = s.reference();
      mirror.axis = s.axis;
      mirror.radius = s.outer_radius;
      if constexpr (std::is_same_v<Shape, Cap>) mirror.curvature = s.curvature;
      return true;
    }
    node.problem(fmt::format("a mirror of a cavity cannot be of shape '{}'", Shape::key), "use shape 'cap' or 'disk'");
    return false;
  });
}

Footprint cavity_spot(Mirror const& m, double w, Lighting const& beam) {
  Footprint f;
  f.surface = m.id;
  f.centre = m.vertex;
  f.travel = -m.axis;
  f.radius = w;
  f.curvature = m.curvature;  // the wavefront fits the mirror; arriving there it diverges
  f.share = beam.power;
  f.beam = beam.number;
  f.standing = true;
  f.receives = false;
  return f;
}

}  // namespace

void read_cavity(Node const& beam, Node const& cavity, Registry const& names, World& world, Lighting const& light) {
  std::string const& name = light.name;
  LitWish const lit = read_lit(beam, names);
  auto const mirrors = cavity.as_list();
  Mirror one, two;
  if (mirrors.size() != 2) {
    cavity.problem("a cavity has two mirrors here", "write for example cavity: [ITM, ETM]");
    return;
  }
  bool const found = read_mirror(mirrors[0], names, world, one);
  if (!read_mirror(mirrors[1], names, world, two) || !found) return;
  Vec3 const span = two.vertex - one.vertex;
  double const distance = length(span);
  if (!std::isfinite(distance + one.curvature + two.curvature)) return;  // a number is missing, and reported
  double const miss = std::fmax(length(cross(span, one.axis)), length(cross(span, two.axis)));
  if (!(distance > 0) || miss > 1e-9 * distance || dot(span, one.axis) < 0 || dot(span, two.axis) > 0) {
    cavity.problem(fmt::format("the mirrors of '{}' do not face each other", name),
                   "set 'at' and 'facing' so that each axis points at the other mirror's vertex");
    return;
  }
  try {
    CavityMode const mode = cavity_mode(distance, 1 / one.curvature, 1 / two.curvature, world.wavelength);
    world.add_footprint(cavity_spot(one, mode.w1, light));
    world.add_footprint(cavity_spot(two, mode.w2, light));
    world.notes.push_back(fmt::format(
        "beam {}: cavity of {:.6g} m, radius {:.4g} mm and {:.4g} mm on the mirrors, waist {:.4g} mm; light beyond the "
        "clear apertures: {:.3g} and {:.3g} (eq. 5.5)",
        name, distance, 1e3 * mode.w1, 1e3 * mode.w2, 1e3 * mode.waist, clipped_share(one.radius, mode.w1),
        clipped_share(two.radius, mode.w2)));
    for (auto const& [m, w] : {std::pair{&one, mode.w1}, std::pair{&two, mode.w2}})
      if (clipped_share(m->radius, w) > 1e-3)
        beam.warning(fmt::format("{:.2g} of the light of '{}' falls beside a mirror of radius {:g} m",
                                 clipped_share(m->radius, w), name, m->radius),
                     "enlarge the mirror or change the curvatures");
  } catch (NumericalError const& e) {
    cavity.problem(e.what(), "change the mirror curvatures or the length");
    return;
  }
  WorldView const view = world.view();
  Ray const chief{one.vertex, (1 / distance) * span, distance * (1 - 1e-9)};
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (id != one.id.value && id != two.id.value && !world.surfaces()[id].clear &&
        view.shapes.visit(world.surfaces()[id].shape,
                          [&](auto const& s) { return crossing_of(s, chief, false, 0).distance; }) < infinity) {
      beam.problem(fmt::format("'{}' stands in the beam '{}'", world.groups()[world.surfaces()[id].group.value], name),
                   "give it a hole or move it");
      return;
    }
  if (lit.wanted) light_up(beam, lit, names, world, light);
}

}  // namespace straytrace
