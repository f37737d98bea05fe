// SPDX-License-Identifier: BSD-3-Clause
// The list `imperfections` of an entry: single digs, scratches, glints and the chamfer of its surface, each an emitter
// of its own (docs/theory/surfaces.md, eq. 3.32, 3.33). Page: docs/reference/imperfections.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "base/input/document.hpp"
#include "base/math/rng.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

constexpr std::size_t most_imperfections = 500;  // emitters of a scene: each starts histories of its own
constexpr std::size_t too_many_to_trace = 50;    // from which on they take most of the time of a trace
constexpr double above = 1e-7;                   // m over the surface
constexpr std::size_t pieces_of_line = 16;
constexpr double steepest = 1.4;  // rad, tilt of a facet
constexpr Dimension metre2{4};

// A small disc on the surface, of the area that takes part.
struct ImperfectionPiece {
  double x = 0, y = 0;              // m, in the frame of the entry
  double area = 0;                  // m^2
  double slope_x = 0, slope_y = 0;  // of its normal against that of the surface, tangents
};
struct Imperfection {
  std::string name;
  std::vector<ImperfectionPiece> pieces;  // one, or those along a scratch or a chamfer
};

// The surface of an entry, or of a face of its part.
struct ImperfectionHost {
  SurfaceId id;
  Pose frame;
  bool front = true;  // the side that is not black
  double radius = 0;  // m, about the axis
};

double disc_area(double diameter) { return pi * diameter * diameter / 4; }

// In steps of 5 %: each size of a facet has a lobe of its own, whose table takes tens of milliseconds.
double stepped(double diameter) { return std::exp(0.05 * std::round(std::log(diameter) / 0.05)); }

// Number of N(>d) ~ d^-exponent between two diameters, at the quantile u.
double drawn_diameter(double low, double high, double exponent, double u) {
  if (!(high > low)) return low;
  if (std::fabs(exponent) < 1e-9) return low * std::pow(high / low, u);
  double const a = std::pow(low, -exponent), b = std::pow(high, -exponent);
  return std::pow(a + u * (b - a), -1 / exponent);
}

class ImperfectionReader {
 public:
  ImperfectionReader(Node const& row, ImperfectionHost const& host, std::uint64_t number)
      : row_(row), host_(host), number_(number) {}

  std::vector<Imperfection> read() {
    char const* const kind = row_.has("scratch")   ? "scratch"
                             : row_.has("chamfer") ? "chamfer"
                             : row_.has("facet")   ? "glint"
                                                   : "dig";
    std::string const name = row_.word("name", kind);
    if (row_.has("scratch")) return scratch(name);
    if (row_.has("chamfer")) return chamfer(name);
    sizes();
    std::vector<double> const tilt = tilts();
    double const spread = row_.number("spread", dim::angle, 0, 0, 0.5);
    bool const placed = row_.has("at");
    auto const count = row_.whole("count", 1, 1, most_imperfections);
    auto const seed = row_.whole("seed", 1, 0, 1u << 31);
    double const within = row_.number("within", dim::length, host_.radius, 0, 1e3);
    if (placed && row_.has("count"))
      row_["count"].problem("'at' places one imperfection, 'count' draws places", "keep one of them");
    Vec3 at;
    if (placed) at = place(row_["at"]);
    std::vector<Imperfection> all;
    if (!std::isfinite(low_ + high_ + within + at.x + tilt[0] + tilt[1] + spread)) return all;
    for (std::uint64_t i = 0; i < count; ++i) {
      Rng rng(seed, number_, std::uint32_t(i), Stream::height);
      double const rho = within * std::sqrt(rng.uniform()), turn = 2 * pi * rng.uniform(), u = rng.uniform();
      double const any = drawn_diameter(low_, high_, exponent_, u),
                   drawn = row_.has("facet") && high_ > low_ ? stepped(any) : any;
      ImperfectionPiece one{placed ? at.x : rho * std::cos(turn), placed ? at.y : rho * std::sin(turn),
                            disc_area(drawn)};
      double const size = std::sqrt(-2 * std::log(1 - rng.uniform())), way = 2 * pi * rng.uniform();
      one.slope_x = std::tan(std::clamp(tilt[0] + spread * size * std::cos(way), -steepest, steepest));
      one.slope_y = std::tan(std::clamp(tilt[1] + spread * size * std::sin(way), -steepest, steepest));
      all.push_back({name, {one}});
    }
    return all;
  }

 private:
  Vec3 place(Node const& pair) const {
    auto const xy = pair.as_numbers(dim::length, 2);
    return xy.size() == 2 ? Vec3{xy[0], xy[1], 0} : Vec3{not_a_number, not_a_number, 0};
  }

  std::vector<double> tilts() const {
    if (!row_.has("tilt")) return {0, 0};
    std::vector<double> const given = row_["tilt"].as_numbers(dim::angle, 2);
    if (given.size() != 2) return {not_a_number, not_a_number};
    if (std::fabs(given[0]) < steepest && std::fabs(given[1]) < steepest) return given;
    row_["tilt"].problem("the facet is tilted by more than 80 deg",
                         "give smaller angles about the normal of the surface");
    return {not_a_number, not_a_number};
  }

  // A cone about the axis at the outer edge of the surface, `width` wide as seen along the axis.
  std::vector<Imperfection> chamfer(std::string const& name) const {
    double const width = row_.number("chamfer", dim::length, required, 1e-6, 0.1),
                 angle = row_.number("angle", dim::angle, pi / 4, 0, steepest), radius = host_.radius - width / 2;
    if (!std::isfinite(width + angle)) return {};
    if (!(width < 0.2 * host_.radius)) {
      row_["chamfer"].problem(fmt::format("the chamfer is wide against the surface, of radius {:.4g} m", host_.radius),
                              "give at most a fifth of the radius, or describe it by a shape 'cone'");
      return {};
    }
    Imperfection one{name, {}};
    for (std::size_t i = 0; i < pieces_of_line; ++i) {
      double const turn = 2 * pi * (double(i) + 0.5) / pieces_of_line, x = std::cos(turn), y = std::sin(turn);
      one.pieces.push_back({radius * x, radius * y, 2 * pi * radius * width / std::cos(angle) / pieces_of_line,
                            std::tan(angle) * x, std::tan(angle) * y});
    }
    return {one};
  }

  // Diameters of discs of the same area: stated, ISO 10110-7 grade (root of the area), or dig number (10 um).
  void sizes() {
    int given = 0;
    for (char const* key : {"diameter", "grade", "dig", "area"}) given += row_.has(key);
    if (given != 1) {
      row_.problem(given == 0 ? "the size of the imperfection is missing" : "two sizes of one imperfection",
                   "write one of diameter: 50 um, grade: 0.16 mm (ISO 10110-7), dig: 10 (in units of 10 um), area");
      low_ = not_a_number;
    }
    if (row_.has("diameter")) diameters(row_["diameter"]);
    if (row_.has("grade")) low_ = high_ = row_.number("grade", dim::length, required, 1e-9, 0.1) * 2 / std::sqrt(pi);
    if (row_.has("dig")) low_ = high_ = 1e-5 * row_.number("dig", dim::plain, required, 1e-3, 1e4);
    if (row_.has("area")) low_ = high_ = std::sqrt(4 / pi * row_.number("area", metre2, required, 1e-18, 1e-2));
  }
  void diameters(Node const& node) {
    if (node.kind() != Node::Kind::list) {
      low_ = high_ = row_.number("diameter", dim::length, required, 1e-9, 0.1);
      return;
    }
    auto const range = node.as_numbers(dim::length, 2);
    constexpr double least = 1e-9;  // m
    low_ = range.size() == 2 ? range[0] : not_a_number;
    high_ = range.size() == 2 ? range[1] : not_a_number;
    exponent_ = row_.number("exponent", dim::plain, 2, 0, 10);
    if (!(std::isfinite(low_ + high_)) || (low_ >= least && high_ >= low_ && high_ <= 0.1)) return;
    node.problem("a range of diameters runs from the smallest, at least 1 nm, to the largest, at most 10 cm",
                 "write [10 um, 100 um]");
    low_ = not_a_number;
  }

  std::vector<Imperfection> scratch(std::string const& name) {
    auto const ends = row_.list("scratch");
    double const width = row_.number("width", dim::length, required, 1e-9, 1e-2);
    if (ends.size() != 2) {
      row_["scratch"].problem("a scratch runs between two places", "write scratch: [[0 mm, 0 mm], [3 mm, 1 mm]]");
      return {};
    }
    Vec3 const from = place(ends[0]), to = place(ends[1]);
    double const size = length(to - from);
    if (!std::isfinite(size + width)) return {};
    if (!(size > width)) {
      row_["scratch"].problem("the scratch is no longer than it is wide", "describe it as a dig: 'at' and 'diameter'");
      return {};
    }
    Imperfection one{name, {}};
    for (std::size_t i = 0; i < pieces_of_line; ++i) {
      Vec3 const p = from + ((double(i) + 0.5) / pieces_of_line) * (to - from);
      one.pieces.push_back({p.x, p.y, size * width / pieces_of_line});
    }
    return {one};
  }

  Node const& row_;
  ImperfectionHost const& host_;
  std::uint64_t number_;
  double low_ = 0, high_ = 0, exponent_ = 2;  // diameters, m
};

class ImperfectionAdder {
 public:
  ImperfectionAdder(World& world, Registry const& names)
      : world_(world), names_(names), spots_(world.footprints().size()) {}

  void add_entry(Scene::Instance const& instance, std::string const& face) {
    auto const id = names_.surfaces.find(instance.name);
    if (id == names_.surfaces.end() || !names_.frames.contains(id->second.value)) return;
    ImperfectionHost const host = host_of(id->second);
    std::uint64_t number = 0;
    for (Node const& row : instance.placement.list("imperfections")) {
      ++number;
      if ((row.has("face") ? row.word("face") : "") != face) continue;
      add_row(instance, row, host, number);
    }
  }

 private:
  ImperfectionHost host_of(SurfaceId id) const {
    Surface const& s = world_.surfaces()[id.value];
    Extent const e = world_.view().shapes.visit(s.shape, [](auto const& shape) { return shape.extent(); });
    return {id, names_.frames.at(id.value), s.front != names_.black, e.r_max};
  }

  // Its material, or nothing: a facet.
  std::optional<std::uint32_t> optic_of(Node const& row) const {
    Node const material = row["material"];
    std::string const name = material ? material.as_word() : "";
    auto const optic = names_.materials.find(name);
    if (row.has("facet")) {
      for (char const* key : {"material", "scratch", "chamfer"})
        if (row.has(key)) row[key].problem(fmt::format("'facet' and '{}' are both given", key), "keep one of them");
      return {};
    }
    for (char const* key : {"tilt", "spread"})
      if (row.has(key) && (row.has("scratch") || row.has("chamfer")))
        row[key].problem(fmt::format("'{}' is of a single disc", key), "remove it");
    if (!material)
      row.problem("the imperfection has no material",
                  "write material: NAME; {scatter: {model: lambertian, tis: 1}} scatters all light that meets it");
    else if (optic == names_.materials.end() && !name.empty())
      material.problem(fmt::format("material '{}' is not defined", name), "name one of 'materials'");
    return optic == names_.materials.end() ? std::nullopt : std::optional(optic->second);
  }

  void add_row(Scene::Instance const& instance, Node const& row, ImperfectionHost const& host, std::uint64_t number) {
    std::optional<std::uint32_t> const material = optic_of(row);
    double const facet = row.has("facet") ? row.number("facet", dim::plain, required, 0, 1) : 0;
    std::vector<Imperfection> const all = ImperfectionReader(row, host, number).read();
    row.refuse_unknown("an imperfection");
    if (!row.healthy()) return;
    std::size_t const before = count_;
    for (Imperfection const& one : all) {
      count_ += one.pieces.size();
      if (count_ > most_imperfections)
        return row.problem(
            fmt::format("more than {} imperfections (each piece of a scratch or chamfer counts)", most_imperfections),
            "keep the largest, and describe the others by the model 'defects' of the material");
      std::uint32_t const optic = material ? *material : facet_optic(facet, one.pieces.front().area);
      if (!add(instance.group, row, host, one, optic)) return;
    }
    if (before <= too_many_to_trace && count_ > too_many_to_trace)
      row.warning(
          fmt::format("more than {} single imperfections: the time of a trace grows with the square of their number",
                      too_many_to_trace),
          "keep the largest, and describe the others by the model 'defects' of the material");
  }

  // A flat mirror reflects R into its diffraction pattern, of peak R A/lambda^2 (eq. 3.33): the Gaussian lobe of the
  // same peak and total.
  std::uint32_t facet_optic(double reflectance, double area) {
    auto const [at, added] = facets_.try_emplace({reflectance, area});
    if (!added) return at->second;
    Gaussian lobe;
    lobe.peak = reflectance * area / (world_.wavelength * world_.wavelength);
    lobe.width = world_.wavelength / std::sqrt(2 * pi * area);
    lobe.prepare();
    Optic optic;
    optic.depolarise = 0;
    optic.law[optic.laws++] = world_.add_law(lobe);
    return at->second = world_.add_optic(optic);
  }

  // A disc for each piece, with the light of every beam of the host there.
  bool add(std::string const& group, Node const& row, ImperfectionHost const& host, Imperfection const& one,
           std::uint32_t optic) {
    std::size_t& number = named_[group + '/' + one.name];
    std::string const name = fmt::format("{}/{}_{}", group, one.name, ++number);
    double light = 0;
    for (ImperfectionPiece const& piece : one.pieces) {
      auto const where = on_surface(host, piece);
      if (!where) {
        row.problem(fmt::format("'{}' lies beside the surface, at ({:.4g}, {:.4g}) m", name, piece.x, piece.y),
                    "give its place in the frame of the entry, x and y from the axis");
        return false;
      }
      light += add_piece(name, host, piece, *where, optic);
      if (too_large_)
        row.problem(fmt::format("'{}' is {:.3g} of the beam '{}' wide, too large for one place", name, *too_large_,
                                world_.beams[large_in_].name),
                    "an imperfection is much smaller than the beam: describe larger ones as a surface of their own");
      if (too_large_) return false;
    }
    if (light > strongest_[group].second) strongest_[group] = {name, light};
    ++found_[group];
    return true;
  }

  std::optional<Pose> on_surface(ImperfectionHost const& host, ImperfectionPiece const& piece) const {
    WorldView const view = world_.view();
    Extent const e =
        view.shapes.visit(view.surfaces[host.id.value].shape, [](auto const& shape) { return shape.extent(); });
    double const room = 1 + e.high - e.low;
    Vec3 const start = host.frame.point({piece.x, piece.y, e.high + room});
    Crossing const met = view.cross(host.id.value, {start, -host.frame.e3, 2 * room + e.high - e.low}, {});
    if (!(met.distance < infinity)) return {};
    Vec3 const point = view.project(host.id, start - met.distance * host.frame.e3, met.piece);
    Vec3 const normal = view.normal(host.id, point, met.piece), lit = host.front ? normal : -normal;
    Vec3 const facing = unit(lit + piece.slope_x * host.frame.e1 + piece.slope_y * host.frame.e2);
    return facing_along(point + above * lit, facing);
  }

  // Share of the light of all beams that meets it (eq. 3.32).
  double add_piece(std::string const& name, ImperfectionHost const& host, ImperfectionPiece const& piece,
                   Pose const& where, std::uint32_t optic) {
    Surface const under = world_.surfaces()[host.id.value];
    Disk disc;
    disc.outer_radius = std::sqrt(piece.area / pi);
    disc.place(where);
    SurfaceId const id = world_.add_surface(disc, optic, names_.black, under.body, world_.add_group(name));
    world_.make_clear(id);
    double light = 0;
    for (std::size_t i = 0; i < spots_; ++i) {
      Footprint const of_host = world_.footprints()[i];
      Vec3 const travel = of_host.free ? Vec3{} : of_host.direction(where.origin);
      if (of_host.free || of_host.surface != host.id || !(dot(travel, where.e3) < 0)) continue;
      Footprint f = of_host;
      f.surface = id;
      f.centre = where.origin;
      f.travel = travel;
      f.profile = Profile::even;
      f.radius = disc.outer_radius;
      f.curvature = 0;
      f.astigmatism = {};
      f.hollow = 1;
      f.backoff = 0;
      f.share = of_host.share * of_host.intensity(where.origin) * piece.area;
      f.standing = false;
      f.returns = !of_host.standing;
      if (!(f.share > 0)) continue;
      light += f.share * -dot(travel, where.e3);
      constexpr double largest = 0.3;  // of the radius of the beam: |u|^2 changes by 17 % over the disc
      if (of_host.profile == Profile::gaussian && disc.outer_radius > largest * of_host.radius)
        std::tie(too_large_, large_in_) = std::pair(disc.outer_radius / of_host.radius, of_host.beam);
      Feed feed = world_.feeds()[i];
      if (of_host.standing) feed.mirror = std::uint32_t(i);
      world_.add_footprint(f, feed);
    }
    return light;
  }

 public:
  void note() const {
    for (auto const& [group, count] : found_) {
      auto const strongest = strongest_.find(group);
      std::string const most = strongest == strongest_.end() || !(strongest->second.second > 0)
                                   ? "no beam lights them"
                                   : fmt::format("'{}' receives most light, {:.3g} of the main mode",
                                                 strongest->second.first, strongest->second.second);
      world_.notes.push_back(fmt::format("{} single imperfections on '{}': {}", count, group, most));
    }
  }

 private:
  World& world_;
  Registry const& names_;
  std::size_t spots_, count_ = 0;
  std::optional<double> too_large_;  // radius of a disc over that of a beam
  std::uint32_t large_in_ = 0;
  std::map<std::pair<double, double>, std::uint32_t> facets_;  // optics by reflectance and area
  std::map<std::string, std::size_t> named_, found_;
  std::map<std::string, std::pair<std::string, double>> strongest_;
};

// The face of a part, "" for an entry with a shape of its own.
std::string face_of(Scene::Instance const& instance) {
  std::size_t const slash = instance.name.rfind('/');
  return slash == std::string::npos ? "" : instance.name.substr(slash + 1);
}

void check_rows(Node const& entry, std::set<std::string> const& faces) {
  for (Node const& row : entry.list("imperfections")) {
    if (row.kind() != Node::Kind::table) {
      row.problem("an imperfection is a table", "write {at: [1 cm, 0 cm], diameter: 50 um, material: NAME}");
      continue;
    }
    std::string const face = row.has("face") ? row.word("face") : "";
    if (faces.contains(face)) continue;
    (face.empty() ? row : row["face"])
        .problem(face.empty() ? std::string("the entry is a part: its imperfections name a face")
                              : fmt::format("the entry has no face '{}'", face),
                 faces.contains("") ? "remove 'face': the entry has one surface"
                                    : fmt::format("write face: NAME, one of {}", fmt::join(faces, ", ")));
  }
}

}  // namespace

void read_imperfections(Scene const& scene, World& world, Registry const& names) {
  std::map<NodeData const*, std::set<std::string>> faces;  // of each entry
  for (Scene::Instance const& instance : scene.instances())
    faces[instance.placement.data().get()].insert(face_of(instance));
  for (Scene::Instance const& instance : scene.instances())
    if (auto const entry = faces.find(instance.placement.data().get()); entry != faces.end()) {
      check_rows(instance.placement, entry->second);
      faces.erase(entry);
    }
  ImperfectionAdder adder(world, names);
  for (Scene::Instance const& instance : scene.instances())
    if (scene.root().healthy()) adder.add_entry(instance, face_of(instance));
  adder.note();
}

}  // namespace straytrace::world
