// SPDX-License-Identifier: BSD-3-Clause
// Glass and mirrors on which one ray is followed twice: by the walk, and in a given sequence.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "support/sequential.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing {

inline constexpr double metre = 1e-12;  // m, required agreement of two tracings of one ray

// Glass and mirrors about the z axis, a free beam from z = -50 mm and a black screen at z = 1 m.
class Bench {
 public:
  Bench() : body_(world.add_body("bench", {})), group_(world.add_group("bench")), black_(black_optic(world)) {
    bare_ = glass_optic(world);
  }
  std::uint32_t glass(double index) { return world.add_volume({index, 0}); }
  template <class Shape>
  SurfaceId face(Shape const& shape, std::uint32_t volume) {
    return world.add_surface(shape, bare_, bare_, body_, group_, volume);
  }
  template <class Shape>
  SurfaceId mirror(Shape const& shape) {
    std::uint32_t const silver = mirror_optic(world, 1);
    return world.add_surface(shape, silver, silver, body_, group_);
  }
  SurfaceId screen() { return world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, black_, black_, body_, group_); }
  void shine(Vec3 from, Vec3 along) {
    start_ = from;
    along_ = unit(along);
    world.add_footprint(free_beam({}, start_, along_, Profile::point, 0));
    world.limits.roulette_below = 0;
    world.finish();
  }
  Ray ray() const { return {start_, along_}; }

  World world;

 private:
  BodyId body_;
  GroupId group_;
  std::uint32_t black_, bare_ = 0;
  Vec3 start_, along_;
};

struct Visited {
  SurfaceId surface;
  Vec3 point;
  double path_length, n_out;
  Event left_by;  // how light left the vertex before
};
struct Visits : Silent {
  std::vector<Visited> all;
  void visit(PathState const& p, Vertex const& v) {
    all.push_back({v.surface, v.point, p.path_length, v.n_out, p.hop.left_by});
  }
};

// The first history of the walk that passes through everything; reflections as listed in `steps`.
inline std::vector<Visited> walked(World const& world, std::span<SequenceStep const> steps) {
  WorldView const view = world.view();
  for (std::uint64_t h = 0; h < 2000; ++h) {
    Visits sink;
    trace_history(view, 3, h, sink);
    bool same = sink.all.size() == steps.size();
    for (std::size_t i = 0; same && i + 1 < steps.size(); ++i) same = sink.all[i + 1].left_by == steps[i].event;
    if (same) return sink.all;
  }
  return {};
}

inline double largest_difference(Sequence const& s, std::vector<Visited> const& w) {
  if (s.end != SequenceEnd::complete || s.points.size() != w.size() || w.empty()) return infinity;
  double most = 0;
  for (std::size_t i = 0; i < w.size(); ++i)
    most =
        std::max({most, length(s.points[i].point - w[i].point), std::fabs(s.points[i].path_length - w[i].path_length)});
  return most;
}

}  // namespace straytrace::testing
