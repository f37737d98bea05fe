// SPDX-License-Identifier: BSD-3-Clause
// Baffles of a tube like those of GEO 600 (docs/theory/sampling.md; case B11; docs/theory/arm.md eq. 8.16; pure
// visibility): tube of radius R, baffles of clear radius r, mirrors of radius m at both ends. Light from the far edge
// of a mirror that just passes the baffle at z meets the wall at q z, q = (R + m)/(r + m), where the next one has to
// stand: from the first at z_0 to the middle of the tube ceil(ln(L/(2 z_0))/ln q) per half, and one in the middle when
// the last two are further apart than q.
#include <random>

#include "support/trace_support.hpp"

namespace straytrace::testing::trace_baffle_rule {
namespace {

constexpr double tube = 0.30, mirror = 0.09, length_of_tube = 600;  // m, GEO 600

struct Layout {
  double rim, first;  // m
  double ratio() const { return (tube + mirror) / (rim + mirror); }
  int per_half() const { return int(std::ceil(std::log(0.5 * length_of_tube / first) / std::log(ratio()))); }
};
constexpr Layout scene_15{0.28, 10};
// B11: published are 128 baffles per tube, about 3 cm high, no point of the wall visible. Where the first one stands is
// not; 1.8 m is where the rule gives 128.
constexpr Layout geo{0.27, 1.8};

std::vector<double> places(Layout const& l, double step, bool middle = true) {
  std::vector<double> z;
  for (double at = l.first; at < 0.5 * length_of_tube; at *= step) z.push_back(at);
  std::size_t const half = z.size();
  if (middle && length_of_tube - z.back() > step * z.back()) z.push_back(0.5 * length_of_tube);
  for (std::size_t i = half; i-- > 0;) z.push_back(length_of_tube - z[i]);
  return z;
}

struct Tube {
  World world;
  Layout layout;
};
Tube make_tube(Layout const& l, std::vector<double> const& z, std::size_t missing) {
  Tube t{{}, l};
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
  world.add_surface(Cylinder{{}, {0, 0, 1}, tube, l.first, length_of_tube - l.first}, black, grey, body,
                    world.add_group("wall"));
  for (std::size_t i = 0; i < z.size(); ++i)
    if (i != missing) world.add_surface(Disk{{0, 0, z[i]}, {0, 0, 1}, l.rim, tube}, grey, grey, body, baffles);
  world.limits.max_order = 1;
  world.finish();
  return t;
}
Tube make_tube(Layout const& l, std::vector<double> const& z) { return make_tube(l, z, z.size()); }

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
std::size_t seen_anywhere(Tube const& t, int lines) {
  return seen(t, t.layout.first, length_of_tube - t.layout.first, lines, 1);
}

TEST(BaffleRule, NumberOfBafflesScene15) {
  EXPECT_EQ(scene_15.per_half(), 65);
  EXPECT_EQ(places(scene_15, scene_15.ratio()).size(), 2u * 65 + 1);
}

constexpr double closer = 1 - 1e-6;  // baffles are this much closer than where light would just touch two rims

TEST(BaffleRule, NoLineOfSightFromMirrorsToTheWallScene15) {
  std::vector<double> const z = places(scene_15, scene_15.ratio() * closer);
  Tube const whole = make_tube(scene_15, z);
  EXPECT_EQ(seen_anywhere(whole, 1 << 19), 0u);
  World traced = make_tube(scene_15, z).world;
  TraceResult const r = run_histories(traced, 1 << 19);
  EXPECT_EQ(arrived(traced, r, "wall").mean, 0);
  EXPECT_GT(arrived(traced, r, "baffles").mean, 0);
}

// Controls: any one baffle missing, and all of them 1 % further apart than by the rule.
void expect_all_needed(Layout const& l, std::vector<double> const& z) {
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    std::size_t const next = i < z.size() / 2 ? i + 1 : i - 1;  // the gap lies behind it, as seen from its own mirror
    EXPECT_GT(seen(make_tube(l, z, i), std::fmin(z[i], z[next]), std::fmax(z[i], z[next]), 1 << 11, i), 0u) << i;
  }
}

TEST(BaffleRule, EveryBaffleIsNeededScene15) {
  std::vector<double> const z = places(scene_15, scene_15.ratio() * closer);
  expect_all_needed(scene_15, z);
  EXPECT_GT(seen_anywhere(make_tube(scene_15, places(scene_15, 1.01 * scene_15.ratio())), 1 << 17), 0u);
  World traced = make_tube(scene_15, z, 2).world;
  TraceResult const r = run_histories(traced, 1 << 19);
  EXPECT_GT(arrived(traced, r, "wall").mean, 0);
}

// Rule 8.16 from both ends gives the published number. Their shadows then end 2 m beyond the middle, before the first
// baffle of the other row: a ring between the rows stays in sight. With the first baffle 6 cm further (z_N q = L - z_N)
// the same 128 hide all of the wall.
TEST(BaffleRule, GeoHas128BafflesB11) {
  EXPECT_NEAR(2 * geo.per_half(), 128, 0.5);
  EXPECT_NE(2 * (Layout{0.28, 1.8}.per_half()), 128) << "control: 2 cm high";
  EXPECT_NE(2 * (Layout{0.27, 2.0}.per_half()), 128) << "control: the first at 2 m";
  std::vector<double> const z = places(geo, geo.ratio() * closer, false);
  ASSERT_EQ(z.size(), 128u);
  Tube const open = make_tube(geo, z);
  EXPECT_GT(seen(open, z[63] * geo.ratio(), z[64], 1 << 14, 2), 0u);
  EXPECT_EQ(seen(open, geo.first, z[63], 1 << 17, 3), 0u);

  Layout const shut{geo.rim, length_of_tube / (1 + geo.ratio()) / std::pow(geo.ratio() * closer, 63) * (2 - closer)};
  EXPECT_NEAR(shut.first, 1.86, 0.005);
  std::vector<double> const all = places(shut, shut.ratio() * closer, false);
  EXPECT_EQ(all.size(), 128u);
  EXPECT_EQ(seen_anywhere(make_tube(shut, all), 1 << 19), 0u);
  expect_all_needed(shut, all);  // negative controls
}

}  // namespace
}  // namespace straytrace::testing::trace_baffle_rule
