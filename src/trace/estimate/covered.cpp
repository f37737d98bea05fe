// SPDX-License-Identifier: BSD-3-Clause
#include "trace/estimate/importance.hpp"
#include "trace/estimate/through_glass.hpp"

namespace straytrace {

void find_covered_receivers(World& world) {
  constexpr std::uint64_t tries = 4096, enough = 4;  // one part in a thousand of what it sees
  WorldView const view = world.view();
  for (std::uint32_t i = 0; i < view.receivers.size; ++i) {
    if (view.receivers[i].clear) continue;
    if (view.polarised) {  // sub-paths know no polarisation: the walk alone does
      world.cover_receiver(i, false);
      continue;
    }
    std::uint64_t found = 0;
    auto const meets_light = [&](Backward const& met) {
      for (std::size_t e = 0; e < view.emitters.size; ++e) found += view.lit[view.emitters[e]].surface == met.z;
    };
    for (std::uint64_t n = 0; n < tries; ++n) {
      PathState path;
      path.history = n;
      Rng rng = backward_numbers(0, path, i);
      if (backward_from(
              view, view.receivers[i], rng, [](Vertex const&, bool) {}, meets_light)
              .tau > 0)
        ++found;
    }
    world.cover_receiver(i, view.receivers[i].behind_glass || found >= enough);
  }
}

}  // namespace straytrace
