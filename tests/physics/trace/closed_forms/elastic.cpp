// SPDX-License-Identifier: BSD-3-Clause
// Elastic modes: J_m = sum over hits of kappa . psi_m(r) (docs/theory/motion.md, eq. 2.1 to 2.3).
#include <fmt/format.h>

#include <random>

#include "scene/scene.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"
#include "world/build/read_parts.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing::trace_elastic {
namespace {

constexpr double k = 2 * pi / 1.064e-6;
Vec3 const pivot{0.1, 0.2, 0.3};

// Shapes as they are written, on one body with a pivot.
World world_with(std::vector<std::string> const& shapes, FileTexts files = {}) {
  std::string text = "straytrace: 1\nbodies:\n  body:\n    modes:\n";
  for (std::size_t i = 0; i < shapes.size(); ++i)
    text += "      m" + std::to_string(i) + ": {shape: {" + shapes[i] + "}}\n";
  files["scene.yaml"] = text;
  Scene const scene = read_scene("scene.yaml", {}, &files);
  World world;
  std::uint32_t const black = black_optic(world);
  BodyId const body = world.add_body("body", pivot);
  std::vector<ElasticMode> modes;
  for (auto const& [name, node] : scene.root()["bodies"]["body"]["modes"].items())
    modes.push_back(read_elastic_mode(node["shape"]));
  scene.throw_if_problems();
  for (std::size_t i = 0; i < modes.size(); ++i) world.add_mode(body, "body/m" + std::to_string(i), modes[i]);
  world.add_surface(Disk{}, black, black, body, world.add_group("any"));
  world.add_footprint(spot({0}, {}, {0, 0, -1}, Profile::gaussian, 1e-3));
  world.finish();
  return world;
}

double mode_phase_sensitivity(World const& world, std::uint32_t mode, Vec3 point, Vec3 kappa) {
  std::vector<PhaseSensitivity> phase_sensitivities;
  add_hit(phase_sensitivities, world, {0}, point, kappa);
  return phase_sensitivities.at(1 + mode).d[0];
}
Vec3 psi(World const& world, std::uint32_t mode, Vec3 point) {
  return {mode_phase_sensitivity(world, mode, point, {1, 0, 0}), mode_phase_sensitivity(world, mode, point, {0, 1, 0}),
          mode_phase_sensitivity(world, mode, point, {0, 0, 1})};
}

// The six rigid motions written as modes have the phase sensitivities of the body, to 1e-12.
TEST(ElasticModes, RigidShapesAreTheRigidBody) {
  // r x: rotation about x is e_x cross r = (0, -z, y), and so on.
  World const world = world_with(
      {"polynomial: {x: [[1, 0, 0, 0]]}", "polynomial: {y: [[1, 0, 0, 0]]}", "polynomial: {z: [[1, 0, 0, 0]]}",
       "polynomial: {y: [[-1, 0, 0, 1]], z: [[1, 0, 1, 0]]}", "polynomial: {x: [[1, 0, 0, 1]], z: [[-1, 1, 0, 0]]}",
       "polynomial: {x: [[-1, 0, 1, 0]], y: [[1, 1, 0, 0]]}"});
  std::mt19937_64 engine{5};
  std::normal_distribution<double> normal;
  auto const any = [&] { return Vec3{normal(engine), normal(engine), normal(engine)}; };
  std::vector<PassedVertex> path(3);
  for (PassedVertex& v : path) v = {SurfaceId{0}, any(), unit(any()), unit(any())};
  std::vector<PhaseSensitivity> const phase_sensitivities = phase_sensitivities_of(world, path, 0, 0);
  ASSERT_EQ(phase_sensitivities.size(), 7u);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(phase_sensitivities[std::size_t(i) + 1].d[0], phase_sensitivities[0].d[i],
                1e-12 * std::fabs(phase_sensitivities[0].d[i]))
        << i;
  EXPECT_GT(std::fabs(phase_sensitivities[1].d[0] - phase_sensitivities[0].d[1]), 1e-3 * k);  // control: another axis
}

// cos 2 phi: the wall goes out at 0 and pi, in at pi/2; light reflected along the diameter sees 2 k per metre.
TEST(ElasticModes, TubeCrossSection) {
  World const world = world_with({"origin: [0 m, 0 m, 0 m], tube: {axis: [0, 0, 1], from: [1, 0, 0], order: 2}",
                                  "origin: [0 m, 0 m, 0 m], tube: {axis: [0, 0, 1], from: [1, 0, 0], order: 0}"});
  double const r = 0.5;
  for (double phi : {0.0, 0.3, pi / 4, pi / 2, 2.0}) {
    Vec3 const out{std::cos(phi), std::sin(phi), 0}, round{-std::sin(phi), std::cos(phi), 0},
        p = r * out + Vec3{0, 0, 7};
    // Reflection at the inner wall: kappa = k (in - out) = 2 k along the outward normal.
    EXPECT_NEAR(mode_phase_sensitivity(world, 0, p, 2 * k * out), 2 * k * std::cos(2 * phi), 1e-9 * k);
    EXPECT_NEAR(mode_phase_sensitivity(world, 1, p, 2 * k * out), 2 * k, 1e-9 * k);  // breathing
    // The wall keeps its length: radial/r + d(tangential)/(r d phi) = 0.
    double const h = 1e-4;
    Vec3 const p1 = r * Vec3{std::cos(phi - h), std::sin(phi - h), 0},
               p2 = r * Vec3{std::cos(phi + h), std::sin(phi + h), 0};
    auto const tangential = [&](Vec3 q) { return dot(psi(world, 0, q), unit(cross({0, 0, 1}, q))); };
    EXPECT_NEAR(dot(psi(world, 0, p), out) + (tangential(p2) - tangential(p1)) / (2 * h), 0, 1e-6);
    EXPECT_NEAR(dot(psi(world, 1, p), round), 0, 1e-12);
  }
}

// Nodes of the first bending mode of a free beam lie at 0.22416 and 0.77584 of its length; fixed ends stay.
TEST(ElasticModes, BendingBench) {
  std::string const beam = "along: [1, 0, 0], direction: [0, 1, 0], length: 2 m, order: 1, ends: ";
  World const world =
      world_with({"beam: {" + beam + "free}", "beam: {" + beam + "clamped}", "beam: {" + beam + "pinned}",
                  "plate: {normal: [0, 1, 0], along: [1, 0, 0], size: [2 m, 1 m], order: [1, 2]}"});
  auto const at = [&](std::uint32_t mode, double s, double across = 0) {
    return psi(world, mode, pivot + Vec3{2 * (s - 0.5), 0, across}).y;
  };
  EXPECT_NEAR(at(0, 0.22416), 0, 1e-4);
  EXPECT_NEAR(at(0, 0.77584), 0, 1e-4);
  EXPECT_NEAR(std::fabs(at(0, 0)), 1, 1e-9);
  EXPECT_NEAR(at(0, 0), at(0, 1), 1e-9);
  EXPECT_NEAR(at(0, 0.5) / at(0, 0), -0.60782, 1e-4);
  EXPECT_NEAR(at(1, 0), 0, 1e-12);
  EXPECT_NEAR(std::fabs(at(1, 1)), 1, 1e-9);
  EXPECT_NEAR(at(1, 0.5) / at(1, 1), 0.33952, 1e-4);  // textbook value of the cantilever
  EXPECT_NEAR(at(2, 0.5), 1, 1e-12);
  EXPECT_NEAR(at(3, 0.5, 0.25), -at(3, 0.5, -0.25), 1e-12);
  EXPECT_NEAR(std::fabs(at(3, 0.5, 0.25)), 1, 1e-12);
  EXPECT_NEAR(at(3, 0.5, 0), 0, 1e-12);
}

// A table of points gives a field that is linear in the place back, on a body and on a flat bench.
TEST(ElasticModes, TableOfPoints) {
  std::mt19937_64 engine{6};
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::string rows = "# x y z\n", bent;
  auto const turn = [](Vec3 r) { return cross({0.3, -0.2, 0.9}, r) + Vec3{1, 2, 3}; };
  for (int i = 0; i < 200; ++i) {
    Vec3 const r{uniform(engine), uniform(engine), uniform(engine)}, v = turn(r), flat{r.x, 0, r.z};
    rows += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", 1e3 * r.x, 1e3 * r.y, 1e3 * r.z, v.x, v.y,
                        v.z);
    bent += fmt::format("{:.17g}, 0, {:.17g}, 0, {:.17g}, 0\n", flat.x, flat.z, flat.x * flat.x);
  }
  World const world = world_with({"points: solid.txt, unit: mm", "points: bench.csv, unit: m"},
                                 {{"solid.txt", rows}, {"bench.csv", bent}});
  for (int i = 0; i < 20; ++i) {
    Vec3 const r{0.7 * uniform(engine), 0.7 * uniform(engine), 0.7 * uniform(engine)};
    EXPECT_LT(length(psi(world, 0, pivot + r) - turn(r)), 1e-9);
    EXPECT_NEAR(psi(world, 1, pivot + Vec3{r.x, 0, r.z}).y, r.x * r.x, 0.08);  // 12 of 50 per m^2 lie within 0.28 m
  }
}

TEST(ElasticModes, InvalidShapesAreErrors) {
  auto const problem = [](std::string const& shape, FileTexts files = {}) -> std::string {
    try {
      world_with({shape}, std::move(files));
    } catch (InputError const& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_NE(problem("").find("a mode has one shape"), std::string::npos);
  EXPECT_NE(problem("tube: {axis: [0, 0, 1], from: [0, 0, 2]}").find("parallel to the axis"), std::string::npos);
  EXPECT_NE(problem("beam: {along: [1, 0, 0], direction: [0, 1, 0], length: 2}").find("without a unit"),
            std::string::npos);
  EXPECT_NE(problem("polynomial: {x: [[1, 0, 0.5, 0]]}").find("whole numbers"), std::string::npos);
  EXPECT_NE(problem("points: p.txt, unit: m", {{"p.txt", "1 2 3\n"}})
                .find("p.txt:1:1: error: this line has 3 numbers, not 6"),
            std::string::npos);
  EXPECT_NE(problem("plaet: {}").find("plate"), std::string::npos);
}

}  // namespace
}  // namespace straytrace::testing::trace_elastic
