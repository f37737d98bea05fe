// SPDX-License-Identifier: BSD-3-Clause
// The solved cavity of a scene: its loss against the Hankel transform (docs/theory/wave.md, eq. W.10), where its power
// goes (eq. W.24), the levers of its rims (eq. W.14), and that threads change no bit.
#include "wave/arm/arm_waves.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "beams/cavity_mode.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::wave_arm_waves {
namespace {

using testing::deviation;
using testing::kilometre_arm;
using testing::KilometreArm;
using wave::Complex;

constexpr char grid[] = "crossover: 120 urad, grid: {points: 256, window: 0.5 m}";
std::string const perfect = std::string(grid) + ", maps: {I: {spectrum: none}, E: {spectrum: none}}";

ArmWaves solved(KilometreArm const& scene, int threads = 1, int highest_order = -1) {
  World const world = scene.world();
  ArmOptions options;
  options.threads = threads;
  options.highest_order = highest_order;
  return solve_arm(world, world.wave, options);
}
ArmWaves solved(std::string const& settings) { return solved(kilometre_arm(settings)); }

// As drawn in the scene, with the first draw of the heights.
RimLevers const& nominal_levers(ArmWaves const& waves, std::size_t rim) {
  return waves.rims.at(rim).draws.at(0).responses.at(0).levers;
}
bool same(RimLevers const& a, RimLevers const& b) {
  for (int i = 0; i < 3; ++i)
    if (a.displacement[i] != b.displacement[i] || a.rotation[i] != b.rotation[i]) return false;
  return true;
}

double hankel_loss(std::vector<RoundOpening> openings) {
  return round_modes({1064e-9, 1 / 2500., 1 / 2500., std::move(openings)}, 0, 1).front().loss();
}

// Without scatter; smooth mirrors that scatter beyond the crossover angle have a factor 1 - scattered in power.
double diffracted(ArmWaves const& waves) {
  double const kept = (1 - waves.arm.mirrors[0].scattered) * (1 - waves.arm.mirrors[1].scattered);
  return 1 - std::norm(waves.mode.eigenvalue) / kept;
}

// Two baffles that clip the beam send light beyond 400 urad from one to the other, so that the grid is finer than the
// crossover angle needs.
TEST(ArmWaves, LossOfSmoothMirrors) {
  std::string const fine = "crossover: 120 urad, grid: {points: 1024, window: 0.5 m}, ";
  ArmWaves const waves = solved(fine + "maps: {I: {spectrum: none}, E: {spectrum: none}}");
  double const expected = hankel_loss({{0, 0.075}, {400, 0.045}, {600, 0.045}, {1000, 0.075}});
  EXPECT_LT(deviation(diffracted(waves), expected), 1e-4);
  EXPECT_GT(deviation(diffracted(waves), hankel_loss({{0, 0.075}, {400, 0.045}, {1000, 0.075}})), 0.1);  // control
  EXPECT_GT(waves.mode.loss(), 2 * waves.arm.mirrors[0].scattered);
  EXPECT_LT(deviation(waves.perfect_loss, hankel_loss({{0, 0.075}, {1000, 0.075}})), 1e-6);
  EXPECT_LT(deviation(waves.ledger.total(), waves.mode.loss()), 1e-6);
  EXPECT_GT(waves.ledger.towards_mirror1[0], 0);
  EXPECT_GT(deviation(waves.ledger.total() - waves.ledger.towards_mirror1[0], waves.mode.loss()), 1e-3);  // control
}

// A rim about the axis of a round mode has no transverse lever, but one off the axis does.
TEST(ArmWaves, CentredRimsHaveLongitudinalLeversOnly) {
  KilometreArm scene = kilometre_arm(perfect);
  ArmWaves const centred = solved(scene);
  ASSERT_EQ(centred.rims.size(), 2u);
  std::size_t const at = scene.baffles.find("[0 m, 0 m, 400 m]");
  scene.baffles.replace(at, 17, "[1 mm, 0 m, 400 m]");
  ArmWaves const moved = solved(scene);
  double const lever = std::abs(nominal_levers(moved, 0).displacement[0]);
  for (RimResult const& rim : centred.rims) {
    ASSERT_EQ(rim.ensemble().size(), 1u);
    RimLevers const& levers = rim.ensemble()[0]->levers;
    for (int axis : {0, 1}) EXPECT_LT(std::abs(levers.displacement[axis]), 1e-5 * lever);
    EXPECT_LT(std::abs(levers.rotation[2]), 1e-5 * lever * 0.045);
    EXPECT_GT(std::abs(levers.displacement[2]), 0);
  }
  EXPECT_LT(std::abs(nominal_levers(moved, 0).displacement[1]), 1e-5 * lever);  // across its offset
  EXPECT_GT(std::abs(centred.rims[0].draws[0].clipped), 0);
}

// The displacements of mirrors and rims together change nothing (eq. W.16). The mode is known to 1e-5 of its amplitude,
// and a mirror moved alone turns the beam by 2 k w/RoC = 97/m.
TEST(ArmWaves, CommonMotionChangesNothing) {
  ArmWaves const waves = solved(KilometreArm{});
  for (int axis : {0, 1}) {
    std::complex<double> sum =
        waves.draws[0].mirrors[0].whole.displacement[axis] + waves.draws[0].mirrors[1].whole.displacement[axis];
    for (std::size_t i : {0, 1}) sum += nominal_levers(waves, i).displacement[axis];
    double const size = std::abs(waves.draws[0].mirrors[0].whole.displacement[axis]);
    EXPECT_LT(std::abs(sum), 0.05 * size);
    EXPECT_GT(std::abs(sum - waves.draws[0].mirrors[1].whole.displacement[axis]),
              0.5 * size);  // negative control: one mirror stays
  }
}

// eq. W.22 and W.29. The crossover angle lies between those at which both mirrors see each rim, so that the grid holds
// the light of one of them. The mode does not reach the outlines of the mirrors, 3.6 of its radii away, but what the
// other mirror scatters does.
void expect_speckle(KilometreArm const& scene, double radius, bool held) {
  ArmWaves const waves = solved(scene);
  for (std::size_t i : {0, 1}) {
    RimResult const& rim = waves.rims[i];
    EXPECT_TRUE(rim.draws.empty());
    double const l1 = i == 0 ? 400 : 600, l2 = 1000 - l1;
    auto const brdf = [&](double distance) { return 5e-7 * std::pow(std::atan(radius / distance), -2); };
    RingField const& far = waves.light[0].at_rims[i][1 - i];
    double const one = i == 1 && held ? 0 : brdf(l1), two = i == 0 && held ? 0 : brdf(l2);
    SpeckledRim lit{1064e-9, radius, l1, l2, waves.arm.mirrors[0].spot, waves.arm.mirrors[1].spot, one, two};
    SpeckleMeans const dark = speckle_means(lit);
    auto const& outlines = waves.light[0].outlines;
    // The light of the farther mirror passes the other rim (eq. W.30).
    std::vector<PassedEdge> const other{{400, radius}}, none;
    lit.edge1 = diffracted(outlines[0], waves.arm.mirrors[0].radius, 1064e-9, radius, l1, i == 1 ? other : none);
    lit.edge2 = diffracted(outlines[1], waves.arm.mirrors[1].radius, 1064e-9, radius, l2, i == 0 ? other : none);
    if (held) (i == 0 ? lit.edge2 : lit.edge1) = far;  // the wave of the outline is in it
    SpeckleMeans const means = speckle_means(lit);
    EXPECT_GT(deviation(dark.transverse, means.transverse), 0.01);
    EXPECT_LT(deviation(rim.speckle.transverse, means.transverse), 1e-4);
    EXPECT_LT(deviation(rim.speckle.longitudinal, means.longitudinal), 1e-4);
    EXPECT_LT(deviation(rim.speckle.field, means.field), 1e-4);
    EXPECT_EQ(far.value.empty(), !held);
    // The irradiance is not that of the BSDF.
    EXPECT_TRUE(!held || deviation(600 * 600 * far.irradiance(), brdf(600)) > 0.01);
  }
}

TEST(ArmWaves, RimsBeyondTheAngleHaveTheirExpectation) {
  std::string const grid_of_100 = "crossover: 100 urad, grid: {points: 256, window: 0.5 m}";
  expect_speckle(kilometre_arm(grid_of_100), 0.045, false);  // the mode itself reaches the rim
  KilometreArm wide = kilometre_arm(grid);
  for (std::size_t at = 0; (at = wide.baffles.find("45 mm", at)) != std::string::npos;)
    wide.baffles.replace(at, 5, "70 mm");
  expect_speckle(wide, 0.07, true);
}

// A kilometre near the concentric limit: what its small mirrors clip of the mode, their outlines send across the axis
// to edges next to the other mirror.
World dense_arm(int points) {
  KilometreArm scene = kilometre_arm(fmt::format("crossover: 120 urad, grid: {{points: {}, window: 0.42 m}}", points));
  scene.baffles.clear();
  for (int const z : {90, 100, 115, 130, 150, 175, 205})
    scene.baffles += fmt::format(
        "  - {{name: baffle_{}, shape: {{disk: {{inner_radius: 71 mm, outer_radius: 30 cm}}}}, at: [0 m, 0 m, {} m],"
        " facing: [0, 0, 1], body: pipe, material: black}}\n",
        z, z);
  std::string text = scene.text();
  for (auto const& [from, to] : {std::pair<std::string, std::string>{"radius: 75 mm", "radius: 60 mm"},
                                 {"curvature: 2500 m", "curvature: 560 m"}})
    for (std::size_t at; (at = text.find(from)) != std::string::npos;) text.replace(at, from.size(), to);
  FileTexts const texts{{"a.yaml", text}};
  return build_world(read_scene("a.yaml", {}, &texts));
}

// Sum of <|A_x|^2> over edges that only the far mirror E lights on the grid, and of the same with its light as the wave
// W.28 of its outline beside speckle of the rest of the irradiance; the largest irradiance of that wave over all.
struct LeversByFarLight {
  double by_harmonics = 0, by_outline = 0, largest_share = 0;
};
LeversByFarLight levers_by_far_light(World const& world) {
  ArmOptions options;
  options.threads = 1;
  ArmWaves const waves = solve_arm(world, world.wave, options);
  LeversByFarLight sums;
  std::vector<PassedEdge> nearer;  // to E
  for (std::size_t i = waves.rims.size(); i-- > 0;) {
    RingField const& far = waves.light[0].at_rims[i][1];
    double const z = waves.arm.rims[i].centre.z, l = 1000 - z, a = waves.arm.rims[i].rim.radius;
    EXPECT_FALSE(far.value.empty()) << z;
    sums.by_harmonics += waves.rims[i].speckle.transverse;
    SpeckledRim lit{1064e-9, a, z, l, waves.arm.mirrors[0].spot, waves.arm.mirrors[1].spot};
    lit.brdf1 = 5e-7 * std::pow(std::atan(a / z), -2);
    lit.edge1 = diffracted(waves.light[0].outlines[0], waves.arm.mirrors[0].radius, 1064e-9, a, z, {});
    lit.edge2 = diffracted(waves.light[0].outlines[1], waves.arm.mirrors[1].radius, 1064e-9, a, l, nearer);
    double const all = far.irradiance(), outline = lit.edge2.irradiance();
    sums.largest_share = std::fmax(sums.largest_share, outline / all);
    for (Complex& f : lit.edge2.value) f *= std::sqrt(std::fmin(1, all / outline));
    lit.brdf2 = l * l * std::fmax(all - outline, 0);
    sums.by_outline += speckle_means(lit).transverse;
    nearer.push_back({l, a});
  }
  return sums;
}

// Levers by the harmonics of the field (eq. W.63) do not depend on the grid. The control takes W.28 for the light of E,
// which diverges where the outline reflects light straight to an edge: it states more light than there is.
TEST(ArmWaves, LeversOfDenseEdgesDoNotDependOnTheGrid) {
  LeversByFarLight const coarse = levers_by_far_light(dense_arm(384)), fine = levers_by_far_light(dense_arm(480));
  EXPECT_LT(deviation(coarse.by_harmonics, fine.by_harmonics), 0.01);
  EXPECT_GT(coarse.largest_share, 1.2);
  EXPECT_GT(deviation(coarse.by_outline, coarse.by_harmonics), 0.1);
}

// The first levers are those of the rim as drawn; each draw of the tolerances has its own, in each draw of the heights
// others, and each rim. The first draw of the heights is the only one without `map_draws`.
TEST(ArmWaves, DrawsAreReproducible) {
  std::string const tolerance = ", tolerance: {radius: 0.2 mm, centre: 0.5 mm, place: 1 m}, draws: 2";
  ArmWaves const drawn = solved(grid + tolerance + ", map_draws: 2"), again = solved(grid + tolerance),
                 nominal = solved(grid);
  ASSERT_EQ(drawn.draws.size(), 2u);
  EXPECT_EQ(drawn.draws[0].loss, again.draws[0].loss);
  EXPECT_NE(drawn.draws[1].loss, again.draws[0].loss);
  EXPECT_EQ(drawn.ledger.mirror1, 0.5 * (drawn.draws[0].ledger.mirror1 + drawn.draws[1].ledger.mirror1));
  for (std::size_t rim : {0, 1}) {
    ASSERT_EQ(drawn.rims[rim].draws.size(), 2u);
    ASSERT_EQ(drawn.rims[rim].draws[0].responses.size(), 3u);
    ASSERT_EQ(drawn.rims[rim].ensemble().size(), 4u);
    EXPECT_TRUE(same(nominal_levers(drawn, rim), nominal_levers(nominal, rim)));
    for (std::size_t i : {0, 1, 2})
      EXPECT_TRUE(same(drawn.rims[rim].draws[0].responses[i].levers, again.rims[rim].draws[0].responses[i].levers));
    auto const all = drawn.rims[rim].ensemble();
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(same(all[i]->levers, all[j]->levers));
  }
}

// New random heights have the same spectrum: their mean square lies within 5 standard errors of the sum of eq. W.20
// over the frequencies of the grid, each with an exponentially distributed power.
TEST(ArmWaves, DrawsOfHeightsKeepTheSpectrum) {
  World const world = kilometre_arm(grid).world();
  ArmCavity const arm = arm_cavity(world, world.wave);
  double const window = arm.cavity.grid.window, wavelength = arm.cavity.wavelength;
  double expected = 0, variance = 0;
  for (int row = -128; row < 128; ++row)
    for (int column = -128; column < 128; ++column) {
      double const f = std::hypot(row, column) / window;
      if (f == 0 || f > arm.crossover / wavelength) continue;
      double const share = height_spectrum(5e-7 * std::pow(f * wavelength, -2), wavelength) / (window * window);
      expected += share;
      variance += 2 * share * share;  // a frequency and its opposite have one random amplitude
    }
  std::array<std::vector<double>, 2> const first = drawn_heights(world, world.wave, arm, 0);
  EXPECT_EQ(first[0], arm.cavity.mirror1.height);
  for (std::uint32_t draw : {0u, 1u, 2u}) {
    auto const heights = drawn_heights(world, world.wave, arm, draw);
    EXPECT_NE(heights[0], heights[1]);
    EXPECT_EQ(heights[1] == first[1], draw == 0);
    for (std::size_t i : {0, 1}) {
      double const square = std::pow(height_rms(heights[i]), 2);
      EXPECT_NEAR(square, expected, 5 * std::sqrt(variance));
      EXPECT_GT(std::fabs(2 * square - expected), 5 * std::sqrt(variance));  // negative control: a one-sided spectrum
    }
  }
}

TEST(ArmWaves, SpreadOfDraws) {
  Spread const few = spread_of({4, 1, 3});
  EXPECT_DOUBLE_EQ(few.mean, 8. / 3);
  EXPECT_EQ(few.median, 3);
  EXPECT_EQ(few.low, 1);
  EXPECT_EQ(few.high, 4);
  std::vector<double> hundred;
  for (int i = 100; i > 0; --i) hundred.push_back(i);
  Spread const many = spread_of(hundred);
  EXPECT_EQ(many.median, 50.5);
  EXPECT_EQ(many.low, 5);
  EXPECT_EQ(many.high, 95);
}

// The light beyond the edge of a baffle by sectors, mean over the draws, is what the balance of power has on it,
// within the width of a cell: over 2 mm the light falls to a third.
TEST(ArmWaves, LightOnBafflesBySector) {
  ArmWaves const waves = solved(grid + std::string(", map_draws: 2"));
  for (std::size_t rim : {0, 1})
    for (Travel const travel : {Travel::towards_mirror2, Travel::towards_mirror1}) {
      bool const outward = travel == Travel::towards_mirror2;
      RoundHole const& hole = waves.arm.cavity.baffles[rim].rim;
      PolarIrradiance const& light = waves.irradiance.of(int(rim) + 1, travel);
      auto const total = [&](RoundHole const& h) {
        double all = 0;
        for (double share : light.beyond(h)) all += share;
        return all;
      };
      double const expected = (outward ? waves.ledger.towards_mirror2 : waves.ledger.towards_mirror1)[rim];
      EXPECT_LT(deviation(total(hole), expected), 0.2);
      EXPECT_LT(deviation(total(hole), light.power(hole.radius, 1)), 1e-12);
      EXPECT_GT(deviation(total({1.1 * hole.radius}), expected), 0.4);  // control
      // A shift towards +x moves light from the sectors there to the others.
      std::vector<double> const centred = light.beyond(hole), shifted = light.beyond({hole.radius, 2e-3, 0});
      EXPECT_LT(shifted.front(), centred.front());
      EXPECT_GT(shifted[centred.size() / 2], centred[centred.size() / 2]);
    }
}

// The check reports the change by a grid of 384 points, the next number of points above 256 times the root of two, with
// the same heights.
TEST(ArmWaves, GridCheckIsTheFinerGrid) {
  World const coarse = kilometre_arm(grid).world(),
              fine = kilometre_arm("crossover: 120 urad, grid: {points: 384, window: 0.5 m}").world();
  ArmOptions options;
  options.threads = 1;
  options.grid_check = true;
  ArmWaves const checked = solve_arm(coarse, coarse.wave, options), finer = solve_arm(fine, fine.wave);
  ASSERT_TRUE(checked.grid_check);
  GridCheck const& check = *checked.grid_check;
  EXPECT_EQ(check.points, 384);
  EXPECT_FALSE(finer.grid_check);
  double const loss = checked.mode.loss();
  EXPECT_LT(std::fabs(check.loss - (finer.mode.loss() - loss)), 1e-5 * loss);
  EXPECT_LT(std::fabs(check.ledger.total() - check.loss), 1e-5 * loss);
  EXPECT_GT(std::fabs(check.loss), 1e-4 * loss);  // control: edges that clip the beam need more than 256 points
  double change = 0, squares = 0;
  for (std::size_t rim : {0, 1})
    for (int axis : {0, 1}) {
      Complex const before = nominal_levers(checked, rim).displacement[axis];
      change = std::max(change, std::abs(nominal_levers(finer, rim).displacement[axis] - before));
      squares += std::norm(before);
    }
  EXPECT_NEAR(check.across, change / std::sqrt(squares / 4), 0.01 * check.across + 1e-4);
  EXPECT_GT(check.along, 0);
}

// Mirrors with heights, tolerances and higher modes.
TEST(ArmWaves, SameBitsWithAnyThreads) {
  std::string const settings = std::string(grid) + ", tolerance: {centre: 0.5 mm}, draws: 2, map_draws: 2";
  ArmWaves const one = solved(kilometre_arm(settings), 1, 1);
  auto const differs = [&](ArmWaves const& other) {
    if (one.mode.eigenvalue != other.mode.eigenvalue || one.ledger.total() != other.ledger.total()) return true;
    for (std::size_t i : {0, 1}) {
      ArmDraw const &a = one.draws[i], &b = other.draws[i];
      if (a.loss != b.loss) return true;
      for (std::size_t mirror : {0, 1})
        if (!same(a.mirrors[mirror].whole, b.mirrors[mirror].whole)) return true;
    }
    if (one.irradiance.of(1, Travel::towards_mirror1).mean != other.irradiance.of(1, Travel::towards_mirror1).mean)
      return true;
    if (one.modes.size() != other.modes.size()) return true;
    for (std::size_t i = 0; i < one.modes.size(); ++i)
      if (one.modes[i].loss != other.modes[i].loss || one.modes[i].phase != other.modes[i].phase) return true;
    for (std::size_t rim : {0, 1}) {
      if (one.rims[rim].draws[1].clipped != other.rims[rim].draws[1].clipped) return true;
      auto const ours = one.rims[rim].ensemble(), theirs = other.rims[rim].ensemble();
      for (std::size_t i = 0; i < 4; ++i)
        if (!same(ours[i]->levers, theirs[i]->levers)) return true;
    }
    return false;
  };
  EXPECT_FALSE(one.modes.empty());
  for (int threads : {2, 5}) EXPECT_FALSE(differs(solved(kilometre_arm(settings), threads, 1))) << threads;
  EXPECT_TRUE(differs(solved(kilometre_arm(settings + ", maps: {E: {seed: 2}}"), 1, 1)));  // negative control
}

// V9: centroids of the light beside eq. W.23. A mirror of radius R that is displaced by d acts as one that leans by
// d/R, and both displaced alike take the light along.
TEST(ArmWaves, TiltsAndShiftsOfTheSceneV9) {
  auto const spots = [](std::string const& mirrors) {
    KilometreArm scene = kilometre_arm(perfect + ", mirrors: {" + mirrors + "}");
    scene.wave.replace(scene.wave.find("baffles: \"baffle*\", "), 20, "");
    return solved(scene);
  };
  ArmWaves const tilted = spots("E: {tilt: [0.3 urad, 0 rad]}");
  EXPECT_LT(deviation(tilted.spots[0].found[0], 0.46875e-3), 1e-4);
  EXPECT_LT(deviation(tilted.spots[1].found[0], 0.28125e-3), 1e-4);
  EXPECT_LT(deviation(tilted.spots[0].expected[0], 0.46875e-3), 1e-9);
  EXPECT_LT(std::abs(tilted.spots[0].found[1]), 1e-9);
  ArmWaves const leaning = spots("E: {tilt: [0 rad, 0.4 urad]}"), displaced = spots("E: {shift: [0 m, 1 mm]}");
  for (std::size_t i : {0, 1}) {
    EXPECT_LT(deviation(displaced.spots[i].expected[1], leaning.spots[i].expected[1]), 1e-9);
    EXPECT_LT(deviation(displaced.spots[i].found[1], leaning.spots[i].expected[1]), 1e-3);
  }
  ArmWaves const both = spots("I: {shift: [2 mm, 1 mm]}, E: {shift: [2 mm, 1 mm]}"), aligned = spots("");
  EXPECT_LT(deviation(both.spots[1].found[0], 2e-3), 1e-4);
  EXPECT_LT(deviation(both.spots[0].found[1], 1e-3), 1e-4);
  // The edges clip more of a tilted mode, but not of one that moved with its mirrors.
  EXPECT_LT(deviation(both.mode.loss(), aligned.mode.loss()), 1e-3);
  ArmWaves const strong = spots("E: {tilt: [25 urad, 0 rad]}");
  EXPECT_GT(strong.ledger.mirror1, 2 * aligned.ledger.mirror1);
  EXPECT_LT(deviation(strong.ledger.total(), strong.mode.loss()), 1e-4);
}

}  // namespace
}  // namespace straytrace::wave_arm_waves
