// SPDX-License-Identifier: BSD-3-Clause
// The list `imperfections` of an entry: single digs and scratches of its surface, each an emitter of its own
// (docs/theory/surfaces.md, eq. 3.32). Page: docs/reference/imperfections.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/input/document.hpp"
#include "base/math/rng.hpp"
#include "geometry/shape_types.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

constexpr std::size_t most_imperfections = 500;  // emitters of a scene: each starts histories of its own
constexpr std::size_t too_many_to_trace = 50;    // from which on they take most of the time of a trace
constexpr double above = 1e-7;                   // m over the surface
constexpr std::size_t pieces_of_scratch = 16;
constexpr Dimension metre2{4};

// A small disc on the surface, of the area that takes part.
struct ImperfectionPiece {
  double x = 0, y = 0;  // m, in the frame of the entry
  double area = 0;      // m^2
};
struct Imperfection {
  std::string name;
  std::vector<ImperfectionPiece> pieces;  // one, or those along a scratch
};

// The surface of an entry, or of a face of its part.
struct ImperfectionHost {
  SurfaceId id;
  Pose frame;
  bool front = true;  // the side that is not black
  double radius = 0;  // m, about the axis
};

double disc_area(double diameter) { return pi * diameter * diameter / 4; }

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
    std::string const name = row_.word("name", row_.has("scratch") ? "scratch" : "dig");
    if (row_.has("scratch")) return scratch(name);
    sizes();
    bool const placed = row_.has("at");
    auto const count = row_.whole("count", 1, 1, most_imperfections);
    auto const seed = row_.whole("seed", 1, 0, 1u << 31);
    double const within = row_.number("within", dim::length, host_.radius, 0, 1e3);
    if (placed && row_.has("count"))
      row_["count"].problem("'at' places one imperfection, 'count' draws places", "keep one of them");
    Vec3 at;
    if (placed) at = place(row_["at"]);
    std::vector<Imperfection> all;
    if (!std::isfinite(low_ + high_ + within + at.x)) return all;
    for (std::uint64_t i = 0; i < count; ++i) {
      Rng rng(seed, number_, std::uint32_t(i), Stream::height);
      double const rho = within * std::sqrt(rng.uniform()), turn = 2 * pi * rng.uniform(), u = rng.uniform();
      ImperfectionPiece const one{placed ? at.x : rho * std::cos(turn), placed ? at.y : rho * std::sin(turn),
                                  disc_area(drawn_diameter(low_, high_, exponent_, u))};
      all.push_back({name, {one}});
    }
    return all;
  }

 private:
  Vec3 place(Node const& pair) const {
    auto const xy = pair.as_numbers(dim::length, 2);
    return xy.size() == 2 ? Vec3{xy[0], xy[1], 0} : Vec3{not_a_number, not_a_number, 0};
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
    low_ = range.size() == 2 ? range[0] : not_a_number;
    high_ = range.size() == 2 ? range[1] : not_a_number;
    exponent_ = row_.number("exponent", dim::plain, 2, 0, 10);
    if (!(std::isfinite(low_ + high_)) || (low_ > 0 && high_ >= low_ && high_ <= 0.1)) return;
    node.problem("a range of diameters runs from the smallest to the largest, at most 10 cm", "write [10 um, 100 um]");
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
    Imperfection one{name, {}};
    for (std::size_t i = 0; i < pieces_of_scratch; ++i) {
      Vec3 const p = from + ((double(i) + 0.5) / pieces_of_scratch) * (to - from);
      one.pieces.push_back({p.x, p.y, size * width / pieces_of_scratch});
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

  void add_row(Scene::Instance const& instance, Node const& row, ImperfectionHost const& host, std::uint64_t number) {
    Node const material = row["material"];
    std::string const name = material ? material.as_word() : "";
    auto const optic = names_.materials.find(name);
    if (!material)
      row.problem("the imperfection has no material",
                  "write material: NAME; {scatter: {model: lambertian, tis: 1}} scatters all light that meets it");
    else if (optic == names_.materials.end() && !name.empty())
      material.problem(fmt::format("material '{}' is not defined", name), "name one of 'materials'");
    std::vector<Imperfection> const all = ImperfectionReader(row, host, number).read();
    row.refuse_unknown("an imperfection");
    if (optic == names_.materials.end() || !row.healthy()) return;
    std::size_t const before = count_;
    for (Imperfection const& one : all) {
      count_ += one.pieces.size();
      if (count_ > most_imperfections)
        return row.problem(
            fmt::format("more than {} imperfections (each piece of a scratch counts)", most_imperfections),
            "keep the largest, and describe the others by the model 'defects' of the material");
      if (!add(instance.group, row, host, one, optic->second)) return;
    }
    if (before <= too_many_to_trace && count_ > too_many_to_trace)
      row.warning(
          fmt::format("more than {} single imperfections: the time of a trace grows with the square of their number",
                      too_many_to_trace),
          "keep the largest, and describe the others by the model 'defects' of the material");
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
    return facing_along(point + above * lit, lit);
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
