// SPDX-License-Identifier: BSD-3-Clause
// The mixture of BSDF model and targets (docs/theory/sampling.md): scene 16, and what a wrong table does to the energy
// balance.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "support/shapes.hpp"
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing::trace_mixture {
namespace {

constexpr double rho = 0.9;

// A closed sphere of two hemispheres, lit evenly on a spot of one of them: power arriving per emitted 1/(1 - rho).
World two_caps(bool disc = false) {
  World world;
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  BodyId const body = world.add_body("sphere", {});
  SurfaceId const below =
      world.add_surface(cap(1, 0, 1, {{0, 0, -1}, {0, 0, 1}}), white, black, body, world.add_group("below"));
  world.add_surface(cap(1, 0, 1, {{0, 0, 1}, {0, 0, -1}}), white, black, body, world.add_group("above"));
  if (disc) world.add_surface(disk(0, 0.5, {{0, 0, 0.2}, {0, 0, 1}}), white, white, body, world.add_group("disc"));
  world.add_footprint(spot(below, {0, 0, -1}, {0, 0, -1}, Profile::even, 0.3));
  world.limits.max_order = 400;
  world.limits.roulette_below = 1e-3;
  world.finish();
  return world;
}

void add_strip(SteeringTables& t, SurfaceId surface, double from, double to, double area) {
  auto const number = std::uint32_t(t.strips.size());
  t.strips.push_back({surface, from, to, (to - from) * area, number});
  t.patches.push_back({t.strips.back().area, number, 1});
  t.members.push_back({number, 0});
}

// Targets of uneven shares on four strips of each cap, and adjoints that make the window work. `hole`: strip 4 is on no
// list.
SteeringTables uneven(double alpha, bool hole = false, bool disc = false) {
  SteeringTables t;
  for (std::uint32_t surface = 0; surface < 2; ++surface) {
    t.first_of_surface.push_back(std::uint32_t(t.strips.size()));
    double const edges[] = {0, 0.1, 0.35, 0.4, 1};
    for (int i = 0; i < 4; ++i) add_strip(t, {surface}, edges[i], edges[i + 1], 2 * pi);
  }
  t.first_of_surface.push_back(8);
  if (disc) {  // on no list
    add_strip(t, {2}, 0, 1, 0.25 * pi);
    t.first_of_surface.push_back(9);
  }
  double const shares[] = {0.02, 0.2, 0.05, 0.2, hole ? 0 : 0.03, 0.25, 0.01, 0.24};
  double so_far = 0;
  for (std::uint32_t i = 0; i < 8; ++i)
    if (shares[i] > 0) t.targets.push_back({i, shares[i], so_far += shares[i]});
  for (int side = 0; side < 2 * int(t.patches.size()); ++side)
    t.sides.push_back({1 + 0.1 * side, alpha, 0, std::uint32_t(t.targets.size())});
  t.level = 1;
  return t;
}

// The same strips in four patches of unequal ones, some on both caps; what is drawn with is what is divided by.
SteeringTables patched(double alpha) {
  SteeringTables t = uneven(alpha);
  t.patches.clear();
  t.members.clear();
  t.targets.clear();
  t.sides.clear();
  for (std::vector<std::uint32_t> const& strips : {std::vector{0u, 5u, 6u}, {1u}, {2u, 3u, 7u}, {4u}}) {
    Patch patch{0, std::uint32_t(t.members.size()), std::uint32_t(strips.size())};
    for (std::uint32_t const i : strips) {
      t.strips[i].patch = std::uint32_t(t.patches.size());
      t.members.push_back({i, patch.area});
      patch.area += t.strips[i].area;
    }
    t.patches.push_back(patch);
  }
  double const shares[] = {0.3, 0.1, 0.45, 0.15};
  double so_far = 0;
  for (std::uint32_t i = 0; i < 4; ++i) t.targets.push_back({i, shares[i], so_far += shares[i]});
  for (int side = 0; side < 8; ++side) t.sides.push_back({1 + 0.1 * side, alpha, 0, 4});
  return t;
}

SampleMean arriving(World& world, TraceResult const& r) {
  SampleMean const a = arrived(world, r, "below"), b = arrived(world, r, "above");
  return {a.mean + b.mean, a.std_error + b.std_error, a.n};  // errors of the two are correlated: added, not squared
}

TEST(Mixture, ArrivingPowerScene16) {
  for (double const alpha : {0.1, 0.5, 0.9}) {
    World world = two_caps();
    world.steer(uneven(alpha));
    TraceResult const r = run_histories(world, 1 << 17);
    expect_mean("arriving power, 1/(1 - rho)", arriving(world, r), 10, 0.5);
    double sum = 0;
    for (Moments const& column : r.total.energy_balance) sum += column.sum;
    EXPECT_NEAR(sum / r.total.emitted.sum, 1, 1e-12);
    for (BalanceTerm const balance_term : {BalanceTerm::sampling, BalanceTerm::roulette}) {
      Estimate const e = estimate(r.total.energy_balance[int(balance_term)], r.total.histories, r.total.blocks);
      EXPECT_GT(e.std_error, 0);
      EXPECT_LT(std::fabs(e.mean), 5 * e.std_error);
    }
  }
}

TEST(Mixture, ArrivingPowerWithPatchesScene16) {
  for (double const alpha : {0.1, 0.5}) {
    World world = two_caps();
    world.steer(patched(alpha));
    TraceResult const r = run_histories(world, 1 << 17);
    expect_mean("arriving power, 1/(1 - rho)", arriving(world, r), 10, 0.5);
    Estimate const sampling =
        estimate(r.total.energy_balance[int(BalanceTerm::sampling)], r.total.histories, r.total.blocks);
    EXPECT_LT(std::fabs(sampling.mean), 5 * sampling.std_error);
  }
}

// Controls: the strips of a patch drawn evenly instead of by area, and a patch with a strip that is never drawn.
TEST(Mixture, WrongPatchesAreRejected) {
  for (bool const even : {true, false}) {
    World world = two_caps();
    SteeringTables tables = patched(0.1);
    for (Patch const& p : tables.patches)
      for (std::uint32_t i = 0; i < p.count; ++i)
        if (even)
          tables.members[p.first + i].before = p.area * i / p.count;
        else if (i > 0)
          tables.members[p.first + i].before = 2 * p.area;
    world.steer(tables);
    try {
      expect_rejected(even ? "even over strips" : "strips left out", arriving(world, run_histories(world, 1 << 17)),
                      10);
    } catch (NumericalError const&) {
      SUCCEED() << "the check of the energy balance rejects it";
    }
  }
}

// The weight of a hop as in finish_hop_weight(), with one thing wrong.
enum class Fault { none, no_square, no_cosine, hidden_kept, area };
double weight(WorldView const& view, PathState& path, Vertex const& v, Fault fault) {
  Hop& hop = path.hop;
  bool const hidden = hop.aim.valid() && (v.surface != hop.aim || v.leg < hop.aim_distance * (1 - 1e-9));
  if (hidden && fault != Fault::hidden_kept) return 0;
  double const alpha = law_share(view, hop.side);
  double const distance = fault == Fault::no_square ? 1 : v.leg, cosine = fault == Fault::no_cosine ? 1 : v.wi.z;
  double const aimed = aimed_pdf(view, hop.side, v.patch, distance, cosine) / (fault == Fault::area ? 1.01 : 1);
  double const pdf = hop.lobe * (alpha * hop.law_pdf + (1 - alpha) * aimed);
  hop.pdf = pdf;
  return pdf > 0 ? hop.value / pdf : 0;
}
// Power of the first four arrivals in the sphere, with a disc in it that hides parts of it; everything scatters 90 %.
SampleMean arriving_with(Fault fault, std::uint64_t histories) {
  World world = two_caps(true);
  world.steer(uneven(0.5, false, true));
  WorldView const view = world.view();
  Silent sink;
  Sampler found;
  for (std::uint64_t h = 0; h < histories; ++h) {
    PathState path;
    path.history = h;
    double sum = 0;
    if (!emit(view, 1, path, sink)) continue;
    for (path.event = 1; path.event <= 4; ++path.event) {
      Hit const hit = view.closest(path.ray, path.from);
      if (!hit.surface.valid()) break;
      Vertex v = vertex_at(view, path, hit);
      path.power *= weight(view, path, v, fault);
      if (!(path.power > 0)) break;
      evaluate_scattering(view, path, path.ray.dir, v);
      sum += path.power;
      if (!scatter(view, 1, path, v, sink)) break;
    }
    found.add(sum / path.emitted);
  }
  return found.mean();
}

// Controls of the mixture's density (docs/theory/sampling.md): none gives 1 + rho + rho^2 + rho^3.
TEST(Mixture, WrongDensitiesAreRejected) {
  double const expected = 3.439;
  expect_mean("as it is", arriving_with(Fault::none, 1 << 20), expected, 0.02);
  expect_rejected("pdf without d^2", arriving_with(Fault::no_square, 1 << 15), expected);
  expect_rejected("pdf without its cosine", arriving_with(Fault::no_cosine, 1 << 15), expected);
  expect_rejected("hidden target that keeps its weight", arriving_with(Fault::hidden_kept, 1 << 15), expected);
  expect_rejected("patch area wrong by 1 %", arriving_with(Fault::area, 1 << 20), expected);
}

// Control: patch areas wrong by a few per cent leave a mean in `sampling`, which the check of the energy balance
// rejects.
TEST(Mixture, WrongAreasAreRejected) {
  World world = two_caps();
  SteeringTables tables = uneven(0.1);
  for (Patch& p : tables.patches) p.area *= 1.03;
  world.steer(tables);
  EXPECT_THROW(run_histories(world, 1 << 17), NumericalError);
}

// Control: nothing is ever drawn by the law, and one strip is on no list (alpha = 0 with a hole).
TEST(Mixture, ExclusiveListsAreRejected) {
  World world = two_caps();
  world.steer(uneven(0, true));
  EXPECT_THROW(run_histories(world, 1 << 17), NumericalError);
}

}  // namespace
}  // namespace straytrace::testing::trace_mixture
