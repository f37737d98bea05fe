// SPDX-License-Identifier: BSD-3-Clause
// The energy balance (docs/theory/sampling.md): absorbed + escaped + truncated + roulette + sampling = emitted, and the
// columns `window` and `sampling` are zero on average.
#include <random>

#include "base/errors.hpp"
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {
namespace {

constexpr std::uint64_t histories = 1 << 15;

// A random choice of surfaces between two lit mirrors; reflection, power law, ABg and Lambert mixed on the same optics.
class Lottery {
 public:
  explicit Lottery(std::uint64_t seed) : engine_(seed) {}
  double between(double a, double b) { return a + (b - a) * uniform_(engine_); }

  std::uint32_t optic(World& world) {
    Optic o;
    o.reflect = between(0, 0.4);
    o.laws = 3;
    o.law[0] = world.add_law(Lambertian{between(0, 0.3)});
    double const kappa = between(1e-4, 1e-3), exponent = between(1.2, 2.4), above = between(1e-3, 1e-2);
    o.law[1] = world.add_law(power_law(kappa, exponent, above));  // scatters 25 % at most
    double const a = between(1e-4, 1e-3), b = between(1e-3, 1e-1), g = between(1, 2.5);
    o.law[2] = world.add_law(abg(a, b, g));
    return world.add_optic(o);
  }
  World world() {
    World w;
    BodyId const body = w.add_body("all", {});
    GroupId const group = w.add_group("all");
    std::uint32_t const rough = optic(w), smooth = optic(w);
    SurfaceId const low = w.add_surface(Cap{{}, {0, 0, 1}, between(0, 0.2), 0, 1}, rough, smooth, body, group);
    SurfaceId const high = w.add_surface(Cap{{0, 0, 3}, {0, 0, -1}, between(0, 0.2), 0, 1}, rough, smooth, body, group);
    if (between(0, 1) < 0.7)
      w.add_surface(Cylinder{{}, {0, 0, 1}, 1.1, -0.1, between(1, 3.1)}, rough, smooth, body, group);
    w.add_surface(Sphere{{between(-0.5, 0.5), 0.4, 1.5}, {0, 0, 1}, between(0.1, 0.3)}, rough, smooth, body, group);
    Vec3 const tilted = unit({between(-0.3, 0.3), between(-0.3, 0.3), 1});
    w.add_surface(Disk{{0, 0, between(1, 2)}, tilted, 0.1, 0.9}, rough, smooth, body, group);
    w.add_footprint(spot(low, {}, unit({0.1, 0, -1}), Profile::gaussian, 0.05, w.add_port("low")));
    w.add_footprint(spot(high, {0, 0, 3}, {0, 0, 1}, Profile::even, 0.3, w.add_port("high"), 1));
    w.limits.max_order = std::uint32_t(between(5, 40));
    w.limits.roulette_below = between(0.01, 0.5);
    w.finish();
    return w;
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> uniform_;
};

double gap(BlockSums const& total) {  // of the energy balance, relative to what was emitted
  double sum = 0;
  for (Moments const& column : total.energy_balance) sum += column.sum;
  return std::fabs(sum - total.emitted.sum) / total.emitted.sum;
}
SampleMean column(BlockSums const& total, BalanceTerm balance_term) {  // relative to what was emitted
  Estimate const e = estimate(total.energy_balance[int(balance_term)], total.histories, total.blocks);
  return sample_mean(e, total.histories, double(total.histories) / total.emitted.sum);
}

TEST(EnergyBalance, CloseInRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World const world = Lottery(seed).world();
    BlockSums const total = run_histories(world, histories).total;
    EXPECT_LT(gap(total), 1e-12) << "scene " << seed;
    expect_mean("roulette", column(total, BalanceTerm::roulette), 0, 2e-2);
    expect_mean("sampling", column(total, BalanceTerm::sampling), 0, 5e-2);
    BlockSums forgetful = total;  // control: without one column
    forgetful.energy_balance[int(BalanceTerm::roulette)] = {};
    EXPECT_GT(gap(forgetful), 1e-12) << "scene " << seed;
  }
}

// Each watt is on an object, in a medium, or out of the scene (R2.24). Two groups, glass with losses.
double open_by_object(BlockSums const& total) {
  double sum = 0;
  for (Moments const& m : total.absorbed) sum += m.sum;
  for (BalanceTerm balance_term :
       {BalanceTerm::escaped, BalanceTerm::truncated, BalanceTerm::roulette, BalanceTerm::sampling})
    sum += total.energy_balance[int(balance_term)].sum;
  return std::fabs(sum - total.emitted.sum) / total.emitted.sum;
}
TEST(EnergyBalance, CloseByObject) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    Lottery draw(seed);
    World world = draw.world();
    std::uint32_t const grey = lambertian_optic(world, draw.between(0.2, 0.8)), glass = [&] {
      Optic optic;
      optic.has_interface = true;
      optic.interface = world.add_interface(Fresnel{});
      return world.add_optic(optic);
    }();
    BodyId const body = world.add_body("more", {});
    world.add_surface(Disk{{0.2, 0, 0.7}, {0, 0.1, 0.9}, 0, 0.4}, grey, grey, body, world.add_group("screen"));
    std::uint32_t const volume = world.add_volume({1.5, draw.between(0.1, 3)});
    world.add_surface(Sphere{{-0.4, -0.5, 2}, {0, 0, 1}, 0.25}, glass, glass, body, world.add_group("ball"), volume);
    world.finish();
    BlockSums const total = run_histories(world, histories).total;
    ASSERT_EQ(total.absorbed.size(), 4u);
    for (std::size_t i : {0, 1, 3}) EXPECT_GT(total.absorbed[i].sum, 0) << "scene " << seed << ", row " << i;
    EXPECT_LT(open_by_object(total), 1e-12) << "scene " << seed;
    for (std::size_t i : {0, 1, 3}) {  // controls: an object or the medium is forgotten
      BlockSums forgetful = total;
      forgetful.absorbed[i] = {};
      EXPECT_GT(open_by_object(forgetful), 1e-9) << "scene " << seed << ", row " << i;
    }
  }
}

// Every single history closes, not only the sum.
struct EnergyBalance : Silent {
  double out = 0, in = 0, worst = 0;
  void emitted(PathState const& path, Vertex const&) { in = path.emitted; }
  void book(BalanceTerm, double p) { out += p; }
  void close() {
    worst = std::fmax(worst, std::fabs(out - in) / in);
    out = 0;
  }
};
TEST(EnergyBalance, CloseInEveryHistory) {
  World const world = Lottery(1).world();
  EnergyBalance energy_balance;
  walk(world, 20000, energy_balance, [&] { energy_balance.close(); });
  EXPECT_LT(energy_balance.worst, 1e-12);
}

// A pdf that is wrong by 1 %: the albedo that the energy balance expects is not what the samples carry.
TEST(EnergyBalance, WrongAlbedoLeavesAMeanInSampling) {
  for (double const wrong : {1.0, 1.01}) {
    World world;
    BodyId const body = world.add_body("all", {});
    PowerLaw law = power_law(1e-3, 2, 1e-2);
    for (double& a : law.lobe.albedo.value) a *= wrong;
    Optic optic;
    optic.laws = 1;
    optic.law[0] = world.add_law(law);
    SurfaceId const s =
        world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, world.add_optic(optic), 0, body, world.add_group("plate"));
    world.add_footprint(spot(s, {}, {0, 0, -1}, Profile::gaussian, 0.1, world.add_port("plate")));
    world.finish();
    if (wrong == 1) {
      expect_mean("sampling", column(run_histories(world, 1 << 19).total, BalanceTerm::sampling), 0, 1e-2);
    } else {
      EXPECT_THROW(run_histories(world, 1 << 19), NumericalError);
    }
  }
}

// A small disk takes three quarters of the directions. Strata deal these evenly, and the law, whose quarter would have
// to meet the disk as well, does so less than once in a run: what was drawn then spreads much less than the mean of
// `sampling` lies from zero, and nothing is wrong (docs/theory/errors.md).
World spot_and_disk(bool sound) {
  World world;
  BodyId const body = world.add_body("all", {});
  PowerLaw law = power_law(1e-3, 2, 1e-2);
  for (double& a : law.lobe.albedo.value) a *= 1.01;
  Optic optic;
  optic.laws = 1;
  optic.law[0] = sound ? world.add_law(Lambertian{0.1}) : world.add_law(law);
  std::uint32_t const steel = lambertian_optic(world, 0.03);
  SurfaceId const lit =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, world.add_optic(optic), 0, body, world.add_group("spot"));
  world.add_surface(Disk{{1, 0, 10}, {0, 0, -1}, 0, 0.01}, steel, steel, body, world.add_group("disk"));
  world.add_footprint(spot(lit, {}, {0, 0, -1}, Profile::gaussian, 0.02, world.add_port("spot")));
  world.finish();
  steer(world);
  return world;
}
TEST(EnergyBalance, DirectionsTooRareToBeDrawnCauseNoImbalance) {
  World const sound = spot_and_disk(true), wrong = spot_and_disk(false);
  double farthest = 0;  // in standard errors of what was drawn
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    BlockSums const total =
        run_histories(sound, 1 << 18, seed).total;  // throws where the energy balance do not balance
    Estimate const e = estimate(total.energy_balance[int(BalanceTerm::sampling)], total.histories, total.blocks);
    farthest = std::fmax(farthest, std::fabs(e.mean) / e.std_error);
    EXPECT_THROW(run_histories(wrong, 1 << 18, seed), NumericalError) << "seed " << seed;  // control: an albedo 1 % off
  }
  EXPECT_GT(farthest, 5);  // the effect is there
}

}  // namespace
}  // namespace straytrace::testing
