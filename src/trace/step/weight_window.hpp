// SPDX-License-Identifier: BSD-3-Clause
// Keeps the population of paths level (docs/theory/sampling.md): bright or important paths are split, faint ones
// survive by chance with their power raised, so the mean is kept. Power times adjoint is what a path is worth.
#pragma once

#include "base/math/rng.hpp"
#include "trace/step/path.hpp"

namespace straytrace {

constexpr double window_width = 5;  // paths within this factor of the target are left alone
constexpr std::uint32_t most_copies = 16;

// What a path is kept at: power x adjoint at its first vertex, so that routes through a rare first target are followed
// with the effort that the target was given; a scattered path that nothing aimed at has to be worth an average one. The
// level excludes free beams: their first vertex sets its own.
STRAY_HD double level_of(WorldView const& world, PathState const& path, double adjoint) {
  bool const astray = !path.coherent && (path.hop.off_list || !path.hop.aimed);
  return astray ? world.steering.level : path.power * adjoint;
}

// Copies to follow from here on, 0: the path has lost; path.power is that of each copy. Without an adjoint, plain
// roulette below a share of the power first scattered.
template <class Sink>
STRAY_HD std::uint32_t control(WorldView const& world, std::uint64_t seed, PathState& path, Vertex const& vertex,
                               std::uint32_t room, Sink& sink) {
  std::uint32_t const side = vertex.side();
  double const adjoint =
      side == WorldView::none || !(world.steering.level > 0) ? 0 : world.steering.sides[side].adjoint;
  if (adjoint > 0 && path.level == 0) path.level = level_of(world, path, adjoint);
  double target = adjoint > 0 ? path.level / adjoint : world.limits.roulette_below * path.emitted;
  if (target > path.emitted) target = path.emitted;  // no path is ever worth more than its history gave
  double const lowest = adjoint > 0 ? target / window_width : target;
  if (path.power < lowest) {
    bool const lucky = Rng(seed, path.history, path.event, Stream::window).uniform() * target < path.power;
    double const after = lucky ? target : 0;
    sink.book(BalanceTerm::roulette, path.power - after);
    if constexpr (requires { sink.roulette_variance(0.0); }) sink.roulette_variance(path.power * (target - path.power));
    path.power = after;
    return lucky ? 1 : 0;
  }
  if (!(adjoint > 0) || path.power <= window_width * target) return 1;
  std::uint32_t const most = room + 1 < most_copies ? room + 1 : most_copies;
  double const wanted = std::floor(path.power / target);
  std::uint32_t const copies = wanted < most ? static_cast<std::uint32_t>(wanted) : most;
  path.power /= copies;
  return copies;
}

}  // namespace straytrace
