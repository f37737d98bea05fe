// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>

#include "trace/importance/importance.hpp"
#include "trace/step/sub_path.hpp"

namespace straytrace::trace {
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

bool specular(WorldView const& world, SurfaceId id) {
  Surface const& surface = world.surfaces[id.value];
  for (std::uint32_t const side : {surface.front, surface.back}) {
    Optic const& optic = world.optics[side];
    if (optic.has_interface || optic.reflect > 0 || optic.transmit > 0) return !surface.clear;
  }
  return false;
}

// Sub-paths of a receiver, tried out.
class Trials {
 public:
  Trials(WorldView const& world, std::uint32_t receiver, std::vector<bool> const& lit)
      : world_(world), receiver_(receiver), lit_(lit) {}

  // Sub-paths that reached a scattering surface, or one lit by a beam. Sums of 1/density and of its square.
  struct Found {
    int hits = 0, lit = 0;  // lit: those that met a surface lit by a beam
    double etendue = 0, square = 0;
    bool enough() const { return hits >= 4; }
  };
  // Of `tries` started as `r` says; only those that met `first` first, when it is given.
  Found found(Receiver const& r, std::uint64_t tries, SurfaceId first = {}) const {
    Found sum;
    WorldView world = world_;
    world.block_size = largest_block;  // not that of the run, which changes as it grows
    std::vector<Receiver> receivers(world_.receivers.data, world_.receivers.data + world_.receivers.size);
    receivers[receiver_] = r;
    world.receivers = {receivers.data(), receivers.size()};
    sub_->goal = goal_of_receiver(world, receiver_);
    for (std::uint64_t n = 0; n < tries; ++n) {
      BackwardNumbers numbers(world, 0, n, Strata(0, n, world.block_size), sub_->goal);
      SurfaceId passed;
      bool lit = false;
      grow(
          world, 1, numbers, *sub_,
          [&](Vertex const& at, Event, bool) {
            if (!passed.valid()) passed = at.surface;
          },
          [&](SubVertex const& met) { lit = lit || (met.hops > 0 && lit_[met.at.surface.value]); });
      bool const reached = sub_->count > 0 && sub_->vertex[0].hops > 0;
      if ((first.valid() && passed != first) || !(lit || reached)) continue;
      double const start = 1 / sub_->density;
      ++sum.hits;
      sum.lit += lit;
      sum.etendue += start;
      sum.square += start * start;
    }
    return sum;
  }
  // The mirrors and glass by way of which it sees most, each tried alone: those so small or far that aiming at them
  // starts useful sub-paths four times as often as the cosine law, which has the density 1/`even`.
  std::vector<Receiver::Aim> aims() const {
    std::vector<std::pair<double, Receiver::Aim>> all;
    Receiver r = world_.receivers[receiver_];
    double const even = pi * r.sides() / receiver_density(world_, r);
    for (std::uint32_t id = 0; id < world_.surfaces.size && id < 4096; ++id) {
      if (!specular(world_, {id}) || r.surface == SurfaceId{id}) continue;
      r.aim_at({{{id}}});
      Found const seen = found(r, 256, {id});
      if (seen.enough() && 4 * seen.square < even * seen.etendue) all.push_back({seen.etendue, {{id}, seen.lit > 0}});
    }
    std::ranges::stable_sort(all, [](auto const& a, auto const& b) { return a.first > b.first; });
    if (all.size() > Receiver::most_aims) all.resize(Receiver::most_aims);
    std::vector<Receiver::Aim> aims;
    for (auto const& [seen, aim] : all) aims.push_back(aim);
    return aims;
  }

 private:
  WorldView const& world_;
  std::uint32_t receiver_;
  std::vector<bool> const& lit_;
  std::unique_ptr<SubPath> sub_ = std::make_unique<SubPath>();
};

// Every history has sub-paths for the receivers that see through glass, at most three, and one for one of the others:
// more would cost the light on other goals too much. In all at most SubPaths::most.
void share_sub_paths(World& world) {
  auto const count = [&](bool behind_glass) {
    return double(std::ranges::count_if(world.receivers(),
                                        [&](Receiver const& r) { return !r.clear && r.behind_glass == behind_glass; }));
  };
  double const glass = std::fmin(1, 3 / std::fmax(1, count(true))), others = count(false);
  for (std::uint32_t i = 0; i < world.receivers().size(); ++i) {
    Receiver const& r = world.receivers()[i];
    if (!r.clear) world.set_sub_paths(i, r.behind_glass ? glass : others == 1 ? 1 : 0.999 / others);
  }
}

}  // namespace

void find_covered_receivers(World& world) {
  WorldView const view = world.view();
  std::vector<bool> const lit = lit_surfaces(view);
  for (std::uint32_t i = 0; i < view.receivers.size; ++i) {
    if (view.polarised) {  // sub-paths neglect polarisation; only the walk includes it
      world.cover_receiver(i, false);
      continue;
    }
    if (view.receivers[i].clear) continue;
    Trials const trials(view, i, lit);
    std::vector<Receiver::Aim> const aims = trials.aims();
    Receiver even = view.receivers[i];
    even.aim_at({});
    world.cover_receiver(i, even.behind_glass || !aims.empty() || trials.found(even, 4096).enough(), aims);
  }
  if (!view.polarised) share_sub_paths(world);
}

}  // namespace straytrace::trace
