// SPDX-License-Identifier: BSD-3-Clause
// Beams of the interferometer -> lit surfaces. Modes of cavities are computed, not typed (physics.md eq. 6.3).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/message.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/clipping.hpp"
#include "world/read_parts.hpp"

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
    node.problem(fmt::format("a {} cannot be a mirror of a cavity", Shape::key), "use shape 'cap' or 'disk'");
    return false;
  });
}

// What a beam hands to all its footprints.
struct Lighting {
  std::string name;
  std::uint32_t number = 0;
  double power = 1;  // over that of the first beam that states one (q of eq. 1.1)
};

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

void read_cavity(Node const& beam, Node const& cavity, Registry const& names, World& world, Lighting const& light) {
  std::string const& name = light.name;
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
}

Profile read_profile(Node const& beam) {
  static constexpr std::array<std::string_view, 3> profiles = {"gaussian", "even", "point"};
  std::string const profile = beam.choice("profile", profiles, "gaussian");
  return profile == "even" ? Profile::even : profile == "point" ? Profile::point : Profile::gaussian;
}

// Linear, along the part of the vector that lies across the travel.
void read_polarisation(Node const& beam, Vec3 travel, World& world, Footprint& f) {
  Node const given = beam["polarisation"];
  if (!given) return;
  Vec3 const vector = read_vector(given, dim::plain), across = vector - dot(vector, travel) * travel;
  if (!(length(across) > 1e-6 * length(vector)))
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

// A beam that starts in empty space, at the plane through `from` across `facing`.
void read_free(Node const& beam, World& world, Lighting const& light) {
  Footprint f;
  f.free = true;
  f.receives = false;
  f.beam = light.number;
  f.profile = read_profile(beam);
  f.centre = read_vector(beam["from"], dim::length);
  Vec3 const facing = beam.has("facing") ? read_vector(beam["facing"], dim::plain) : Vec3{};
  if (!(length(facing) > 0))
    return beam.problem(fmt::format("beam '{}' goes nowhere", light.name), "give 'facing', for example [0, 0, 1]");
  f.travel = unit(facing);
  read_wavefront(beam, world, f);
  f.share = light.power * beam.number("share", dim::plain, 1, 0, 1);
  read_polarisation(beam, f.travel, world, f);
  if (std::find(world.groups().begin(), world.groups().end(), light.name) != world.groups().end())
    return beam.problem(fmt::format("an entry of 'scene' is called '{}' already", light.name),
                        "routes begin with the name of the beam: choose another");
  f.origin = world.add_group(light.name);
  world.add_footprint(f);
}

void read_spot(Node const& beam, Registry const& names, World& world, Lighting const& light) {
  Footprint f;
  f.surface = find_surface(beam["on"], names);
  f.profile = read_profile(beam);
  f.radius = f.profile == Profile::point ? 0 : beam.number("radius", dim::length, required, 1e-6, 10);
  Vec3 const travel = beam.has("travel") ? read_vector(beam["travel"], dim::plain) : Vec3{0, 0, -1};
  f.travel = length(travel) > 0 ? unit(travel) : Vec3{0, 0, -1};
  f.curvature = beam.number("wavefront_curvature", dim::per_metre, 0, -1e3, 1e3);
  f.share = light.power * beam.number("share", dim::plain, 1, 0, 1);
  read_polarisation(beam, f.travel, world, f);
  f.emits = beam.flag("emits", true);
  f.beam = light.number;
  f.receives = false;
  bool const aimed = beam.has("centre");
  if (aimed) f.centre = read_vector(beam["centre"], dim::length);
  if (!f.surface.valid()) return;  // all else of the beam has been read
  if (!aimed)
    f.centre =
        world.view().shapes.visit(world.surfaces()[f.surface.value].shape, [](auto const& s) { return s.reference(); });
  world.add_footprint(f);
}

// Beams as far as they were read; `broken` ones have a problem of their own, which ports need not repeat.
struct Beams {
  std::vector<std::string> names;
  std::vector<bool> broken;
};

void read_ports(Scene const& scene, World& world, Registry const& names, Beams const& beams) {
  for (auto const& [name, node] : scene.table("ports").items()) {
    std::string const beam = node.word("beam");
    std::uint32_t number = WorldView::none;
    for (std::uint32_t i = 0; i < beams.names.size(); ++i)
      if (beams.names[i] == beam) number = i;
    if (number == WorldView::none && !beams.names.empty() && node.has("beam")) {
      std::string const near = nearest_word(beam, beams.names);
      node["beam"].problem(fmt::format("beam '{}' is not defined", beam),
                           near.empty() ? "name one of 'beams'" : fmt::format("did you mean '{}'?", near));
    }
    SurfaceId const at = find_surface(node["at"], names);
    node.refuse_unknown(fmt::format("port '{}'", name));
    if (number == WorldView::none || !at.valid()) continue;
    if (!world.open_port(at, number, name) && !beams.broken[number])
      node["at"].problem(fmt::format("beam '{}' does not light '{}'", beam, node.word("at")),
                         "ports lie where their beam meets a surface");
  }
}

// A route and its reverse are one coherent pair: C_rev counts on both ends being ports (physics.md eq. 1.5).
void warn_of_closed_ends(Scene const& scene, World const& world) {
  for (Footprint const& f : world.footprints())
    if (f.standing && !f.receives && !world.ports().empty())
      scene.table("ports").warning(
          fmt::format("no port is open at '{}', a mirror of a cavity: light that rejoins there is not counted",
                      world.groups()[world.surfaces()[f.surface.value].group.value]),
          "open a port at each mirror of the cavity");
}

}  // namespace

void read_beams(Scene const& scene, World& world, Registry const& names) {
  Beams beams;
  bool first = true;
  for (auto const& [name, node] : scene.table("beams").items()) {
    double const wavelength = node.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!first && wavelength != world.wavelength)
      node.problem("all beams of a scene share one wavelength", "trace other wavelengths in scenes of their own");
    world.wavelength = wavelength;
    first = false;
    Lighting light{name, std::uint32_t(beams.names.size())};
    std::size_t const spots = world.footprints().size();
    if (node.has("power")) {
      double const power = node.number("power", dim::power, required, 1e-12, 1e9);
      bool const wrong = std::isnan(power);  // then it is not also a missing one
      if (world.beam_power == 0) world.beam_power = wrong ? 1 : power;
      if (!wrong) light.power = power / world.beam_power;
    }
    if (Node const cavity = node["cavity"])
      read_cavity(node, cavity, names, world, light);
    else if (node.has("on"))
      read_spot(node, names, world, light);
    else if (node.has("from"))
      read_free(node, world, light);
    else
      node.problem(fmt::format("beam '{}' lights nothing", name),
                   "give 'cavity: [MIRROR, MIRROR]', 'on: SURFACE', or 'from' and 'facing'");
    node.refuse_unknown(fmt::format("beam '{}'", name));
    beams.names.push_back(name);
    beams.broken.push_back(world.footprints().size() == spots);
  }
  read_ports(scene, world, names, beams);
  warn_of_closed_ends(scene, world);
  if (beams.names.empty())
    scene.root().problem("no beam lights the scene", "add 'beams: {arm: {cavity: [ITM, ETM]}}'");
  else if (scene.table("ports").items().empty() && scene.table("receivers").items().empty())
    scene.root().problem("there is no port where light could rejoin, and no receiver",
                         "add 'ports: {ITM: {beam: arm, at: ITM}}', or 'receivers: {PD: {on: SURFACE}}'");
}

}  // namespace straytrace
