// SPDX-License-Identifier: BSD-3-Clause
// Beams of the interferometer -> lit surfaces, and the ports where light rejoins them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/text/words.hpp"
#include "beams/cavity_mode.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

// A route and its reverse are one coherent pair: C_rev counts on both ends being ports (docs/theory/path_integral.md,
// eq. 1.5).
void warn_of_closed_ends(Scene const& scene, World const& world) {
  for (Footprint const& f : world.footprints())
    if (f.standing && !f.receives && !world.ports().empty())
      scene.table("ports").warning(
          fmt::format("no port is open at '{}', a mirror of a cavity: light that rejoins there is not counted",
                      world.name_of(f.surface)),
          "open a port at each mirror of the cavity");
}

constexpr double least_power = 1e-12;  // W

// W; not a number with a problem, or where the interferometer has one.
double read_power(Node const& beam, NetworkPowers const& network) {
  if (!beam.has("network")) return beam.number("power", dim::power, required, least_power, 1e9);
  std::string const name = beam.word("network");
  if (beam.has("share"))
    beam["share"].problem("'network' and 'share' are both given", "remove 'share': the network states the power");
  if (beam.has("power"))
    beam["power"].problem("'network' and 'power' are both given", "keep one of them: the network states the power");
  if (network.faulty || name.empty()) return not_a_number;
  auto const found = network.watts.find(name);
  if (found != network.watts.end() && found->second >= least_power) return found->second;
  if (found != network.watts.end()) {
    beam["network"].problem(fmt::format("no light runs in the beam '{}' of the interferometer", name),
                            "name another, or write 'power'");
  } else if (network.watts.empty()) {
    beam["network"].problem("the scene has no interferometer whose network is solved",
                            "add 'interferometer: {preset: adv}' or another with a network, or write 'power'");
  } else {
    std::vector<std::string> known;
    for (auto const& [beam_name, watts] : network.watts) known.push_back(beam_name);
    beam["network"].problem(fmt::format("the interferometer has no beam '{}'", name),
                            did_you_mean(name, known, "name a port of a component and the way of its light: BS.3.out"));
  }
  return not_a_number;
}

// Light of both directions of a space returns from a face as one field (docs/theory/recoupling.md, eq. N.20), unless
// the interferometer states the response of one of the two ports.
void open_face_ports(Scene const& scene, World& world, std::vector<std::uint32_t> const& reverse) {
  auto const stated = [&](PortId port, PortId partner) {
    Node const ifo = scene.root()["interferometer"], ports = ifo["ports"], files = ifo["responses"];
    std::string const &name = world.ports()[port.value], &other = world.ports()[partner.value];
    Node const entry = ports && ports.has(name) ? ports[name] : Node();
    bool const table = entry.kind() == Node::Kind::table;
    if (table && entry.has("both_sides"))
      entry["both_sides"].problem(fmt::format("'{}' is a port too: light of the other side would count twice", other),
                                  "remove 'both_sides': faces that both beams meet are found");
    constexpr std::array keys = {"at", "lit_by", "distance", "lit_distance", "isolation", "pick_off"};
    bool const place = table && std::ranges::any_of(keys, [&](char const*key) { return entry.has(key); }),
               file = files && files.has(name);
    if (place || file)
      (place ? entry : files[name])
          .warning(fmt::format("faces that the beams of '{}' and '{}' both meet return two fields, whose powers add, "
                               "instead of one (docs/theory/recoupling.md, eq. N.20)",
                               name, other),
                   "state nothing but 'copies' here");
    return place || file;
  };
  auto const port_of = [&](std::uint32_t beam) {
    auto const at =
        std::ranges::find_if(world.footprints(), [&](Footprint const& f) { return f.beam == beam && f.port.valid(); });
    return at == world.footprints().end() ? PortId{} : at->port;
  };
  for (std::uint32_t b = 0; b < reverse.size(); ++b) {
    if (reverse[b] == World::no_beam || reverse[b] < b) continue;
    PortId const first = port_of(b), second = port_of(reverse[b]);
    if (!first.valid() || !second.valid()) continue;
    bool const one = stated(first, second), other = stated(second, first);
    if (!one && !other) world.open_face_port(first, second);
  }
}

// Every beam of the network has a port; light that joins another of them counts at a port of its own.
void open_network_ports(Scene const& scene, World& world, NetworkPowers const& network) {
  std::vector<std::uint32_t> reverse(world.beams.size(), World::no_beam);
  for (std::uint32_t b = 0; b < world.beams.size(); ++b) {
    LightBeam const& beam = world.beams[b];
    bool const lights = !beam.network.empty();
    for (std::uint32_t other = 0; lights && other < world.beams.size(); ++other)
      if (world.beams[other].network == network.reverse_of(beam.network)) reverse[b] = other;
    std::vector<std::uint32_t> scatter, met;
    bool open = !lights;
    for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
      Footprint const& f = world.footprints()[i];
      if (f.beam != b) continue;
      open = open || f.port.valid();
      if (f.emits && !f.free) scatter.push_back(i);
      if (world.feeds()[i].propagated) met.push_back(i);
    }
    // Ghosts join on surfaces that do not scatter, too.
    if (!open) world.open_port(beam.name, scatter.empty() ? met : scatter);
  }
  world.pair_ports(reverse);
  open_face_ports(scene, world, reverse);
}

// Of the last beam, W; not a number: it was wrong, so it is not also a missing one.
void set_power(double power, World& world, Lighting& light) {
  bool const wrong = std::isnan(power);
  if (world.beam_power == 0) world.beam_power = wrong ? 1 : power;
  if (!wrong) world.beams.back().share = light.power = power / world.beam_power;
  world.beam_powers.back() = wrong ? 1 : power;
}

}  // namespace

void read_beams(Scene const& scene, World& world, Registry const& names, NetworkPowers const& network) {
  Beams beams;
  std::vector<BehindMirror> behind;
  bool first = true;
  for (auto const& [name, node] : scene.table("beams").items()) {
    double const wavelength = node.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!first && wavelength != world.wavelength)
      node.problem("all beams of a scene must have the same wavelength", "trace each wavelength in a separate scene");
    world.wavelength = wavelength;
    first = false;
    Lighting light{name, std::uint32_t(beams.names.size()), 1, &network, &behind};
    bool const cavity =
        bool(node["cavity"]);  // then the network states the power of the mode, which its ports refer to
    world.beams.push_back({name, light.number, cavity ? "" : network.named_where_it_leaves(node["network"].text())});
    std::size_t const spots = world.footprints().size();
    world.beam_powers.push_back(0);
    node["modulation"];  // read with the motion
    if (node.has("power") || node.has("network")) set_power(read_power(node, network), world, light);
    if (Node const cavity = node["cavity"])
      read_cavity(node, cavity, names, world, light);
    else if (node.has("on"))
      read_spot(node, names, world, light);
    else if (node.has("from"))
      read_free(node, names, world, light);
    else
      node.problem(fmt::format("beam '{}' illuminates no surface", name),
                   "give 'cavity: [MIRROR, MIRROR]', 'on: SURFACE', or 'from' and 'facing'");
    node.refuse_unknown(fmt::format("beam '{}'", name));
    beams.names.push_back(name);
    bool const unfollowed = node.has("lit") && !node.healthy();
    beams.broken.push_back(world.footprints().size() == spots || unfollowed);
  }
  for (BehindMirror const& b : behind) light_behind(b, names, world, network);
  for (auto const& [name, node] : scene.table("ports").items())
    for (std::size_t b = beams.names.size(); b < world.beams.size(); ++b)
      if (world.beams[b].name == name)
        node.problem(fmt::format("'{}' is the port of the light of that name behind a mirror", name),
                     "choose another name");
  read_ports(scene, world, names, beams);
  if (scene.root().healthy()) open_network_ports(scene, world, network);
  warn_of_closed_ends(scene, world);
  if (scene.root().data()->misspelt) return;  // it may be the cause
  if (beams.names.empty())
    scene.root().problem("the scene has no beam", "add 'beams: {arm: {cavity: [ITM, ETM]}}'");
  else if (scene.table("ports").items().empty() && scene.table("receivers").items().empty())
    scene.root().problem("the scene has neither a port where light can rejoin nor a receiver",
                         "add 'ports: {ITM: {beam: arm, at: ITM}}', or 'receivers: {PD: {on: SURFACE}}'");
}

// Cavities: their modes are computed, not typed (docs/theory/beams.md, eq. 6.3).

// A cap or disk can be a cavity mirror.
bool read_mirror(Node const& node, Registry const& names, World const& world, CavityMirror& mirror) {
  mirror.id = find_surface(node, names);
  if (!mirror.id.valid()) return false;
  Surface const& surface = world.surfaces()[mirror.id.value];
  if (world.view().optics[surface.front].diffracts || world.view().optics[surface.back].diffracts) {
    node.problem(fmt::format("'{}' is a grating: the mode of a cavity with gratings is not computed", node.text()),
                 "state the beam by 'from' and 'facing', or give the mirror 'reflect' instead of 'grating'");
    return false;
  }
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

std::optional<SurfaceId> obstacle(World const& world, CavityMirror const& one, Vec3 from, CavityMirror const& two,
                                  Vec3 to) {
  WorldView const view = world.view();
  Vec3 const span = to - from;
  double const distance = length(span);
  Ray const chief{from, (1 / distance) * span, distance * (1 - 1e-9)};
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (id != one.id.value && id != two.id.value && !world.surfaces()[id].clear &&
        view.shapes.visit(world.surfaces()[id].shape,
                          [&](auto const& s) { return crossing_of(s, chief, false, 0).distance; }) < infinity)
      return SurfaceId{id};
  return {};
}

namespace {

Footprint cavity_spot(CavityMirror const& m, double w, Lighting const& beam) {
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

// Share of the power that the rims of both mirrors take per round trip (docs/theory/beams.md, eq. W.10); none where the
// mirrors are too large for the computation. A rim beyond 4.5 w takes less than 1e-17.
std::optional<double> rim_loss(CavityMirror const& one, CavityMirror const& two, double distance,
                               CavityMode const& mode, double wavelength) {
  RoundCavity const cavity{
      wavelength,
      one.curvature,
      two.curvature,
      {{0, std::fmin(one.radius, 4.5 * mode.w1)}, {distance, std::fmin(two.radius, 4.5 * mode.w2)}}};
  if (fresnel_number(cavity) > largest_fresnel_number) return {};
  return round_modes(cavity, 0, 1).front().loss();
}

std::string loss_text(std::optional<double> loss) {
  if (!loss) return "not computed (Fresnel number above " + fmt::format("{:g})", largest_fresnel_number);
  return *loss < 1e-12 ? "below 1e-12 (eq. W.10)" : fmt::format("{:.3g} (eq. W.10)", *loss);
}

}  // namespace

void read_cavity(Node const& beam, Node const& cavity, Registry const& names, World& world, Lighting const& light) {
  if (cavity.as_list().size() > 2) return read_ring_cavity(beam, cavity, names, world, light);
  std::string const& name = light.name;
  LitWish const lit = read_lit(beam, names);
  auto const mirrors = cavity.as_list();
  CavityMirror one, two;
  if (mirrors.size() < 2) {
    cavity.problem("a cavity has two mirrors or more", "write for example cavity: [ITM, ETM]");
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
    std::optional<double> const loss = rim_loss(one, two, distance, mode, world.wavelength);
    world.notes.push_back(fmt::format(
        "beam {}: cavity of {:.6g} m, radius {:.4g} mm and {:.4g} mm on the mirrors, waist {:.4g} mm; light "
        "lost past their rims per round trip: {}",
        name, distance, 1e3 * mode.w1, 1e3 * mode.w2, 1e3 * mode.waist, loss_text(loss)));
    if (loss && *loss > 1e-3)
      beam.warning(fmt::format("the light of '{}' loses {:.2g} per round trip past mirrors of radius {:g} m and {:g} m",
                               name, *loss, one.radius, two.radius),
                   "enlarge the mirrors or change the curvatures");
  } catch (NumericalError const& e) {
    cavity.problem(e.what(), "change the mirror curvatures or the length");
    return;
  }
  if (auto const id = obstacle(world, one, one.vertex, two, two.vertex)) {
    beam.problem(fmt::format("'{}' obstructs the beam '{}'", world.name_of(*id), name), "give it a hole or move it");
    return;
  }
  if (lit.wanted) light_up(beam, lit, names, world, light);
}

// Beams that are stated: a spot on a surface, or one that starts in empty space.

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
    return given.problem("the polarisation is parallel to the beam", "give a direction across the beam");
  f.polarisation = {unit(across), 1, 0, 0};
  world.polarised = true;
}

// Radius and curvature of the wavefront where the beam starts; of a Gaussian also from its waist:
// w^2 = w0^2 (1 + z^2/zR^2), 1/R = z/(z^2 + zR^2), zR = pi w0^2/lambda, at z behind the waist (docs/theory/beams.md,
// eq. 0.6).
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
    beam.problem(fmt::format("beam '{}' has no direction", light.name), "give 'facing', for example [0, 0, 1]");
  auto const facing = read_direction(beam["facing"]);
  f.travel = facing.value_or(Vec3{0, 0, 1});
  read_wavefront(beam, world, f);
  f.share = light.power * beam.number("share", dim::plain, 1, 0, 1);
  read_polarisation(beam, f.travel, world, f);
  if (std::ranges::find(world.groups(), light.name) != world.groups().end())
    return beam.problem(fmt::format("an entry of 'scene' is already called '{}'", light.name),
                        "routes begin with the name of the beam: choose another");
  if (!facing || !known_place(f.centre)) return;  // all else of the beam has been read
  f.origin = world.add_group(light.name);
  f.emits = !lit.wanted;  // then it is followed as a mode, not as rays
  world.add_footprint(f);
  bool const known = light.network && !world.beams[light.number].network.empty();
  if (known && beam.healthy() && f.profile == Profile::gaussian)
    end_in_network(beam, world, *light.network, world.beams[light.number].network);
  if (!lit.wanted) return;
  if (f.profile != Profile::gaussian)
    return beam["lit"].problem("only a Gaussian beam can propagate through the scene", "remove 'profile'");
  light_up(beam, lit, names, world, light);
}

void read_spot(Node const& beam, Registry const& names, World& world, Lighting const& light) {
  if (read_lit(beam, names).wanted)
    beam["lit"].problem("'on' states the lit surface, so 'lit' has no effect",
                        "launch the beam with 'from' and 'facing', or remove 'lit'");
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

namespace {

struct Met {
  double at;   // m along the travel, from the plane across it through the centre
  bool front;  // on the side the normal points to
  std::uint32_t piece;
};

// All crossings of a line from `before` m before its start, in their order.
std::vector<Met> crossings(WorldView const& view, SurfaceId id, Ray line, double before) {
  constexpr std::size_t most = 64;
  std::vector<Met> all;
  Departure from;
  double at = -before;
  line.origin = line.origin - before * line.dir;
  while (all.size() < most) {
    Crossing const next = view.cross(id.value, line, from);
    if (!(next.distance < infinity)) break;
    at += next.distance;
    line.origin = view.project(id, line.origin + next.distance * line.dir, next.piece);
    all.push_back({at, dot(view.normal(id, line.origin, next.piece), line.dir) < 0, next.piece});
    from = {id, next.piece};
  }
  return all;
}

// Which of them is lit.
std::size_t lit_one(std::vector<Met> const& all, double radius, auto const& alive) {
  constexpr double least = 1e-3;  // m, to which a place is stated
  std::size_t nearest = 0, first = all.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::fabs(all[i].at) < std::fabs(all[nearest].at)) nearest = i;
    if (first == all.size() && alive(all[i])) first = i;
  }
  if (std::fabs(all[nearest].at) <= std::fmax(radius, least)) return nearest;
  return first < all.size() ? first : 0;
}

}  // namespace

void place_spot(World const& world, Footprint& f) {
  constexpr int across = 8;  // lines tried in radius, and in azimuth
  WorldView const view = world.view();
  Surface const& surface = world.surfaces()[f.surface.value];
  double const before = view.shapes.visit(surface.shape, [&](auto const& shape) {
    Extent const e = shape.extent();
    return 2 * (e.r_max + std::fmax(std::fabs(e.low), std::fabs(e.high))) + length(f.centre - shape.reference());
  });
  std::vector<Met> const chief = crossings(view, f.surface, {f.centre, f.travel}, before);
  if (chief.size() < 2) return;
  auto const alive = [&](Met const& m) { return !only_absorbs(view.optics[m.front ? surface.front : surface.back]); };
  std::size_t const lit = lit_one(chief, f.radius, alive);
  double const place = chief[lit].at;
  double start = lit > 0 ? chief[lit - 1].at : -infinity, end = place;
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < across; ++k) {
      std::vector<Met> const line =
          crossings(view, f.surface, f.sample((i + 0.5) / across, (k + 0.5) / across), before);
      std::size_t same = line.size();
      for (std::size_t j = 0; j < line.size(); ++j)
        if (line[j].front == chief[lit].front &&
            (same == line.size() || std::fabs(line[j].at - place) < std::fabs(line[same].at - place)))
          same = j;
      if (same == line.size()) continue;
      end = std::min(end, line[same].at);
      if (same > 0) start = std::max(start, line[same - 1].at);
    }
  if (!(start > -infinity)) return;
  f.centre = f.centre + place * f.travel;
  f.backoff = place - 0.5 * (start + end);
}

// Where light rejoins the beams: at the surfaces named, or at all that a beam lights.

namespace {

struct Port {
  std::string name;
  Node node;
  std::uint32_t beam = 0;
  enum class At : std::uint8_t { surface, pattern, everywhere } at = At::everywhere;
  std::vector<SurfaceId> surfaces;  // unless everywhere
};

bool is_pattern(std::string const& name) { return name.find('*') != std::string::npos; }

// The key `at`; false: a problem was recorded.
bool read_place(Port& port, Registry const& names) {
  if (!port.node.has("at")) return true;
  std::string const at = port.node.word("at");
  if (!is_pattern(at)) {
    port.at = Port::At::surface;
    port.surfaces = {find_surface(port.node["at"], names)};
    return port.surfaces.front().valid();
  }
  port.at = Port::At::pattern;
  for (auto const& [name, id] : names.surfaces)
    if (matches(at, name)) port.surfaces.push_back(id);
  return true;
}

// Footprints of a port. Surfaces that do not scatter count only if the port names them.
std::vector<std::uint32_t> footprints_of(Port const& port, World const& world) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    bool const idle = !f.emits && world.feeds()[i].propagated;
    if (f.beam != port.beam || f.free || (idle && port.at != Port::At::surface)) continue;
    if (port.at == Port::At::everywhere || std::ranges::find(port.surfaces, f.surface) != port.surfaces.end())
      all.push_back(i);
  }
  return all;
}

void open(Port const& port, World& world, Beams const& beams) {
  std::vector<std::uint32_t> footprints = footprints_of(port, world);
  bool const lit = !footprints.empty();
  std::string taken;
  std::erase_if(footprints, [&](std::uint32_t i) {
    PortId const other = world.footprints()[i].port;
    if (other.valid()) taken = world.ports()[other.value];
    return other.valid();
  });
  if (!footprints.empty()) return world.open_port(port.name, footprints);
  if (beams.broken[port.beam]) return;
  std::string const& beam = beams.names[port.beam];
  Node const place = port.at == Port::At::everywhere ? port.node["beam"] : port.node["at"];
  if (lit)
    place.problem(fmt::format("port '{}' is already there", taken), "a spot of a beam can belong to only one port");
  else if (port.at == Port::At::everywhere)
    place.problem(fmt::format("beam '{}' illuminates no surface that scatters", beam), "nothing can rejoin it");
  else
    place.problem(fmt::format("beam '{}' does not illuminate '{}'", beam, port.node.word("at")),
                  "place the port where its beam meets a surface");
}

// Light that rejoins a ring does so in the mode of opposite direction; in a folded cavity both are one mode.
void check_ring_port(Node const& port, Node const& cavity) {
  if (!cavity || cavity.as_list().size() < 3) return;
  if (turns_back(cavity.as_list()))
    port["beam"].problem("light that rejoins a folded cavity is not computed",
                         "use 'receivers', or a scene of two mirrors with the same mode");
  else
    port.warning(
        "the port of a ring takes light into the mode of opposite direction alone, per passage; its resonance in the "
        "ring and light that rejoins along the beam are not counted",
        "scale the couplings by the gain of the ring in this mode, and state 'at' for the port in 'interferometer'");
}

}  // namespace

void read_ports(Scene const& scene, World& world, Registry const& names, Beams const& beams) {
  std::vector<Port> ports;
  for (auto const& [name, node] : scene.table("ports").items()) {
    std::string const beam = node.word("beam");
    auto const number = std::size_t(std::ranges::find(beams.names, beam) - beams.names.begin());
    bool const known = number < beams.names.size();
    if (!known && !beams.names.empty() && node.has("beam")) {
      node["beam"].problem(fmt::format("beam '{}' is not defined", beam),
                           did_you_mean(beam, beams.names, "name one of 'beams'"));
    }
    Port port;
    port.name = name;
    port.node = node;
    port.beam = std::uint32_t(number);
    bool const placed = read_place(port, names);
    if (known) check_ring_port(node, scene.table("beams").items()[number].second["cavity"]);
    node.refuse_unknown(fmt::format("port '{}'", name));
    if (known && placed) ports.push_back(port);
  }
  // More specific ports take their spots first; otherwise in the order of the scene.
  for (Port::At const at : {Port::At::surface, Port::At::pattern, Port::At::everywhere})
    for (Port const& port : ports)
      if (port.at == at) open(port, world, beams);
}

}  // namespace straytrace::world
