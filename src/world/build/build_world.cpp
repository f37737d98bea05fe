// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/math/linear_algebra.hpp"
#include "base/text/words.hpp"
#include "base/units/media_presets.hpp"
#include "io/delimited_text.hpp"
#include "scene/model_tree.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::world {
namespace {

double whole_power(double x, int n) {
  double p = 1;
  for (int i = 0; i < n; ++i) p *= x;
  return p;
}

// Each component a sum of c x^i y^j z^k, lengths in units of `scale`.
class PolynomialShape final : public ModeShape {
 public:
  struct Term {
    double factor;
    int power[3];
  };
  Vec3 at(Vec3 r) const override {
    Vec3 const u = (1 / scale) * r;
    double sum[3] = {};
    for (int c = 0; c < 3; ++c)
      for (Term const& t : terms[c])
        sum[c] += t.factor * whole_power(u.x, t.power[0]) * whole_power(u.y, t.power[1]) * whole_power(u.z, t.power[2]);
    return {sum[0], sum[1], sum[2]};
  }
  std::vector<Term> terms[3];
  double scale = 1;  // m
};

// Bending of a slender beam between its ends, Euler and Bernoulli, largest displacement of an end or antinode about 1.
class BentBeam final : public ModeShape {
 public:
  enum class Ends { pinned, free, clamped };  // both pinned; both free; first clamped, second free
  BentBeam(Vec3 along, Vec3 direction, double length, int order, Ends ends)
      : along_(along), direction_(direction), length_(length), order_(order), ends_(ends) {
    if (ends != Ends::pinned) wave_ = wave_number();
  }
  Vec3 at(Vec3 r) const override { return shape(dot(r, along_) / length_ + 0.5) * direction_; }

 private:
  // Root of cos b cosh b = 1 (free) or -1 (clamped and free).
  double wave_number() const {
    double const sign = ends_ == Ends::free ? 1 : -1;
    double b = (ends_ == Ends::free ? order_ + 0.5 : order_ - 0.5) * pi;
    for (int i = 0; i < 50; ++i) {
      double const f = std::cos(b) - sign / std::cosh(b), slope = -std::sin(b) + sign * std::tanh(b) / std::cosh(b);
      b -= f / slope;
    }
    return b;
  }
  double shape(double s) const {
    if (ends_ == Ends::pinned) return std::sin(order_ * pi * s);
    double const b = wave_, x = b * s;
    if (ends_ == Ends::free) {
      double const ratio = (std::cosh(b) - std::cos(b)) / (std::sinh(b) - std::sin(b));
      return 0.5 * (std::cosh(x) + std::cos(x) - ratio * (std::sinh(x) + std::sin(x)));
    }
    double const ratio = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
    return 0.5 * (std::cosh(x) - std::cos(x) - ratio * (std::sinh(x) - std::sin(x)));
  }

  Vec3 along_, direction_;
  double length_;
  int order_;
  Ends ends_;
  double wave_ = 0;
};

// Rectangular plate with simply supported edges.
class Plate final : public ModeShape {
 public:
  Vec3 at(Vec3 r) const override {
    double const s = dot(r, along) / size[0] + 0.5, t = dot(r, cross(normal, along)) / size[1] + 0.5;
    return std::sin(order[0] * pi * s) * std::sin(order[1] * pi * t) * normal;
  }
  Vec3 normal, along;
  double size[2] = {};
  int order[2] = {};
};

// Cross section of a thin tube: radial cos(n phi), and the tangential motion that leaves its wall unstretched.
class Tube final : public ModeShape {
 public:
  Vec3 at(Vec3 r) const override {
    double const x = dot(r, from), y = dot(r, cross(axis, from)), phi = std::atan2(y, x);
    if (x == 0 && y == 0) return {};
    Vec3 const out = std::cos(phi) * from + std::sin(phi) * cross(axis, from), round = cross(axis, out);
    if (order == 0) return out;
    return std::cos(order * phi) * out - std::sin(order * phi) / order * round;
  }
  Vec3 axis, from;  // phi counts from there
  int order = 2;
};

std::optional<Vec3> read_unit(Node const& table, std::string_view key) {
  if (!table.has(key)) {
    table.problem(fmt::format("'{}' is missing", key), fmt::format("add '{}: [0, 0, 1]'", key));
    return {};
  }
  return read_direction(table[key]);
}

bool unread(Node const& table, std::string_view key, std::vector<double> const& v) {
  return table.has(key) && some_missing(v);
}

using Shape = std::shared_ptr<ModeShape const>;

Shape read_polynomial_shape(Node const& t) {
  auto shape = std::make_shared<PolynomialShape>();
  if (t.has("scale")) shape->scale = t.number("scale", dim::length, required, 1e-9);
  constexpr std::array<std::string_view, 3> names = {"x", "y", "z"};
  for (int c = 0; c < 3; ++c)
    for (Node const& term : t.list(names[std::size_t(c)])) {
      std::vector<double> const v = term.as_numbers(dim::plain, 4);
      if (some_missing(v)) return {};
      PolynomialShape::Term to{v[0], {int(v[1]), int(v[2]), int(v[3])}};
      for (int i = 0; i < 3; ++i)
        if (!(v[std::size_t(i) + 1] == to.power[i] && to.power[i] >= 0 && to.power[i] <= 20)) {
          term.problem("powers are whole numbers from 0 to 20", "write [factor, power of x, power of y, power of z]");
          return {};
        }
      shape->terms[c].push_back(to);
    }
  return shape;
}

Shape read_beam(Node const& t) {
  constexpr std::array<std::string_view, 3> choices = {"pinned", "free", "clamped"};
  auto const along = read_unit(t, "along"), direction = read_unit(t, "direction");
  double const length = t.number("length", dim::length, required, 1e-9);
  auto const order = t.whole("order", 1, 1, 20);
  std::string const ends = t.choice("ends", choices, "free");
  if (!along || !direction || !std::isfinite(length) || order == 0 || ends.empty()) return {};
  return std::make_shared<BentBeam>(*along, *direction, length, int(order),
                                    ends == "pinned" ? BentBeam::Ends::pinned
                                    : ends == "free" ? BentBeam::Ends::free
                                                     : BentBeam::Ends::clamped);
}

Shape read_plate(Node const& t) {
  auto shape = std::make_shared<Plate>();
  auto const normal = read_unit(t, "normal"), along = read_unit(t, "along");
  std::vector<double> const size = t["size"].as_numbers(dim::length, 2), order = t["order"].as_numbers(dim::plain, 2);
  if (!normal || !along || unread(t, "size", size) || unread(t, "order", order)) return {};
  if (std::fabs(dot(*normal, *along)) > 1e-9) {
    t["along"].problem("'along' must lie in the plate, perpendicular to 'normal'",
                       "write the direction of the first side");
    return {};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    shape->size[i] = size[i];
    shape->order[i] = int(order[i]);
    if (!(size[i] > 0) || order[i] != shape->order[i] || shape->order[i] < 1) {
      t.problem("sides are positive lengths, orders whole numbers from 1", "write 'size: [1 m, 0.6 m], order: [1, 2]'");
      return {};
    }
  }
  shape->normal = *normal;
  shape->along = *along;
  return shape;
}

Shape read_tube(Node const& t) {
  auto shape = std::make_shared<Tube>();
  auto const axis = read_unit(t, "axis"), from = read_unit(t, "from");
  shape->order = int(t.whole("order", 2, 0, 100));
  if (!axis || !from) return {};
  Vec3 const across = *from - dot(*axis, *from) * *axis;
  if (!(length(across) > 1e-9)) {
    t["from"].problem("'from' (phi = 0) must not be parallel to the axis", "write a direction perpendicular to 'axis'");
    return {};
  }
  shape->axis = *axis;
  shape->from = unit(across);
  return shape;
}

// Shapes as tables of points, from a finite-element program or a tapping test.

struct ModePoint {
  Vec3 place, displacement;  // m; per unit of the coordinate
};

// A plane through the nearest points, weighted by 1/(distance^2 + (1e-6 of the farthest)^2): it reproduces fields that
// are linear in the place exactly, if the points span the directions in which the shape is evaluated.
class PointsShape final : public ModeShape {
 public:
  explicit PointsShape(std::vector<ModePoint> points)
      : points_(std::move(points)), neighbours_(std::min<std::size_t>(12, points_.size())) {}

  Vec3 at(Vec3 r) const override {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < points_.size(); ++i) order.emplace_back(length2(points_[i].place - r), i);
    std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(neighbours_), order.end());
    double const farthest = order[neighbours_ - 1].first;
    auto const n = Eigen::Index(neighbours_);
    Eigen::MatrixXd a(n, 4), b(n, 3);
    double const size = farthest > 0 ? std::sqrt(farthest) : 1;
    for (Eigen::Index i = 0; i < n; ++i) {
      auto const& [distance2, at] = order[std::size_t(i)];
      double const w = 1 / std::sqrt(distance2 / (size * size) + 1e-12);
      Vec3 const d = (1 / size) * (points_[at].place - r), psi = points_[at].displacement;
      a.row(i) << w, w * d.x, w * d.y, w * d.z;
      b.row(i) << w * psi.x, w * psi.y, w * psi.z;
    }
    Eigen::RowVector3d const value = least_norm_solution(a, b, 1e-9).row(0);
    return {value[0], value[1], value[2]};
  }

 private:
  std::vector<ModePoint> points_;
  std::size_t neighbours_;
};

// {points: FILE, unit: m}: rows x, y, z, psi_x, psi_y, psi_z. Adds a summary to `description`.
Shape read_mode_points(Node const& shape, std::string& description) {
  Node const file = shape["points"];
  std::string const name = file.as_word(), unit_text = shape.word("unit");
  auto const unit = parse_unit(unit_text);
  if (!unit_text.empty() && (!unit || unit->dimension != dim::length))
    shape["unit"].problem(fmt::format("\"{}\" is not a unit of length", unit_text), "write 'm' or 'mm'");
  if (name.empty() || !unit || unit->dimension != dim::length) return {};
  auto const table = read_numbers(file, 6, "write x, y, z of the point and the three components of its displacement");
  if (!table) return {};
  if (table->rows() < 4) {
    file.file_problem(name, 0, 0, "a shape needs at least four points", "give more lines");
    return {};
  }
  std::vector<ModePoint> points;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    auto const v = table->row(i);
    points.push_back({unit->si * Vec3{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
  }
  description += unit_text + file.data_file(name);
  return std::make_shared<PointsShape>(std::move(points));
}

// Every scalar of a table, in the order of the file.
std::string written(Node const& node) {
  if (node.kind() == Node::Kind::scalar) return node.text() + " ";
  std::string text;
  if (node.kind() == Node::Kind::list)
    for (Node const& element : node.as_list()) text += written(element);
  if (node.kind() == Node::Kind::table)
    for (auto const& [key, value] : node.items()) text += key + ":" + written(value);
  return text;
}

}  // namespace

ElasticMode read_elastic_mode(Node const& node) {
  ElasticMode mode;
  if (node.kind() != Node::Kind::table) {
    node.problem("the shape of a mode is a table",
                 "write {beam: ...}, {plate: ...}, {tube: ...}, {polynomial: ...} or {points: FILE}");
    return mode;
  }
  if (node.has("origin")) {
    mode.origin = read_vector(node["origin"], dim::length);
    mode.origin_given = true;
  }
  mode.description = fmt::format("{} {} {} ", mode.origin.x, mode.origin.y, mode.origin.z);
  using Reader = Shape (*)(Node const&);
  constexpr std::array<std::pair<std::string_view, Reader>, 4> kinds = {
      {{"polynomial", read_polynomial_shape}, {"beam", read_beam}, {"plate", read_plate}, {"tube", read_tube}}};
  int found = 0;
  for (auto const& [key, read] : kinds) {
    if (!node.has(key)) continue;
    ++found;
    Node const t = node.table(key);
    if (!t) continue;
    mode.shape = read(t);
    t.refuse_unknown(fmt::format("shape '{}' of a mode", key));
    mode.description += std::string(key) + written(t);
  }
  if (node.has("points")) {
    ++found;
    mode.shape = read_mode_points(node, mode.description);
  }
  if (found != 1)
    node.problem("a mode has one shape",
                 "write {beam: ...}, {plate: ...}, {tube: ...}, {polynomial: ...} or {points: FILE}");
  node.refuse_unknown("the shape of a mode");
  return mode;
}

void read_trace_limits(Scene const& scene, World& world) {
  Node const t = scene.table("trace");
  if (!t) return;
  world.limits.max_order = std::uint32_t(t.whole("order_limit", world.limits.max_order, 1, 1e6));
  world.limits.roulette_below = t.number("roulette_below", dim::plain, world.limits.roulette_below, 0, 1);
  world.limits.route_vertices = std::uint32_t(t.whole("route_vertices", world.limits.route_vertices, 2, 8));
  world.limits.targets = t.flag("targets", true);
  world.limits.law_share = t.number("law_share", dim::plain, world.limits.law_share, 0.1, 1);
  world.limits.window = t.flag("window", true);
  world.limits.children = std::uint32_t(t.whole("children", world.limits.children, 1, 100000));
  world.reverse_routes = t.flag("reverse_routes", true);
  static constexpr std::string_view structures[] = {"axial", "none"};
  world.limits.brute_force = t.choice("structure", structures, "axial") == "none";
}

World build_world(Scene const& scene) { return build_world(scene, {}); }

World build_world(Scene const& scene, NetworkPowers const& powers) {
  World world;
  Registry names;
  world.notes = assumed_parameters(scene);
  read_media(scene, world, names);
  read_materials(scene, world, names);
  read_bodies(scene, world, names);
  read_surfaces(scene, world, names);
  world.settle_pivots();
  read_receivers(scene, world, names);
  read_beams(scene, world, names, powers);
  read_edges(scene, world, names);
  read_wave(scene, world, names);
  read_imperfections(scene, world, names);
  read_trace_limits(scene, world);
  if (scene.root().healthy()) {  // shapes with missing numbers cannot be searched
    world.finish();
    check_lays(scene, world);
    check_glass(scene, world, names);
    check_beams(scene, world);
    check_faces(scene, world);
  }
  return world;
}

// The table `media`: the filling of volumes. Also the wavelength, which indices and films need first.

namespace {

// A preset at the wavelength of the scene; empty after a problem, if the wavelength is out of range.
std::optional<Medium> from_preset(Node const& where, MediumPreset const& preset, double wavelength) {
  if (auto const index = index_of(preset, wavelength)) return Medium{*index, 0};
  where.problem(fmt::format("the index of '{}' is known from {:.0f} nm to {:.0f} nm only", preset.name,
                            preset.shortest * 1e9, preset.longest * 1e9),
                "give the index at the wavelength of the beams: 'media: {name: {index: 1.45}}'");
  return {};
}

MediumPreset const* find_preset(std::string_view name) {
  for (MediumPreset const& p : medium_presets())
    if (p.name == name) return &p;
  return nullptr;
}

}  // namespace

void read_media(Scene const& scene, World& world, Registry& names) {
  for (auto const& [name, beam] : scene.table("beams").items()) {
    double const wavelength = beam.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!std::isnan(wavelength)) world.wavelength = wavelength;
    break;  // one for all beams
  }
  for (auto const& [name, node] : scene.table("media").items()) {
    Medium medium;
    if (node.has("preset")) {
      if (node.has("index")) node.problem("'preset' and 'index' both set the index", "keep one of them");
      auto const found = find_medium(node["preset"], world, Registry{});
      if (found) medium = *found;
    } else {
      medium.index = node.number("index", dim::plain, required, 0.1, 10);
    }
    medium.absorption = node.number("absorption", dim::per_metre, 0, 0, 1e9);
    node.has("source");
    node.refuse_unknown(fmt::format("medium '{}'", name));
    names.media[name] = medium;
  }
}

bool is_medium(std::string_view name, Registry const& names) {
  return name == "vacuum" || find_preset(name) || names.media.contains(std::string(name));
}

std::optional<Medium> find_medium(Node const& where, World const& world, Registry const& names) {
  std::string const name = where.as_word();
  if (name.empty()) return {};
  if (auto const own = names.media.find(name); own != names.media.end()) return own->second;
  if (name == "vacuum") return Medium{};
  if (MediumPreset const* const preset = find_preset(name)) return from_preset(where, *preset, world.wavelength);
  std::vector<std::string> known{"vacuum"};
  for (MediumPreset const& p : medium_presets()) known.emplace_back(p.name);
  for (auto const& [own, medium] : names.media) known.push_back(own);
  std::string all;
  for (std::string const& k : known) all += (all.empty() ? "" : ", ") + k;
  where.problem(fmt::format("medium '{}' is not defined", name), did_you_mean(name, known, "known media: " + all));
  return {};
}

std::vector<KnownMedium> known_media() {
  std::vector<KnownMedium> all;
  for (MediumPreset const& p : medium_presets())
    for (double const wavelength : {1064e-9, 1550e-9})
      if (auto const index = index_of(p, wavelength)) {
        all.push_back({std::string(p.name), std::string(p.source), *index, wavelength});
        break;
      }
  return all;
}

// The table `edges`: rims that diffract light from one mirror of a cavity to the other (docs/theory/diffraction.md).

std::vector<std::string> groups_with_rims(World const& world) {
  std::vector<std::string> found;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    std::string const& group = world.name_of({id});
    bool const known = std::ranges::find(found, group) != found.end();
    if (!known && rim_of(world, {id})) found.push_back(group);
  }
  return found;
}

void choose_rims(Node const& node, World const& world, Registry const& names, std::vector<std::string> const& with_rims,
                 std::vector<std::string>& chosen) {
  std::string const pattern = node.as_word();
  bool any = false;
  for (std::string const& group : with_rims) {
    if (!matches(pattern, group)) continue;
    any = true;
    if (std::ranges::find(chosen, group) == chosen.end()) chosen.push_back(group);
  }
  if (any || is_refused(pattern, names)) return;
  auto const& all = world.groups();
  bool const solid = std::ranges::any_of(all, [&](auto const& group) { return matches(pattern, group); });
  std::string const near = nearest_word(pattern, with_rims);
  node.problem(
      solid ? fmt::format("'{}' has no inner edge", pattern) : fmt::format("'{}' is not an entry of 'scene'", pattern),
      !near.empty() && !solid
          ? fmt::format("did you mean '{}'?", near)
          : (with_rims.empty() ? std::string("inner edges are those of disks, caps and cones with an inner radius")
                               : fmt::format("entries with inner edges: {}", fmt::join(with_rims, ", "))));
}

namespace {

// Of the smallest rim that is chosen, m.
double smallest_rim(World const& world) {
  double radius = infinity;
  auto const& chosen = world.edges.groups;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (auto const rim = rim_of(world, {id}))
      if (std::ranges::find(chosen, world.name_of({id})) != chosen.end()) radius = std::min(radius, rim->radius);
  return radius;
}

// Teeth and offsets that are too large for the smallest rim.
void check_sizes(Node const& table, World const& world) {
  double const radius = smallest_rim(world);
  if (!(radius < infinity)) return;
  EdgeSettings const& edges = world.edges;
  auto const refuse = [&](std::string_view key, double size, double most, char const* of) {
    if (!table.has(key) || !(size >= most)) return;
    table[key].problem(fmt::format("{} of {:.4g} m is too large for an edge of radius {:.4g} m", key, size, radius),
                       fmt::format("choose less than {:.4g} m, {} of the smallest edge in 'surfaces'", most, of));
  };
  refuse("offset", length(edges.offset), radius, "the radius");
  refuse("tooth_height", edges.tooth_height, radius, "the radius");
  refuse("tooth_width", edges.tooth_width, 2 * pi * radius, "the circumference");
}

bool has_cavity(World const& world) {
  return std::ranges::any_of(world.footprints(), [](auto const& f) { return f.standing; });
}

}  // namespace

void read_edges(Scene const& scene, World& world, Registry const& names) {
  Node const table = scene.table("edges");
  if (!table) return;
  EdgeSettings& edges = world.edges;
  std::vector<std::string> const with_rims = groups_with_rims(world);
  std::vector<Node> const surfaces = table.list("surfaces");
  if (surfaces.empty())
    table.problem("'edges' names no surfaces", "add 'surfaces: \"baffles*\"', entries of 'scene' with inner edges");
  for (Node const& node : surfaces) choose_rims(node, world, names, with_rims, edges.groups);
  if (table.has("offset")) edges.offset = read_vector(table["offset"], dim::length);
  edges.tooth_height = table.number("tooth_height", dim::length, 0, 0, 1);
  if (table.has("tooth_width") && !table.has("tooth_height"))
    table["tooth_width"].problem("'tooth_width' without 'tooth_height'", "give both, or neither");
  if (table.has("tooth_height")) edges.tooth_width = table.number("tooth_width", dim::length, required, 1e-5, 1);
  check_sizes(table, world);
  static constexpr std::array<std::string_view, 3> sums = {"independent", "geometric", "in-phase"};
  std::string const sum = table.choice("sum", sums, "independent");
  edges.sum = EdgeSettings::Sum(std::ranges::find(sums, sum) - sums.begin());
  if (!has_cavity(world) && table.healthy())
    table.problem("no beam is the mode of a cavity, so no edge can diffract between its mirrors",
                  "add 'beams: {arm: {cavity: [ITM, ETM]}}', or remove 'edges'");
  table.refuse_unknown("'edges'");
}

}  // namespace straytrace::world
