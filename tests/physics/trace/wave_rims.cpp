// SPDX-License-Identifier: BSD-3-Clause
// Routes of the rims and mirrors of a solved cavity: what their records make of the levers (docs/theory/wave.md,
// eq. W.14, W.22, W.26 and W.27).
#include "trace/deterministic/wave_rims.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>

#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::trace_wave_rims {
namespace {

using ::testing::HasSubstr;
using Complex = std::complex<double>;

enum Coordinate { x, y, z, rx, ry, rz };
enum Bodies : std::uint32_t { pipe, input, end };  // of the rims and of both mirrors; or `input` alone of both

// The cavity of a scene with the levers of the test in place of computed ones.
struct Bench {
  World world;
  ArmWaves waves;

  explicit Bench(KilometreArm const& scene = {})
      : world(scene.world()),
        waves{arm_cavity(world, world.wave), {1, 0, 0, Field(Grid{})}, {}, 0, {}, {}, {}, {}, {}, {}, {}, {}} {
    waves.rims.resize(waves.arm.rims.size());
    waves.draws.resize(1);
  }
  std::vector<CouplingClass> classes() const { return wave_rim_classes(world, waves); }
  CouplingClass of(std::string const& group) const {
    for (CouplingClass const& c : classes())
      if (c.steps.size() == 3 && world.groups()[c.steps.at(1).group.value] == group) return c;
    ADD_FAILURE() << "no class of " << group;
    return {};
  }
};

RimResponse levers(Complex a_x, Complex a_y = 0, Complex a_z = 0, Complex r_y = 0) {
  RimResponse response;
  response.levers.displacement[0] = a_x;
  response.levers.displacement[1] = a_y;
  response.levers.displacement[2] = a_z;
  response.levers.rotation[1] = r_y;
  return response;
}

// Mean square of the field by a coordinate of a body of all records: that of a displacement d is this times d^2.
double square(CouplingClass const& c, Coordinate coordinate, std::uint32_t body = pipe) {
  double sum = 0;
  for (PathRecord const& r : c.records)
    for (PhaseSensitivity const& s : r.phase_sensitivities)
      if (s.body.value == body) sum += r.weight * s.d[coordinate] * s.d[coordinate];
  return sum;
}
double weights(CouplingClass const& c) {
  double sum = 0;
  for (PathRecord const& r : c.records) sum += r.weight;
  return sum;
}

Complex const first{3e-4, -4e-4}, second{1e-4, 2e-4}, vertical{0, 7e-4}, along{2e-6, 1e-6};

// One draw of the heights.
RimResult found(std::vector<RimResponse> responses, Complex clipped) { return {{{std::move(responses), clipped}}, {}}; }

Bench solved_bench(KilometreArm const& scene = {}) {
  Bench bench(scene);
  bench.waves.rims.at(0) = found({levers(first, 0, along)}, {3e-6, 4e-6});
  bench.waves.rims.at(1) = found({levers(second, vertical)}, {0, 2e-6});
  return bench;
}

TEST(WaveRims, OneClassForEachGroupAndKind) {
  Bench bench = solved_bench();
  bench.waves.rims[1].draws.clear();
  bench.waves.rims[1].speckle = {1e-12, 1e-8, 1e-14};
  auto const classes = bench.classes();
  ASSERT_EQ(classes.size(), 2u);
  EXPECT_EQ(classes[0].kind, ClassKind::wave);
  EXPECT_EQ(classes[1].kind, ClassKind::speckle);
  EXPECT_EQ(std::string(name_of(classes[1].kind)), "speckle");
  char const* const rims[] = {"baffle_one", "baffle_two"};
  for (std::size_t i : {0, 1}) {
    CouplingClass const& c = classes[i];
    ASSERT_EQ(c.steps.size(), 3u);
    EXPECT_EQ(bench.world.groups()[c.steps[0].group.value], "E");  // the mirror without the port
    EXPECT_EQ(bench.world.groups()[c.steps[1].group.value], rims[i]);
    EXPECT_EQ(bench.world.groups()[c.steps[2].group.value], "I");
    EXPECT_EQ(c.steps[1].event, Event::diffract);
    EXPECT_EQ(bench.world.ports()[c.port.value], "I");
    EXPECT_EQ(c.reverse, 1);  // both directions are in the levers
    EXPECT_TRUE(c.coupling.trusted);
    EXPECT_EQ(c.coupling.std_error, 0);
    EXPECT_NEAR(weights(c) / c.coupling.mean, 1, 1e-12);
    EXPECT_THAT(c.statement, HasSubstr("1 inner edge"));
  }
  EXPECT_NE(classes[0].hash, classes[1].hash);
  EXPECT_NEAR(classes[0].coupling.mean / 25e-12, 1, 1e-12);  // |s|^2 of the light that the rim takes
  EXPECT_NEAR(classes[1].coupling.mean / 1e-12, 1, 1e-12);
  EXPECT_THAT(classes[1].statement, HasSubstr("mean over random mirrors"));
}

// The port of the second mirror where the first has none.
TEST(WaveRims, PortOfTheOtherMirror) {
  KilometreArm scene;
  scene.ports = "ports: {E: {beam: arm, at: E}}\n";
  Bench const bench = solved_bench(scene);
  CouplingClass const c = bench.of("baffle_one");
  EXPECT_EQ(bench.world.ports()[c.port.value], "E");
  EXPECT_EQ(bench.world.groups()[c.steps[0].group.value], "I");
  EXPECT_EQ(bench.world.groups()[c.steps[2].group.value], "E");
}

// |A|^2 summed over the rims of a group, for motion along each axis of the scene.
TEST(WaveRims, RecordsHoldTheLevers) {
  KilometreArm scene;
  scene.baffles =
      "  - {name: baffles, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, facing: [0, 0, 1], body: pipe,"
      " material: black, repeat: {count: 2, along: z, from: 400 m, to: 600 m}}\n";
  auto const classes = solved_bench(scene).classes();
  ASSERT_EQ(classes.size(), 1u);
  CouplingClass const& c = classes[0];
  double const across = std::norm(first) + std::norm(second);
  EXPECT_NEAR(square(c, x) / across, 1, 1e-12);
  EXPECT_NEAR(square(c, y) / std::norm(vertical), 1, 1e-12);
  EXPECT_NEAR(square(c, z) / std::norm(along), 1, 1e-12);
  EXPECT_GT(std::fabs(square(c, x) / std::norm(first + second) - 1), 0.1);  // negative control: fields added
  EXPECT_THAT(c.statement, HasSubstr("2 inner edges"));
  EXPECT_THAT(c.statement, HasSubstr("one draw of the mirrors"));
}

// About the pivot at the input mirror, a rotation about y by a small angle moves a rim at 400 m by 400 m times it.
TEST(WaveRims, RotationAboutAFarPivot) {
  Bench bench = solved_bench();
  double const arm = 400;
  EXPECT_NEAR(square(bench.of("baffle_one"), ry) / std::norm(arm * first), 1, 1e-9);
  EXPECT_NEAR(square(bench.of("baffle_one"), rz) / std::norm(first), 0, 1e-9);  // it is on the axis
  Complex const own{0.05, 0.02};  // by the rotation about the centre of the rim
  bench.waves.rims[0].draws[0].responses[0].levers.rotation[1] = own;
  EXPECT_NEAR(square(bench.of("baffle_one"), ry) / std::norm(arm * first + own), 1, 1e-9);
  EXPECT_GT(std::fabs(square(bench.of("baffle_one"), ry) / std::norm(arm * first) - 1), 0.1);  // negative control
  EXPECT_NEAR(square(bench.of("baffle_two"), rx) / std::norm(600.0 * vertical), 1, 1e-9);
  KilometreArm near;
  near.pipe = "{pivot: [0 m, 0 m, 400 m], motion: {x: {peterson: typical}, others: still}}";
  EXPECT_NEAR(square(solved_bench(near).of("baffle_one"), ry) / std::norm(arm * first), 0, 1e-12);
}

// The axes of the scene, however the beam lies in it: across x are first y, then z.
TEST(WaveRims, AxesOfTheScene) {
  KilometreArm scene;
  scene.input = "facing: [1, 0, 0]";
  scene.end = "at: [1000 m, 0 m, 0 m], facing: [-1, 0, 0]";
  scene.baffles =
      "  - {name: baffle, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [400 m, 0 m, 0 m],"
      " facing: [1, 0, 0], body: pipe, material: black}\n";
  Bench bench(scene);
  bench.waves.rims.at(0) = found({levers(first, vertical, along)}, 0);
  CouplingClass const c = bench.of("baffle");
  EXPECT_NEAR(square(c, y) / std::norm(first), 1, 1e-12);
  EXPECT_NEAR(square(c, z) / std::norm(vertical), 1, 1e-12);
  EXPECT_NEAR(square(c, x) / std::norm(along), 1, 1e-12);
}

// With tolerances the mean over their draws, without the rim as drawn in the scene; with draws of the heights over all.
// Records of one draw have its number.
TEST(WaveRims, MeanOverDraws) {
  Bench bench = solved_bench();
  bench.waves.rims[0].draws[0].responses = {levers(1), levers(first), levers(second)};
  CouplingClass const c = bench.of("baffle_one");
  EXPECT_NEAR(square(c, x) / (0.5 * std::norm(first) + 0.5 * std::norm(second)), 1, 1e-12);
  EXPECT_NEAR(weights(c) / 25e-12, 1, 0.5);
  EXPECT_THAT(c.statement, HasSubstr("one draw of the mirrors, with 2 rolls of one of them"));
  bench.waves.rims[0].draws.push_back({{levers(1), levers(along), levers(along)}, Complex{3e-6, 4e-6}});
  CouplingClass const more = bench.of("baffle_one");
  double const mean = (std::norm(first) + std::norm(second) + 2 * std::norm(along)) / 4;
  EXPECT_NEAR(square(more, x) / mean, 1, 1e-12);
  EXPECT_GT(std::fabs(square(more, x) / square(c, x) - 1), 0.1);  // negative control
  EXPECT_THAT(more.statement, HasSubstr("mean over 2 draws of the mirrors, each with 2 rolls of one of them"));
  ASSERT_EQ(more.records.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(more.records[i].history, i / 2);
}

// A rim whose static field vanishes still moves: nothing is divided by zero.
TEST(WaveRims, WithoutStaticField) {
  Bench bench = solved_bench();
  for (RimResult& rim : bench.waves.rims) rim.draws[0].clipped = 0;
  CouplingClass const c = bench.of("baffle_one");
  EXPECT_NEAR(square(c, x) / std::norm(first), 1, 1e-12);
  EXPECT_GT(c.coupling.mean, 0);
}

// Expectations over speckle: independent along the three axes; a rotation moves each patch along the beam by its
// distance from the axis of rotation.
TEST(WaveRims, ExpectationOverSpeckle) {
  Bench bench = solved_bench();
  double const field = 1e-6, across = 4e-8, longitudinal = 9e-12;
  for (RimResult& rim : bench.waves.rims) rim = {{}, {field, across, longitudinal}};
  CouplingClass const c = bench.of("baffle_one");
  EXPECT_EQ(c.kind, ClassKind::speckle);
  EXPECT_NEAR(square(c, x) / across, 1, 1e-12);
  EXPECT_NEAR(square(c, y) / across, 1, 1e-12);
  EXPECT_NEAR(square(c, z) / longitudinal, 1, 1e-12);
  EXPECT_NEAR(square(c, ry) / (400.0 * 400.0 * across + 0.045 * 0.045 * longitudinal / 2), 1, 1e-12);
  EXPECT_NEAR(weights(c) / field, 1, 1e-12);
  EXPECT_GT(std::fabs(square(c, x) / longitudinal - 1), 0.1);  // negative control: another axis
  KilometreArm near;
  near.pipe = "{pivot: [0 m, 0 m, 400 m], motion: {x: {peterson: typical}, others: still}}";
  Bench own(near);
  for (RimResult& rim : own.waves.rims) rim = {{}, {field, across, longitudinal}};
  EXPECT_NEAR(square(own.of("baffle_one"), ry) / (0.045 * 0.045 * longitudinal / 2), 1, 1e-9);
}

KilometreArm separate_mirrors() {
  KilometreArm scene;
  scene.bodies = "input: {pivot: [0 m, 0 m, 0 m], motion: still}, end: {pivot: [0 m, 0 m, 1000 m], motion: still}";
  scene.input_body = "input";
  scene.end_body = "end";
  return scene;
}

// Eq. W.26 with W.23: g = 0.6, the tilt of the end mirror moves the axis at 400 m by 1000 m (1 + 0.4 (0.6 - 1))/0.64
// times it, and its displacement does so by its tilt of 1/2500 m.
TEST(WaveRims, MirrorsMoveTheAxis) {
  Bench const bench = solved_bench(separate_mirrors());
  double const arm = 1000 * 0.84 / 0.64, other = 1000 * (0.6 + 0.4 * 0.4) / 0.64;  // by the input mirror
  CouplingClass const c = bench.of("baffle_one");
  EXPECT_NEAR(square(c, ry, end) / std::norm(arm * first), 1, 1e-9);
  EXPECT_NEAR(square(c, x, end) / std::norm(arm / 2500 * first), 1, 1e-9);
  EXPECT_NEAR(square(c, ry, input) / std::norm(other * first), 1, 1e-9);
  EXPECT_NEAR(square(bench.of("baffle_two"), rx, input) / std::norm(arm * vertical), 1, 1e-9);
  EXPECT_NEAR(square(c, z, end) / std::norm(400. * 400 / (400. * 400 + 600. * 600) * along), 1, 1e-9);
  Bench speckled = solved_bench(separate_mirrors());
  for (RimResult& rim : speckled.waves.rims) rim = {{}, {1e-6, 4e-8, 0}};
  EXPECT_NEAR(square(speckled.of("baffle_one"), ry, end) / (arm * arm * 4e-8), 1, 1e-9);
}

// Largest change of the field of a record when all bodies that move do so by `displacement` and turn by `rotation`
// about a point, over the largest change by one of them.
double left_by_common_motion(Bench const& bench, CouplingClass const& c, bool mirrors_move = true) {
  Vec3 const displacement{1e-6, -2e-6, 3e-6}, rotation{4e-9, 5e-9, -6e-9}, about{3, -2, 250};
  double worst = 0;
  for (PathRecord const& r : c.records) {
    double all = 0, size = 0;
    for (PhaseSensitivity const& s : r.phase_sensitivities) {
      if (!mirrors_move && s.body.value != pipe) continue;
      Vec3 const t = displacement + cross(rotation, bench.world.bodies()[s.body.value].pivot - about);
      double const part =
          s.d[0] * t.x + s.d[1] * t.y + s.d[2] * t.z + s.d[3] * rotation.x + s.d[4] * rotation.y + s.d[5] * rotation.z;
      all += part;
      size = std::fmax(size, std::fabs(part));
    }
    if (size > 0) worst = std::fmax(worst, std::fabs(all) / size);
  }
  return worst;
}

// Eq. W.16 holds for every record of every class.
TEST(WaveRims, CommonMotionChangesNothing) {
  KilometreArm scene = separate_mirrors();
  scene.baffles.replace(scene.baffles.find("[0 m, 0 m, 400 m]"), 17, "[3 mm, 1 mm, 400 m]");
  Bench bench = solved_bench(scene);
  RimResponse full = levers(first, vertical, along, 0.05);
  full.levers.rotation[0] = second;
  full.levers.rotation[2] = {2e-6, 1e-6};
  bench.waves.rims[0] = {{RimDraw{{full}, Complex{3e-6, 4e-6}}}, {}};
  bench.waves.rims[1] = {{}, {1e-6, 4e-8, 9e-12}};
  bench.waves.draws[0].mirrors[0].figure = {first, vertical, second};
  bench.waves.draws[0].mirrors[1].figure = {along, first, vertical};
  auto const classes = bench.classes();
  ASSERT_EQ(classes.size(), 3u);
  for (CouplingClass const& c : classes) EXPECT_LT(left_by_common_motion(bench, c), 1e-9) << c.statement;
  EXPECT_GT(left_by_common_motion(bench, bench.of("baffle_one"), false), 0.9);  // negative control
}

// Eq. W.27: the loss of the mode by the motion of its mirrors, relative to the axis, is one stray field.
TEST(WaveRims, MirrorsHaveARowOfTheirOwn) {
  Bench bench = solved_bench(separate_mirrors());
  bench.waves.rims.clear();
  bench.waves.arm.rims.clear();
  EXPECT_EQ(bench.classes().size(), 0u);  // perfect mirrors without outlines
  double const loss = 3e-4;
  bench.waves.draws[0].mirrors[1].figure[0] = Complex{loss, 5e-2};
  auto const classes = bench.classes();
  ASSERT_EQ(classes.size(), 1u);
  CouplingClass const& c = classes[0];
  EXPECT_EQ(c.kind, ClassKind::wave);
  ASSERT_EQ(c.steps.size(), 2u);
  EXPECT_EQ(bench.world.groups()[c.steps[0].group.value], "E");
  EXPECT_EQ(bench.world.groups()[c.steps[1].group.value], "I");
  // The spot on the end mirror moves by 937.5 m times its tilt, and by 1562.5 m times that of the input mirror.
  EXPECT_NEAR(square(c, ry, end) / (2 * std::pow(937.5 * loss, 2)), 1, 1e-9);
  EXPECT_NEAR(square(c, ry, input) / (2 * std::pow(1562.5 * loss, 2)), 1, 1e-9);
  EXPECT_NEAR(square(c, x, end) / (2 * std::pow((1 - 937.5 / 2500) * loss, 2)), 1, 1e-9);
  EXPECT_THAT(c.statement, HasSubstr("loss of the mode"));
}

}  // namespace
}  // namespace straytrace::testing::trace_wave_rims
