// SPDX-License-Identifier: BSD-3-Clause
// Russian roulette: faint paths survive by chance with their power raised to the threshold, so the mean is kept.
#pragma once

#include "base/rng.hpp"
#include "trace/history/path.hpp"

namespace straytrace {

template <class Sink>
STRAY_HD bool survives(WorldView const& world, std::uint64_t seed, PathState& path, Sink& sink) {
  double const threshold = world.limits.roulette_below * path.emitted;
  if (path.power >= threshold) return true;
  bool const lucky = Rng(seed, path.history, path.event, Stream::window).uniform() * threshold < path.power;
  double const after = lucky ? threshold : 0;
  sink.book(Fate::window, path.power - after);
  path.power = after;
  return lucky;
}

}  // namespace straytrace
