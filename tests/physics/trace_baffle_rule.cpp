// SPDX-License-Identifier: BSD-3-Clause
// Baffles of a tube like those of GEO 600 (estimators.md 17, scene 15; physics.md 8.7; pure visibility): tube of radius
// R, baffles of clear radius r, mirrors of radius m at both ends. Light from the far edge of a mirror that just passes
// the baffle at z meets the wall at q z, q = (R + m)/(r + m), where the next one has to stand: from the first at z_0 to
// the middle of the tube ceil(ln(L/(2 z_0))/ln q) per half, and one in the middle when the last two stand further apart
// than q.
#include <random>

#include "trace_support.hpp"

namespace straytrace::testing::trace_baffle_rule {
namespace {

constexpr double tube = 0.30, rim = 0.28, mirror = 0.09, length_of_tube = 600, first = 10;
constexpr double ratio = (tube + mirror) / (rim + mirror);

int number_per_half() { return int(std::ceil(std::log(0.5 * length_of_tube / first) / std::log(ratio))); }

std::vector<double> places(double step = ratio) {
  std::vector<double> z;
  for (double at = first; at < 0.5 * length_of_tube; at *= step) z.push_back(at);
  std::size_t const half = z.size();
  if (length_of_tube - z.back() > step * z.back()) z.push_back(0.5 * length_of_tube);
  for (std::size_t i = half; i-- > 0;) z.push_back(length_of_tube - z[i]);
  return z;
}

struct Tube {
  World world;
  SurfaceId wall;
};
Tube make_tube(std::vector<double> const& z, std::size_t missing) {
  Tube t;
  World& world = t.world;
  BodyId const body = world.add_body("tube", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.3),
                      white = lambertian_optic(world, 1);
  GroupId const baffles = world.add_group("baffles");
  for (int end = 0; end < 2; ++end) {
    SurfaceId const m = world.add_surface(Disk{{0, 0, end * length_of_tube}, {0, 0, end ? -1.0 : 1.0}, 0, mirror},
                                          white, black, body, world.add_group("mirror"));
    world.add_footprint(
        spot(m, {0, 0, end * length_of_tube}, {0, 0, end ? 1.0 : -1.0}, Profile::even, mirror, {}, std::uint32_t(end)));
  }
  // the wall from the first baffle to the last: what lies before them is for other baffles
  t.wall = world.add_surface(Cylinder{{}, {0, 0, 1}, tube, first, length_of_tube - first}, black, grey, body,
                             world.add_group("wall"));
  for (std::size_t i = 0; i < z.size(); ++i)
    if (i != missing) world.add_surface(Disk{{0, 0, z[i]}, {0, 0, 1}, rim, tube}, grey, grey, body, baffles);
  world.limits.max_order = 1;
  world.finish();
  return t;
}

// Lines of sight from points of both mirrors, half of them on their edges, to points of the wall between two heights.
std::size_t seen(Tube const& t, double from, double to, int lines, std::uint64_t seed) {
  WorldView const view = t.world.view();
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  std::size_t count = 0;
  for (int i = 0; i < lines; ++i) {
    double const a = 2 * pi * uniform(engine), b = 2 * pi * (i % 4 < 2 ? 0.5 + uniform(engine) / 50 : uniform(engine));
    double const r = mirror * (i % 4 < 2 ? 1 - 1e-9 : std::sqrt(uniform(engine)));
    Vec3 const start{r * std::cos(a), r * std::sin(a), i % 2 ? length_of_tube : 0};
    Vec3 const end{tube * std::cos(a + b), tube * std::sin(a + b), from + (to - from) * uniform(engine)};
    double const d = length(end - start);
    if (!view.occluded({start, (1 / d) * (end - start), d * (1 - 1e-9)}, {{std::uint32_t(i % 2)}})) ++count;
  }
  return count;
}

TEST(BaffleRule, NumberOfBafflesScene15) {
  EXPECT_EQ(number_per_half(), 65);
  EXPECT_EQ(places().size(), 2u * 65 + 1);  // GEO 600 has 128 in each tube
}

constexpr double closer = 1e-6;  // baffles stand this much closer than where light would just touch two rims

TEST(BaffleRule, NoPointOfTheMirrorsSeesTheWallScene15) {
  std::vector<double> const z = places(ratio * (1 - closer));
  Tube const whole = make_tube(z, z.size());
  EXPECT_EQ(seen(whole, first, length_of_tube - first, 1 << 19, 1), 0u);
  World traced = make_tube(z, z.size()).world;
  TraceResult const r = run_histories(traced, 1 << 19);
  EXPECT_EQ(arrived(traced, r, "wall").mean, 0);
  EXPECT_GT(arrived(traced, r, "baffles").mean, 0);
}

// Twins: any one baffle missing, and all of them 1 % further apart than the rule says.
TEST(BaffleRule, EveryBaffleIsNeededScene15) {
  std::vector<double> const z = places(ratio * (1 - closer));
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    std::size_t const next = i < z.size() / 2 ? i + 1 : i - 1;  // the gap lies behind it, as seen from its own mirror
    EXPECT_GT(seen(make_tube(z, i), std::fmin(z[i], z[next]), std::fmax(z[i], z[next]), 1 << 11, i), 0u) << i;
  }
  std::vector<double> const sparse = places(1.01 * ratio);
  EXPECT_GT(seen(make_tube(sparse, sparse.size()), first, length_of_tube - first, 1 << 17, 1), 0u);
  World traced = make_tube(z, 2).world;
  TraceResult const r = run_histories(traced, 1 << 19);
  EXPECT_GT(arrived(traced, r, "wall").mean, 0);
}

}  // namespace
}  // namespace straytrace::testing::trace_baffle_rule
