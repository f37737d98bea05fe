// SPDX-License-Identifier: BSD-3-Clause
// The table `wave`: a cavity whose field is computed by Fourier propagation (docs/theory/wave.md).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "beams/eigenmode.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::world {
namespace {

constexpr std::uint32_t least_points = 64, most_points = 8192;

// The cavity that the table names.
struct WaveCavity {
  Node mirrors;                               // the value of `cavity`; none when the beam is unknown or is not a cavity
  bool found = false;                         // with footprints on both mirrors
  bool names(std::string const& name) const;  // whether `cavity` contains this text
};

bool WaveCavity::names(std::string const& name) const {
  return std::ranges::any_of(mirrors.as_list(), [&](Node const& m) { return m.text() == name; });
}

// Numbers of the beams are their places in the table. Beams with a problem of their own have no footprints.
WaveCavity find_cavity(Node const& table, Scene const& scene, World& world) {
  WaveCavity cavity;
  WaveSettings& wave = world.wave;
  wave.beam_name = table.word("beam");
  std::vector<std::string> beams, cavities;
  for (auto const& [name, beam] : scene.table("beams").items()) {
    if (name == wave.beam_name) {
      wave.beam = std::uint32_t(beams.size());
      cavity.mirrors = beam["cavity"];
    }
    beams.push_back(name);
    if (beam.has("cavity")) cavities.push_back(name);
  }
  if (wave.beam_name.empty()) return cavity;
  std::string const remedy = cavities.empty() ? "add 'beams: {arm: {cavity: [ITM, ETM]}}', or remove 'wave'"
                                              : fmt::format("beams that are cavities: {}", fmt::join(cavities, ", "));
  if (std::ranges::find(beams, wave.beam_name) == beams.end())
    table["beam"].problem(fmt::format("beam '{}' is not defined", wave.beam_name),
                          did_you_mean(wave.beam_name, cavities, remedy));
  else if (!cavity.mirrors)
    table["beam"].problem(fmt::format("beam '{}' is not the mode of a cavity", wave.beam_name), remedy);
  wave.ring = cavity.mirrors && cavity.mirrors.as_list().size() > 2;
  std::vector<WaveSettings::Mirror> mirrors;
  for (Footprint const& f : world.footprints())
    if ((f.standing || wave.ring) && f.beam == wave.beam &&
        std::ranges::find(mirrors, f.surface, &WaveSettings::Mirror::surface) == mirrors.end())
      mirrors.emplace_back().surface = f.surface;
  cavity.found = cavity.mirrors && mirrors.size() >= 2;
  if (cavity.found) wave.mirrors = mirrors;
  return cavity;
}

// Numbers of points that the transforms take.
bool quick_to_transform(std::uint64_t n) {
  if (n == 0 || n % 2 != 0) return false;
  for (std::uint64_t const prime : {2, 3, 5})
    while (n % prime == 0) n /= prime;
  return n == 1;
}

void read_wave_grid(Node const& table, WaveSettings& wave) {
  Node const grid = table.table("grid");
  if (!grid) return;
  if (grid.has("points")) {
    std::uint64_t const points = grid.whole("points", required, least_points, most_points);
    if (points != 0 && !quick_to_transform(points)) {
      std::uint64_t fewer = points, more = points;  // both ends of the range are such numbers
      while (!quick_to_transform(fewer)) --fewer;
      while (!quick_to_transform(more)) ++more;
      grid["points"].problem(
          fmt::format("'points' must be even and have no prime factor other than 2, 3 and 5, got {}", points),
          fmt::format("write {} or {}", fewer, more));
    }
    wave.points = std::uint32_t(points);
  }
  if (grid.has("window")) wave.window = grid.number("window", dim::length, required, 1e-3, 100);
  grid.refuse_unknown("'grid'");
}

WaveSettings::Removed read_removed(Node const& map) {
  if (!map.has("remove")) return {};
  static std::vector<std::string> const orders = {"piston", "tilt", "curvature", "astigmatism"};
  std::array<bool, 4> removed{};
  for (Node const& node : map.list("remove")) {
    std::string const word = node.as_word();
    auto const at = std::ranges::find(orders, word) - orders.begin();
    if (at < std::ptrdiff_t(removed.size()))
      removed[std::size_t(at)] = true;
    else if (!word.empty())
      node.problem(fmt::format("'{}' cannot be removed from a map", shortened(word)),
                   did_you_mean(word, orders, fmt::format("accepted: {}", fmt::join(orders, ", "))));
  }
  return {removed[0], removed[1], removed[2], removed[3]};
}

// The document keeps the text of the file for the run file.
void read_map_file(Node const& file, WaveSettings::Mirror& mirror) {
  mirror.file = file.as_word();
  if (mirror.file.empty()) return;
  mirror.bytes = file.data_file(mirror.file);
  if (mirror.bytes.empty() && file.document()->optional_file(file, mirror.file))  // data_file() reports a missing one
    file.problem(fmt::format("file '{}' is empty", mirror.file), "export the map again");
}

// m/W
constexpr Dimension bulge_per_power{-2, -2, 6};

WaveSettings::Absorber read_absorber(Node const& table) {
  WaveSettings::Absorber absorber;
  absorber.radius = table.number("radius", dim::length, required, 1e-7, 0.1);
  double const power = table.number("power", dim::power, required, 0, 100);
  // Expansion (1 + Poisson's ratio)/conductivity of fused silica: 0.55e-6 /K, 0.17, 1.38 W/(m K)
  double const distortivity = table.number("distortivity", bulge_per_power, 0.55e-6 * 1.17 / 1.38, -1e-3, 1e-3);
  absorber.rise = power * distortivity;
  if (table.has("at"))
    if (std::vector<double> const at = table["at"].as_numbers(dim::length, 2); at.size() == 2)
      absorber.x = at[0], absorber.y = at[1];
  table.refuse_unknown("'absorber'");
  return absorber;
}

WaveSettings::Ripple read_ripple(Node const& table) {
  WaveSettings::Ripple ripple;
  Quantity const size = table.amplitude("amplitude", dim::length);
  double const to_peak = size.amplitude == Amplitude::peak_to_peak ? 0.5
                         : size.amplitude == Amplitude::rms        ? std::sqrt(2)
                                                                   : 1;
  ripple.amplitude = to_peak * size.si;
  ripple.period = table.number("period", dim::length, required, 1e-5, 10);
  ripple.direction = table.number("direction", dim::angle, 0, -2 * pi, 2 * pi);
  table.refuse_unknown("'ripple'");
  return ripple;
}

void read_defects(Node const& map, WaveSettings::Mirror& mirror) {
  if (!map.has("defects")) return;
  for (Node const& defect : map.list("defects")) {
    bool const table = defect.kind() == Node::Kind::table;
    bool const absorber = table && defect.has("absorber"), ripple = table && defect.has("ripple");
    if (absorber == ripple) {
      defect.problem(
          "a defect is one of 'absorber' and 'ripple'",
          "write {absorber: {radius: 50 um, power: 10 mW}} or {ripple: {amplitude: 1 nm peak, period: 8 mm}}");
      continue;
    }
    if (Node const inner = defect.table(absorber ? "absorber" : "ripple"))
      absorber ? mirror.absorbers.push_back(read_absorber(inner)) : mirror.ripples.push_back(read_ripple(inner));
    defect.refuse_unknown("a defect");
  }
}

void read_mirror_map(Node const& map, WaveSettings::Mirror& mirror) {
  static constexpr std::array<std::string_view, 2> spectra = {"material", "none"};
  bool const measured = map.has("file");
  bool const perfect = map.choice("spectrum", spectra, "material") == "none";
  mirror.heights = measured  ? WaveSettings::Heights::file
                   : perfect ? WaveSettings::Heights::none
                             : WaveSettings::Heights::material;
  mirror.seed = map.whole("seed", 1, 0, 9e15);
  mirror.removed = read_removed(map);
  read_defects(map, mirror);
  if (measured) read_map_file(map["file"], mirror);
  if (measured && map.has("spectrum"))
    map["spectrum"].problem("'file' and 'spectrum' both state the heights of the mirror", "keep one of them");
  if (measured && map.has("seed"))
    map["seed"].problem("'seed' is for random heights, not for those of a file", "remove 'seed'");
  for (char const* const key : {"seed", "remove"})
    if (perfect && !measured && map.has(key))
      map[key].problem(fmt::format("'{}' has no effect on a perfect mirror", key),
                       fmt::format("remove '{}', or write 'spectrum: material'", key));
  map.refuse_unknown("a map of a mirror");
}

// The mirror of the cavity that a key of `maps` names, or null with a problem.
WaveSettings::Mirror* mirror_of(std::string const& name, Node const& maps, WaveCavity const& cavity,
                                Registry const& names, WaveSettings& wave) {
  if (auto const at = names.surfaces.find(name); at != names.surfaces.end())
    for (WaveSettings::Mirror& m : wave.mirrors)
      if (m.surface.valid() && m.surface == at->second) return &m;
  if (is_refused(name, names) || (!cavity.found && (!cavity.mirrors || cavity.names(name))))
    return nullptr;  // its problem is reported
  std::vector<std::string> known;
  for (Node const& m : cavity.mirrors.as_list()) known.push_back(m.text());
  maps.document()->add({maps.key_place(name),
                        fmt::format("'{}' is not a mirror of the cavity '{}'", shortened(name), wave.beam_name),
                        did_you_mean(name, known, fmt::format("its mirrors: {}", fmt::join(known, ", "))),
                        Severity::error, code_points(name)});
  return nullptr;
}

void read_maps(Node const& table, WaveCavity const& cavity, Registry const& names, WaveSettings& wave) {
  Node const maps = table.table("maps");
  std::vector<WaveSettings::Mirror const*> done;
  for (auto const& [name, map] : maps.items()) {
    WaveSettings::Mirror unused;
    WaveSettings::Mirror* mirror = mirror_of(name, maps, cavity, names, wave);
    if (!mirror) mirror = &unused;
    if (std::ranges::find(done, mirror) != done.end())
      map.problem(fmt::format("'{}' is a mirror that has a map already", name), "keep one of them");
    if (mirror != &unused) done.push_back(mirror);
    mirror->name = name;
    if (map && map.kind() != Node::Kind::table)
      map.problem(fmt::format("the map of '{}' is not a table", name),
                  "write {file: map.h5}, {spectrum: material} or {spectrum: none}");
    else
      read_mirror_map(map, *mirror);
  }
}

// Two numbers along x and y of the frame of the cavity; zeros when absent.
std::array<double, 2> read_pair(Node const& table, std::string_view key, Dimension dimension, double largest) {
  if (!table.has(key)) return {};
  Node const node = table[key];
  std::vector<double> const v = node.as_numbers(dimension, 2);
  if (v.size() != 2 || some_missing(v)) return {};
  if (std::fabs(v[0]) > largest || std::fabs(v[1]) > largest)
    node.problem(fmt::format("'{}' must be at most {:g} {} along each axis", key, largest,
                             dimension == dim::angle ? "rad" : "m"),
                 "check its unit");
  return {v[0], v[1]};
}

constexpr double largest_tilt = 1e-3, largest_shift = 1;  // rad, m

void read_mirrors(Node const& table, WaveCavity const& cavity, Registry const& names, WaveSettings& wave) {
  Node const mirrors = table.table("mirrors");
  std::vector<WaveSettings::Mirror const*> done;
  for (auto const& [name, node] : mirrors.items()) {
    WaveSettings::Mirror unused;
    WaveSettings::Mirror* mirror = mirror_of(name, mirrors, cavity, names, wave);
    if (mirror && std::ranges::find(done, mirror) != done.end())
      node.problem(fmt::format("'{}' is a mirror that is described already", name), "keep one of them");
    if (!mirror) mirror = &unused;
    done.push_back(mirror);
    if (node && node.kind() != Node::Kind::table) {
      node.problem(fmt::format("what 'mirrors' states of '{}' is not a table", name),
                   "write for example {tilt: [0.1 urad, 0 rad], transmission: 1.4 %}");
      continue;
    }
    mirror->tilt = read_pair(node, "tilt", dim::angle, largest_tilt);
    mirror->shift = read_pair(node, "shift", dim::length, largest_shift);
    if (node.has("transmission")) mirror->transmission = node.number("transmission", dim::plain, required, 1e-9, 0.99);
    mirror->loss = node.number("loss", dim::plain, 0, 0, 0.5);
    if (mirror->transmission.value_or(0) + mirror->loss > 0.99)
      node.problem("a mirror that transmits and loses so much holds no light", "lower 'transmission' or 'loss'");
    node.refuse_unknown("a mirror of the cavity");
  }
}

void read_input(Node const& table, WaveSettings& wave) {
  Node const node = table.table("input");
  if (!node) return;
  WaveSettings::Input input;
  if (node.has("radius")) input.radius = node.number("radius", dim::length, required, 1e-6, 10);
  if (node.has("wavefront_curvature"))
    input.wavefront_curvature = node.number("wavefront_curvature", dim::per_metre, required, -1e3, 1e3);
  input.tilt = read_pair(node, "tilt", dim::angle, largest_tilt);
  input.shift = read_pair(node, "shift", dim::length, largest_shift);
  node.refuse_unknown("'input'");
  wave.input = input;
}

void read_tolerance(Node const& table, WaveSettings& wave) {
  if (Node const tolerance = table.table("tolerance")) {
    wave.tolerance.radius = tolerance.number("radius", dim::length, 0, 0, 0.1);
    wave.tolerance.centre = tolerance.number("centre", dim::length, 0, 0, 0.1);
    wave.tolerance.place = tolerance.number("place", dim::length, 0, 0, 10);
    tolerance.refuse_unknown("'tolerance'");
    if (!table.has("baffles"))
      tolerance.problem("'tolerance' without 'baffles'", "name the baffles that it is for, or remove it");
  }
}

void read_draws(Node const& table, WaveSettings& wave) {
  bool const drawn = wave.tolerance.any() || wave.rolled();
  if (table.has("draws") && !wave.random() && !table.has("tolerance"))
    table["draws"].problem("'draws' with mirrors of known heights and without 'tolerance': nothing is drawn",
                           "remove it, or give a 'tolerance'");
  constexpr double most_draws = 1000;  // which give the mean over the tolerances to 3 %
  auto const stated = std::uint32_t(table.whole("draws", drawn ? 32 : 1, 1, most_draws));
  wave.draws = drawn ? stated : 1;
}

void read_map_draws(Node const& table, WaveSettings& wave) {
  wave.map_draws = std::uint32_t(table.whole("map_draws", 1, 1, 1000));
  bool const perfect = std::ranges::all_of(
      wave.mirrors, [](WaveSettings::Mirror const& m) { return m.heights == WaveSettings::Heights::none; });
  if (table.has("map_draws") && perfect)
    table["map_draws"].problem("'map_draws' with perfect mirrors: nothing is drawn",
                               "remove it, or write 'spectrum: material' for a mirror in 'maps'");
}

// Both compute light that goes from mirror to mirror past the same rims.
void refuse_rims_of_edges(Node const& table, World const& world) {
  std::vector<std::string> twice;
  for (std::string const& group : world.wave.groups)
    if (std::ranges::find(world.edges.groups, group) != world.edges.groups.end()) twice.push_back(group);
  if (!twice.empty())
    table["baffles"].problem(
        fmt::format("'wave' and 'edges' count the same light twice, at the inner edges of {}", fmt::join(twice, ", ")),
        "remove 'edges'");
}

// What the field of a cavity of three mirrors or more does not have.
void refuse_of_rings(Node const& table, WaveSettings const& wave) {
  if (!wave.ring) return;
  for (char const* const key : {"tolerance", "draws", "map_draws"})
    if (table.has(key))
      table[key].problem(fmt::format("'{}' works for two-mirror cavities only", key), fmt::format("remove '{}'", key));
  for (auto const& [name, mirror] : table.table("mirrors").items())
    for (char const* const key : {"tilt", "shift"})
      if (mirror.kind() == Node::Kind::table && mirror.has(key))
        mirror[key].problem(fmt::format("'{}' works for two-mirror cavities only", key),
                            "turn or displace the mirror in 'scene'; the axis follows it");
  if (table.has("photodiodes"))
    table["photodiodes"].problem("'photodiodes' work for two-mirror cavities only", "remove 'photodiodes'");
}

}  // namespace

void read_wave(Scene const& scene, World& world, Registry const& names) {
  Node const table = scene.table("wave");
  if (!table) return;
  WaveSettings& wave = world.wave;
  wave.present = true;
  WaveCavity const cavity = find_cavity(table, scene, world);
  if (table.has("crossover")) wave.crossover = table.number("crossover", dim::angle, required, 1e-6, 0.1);
  std::vector<std::string> const with_rims = groups_with_rims(world);
  for (Node const& node : table.list("baffles")) choose_rims(node, world, names, with_rims, wave.groups);
  read_wave_grid(table, wave);
  read_maps(table, cavity, names, wave);
  read_map_draws(table, wave);
  read_mirrors(table, cavity, names, wave);
  read_input(table, wave);
  read_tolerance(table, wave);
  read_draws(table, wave);
  read_photodiodes(table, world, names);
  refuse_of_rings(table, wave);
  refuse_rims_of_edges(table, world);
  table.refuse_unknown("'wave'");
}

// Cavities of three mirrors or more: rings and folded ones. Their axis is the ray that closes on itself, their mode the
// eigenmode of its ray matrix (docs/theory/beams.md, Eigenmodes of cavities).

namespace {

constexpr std::size_t most_mirrors = 24;
constexpr double off_vertex = 1e-9;  // m; nearer is rounding of what the scene states

using Mirrors = std::vector<CavityMirror>;

std::string place_text(Vec3 p) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}] m", p.x, p.y, p.z); }
CavityMirror const& before(Mirrors const& all, std::size_t i) { return all[(i + all.size() - 1) % all.size()]; }
CavityMirror const& after(Mirrors const& all, std::size_t i) { return all[(i + 1) % all.size()]; }

// From vertex to vertex: the first mirror that sends the light past the next one.
struct Stray {
  std::size_t mirror = 0;
  double miss = 0;
  Vec3 facing;
};
std::optional<Stray> first_stray(Mirrors const& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    CavityMirror const& m = all[i];
    Vec3 const in = unit(m.vertex - before(all, i).vertex), way = after(all, i).vertex - m.vertex;
    Vec3 const out = in - 2 * dot(in, m.axis) * m.axis;
    double const along = dot(way, out), miss = along > 0 ? length(way - along * out) : length(way);
    if (miss > after(all, i).radius) return Stray{i, miss, unit(unit(way) - in)};
  }
  return {};
}

void explain(Node const& cavity, std::string const& reason, Mirrors const& all, World const& world) {
  auto const name = [&](CavityMirror const& m) { return world.name_of(m.id); };
  if (auto const stray = first_stray(all)) {
    CavityMirror const &here = all[stray->mirror], &next = after(all, stray->mirror);
    return cavity.problem(
        fmt::format("{}: '{}' at {} sends the light of '{}' past '{}' at {}, by {:.3g} m", reason, name(here),
                    place_text(here.vertex), name(before(all, stray->mirror)), name(next), place_text(next.vertex),
                    stray->miss),
        fmt::format("turn it: 'facing: [{:.9g}, {:.9g}, {:.9g}]', or list the mirrors in the order of the light",
                    stray->facing.x, stray->facing.y, stray->facing.z));
  }
  cavity.problem(reason, "change the curvatures, the places or the directions of the mirrors");
}

// The mirrors that the light does not meet on their fronts, or beside their clear apertures.
bool meets_fronts(Node const& cavity, Mirrors const& all, ClosedCavity const& found, World const& world) {
  bool good = true;
  for (std::size_t i = 0; i < all.size() && good; ++i) {
    CavityMirror const& m = all[i];
    Mode const& arriving = found.arriving[i];
    if (double const off = length(arriving.origin - m.vertex); off > m.radius) {
      explain(cavity,
              fmt::format("the axis meets '{}' at {}, {:.3g} m from its vertex, outside its radius of {:g} m",
                          world.name_of(m.id), place_text(arriving.origin), off, m.radius),
              all, world);
      good = false;
    } else if (!(dot(arriving.travel, m.axis) < 0)) {
      cavity.problem(fmt::format("the light meets the back of '{}'", world.name_of(m.id)), "turn its 'facing' around");
      good = false;
    }
  }
  return good;
}

std::string radii_text(Mode const& mode) {
  Spot const s = spot(mode);
  return s.major - s.minor < 5e-4 * s.major ? fmt::format("{:.4g} mm", 1e3 * s.major)
                                            : fmt::format("{:.4g} x {:.4g} mm", 1e3 * s.major, 1e3 * s.minor);
}

void note_mode(Mirrors const& all, ClosedCavity const& found, bool folded, std::string const& beam, World& world) {
  std::vector<std::string> spots, shifts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    spots.push_back(fmt::format("{} on {}", radii_text(found.arriving[i]), world.name_of(all[i].id)));
    Vec3 const off = found.arriving[i].origin - all[i].vertex;
    if (length(off) > off_vertex + 1e-12 * found.length)
      shifts.push_back(fmt::format("{:.3g} mm on {}", 1e3 * length(off), world.name_of(all[i].id)));
  }
  world.notes.push_back(
      fmt::format("beam {}: {} cavity of {:.6g} m per round trip; radius {}; each order in the plane of incidence adds "
                  "{:.5f}, across "
                  "it {:.5f} of the free spectral range",
                  beam, folded ? "folded" : "ring", found.length, fmt::join(spots, ", "), found.gouy[0] / (2 * pi),
                  found.gouy[1] / (2 * pi)));
  if (!shifts.empty())
    world.notes.push_back(
        fmt::format("beam {}: its axis passes the vertices of mirrors at {}", beam, fmt::join(shifts, ", ")));
}

void add_spots(Mirrors const& all, ClosedCavity const& found, Lighting const& light, World& world) {
  double path = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i > 0) path += length(found.arriving[i].origin - found.arriving[i - 1].origin);
    BeamSpot spot;
    spot.surface = all[i].id;
    spot.normal = all[i].axis;
    spot.mode = found.arriving[i];
    spot.power = 1;
    spot.path_length = path;
    add_lit_surface(world, light.number, light.power, Feed::none, spot, {});
  }
}

bool read_mirrors(Node const& cavity, Registry const& names, World const& world, Mirrors& all) {
  bool good = true;
  std::vector<Node> const nodes = cavity.as_list();
  if (nodes.size() > most_mirrors) {
    cavity.problem(fmt::format("a cavity of {} reflections per round trip", nodes.size()),
                   fmt::format("the limit is {}", most_mirrors));
    return false;
  }
  for (Node const& node : nodes) good = read_mirror(node, names, world, all.emplace_back()) && good;
  for (std::size_t i = 0; good && i < all.size(); ++i) {
    if (!std::isfinite(length(all[i].vertex) + all[i].curvature)) return false;  // a missing number, reported
    if (all[i].id != after(all, i).id) continue;
    nodes[i].problem(fmt::format("the light goes from '{}' to itself", nodes[i].text()),
                     "list the mirrors of one round trip, each next to those before and behind it");
    good = false;
  }
  return good;
}

}  // namespace

bool turns_back(std::vector<Node> const& mirrors) {
  std::size_t const n = mirrors.size();
  if (n < 3) return true;
  for (std::size_t first = 0; first < n; ++first) {
    bool same = true;
    for (std::size_t i = 1; i < n && same; ++i)
      same = mirrors[(first + i) % n].text() == mirrors[(first + n - i) % n].text();
    if (same) return true;
  }
  return false;
}

void read_ring_cavity(Node const& beam, Node const& cavity, Registry const& names, World& world,
                      Lighting const& light) {
  if (read_lit(beam, names).wanted)
    beam["lit"].problem("the light that leaves a cavity of three mirrors or more is not followed",
                        "launch a beam 'from' behind the mirror, and remove 'lit'");
  Mirrors all;
  if (!read_mirrors(cavity, names, world, all)) return;
  std::vector<SphericalMirror> mirrors;
  for (CavityMirror const& m : all) mirrors.push_back({m.vertex, m.axis, m.curvature});
  bool const folded = turns_back(cavity.as_list());
  try {
    ClosedCavity const found = closed_cavity(mirrors, world.wavelength);
    if (!meets_fronts(cavity, all, found, world)) return;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (auto const id = obstacle(world, all[i], found.arriving[i].origin, after(all, i),
                                   found.arriving[(i + 1) % all.size()].origin))
        return beam.problem(fmt::format("'{}' obstructs the beam '{}' between '{}' and '{}'", world.name_of(*id),
                                        light.name, world.name_of(all[i].id), world.name_of(after(all, i).id)),
                            "give it a hole or move it");
    add_spots(all, found, light, world);
    note_mode(all, found, folded, light.name, world);
  } catch (NumericalError const& e) {
    explain(cavity, e.what(), all, world);
  }
}

}  // namespace straytrace::world
