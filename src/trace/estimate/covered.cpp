// SPDX-License-Identifier: BSD-3-Clause
#include "trace/estimate/importance.hpp"
#include "trace/estimate/through_glass.hpp"

namespace straytrace {
namespace {

// Surfaces on which light of beams starts or, of free beams, is scattered first.
std::vector<bool> lit_surfaces(WorldView const& world) {
  constexpr int across = 16;  // lines of a free beam in radius, and in azimuth
  std::vector<bool> lit(world.surfaces.size);
  for (std::size_t e = 0; e < world.emitters.size; ++e) {
    Footprint const& beam = world.lit[world.emitters[e]];
    if (!beam.free) lit[beam.surface.value] = true;
    if (!beam.free || beam.profile == Profile::point) continue;
    for (int i = 0; i < across * across; ++i) {
      Vec3 const start = beam.sample((i / across + 0.5) / across, (i % across + 0.5) / across).origin;
      Hit const hit = world.closest({start, beam.direction(start)}, {});
      if (!hit.surface.valid()) continue;
      Surface const& met = world.surfaces[hit.surface.value];
      if (world.optics[met.front].laws + world.optics[met.back].laws > 0) lit[hit.surface.value] = true;
    }
  }
  return lit;
}

}  // namespace

void find_covered_receivers(World& world) {
  constexpr std::uint64_t tries = 4096, enough = 4;  // one part in a thousand of what it sees
  WorldView const view = world.view();
  std::vector<bool> const lit = lit_surfaces(view);
  for (std::uint32_t i = 0; i < view.receivers.size; ++i) {
    if (view.polarised) {  // sub-paths know no polarisation: the walk alone does
      world.cover_receiver(i, false);
      continue;
    }
    if (view.receivers[i].clear) continue;
    std::uint64_t found = 0;
    for (std::uint64_t n = 0; n < tries; ++n) {
      PathState path;
      path.history = n;
      Rng rng = backward_numbers(0, path, i);
      if (backward_from(
              view, view.receivers[i], rng, [](Vertex const&, bool) {},
              [&](Backward const& met) { found += lit[met.z.value]; })
              .tau > 0)
        ++found;
    }
    world.cover_receiver(i, view.receivers[i].behind_glass || found >= enough);
  }
}

}  // namespace straytrace
