// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>

#include "geometry/shape_types.hpp"
#include "trace/importance/importance.hpp"
#include "trace/importance/steering_tables.hpp"

namespace straytrace::trace {
namespace {

double extent(Box const& box, int axis) {
  Vec3 const size = box.upper - box.lower;
  return axis == 0 ? size.x : axis == 1 ? size.y : size.z;
}
double along(Vec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

// Strips that may become one patch.
struct Cluster {
  std::vector<std::uint32_t> strips;  // ascending
  double size = 0;                    // m, diagonal of the box of all
  double seen = 0;                    // size over the distance from the nearest beam or receiver
};
// The next to be cut: the largest as seen from the nearest beam or receiver, then the largest, then the first.
struct LessUrgent {
  bool operator()(Cluster const& a, Cluster const& b) const {
    if (a.seen != b.seen) return a.seen < b.seen;
    if (a.size != b.size) return a.size < b.size;
    return a.strips.front() > b.strips.front();
  }
};

class Merger {
 public:
  Merger(World const& world, SteeringTables const& tables) : world_(world), tables_(tables) {
    WorldView const view = world.view();
    for (Strip const& s : tables.strips) boxes_.push_back(bounds_of(view, s));
    own_.resize(world.surfaces().size());
    for (Footprint const& lit : world.footprints()) {
      places_.push_back(lit.centre);
      if (!lit.free) own_[lit.surface.value] = true;
    }
    for (Receiver const& r : world.receivers()) {
      own_[r.surface.value] = true;
      places_.push_back(view.shapes.visit(world.surfaces()[r.surface.value].shape,
                                          [](auto const& shape) { return shape.reference(); }));
    }
  }

  // Starts with the largest allowed patches and cuts until there are enough.
  std::vector<std::vector<std::uint32_t>> clusters(std::size_t most) const {
    std::priority_queue<Cluster, std::vector<Cluster>, LessUrgent> waiting;
    std::vector<std::vector<std::uint32_t>> done;
    for (auto& strips : roots(most)) waiting.push(cluster(std::move(strips)));
    while (!waiting.empty()) {
      Cluster const next = waiting.top();
      waiting.pop();
      if (next.strips.size() == 1 || done.size() + waiting.size() + 2 > most) {
        done.push_back(next.strips);
        continue;
      }
      for (auto& half : cut(next)) waiting.push(cluster(std::move(half)));
    }
    std::ranges::sort(done);
    return done;
  }

 private:
  // Common properties of the strips of a patch; the last are dropped first when there are too many kinds.
  static constexpr int most_common = 5;
  using Common = std::array<std::uint32_t, most_common>;
  Common common(std::uint32_t strip, int kept) const {
    std::uint32_t const id = tables_.strips[strip].surface.value;
    Surface const& s = world_.surfaces()[id];
    Common all{own_[id] ? id + 1 : 0, s.body.value, s.group.value, s.front, s.back};
    std::fill(all.begin() + kept, all.end(), 0);
    return all;
  }
  std::vector<std::vector<std::uint32_t>> roots(std::size_t most) const {
    for (int kept = most_common;; --kept) {
      std::map<Common, std::vector<std::uint32_t>> kinds;
      for (std::uint32_t i = 0; i < tables_.strips.size(); ++i) kinds[common(i, kept)].push_back(i);
      if (kinds.size() > most && kept > 0) continue;
      std::vector<std::vector<std::uint32_t>> all;
      for (auto& [kind, strips] : kinds) all.push_back(std::move(strips));
      return all;
    }
  }

  Cluster cluster(std::vector<std::uint32_t> strips) const {
    constexpr double nearest = 0.01;  // of the size: everything nearer has equal priority
    Cluster c{std::move(strips)};
    Box box;
    for (std::uint32_t const i : c.strips) box.add(boxes_[i]);
    c.size = length(box.upper - box.lower);
    double distance = infinity;
    for (Vec3 const p : places_) {
      double square = 0;
      for (int axis = 0; axis < 3; ++axis) {
        double const beside =
            std::max({along(box.lower, axis) - along(p, axis), along(p, axis) - along(box.upper, axis), 0.0});
        square += beside * beside;
      }
      distance = std::min(distance, std::sqrt(square));
    }
    if (c.size > 0) c.seen = c.size / std::max(distance, nearest * c.size);
    return c;
  }

  // At the middle of the longest side of the box of their centres; strips about one centre in their order.
  std::array<std::vector<std::uint32_t>, 2> cut(Cluster const& c) const {
    Box box;
    auto const centre = [this](std::uint32_t i) { return 0.5 * (boxes_[i].lower + boxes_[i].upper); };
    for (std::uint32_t const i : c.strips) box.add(centre(i));
    int axis = 0;
    for (int other = 1; other < 3; ++other)
      if (extent(box, other) > extent(box, axis)) axis = other;
    double const middle = along(0.5 * (box.lower + box.upper), axis);
    std::array<std::vector<std::uint32_t>, 2> halves;
    for (std::uint32_t const i : c.strips) halves[along(centre(i), axis) < middle ? 0 : 1].push_back(i);
    if (halves[0].empty() || halves[1].empty()) {
      auto const half = c.strips.begin() + std::ptrdiff_t(c.strips.size() / 2);
      halves = {std::vector(c.strips.begin(), half), std::vector(half, c.strips.end())};
    }
    return halves;
  }

  World const& world_;
  SteeringTables const& tables_;
  std::vector<Box> boxes_;    // of the strips
  std::vector<Vec3> places_;  // of beams and receivers
  std::vector<bool> own_;     // surfaces that are lit or receive
};

}  // namespace

void merge_strips(World const& world, std::size_t most, SteeringTables& tables) {
  if (tables.strips.size() <= most) return;
  auto const clusters = Merger(world, tables).clusters(most);
  tables.patches.clear();
  tables.members.clear();
  for (auto const& strips : clusters) {
    Patch patch{0, std::uint32_t(tables.members.size()), std::uint32_t(strips.size())};
    for (std::uint32_t const i : strips) {
      tables.strips[i].patch = std::uint32_t(tables.patches.size());
      tables.members.push_back({i, patch.area});
      patch.area += tables.strips[i].area;
    }
    tables.patches.push_back(patch);
  }
  tables.sides.assign(2 * tables.patches.size(), {});
}

namespace {

constexpr std::size_t most_edges = 256;

// Edges in ascending order, from 0 to 1, at some of the `heights` along a wall of this length: close ones only where a
// beam, a receiver or an end of the wall (`near`) is near. Exchange varies there within metres.
std::vector<double> chosen_edges(std::vector<double> const& heights, std::vector<double> const& near, double length,
                                 double least) {
  auto const spacing = [&](double h) {
    double nearest = length;
    for (double const from : near) nearest = std::min(nearest, std::fabs(h - from));
    return std::max(least, std::min(length / double(most_edges), 0.2 * nearest));
  };
  std::vector<double> edges{0};
  for (double const h : heights)
    if (h > edges.back() * length + spacing(h) && h < length - least) edges.push_back(h / length);
  edges.push_back(1);
  return edges;
}

// Places along a long wall where the light changes: the ends of all objects inside it, and geometrically growing steps
// away from each lit surface and receiver and from its own ends.
std::vector<double> wall_edges(World const& world, std::vector<Vec3> const& places, Cylinder const& wall) {
  double const length = wall.to - wall.from;
  std::vector<double> heights;
  auto const height = [&](Vec3 p) { return dot(p - wall.origin, wall.axis) - wall.from; };
  for (Vec3 const at : places)
    if (length2(at - wall.origin - dot(at - wall.origin, wall.axis) * wall.axis) <= wall.radius * wall.radius)
      heights.push_back(height(at));
  std::vector<double> near{0, length};
  for (Footprint const& f : world.footprints()) near.push_back(height(f.centre));
  for (Receiver const& r : world.receivers()) near.push_back(height(places[r.surface.value]));
  for (double const from : near)
    for (double step = 0.5 * wall.radius; step < length; step *= 1.5) {
      heights.push_back(from + step);
      heights.push_back(from - step);
    }
  std::ranges::sort(heights);
  for (double least = 0.2 * wall.radius;; least *= 2) {
    std::vector<double> edges = chosen_edges(heights, near, length, least);
    if (edges.size() <= most_edges + 1) return edges;
  }
}

// Parts of about equal area whose edges lie between triangles; all meshes of a scene share `most`.
std::vector<double> mesh_edges(TriangleMesh const& mesh, std::size_t meshes) {
  constexpr std::size_t most = 512, most_of_one = 64, least_triangles = 4;
  std::size_t const triangles = mesh.content.in_order.size;
  std::size_t const parts = std::max<std::size_t>(
      1, std::min({most / std::max<std::size_t>(meshes, 1), most_of_one, triangles / least_triangles}));
  double const* const before = &mesh.content.area_before[0];
  double const area = before[triangles];
  std::vector<double> edges{0};
  for (std::size_t i = 1; i < parts; ++i) {
    double const edge = *std::lower_bound(before, before + triangles, area * double(i) / double(parts)) / area;
    if (edge > edges.back() && edge < 1) edges.push_back(edge);
  }
  edges.push_back(1);
  return edges;
}

// A ring: rings of four times the width each, from its inner rim outwards. What is seen of a ring behind others is next
// to its rim.
std::vector<double> ring_edges(double inner, double outer) {
  std::vector<double> edges{0};
  for (double const part : {1.0 / 16, 1.0 / 4}) {
    double const radius = inner + part * (outer - inner);
    edges.push_back((radius * radius - inner * inner) / (outer * outer - inner * inner));
  }
  edges.push_back(1);
  return edges;
}

template <class Shape>
std::vector<double> edges_of(World const& world, std::vector<Vec3> const& places, Shape const& shape) {
  if constexpr (std::is_same_v<Shape, Cylinder>)
    if (shape.to - shape.from > 2 * shape.radius) return wall_edges(world, places, shape);
  if constexpr (std::is_same_v<Shape, Disk> || std::is_base_of_v<Cone, Shape>)
    if (shape.inner_radius > 0) return ring_edges(shape.inner_radius, shape.outer_radius);
  if constexpr (std::is_same_v<Shape, TriangleMesh>)
    return mesh_edges(shape, std::get<View<TriangleMesh const>>(world.view().shapes.arrays).size);
  int const parts = std::is_same_v<Shape, Sphere> ? 8 : 1;
  std::vector<double> edges;
  for (int i = 0; i <= parts; ++i) edges.push_back(double(i) / parts);
  return edges;
}

}  // namespace

SteeringTables make_strips(World const& world) {
  SteeringTables tables;
  WorldView const view = world.view();
  std::vector<Vec3> places;  // of the surfaces
  for (Surface const& s : world.surfaces())
    places.push_back(view.shapes.visit(s.shape, [](auto const& shape) { return shape.reference(); }));
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
    view.shapes.visit(world.surfaces()[id].shape, [&](auto const& shape) {
      std::vector<double> const edges = edges_of(world, places, shape);
      for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        auto const number = std::uint32_t(tables.strips.size());
        double const area = (edges[i + 1] - edges[i]) * shape.area();
        tables.strips.push_back({{id}, edges[i], edges[i + 1], area, number});
        tables.patches.push_back({area, number, 1});
        tables.members.push_back({number, 0});
      }
    });
  }
  tables.first_of_surface.push_back(std::uint32_t(tables.strips.size()));
  tables.sides.resize(2 * tables.patches.size());
  return tables;
}

Box bounds_of(WorldView const& view, Strip const& strip) {
  constexpr int steps = 4;
  Box box;
  view.shapes.visit(view.surfaces[strip.surface.value].shape, [&](auto const& shape) {
    if (strip.u_low == 0 && strip.u_high == 1) {
      box = shape.bounds();
      return;
    }
    double const width = strip.u_high - strip.u_low;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j < steps; ++j)
        box.add(sample_in_strip(shape, strip.u_low + width * i / steps, double(j) / steps).point);
  });
  return box;
}

}  // namespace straytrace::trace
