// SPDX-License-Identifier: BSD-3-Clause
#include "trace/estimate/patches.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <queue>

#include "trace/estimate/importance.hpp"

namespace straytrace {
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
// The next to be cut: the largest as seen from where it matters, then the largest, then the first of the scene.
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

  // Starts with whatever may be joined at all and cuts until there are enough.
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
    std::sort(done.begin(), done.end());
    return done;
  }

 private:
  // What strips must have in common; the last are given up first when there would be too many kinds.
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
    constexpr double nearest = 0.01;  // of the size: everything nearer is as urgent
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

}  // namespace straytrace
