// SPDX-License-Identifier: BSD-3-Clause
// Light at small angles that baffles scatter back into the mode of a cavity, from a known irradiance
// (docs/theory/wave.md, eq. W.19 to W.21).
#include "trace/deterministic/halo.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/math/gauss_points.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"
#include "trace/deterministic/halo_light.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::testing::trace_halo {
namespace {

using ::testing::HasSubstr;

constexpr double brdf = 0.03 / pi;  // of the baffles, 1/sr
constexpr double inner = 0.045, outer = 0.2;

KilometreArm lit_arm() {
  KilometreArm arm = kilometre_arm("crossover: 120 urad, grid: {points: 256, window: 0.5 m}");
  arm.baffles =
      "  - {name: baffle_two, shape: {disk: {inner_radius: 45 mm, outer_radius: 20 cm}}, at: [0 m, 0 m, 600 m],"
      " facing: [0, 0, -1], body: pipe, material: grey}\n"
      "  - {name: baffle_one, shape: {disk: {inner_radius: 45 mm, outer_radius: 20 cm}}, at: [0 m, 0 m, 400 m],"
      " facing: [0, 0, 1], body: pipe, material: grey}\n";
  return arm;
}
std::string lit_text() {
  std::string text = lit_arm().text();
  return text.insert(text.find("  black: {}\n"), "  grey: {scatter: {model: lambertian, tis: 0.03}}\n");
}
World lit_world(std::string const& text = lit_text()) {
  FileTexts const texts{{"a.yaml", text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

// The same irradiance everywhere beyond a radius, with the square of speckle.
PolarIrradiance even_irradiance(double mean, double from) {
  PolarIrradiance light{1e-3, 250, 32, std::vector<float>(250 * 32), std::vector<float>(250 * 32)};
  for (int ring = 0; ring < light.rings; ++ring)
    for (int s = 0; s < light.sectors; ++s)
      if (light.radius(ring) > from) {
        light.mean[std::size_t(ring * light.sectors + s)] = float(mean);
        light.square[std::size_t(ring * light.sectors + s)] = float(2 * mean * mean);
      }
  return light;
}

struct LitBench {
  World world;
  ArmWaves waves{arm_cavity(world, world.wave), {1, 0, 0, Field(Grid{})}, {}, 0, {}, {}, {}, {}, {}, {}, {}, {}};

  explicit LitBench(std::string const& text = lit_text()) : world(lit_world(text)) {
    PolarIrradiance const dark = even_irradiance(0, 0);
    waves.irradiance.towards_mirror1.assign(4, dark);
    waves.irradiance.towards_mirror2.assign(4, dark);
    waves.ledger.towards_mirror1 = waves.ledger.towards_mirror2 = {0, 0};
  }
  double coupling(std::string const& mirror, std::string const& baffle) const {
    for (CouplingClass const& c : halo_classes(world, waves).classes)
      if (world.groups()[c.steps.at(0).group.value] == mirror && world.groups()[c.steps.at(1).group.value] == baffle)
        return c.coupling.mean;
    return 0;
  }
};

// 2 lambda^2 beta I^2 over the area, on the side that the light comes from (eq. W.19); the factor 2 is that of speckle.
TEST(Halo, ScattersBackWithTheSquareOfTheIrradiance) {
  LitBench bench;
  constexpr double irradiance = 1e-4, from = 0.1;
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(irradiance, from);
  auto const result = halo_classes(bench.world, bench.waves);
  ASSERT_EQ(result.classes.size(), 1u);
  CouplingClass const& c = result.classes[0];
  double const area = pi * (outer * outer - from * from);
  double beyond = 0;  // 4 I_L I_H, light beyond the crossover angle on one way
  GaussPoints const gauss(16);
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    double const r = from + (outer - from) * gauss.at[i];
    auto const law = [](double angle) { return angle < 120e-6 ? 0 : 5e-7 / (angle * angle); };
    beyond += gauss.weight[i] * (outer - from) * 2 * pi * r *
              mean_irradiance(law, bench.waves.arm.mirrors[0].spot, 1 / 2500., 400, r);
  }
  double const scale = bench.world.wavelength * bench.world.wavelength * brdf,
               expected = scale * (2 * irradiance * irradiance * area + 4 * irradiance * beyond);
  EXPECT_LT(deviation(c.coupling.mean, expected), 5e-3);
  EXPECT_GT(deviation(c.coupling.mean, scale * irradiance * irradiance * area), 0.5);  // control: without speckle
  EXPECT_EQ(c.kind, ClassKind::halo);
  EXPECT_EQ(c.reverse, 1);
  EXPECT_EQ(bench.world.groups()[c.steps.at(0).group.value], "I");
  EXPECT_EQ(bench.world.groups()[c.steps.at(1).group.value], "baffle_one");
  EXPECT_EQ(bench.world.ports()[c.port.value], "I");
  EXPECT_THAT(c.statement, HasSubstr("eq. W.19"));
}

// A cone of half angle 35 deg about the axis, which the light meets at 55 deg: of the power |psi|^2 dA that falls on an
// area across the beam, beta cos(theta) per solid angle goes back (eq. W.19).
TEST(Halo, ConesScatterBackByTheCosine) {
  double const tilt = 35 * pi / 180;
  auto const of = [](std::string const& shape) {
    std::string text = lit_text();
    std::string const flat = "disk: {inner_radius: 45 mm, outer_radius: 20 cm}";
    text.replace(text.rfind(flat), flat.size(), shape);
    LitBench bench{text};
    bench.waves.irradiance.towards_mirror2[1] = even_irradiance(1e-4, 0.1);
    return bench.coupling("I", "baffle_one");
  };
  double const flat = of("disk: {inner_radius: 45 mm, outer_radius: 20 cm}"),
               cone = of("cone: {inner_radius: 45 mm, outer_radius: 20 cm, half_angle: 35 deg}");
  EXPECT_GT(flat, 0);
  EXPECT_LT(deviation(cone / flat, std::sin(tilt)), 1e-3);
  EXPECT_GT(std::fabs(cone / flat - 1), 0.3);  // control: the factor left out
}

// Along the beam +2k of the baffle (and -2k of the mirror), as for every single vertex (eq. 2.3 and 2.5).
TEST(Halo, MovesWithTheBaffle) {
  LitBench bench;
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(1e-4, 0.1);
  auto const result = halo_classes(bench.world, bench.waves);
  ASSERT_EQ(result.classes.size(), 1u);
  double const twice_k = 4 * pi / bench.world.wavelength;
  double along = 0, weights = 0, tilt = 0;
  for (PathRecord const& r : result.classes[0].records) {
    weights += r.weight;
    EXPECT_NEAR(r.path_length, 800, 0.1);
    for (PhaseSensitivity const& s : r.phase_sensitivities)
      if (bench.world.bodies()[s.body.value].name == "pipe") {
        EXPECT_LT(deviation(std::fabs(s.d[2]), twice_k), 1e-6);
        along += r.weight * s.d[2];
        tilt += r.weight * s.d[3];
      }
  }
  EXPECT_LT(deviation(std::fabs(along), twice_k * weights), 1e-6);
  EXPECT_LT(std::fabs(tilt), 1e-3 * 0.1 * twice_k * weights);  // of the two halves against each other
}

// Light from the other mirror meets the other side of the same baffle, and joins the mode at its own mirror.
TEST(Halo, EachSideWithItsMirror) {
  LitBench bench;
  bench.waves.irradiance.towards_mirror1[1] = even_irradiance(1e-4, 0.1);
  EXPECT_GT(bench.coupling("E", "baffle_one"), 0);
  EXPECT_EQ(bench.coupling("I", "baffle_one"), 0);
  bench.waves.irradiance.towards_mirror2[2] = even_irradiance(2e-4, 0.1);
  EXPECT_GT(bench.coupling("I", "baffle_two"), bench.coupling("E", "baffle_one"));
}

// It warns of light that the edges take from the mode but no surface next to them meets, and of measuring planes that
// it passes.
TEST(Halo, TellsWhatItLeavesOut) {
  LitBench bench;
  bench.waves.draws.resize(1);
  constexpr double irradiance = 1e-4, from = 0.1;
  double const on_baffle = irradiance * pi * (outer * outer - from * from);
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(irradiance, from);
  bench.waves.ledger.towards_mirror2[0] = on_baffle;
  auto const whole = halo_classes(bench.world, bench.waves);
  EXPECT_TRUE(whole.warnings.empty());  // control: all of it meets the baffle
  ASSERT_EQ(whole.classes.size(), 1u);
  EXPECT_THAT(whole.classes[0].statement, HasSubstr("at 1 plane,"));
  EXPECT_THAT(whole.classes[0].statement, HasSubstr("one draw of the mirrors"));
  bench.waves.draws.resize(3);
  bench.waves.ledger.towards_mirror2[0] = 2 * on_baffle;
  auto const half = halo_classes(bench.world, bench.waves);
  ASSERT_EQ(half.warnings.size(), 1u);
  EXPECT_THAT(half.warnings[0], HasSubstr("wave: 0.5 of the light within 120 urad"));
  EXPECT_EQ(half.classes[0].coupling.mean, whole.classes[0].coupling.mean);
  EXPECT_THAT(half.classes[0].statement, HasSubstr("mean over 3 draws of the mirrors"));
  Receiver plane;
  plane.surface = bench.waves.arm.mirrors[0].surface;
  bench.world.add_receiver("mirror", plane);
  EXPECT_EQ(halo_classes(bench.world, bench.waves).warnings.size(), 1u);  // control
  plane.clear = true;
  bench.world.add_receiver("plane", plane);
  EXPECT_THAT(halo_classes(bench.world, bench.waves).warnings.back(), HasSubstr("passes measuring planes uncounted"));
}

// The edge of a baffle within a ring of the irradiance is resolved to an eighth of the ring (eq. W.19).
TEST(Halo, EdgesWithinARing) {
  LitBench bench;
  PolarIrradiance coarse{7e-3, 40, 32, std::vector<float>(40 * 32, 1e-4f), std::vector<float>(40 * 32, 2e-8f)};
  bench.waves.irradiance.towards_mirror2[1] = coarse;
  double const coupling = bench.coupling("I", "baffle_one"), area = pi * (outer * outer - inner * inner),
               eighth = 2 * pi * outer * 7e-3 / 8;
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(1e-4, 0);
  EXPECT_LT(deviation(coupling, bench.coupling("I", "baffle_one")), eighth / area);
  // Control: whole rings whose middle the baffle covers, from 42 to 203 mm.
  EXPECT_GT(deviation(pi * (0.203 * 0.203 - 0.042 * 0.042), area), 3 * eighth / area);
}

// For pictures: the irradiance of the side that the light meets, and patches whose light sums to what the surface
// takes.
TEST(Halo, LightOnSurfaces) {
  LitBench bench;
  constexpr double irradiance = 1e-4, from = 0.1;
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(irradiance, from);
  HaloLight const light(bench.world, bench.waves.arm, bench.waves.irradiance);
  auto const all = light.surfaces(10);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(bench.world.name_of(all[0].surface), "baffle_one");
  EXPECT_EQ(all[0].travel, Travel::towards_mirror2);
  double const expected = irradiance * pi * (outer * outer - from * from);
  EXPECT_LT(deviation(all[0].share, expected), 1e-2);  // of a ring of 1 mm
  double sum = 0;
  std::size_t least = 1000;
  for (HaloPatch const& p : all[0].patches) {
    sum += p.irradiance * pi / 32 * (p.outer * p.outer - p.inner * p.inner);
    least = std::min(least, std::size_t(p.inner * 1e3));
    EXPECT_NEAR(p.inner_place, 400, 1e-9);
  }
  EXPECT_LE(all[0].patches.size(), 320u);
  EXPECT_EQ(least, std::size_t(inner * 1e3));
  EXPECT_LT(deviation(sum, all[0].share), 1e-5);
  // It faces +z: light towards mirror 2 meets its back. Controls: its front, the dark ring, the other baffle.
  SurfaceId const surface = all[0].surface;
  EXPECT_EQ(light.on(surface, {0, 0.15, 400}, false), double(float(irradiance)));
  EXPECT_EQ(light.on(surface, {0, 0.15, 400}, true), 0);
  EXPECT_EQ(light.on(surface, {0, 0.09, 400}, false), 0);
  EXPECT_EQ(light.on(surface, {0, 0.15, 600}, false), 0);
}

// On a cone the irradiance is lower by the cosine of the angle of incidence, and patches lie on it. Control: as if
// flat.
TEST(Halo, LightOnACone) {
  std::string text = lit_text();
  std::string const flat = "disk: {inner_radius: 45 mm, outer_radius: 20 cm}";
  for (std::size_t at; (at = text.find(flat)) != text.npos;)
    text.replace(at, flat.size(), "cone: {inner_radius: 45 mm, outer_radius: 20 cm, half_angle: 35 deg}");
  LitBench bench(text);
  bench.waves.irradiance.towards_mirror2[1] = even_irradiance(1e-4, 0);
  auto const all = HaloLight(bench.world, bench.waves.arm, bench.waves.irradiance).surfaces(10);
  ASSERT_EQ(all.size(), 1u);
  double drawn = 0, across = 0;
  for (HaloPatch const& p : all[0].patches) {
    double const width = p.outer - p.inner, height = p.outer_place - p.inner_place;
    EXPECT_NEAR(std::fabs(width / height), std::tan(35 * degree), 1e-6);
    EXPECT_NEAR(p.irradiance, 1e-4 * std::sin(35 * degree), 1e-9);
    drawn += p.irradiance * std::hypot(width, height) * pi / 32 * (p.outer + p.inner);
    across += p.irradiance * width * pi / 32 * (p.outer + p.inner);
  }
  EXPECT_LT(deviation(drawn, all[0].share), 1e-4);
  EXPECT_GT(deviation(across, all[0].share), 0.3);
}

// The rays of the mirrors begin at the crossover angle, and scatter what the BSDF scatters beyond it (eq. W.20).
TEST(Halo, RaysBeginAtTheCrossover) {
  World world = lit_world();
  ArmCavity const before = arm_cavity(world, world.wave);
  WorldView const old = world.view();
  auto const optic = [&world] {
    SurfaceId const mirror = world.wave.mirrors[0].surface;
    return world.view().optics[world.surfaces()[mirror.value].front];
  };
  auto const at = [&](double angle) {
    return scatter_eval(world.view().laws, optic(), {0, 0, 1}, {std::sin(angle), 0, std::cos(angle)});
  };
  double const whole = scatter_albedo(old.laws, optic(), 1.0), inside = at(100e-6), outside = at(140e-6);
  EXPECT_GT(inside, outside);
  begin_rays_at_crossover(world);
  EXPECT_EQ(at(100e-6), 0);
  EXPECT_EQ(at(140e-6), outside);
  double const left = scatter_albedo(world.view().laws, optic(), 1.0);
  EXPECT_LT(deviation(left, before.mirrors[0].scattered), 1e-4);
  EXPECT_GT(whole, 1.2 * left);  // control
  EXPECT_EQ(world.material_optic(world.surfaces()[world.wave.mirrors[0].surface.value].front),
            world.material_optic(world.surfaces()[world.wave.mirrors[1].surface.value].front));
  ArmCavity const after = arm_cavity(world, world.wave);  // the field still has the whole BSDF
  EXPECT_EQ(after.cavity.mirror1.height, before.cavity.mirror1.height);
}

}  // namespace
}  // namespace straytrace::testing::trace_halo
