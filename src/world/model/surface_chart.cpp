// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/surface_chart.hpp"

#include <algorithm>
#include <type_traits>

namespace straytrace {
namespace {

template <class S>
constexpr bool is_round = std::is_base_of_v<Cone, S> || std::is_base_of_v<Sphere, S> || std::is_same_v<S, Disk> ||
                          std::is_same_v<S, Cap> || std::is_same_v<S, Torus>;

struct Reach {
  double low = infinity, high = -infinity, r_min = infinity, r_max = 0;
  bool round = true, barrel = true;  // a barrel seen along its axis is a line
  void add(Reach const& r) {
    low = std::min(low, r.low);
    high = std::max(high, r.high);
    r_min = std::min(r_min, r.r_min);
    r_max = std::max(r_max, r.r_max);
    round = round && r.round;
    barrel = barrel && r.barrel;
  }
};
Reach reach_of(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) {
    Reach r;
    s.extent(r.low, r.high, r.r_min, r.r_max);
    r.round = is_round<std::decay_t<decltype(s)>>;
    r.barrel = r.high > r.low && r.r_max - r.r_min < 1e-6 * r.r_max;
    return r;
  });
}

}  // namespace

SurfaceChart chart_of(WorldView const& view, std::span<SurfaceId const> surfaces) {
  Reach all;
  for (SurfaceId const id : surfaces) all.add(reach_of(view, id));
  double const r = all.r_max;
  if (all.barrel || all.high - all.low > 2 * r) return {Chart::unrolled, {all.low, all.high, -pi * r, pi * r}};
  if (all.round) return {Chart::polar, {all.r_min, r, -pi, pi}};
  return {Chart::plane, {-r, r, -r, r}};
}

}  // namespace straytrace
