// SPDX-License-Identifier: BSD-3-Clause
// The key `lit`: benches fed through mirrors, and beams that are followed (docs/theory/interferometer.md, eq. 9.3;
// cases R2.33, B4).
#include <algorithm>
#include <complex>

#include "beams/cavity_mode.hpp"
#include "scene/scene.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::testing::trace_lit_scenes {
namespace {

constexpr double lambda = 1.064e-6;

World world_of(std::string const& text) {
  FileTexts const texts{{"a.yaml", "straytrace: 1\n" + text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}
// Footprint on a surface, the first of several.
Footprint const* spot_on(World const& world, std::string const& group) {
  for (Footprint const& f : world.footprints())
    if (!f.free && world.groups()[world.surfaces()[f.surface.value].group.value] == group) return &f;
  return nullptr;
}

// An arm of 3 km whose end mirror transmits 4.4 ppm through 20 cm of glass, and a diffuse plate 1 m behind it.
std::string arm(std::string const& more = "", std::string const& lit = "yes") {
  return "materials:\n"
         "  hr: {specular: {reflect: 0.9999956, transmit: 4.4e-6}}\n"
         "  ar: {specular: {transmit: 1}}\n"
         "  white: {scatter: {model: lambertian, brdf: 1e-5 /sr}}\n"
         "  black: {}\n"
         "media: {glass: {index: 1.45}}\n"
         "bodies: {ITM: {motion: still}, ETM: {motion: still}, bench: {motion: still}}\n"
         "scene:\n"
         "  - {name: ITM, use: mirror, radius_of_curvature: 1420 m, facing: [0, 0, 1], body: ITM, material: hr}\n"
         "  - {name: ETM, use: thick_mirror, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3 km], facing: [0, 0, -1],\n"
         "     medium: glass, body: ETM, material: hr, surfaces: {back: ar, barrel: black}}\n"
         "  - {name: plate, shape: {disk: {outer_radius: 50 cm}}, at: [0 m, 0 m, 3001.2 m], facing: [0, 0, -1],\n"
         "     body: bench, material: white}\n"
         "beams: {arm: {cavity: [ITM, ETM/front], lit: " +
         lit + "}}\nports: {bench: {beam: arm, at: plate}}\n" + more;
}
// Radius on the plate by eq. 6.2 (ABCD), not by the modes in space.
double radius_on_the_plate() {
  CavityMode const mode = cavity_mode(3000, 1420, 1683, lambda);
  std::complex<double> q{3000 - mode.waist_position, mode.rayleigh};  // eq. 6.2
  q = 1.45 / (1.0 / q + 0.45 / 1683) + 0.2;                           // face, 20 cm of glass
  q = q / 1.45 + 1.0;                                                 // flat face, 1 m
  return std::sqrt(-lambda / (pi * std::imag(1.0 / q)));
}

// eq. 9.3: f_r = T_E^2 f_sc, f_sc = beta lambda^2/(pi w^2). Controls: the mirror passed once only, the spot of the
// mirror.
TEST(LitScenes, BenchBehindTheEndMirrorEq9_3) {
  World const world = world_of(arm());
  double const w = radius_on_the_plate(), transmission = 4.4e-6, f_sc = 1e-5 * lambda * lambda / (pi * w * w);
  Footprint const* plate = spot_on(world, "plate");
  ASSERT_NE(plate, nullptr);
  EXPECT_NEAR(plate->share / transmission, 1, 1e-7);  // 2.5e-8 miss the faces of the mirror
  EXPECT_NEAR(plate->profile == Profile::gaussian ? plate->radius : 0, w, 1e-6 * w);
  SampleMean const s = total_coupling(run_histories(world, 1 << 20));
  double const expected = transmission * transmission * f_sc;
  expect_mean("T_E^2 f_sc", s, expected, 2e-2 * expected);
  expect_rejected("T_E f_sc", s, transmission * f_sc);
  double const on_mirror = spot_on(world, "ETM/front")->radius;
  EXPECT_GT(std::fabs(w / on_mirror - 1), 1e-4);  // the two spots differ, and the check of w sees it
}

// Relative to the mode of the arm, which bounces on the end mirror: +2k on the bench and -2k on that mirror, whose
// glass is passed straight (eq. 2.5); nothing on the input mirror. Control: the reflection is not subtracted.
TEST(LitScenes, BenchAndEndMirrorMoveAgainstEachOther) {
  double const k = 2 * pi / lambda;
  World const world = world_of(arm());
  TraceResult const r = run_histories(world, 1 << 12);
  CouplingClass const* back = find_route(r, "plate·S");
  ASSERT_NE(back, nullptr);
  for (PathRecord const& p : back->records) {
    double along[3] = {};  // bodies in the order of the scene
    for (PhaseSensitivity const& l : p.phase_sensitivities) along[l.body.value] = l.d[2];
    EXPECT_NEAR(along[0], 0, 1e-9 * k);
    EXPECT_NEAR(along[1], -2 * k, 1e-6 * k);
    EXPECT_NEAR(along[2], 2 * k, 1e-6 * k);
    EXPECT_NEAR(p.path_length, 2 * (0.2 * 1.45 + 1), 1e-4);
  }
  Footprint const& plate = *spot_on(world, "plate");
  auto const index = std::uint32_t(&plate - world.footprints().data());
  std::vector<PassedVertex> const one{{plate.surface, plate.centre, plate.travel, -plate.travel, Event::couple}};
  World loose = world;
  Feed bare = world.feeds()[index];
  bare.mirror = Feed::none;
  loose.add_footprint(plate, bare);
  auto const last = std::uint32_t(loose.footprints().size() - 1);
  for (PhaseSensitivity const& l : phase_sensitivities_of(loose, one, last, last))
    if (l.body.value == 1) {
      EXPECT_NEAR(l.d[2], 0, 1e-6 * k);
    }
}

// The same as a spot that is stated, to rounding.
TEST(LitScenes, StatedSpotIsTheSame) {
  World const lit = world_of(arm());
  std::string text = arm();
  std::string const beams = text.substr(text.find("beams:"));
  text.erase(text.find("beams:"));
  World const stated =
      world_of(text + "beams: {arm: {on: plate, radius: " + std::to_string(1e9 * radius_on_the_plate()) +
               " nm, travel: [0, 0, 1], share: 4.4e-6}}\nports: {bench: {beam: arm, at: plate}}\n");
  double const a = total_coupling(run_histories(lit, 1 << 14)).mean,
               b = total_coupling(run_histories(stated, 1 << 14)).mean;
  EXPECT_NEAR(a / b, 1, 2e-2);  // other strata: the lit scene has four sources
}

// R2.33: beta = 1e-5, w = 1 mm gives 3.604e-12, w = 58 mm 1.071e-15 (eq. 1.4); a flat mirror of a plano-concave cavity
// has w^2 = lambda/pi sqrt(L (R - L)). B4: two benches whose scatter differs by 6 differ by sqrt(6) in G.
double fraction(double beta, double w = 1e-3) {
  double const length = 2000 * w, transmission = 1e-3, reach = pi * w * w / lambda,
               roc = length + reach * reach / length;
  std::string const scene =
      "materials:\n  hr: {specular: {reflect: 0.999, transmit: 0.001}}\n"
      "  white: {scatter: {model: lambertian, brdf: " +
      std::to_string(1e6 * beta) + "e-6 /sr}}\nparams: {w: " + std::to_string(1e3 * w) +
      " mm, roc: " + std::to_string(roc) +
      " m}\nbodies: {b: {motion: still}}\nscene:\n"
      "  - {name: one, use: mirror, radius: 20*w, facing: [0, 0, 1], body: b, material: hr}\n"
      "  - {name: two, use: mirror, radius: 20*w, radius_of_curvature: roc, at: [0 m, 0 m, 2000*w],\n"
      "     facing: [0, 0, -1], body: b, material: hr}\n"
      "  - {name: plate, shape: {disk: {outer_radius: 50*w}}, at: [0 m, 0 m, -w], facing: [0, 0, 1], body: b,\n"
      "     material: white}\n"
      "beams: {c: {cavity: [one, two], lit: yes}}\nports: {bench: {beam: c, at: plate}}\n";
  return total_coupling(run_histories(world_of(scene), 1 << 17)).mean / (transmission * transmission);
}
TEST(LitScenes, ScatterFractionR2_33) {
  double const f = fraction(1e-5);
  EXPECT_NEAR(f / 3.604e-12, 1, 5e-3);
  EXPECT_GT(std::fabs(4 * f / 3.604e-12 - 1), 0.5);  // control: w read as a diameter
  EXPECT_NEAR(fraction(1e-5, 58e-3) / 1.071e-15, 1, 5e-3);
  EXPECT_NEAR(std::sqrt(fraction(6e-5) / f), std::sqrt(6.0), 1e-2);
}

std::string const bench =
    "materials:\n"
    "  mirror: {specular: {reflect: 0.99}, scatter: {model: lambertian, brdf: 1e-4 /sr}}\n"
    "  glass: {specular: fresnel, scatter: {model: lambertian, brdf: 1e-4 /sr}}\n"
    "  white: {scatter: {model: lambertian, brdf: 1e-2 /sr}}\n"
    "media: {silica: {index: 1.45}}\n"
    "bodies: {b: {motion: still}}\n"
    "scene:\n"
    "  - {name: fold, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [1, 0, -1], body: b,\n"
    "     material: mirror}\n"
    "  - {name: plate, use: plate, radius: 3 cm, thickness: 1 cm, medium: silica, at: [30 cm, 0 m, 1 m],\n"
    "     rotate: {axis: [0, 1, 0], angle: -70 deg}, body: b, material: glass}\n"
    "  - {name: dump, shape: {disk: {outer_radius: 5 cm}}, at: [1 m, 0 m, 1 m], facing: [-1, 0, 0], body: b,\n"
    "     material: white}\n"
    "  - {name: catcher, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 125 cm], facing: [766, 0, -643],\n"
    "     body: b, material: white}\n";
std::string laser(std::string const& lit, std::string const& end = "ports: {all: {beam: laser}}\n") {
  return "beams: {laser: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], waist: {radius: 1 mm, ahead: 50 cm}, lit: " + lit +
         "}}\n" + end;
}

// A beam that is followed: every surface it meets has its mode, in glass too; it is not traced as rays in addition.
TEST(LitScenes, FollowedBeamLightsTheSurfacesItMeets) {
  World const world = world_of(bench + laser("yes"));
  std::vector<LitRow> const rows = lit_rows(world);
  ASSERT_EQ(rows.size(), 4u);  // fold, two faces of the plate, dump
  Footprint const &fold = *spot_on(world, "fold"), &back = *spot_on(world, "plate/back"),
                  &dump = *spot_on(world, "dump");
  EXPECT_NEAR(fold.share, 1, 1e-12);
  double const rayleigh = pi * 1e-6 / lambda;
  EXPECT_NEAR(fold.radius, 1e-3 * std::hypot(1, 0.5 / rayleigh), 1e-9);
  EXPECT_NEAR(rows[0].incidence, pi / 4, 1e-9);
  EXPECT_LT(dump.share, 0.99 * 0.94);
  EXPECT_GT(dump.share, 0.99 * 0.90);
  bool const inside = std::fabs(back.index - 1.45) < 1e-12;
  EXPECT_TRUE(inside || std::fabs(spot_on(world, "plate/front")->index - 1.45) < 1e-12);
  TraceResult const r = run_histories(world, 1 << 12);
  double albedo = 0;  // of every spot once: nothing else is emitted
  for (std::size_t i = 0; i < world.footprints().size(); ++i)
    if (world.footprints()[i].emits) {
      Footprint const& f = world.footprints()[i];
      albedo += f.share * (f.surface == dump.surface ? 1e-2 : 1e-4) * pi;
    }
  EXPECT_NEAR(r.total.emitted.sum / double(r.total.histories) / albedo, 1, 1e-9);
  for (CouplingClass const& c : r.coupling.classes)
    EXPECT_EQ(route_name(r.coupling, c).find("laser"), std::string::npos);
}

// Ghosts: weaker spots of the same beam, to the requested order; `only` and `except` choose surfaces.
TEST(LitScenes, OrderAndNames) {
  auto const spots = [](std::string const& lit) {
    return lit_rows(world_of(bench + laser(lit, "receivers: {D: {on: dump}}\n"))).size();
  };
  EXPECT_EQ(spots("yes"), 4u);
  EXPECT_GT(spots("{order: 1}"), 4u);
  EXPECT_GT(spots("{order: 2}"), spots("{order: 1}"));
  EXPECT_EQ(spots("{only: [\"plate/*\"]}"), 2u);
  EXPECT_EQ(spots("{except: [dump, fold]}"), 2u);
  EXPECT_EQ(spots("{floor: 0.99, only: [dump]}"), 0u);
}

// A ghost spot receives with the share it emits with: from the main spot on the dump to the ghost's on the catcher and
// back light couples alike (eq. 1.2).
TEST(LitScenes, GhostsReceiveByReciprocity) {
  World const world = world_of(bench + laser("{order: 1}"));
  Footprint const main = *spot_on(world, "dump"), ghost = *spot_on(world, "catcher");
  EXPECT_GT(ghost.share, 1e-3);  // reflected by the front of the plate
  EXPECT_LT(ghost.share, 0.05);
  auto const coupling = [&](Footprint from, Footprint to, double received = 1) {
    World alone = world_of(bench + laser("{only: [plate/barrel]}", "receivers: {D: {on: dump}}\n"));
    from.receives = to.emits = false;
    to.share *= received;
    alone.add_footprint(from);
    alone.add_footprint(to);
    alone.open_port("end", {std::uint32_t(alone.footprints().size() - 1)});
    alone.limits.max_order = 1;
    alone.finish();
    return total_coupling(run_histories(alone, 1 << 17));
  };
  SampleMean const there = coupling(main, ghost), back = coupling(ghost, main);
  ASSERT_GT(there.mean, 0);
  EXPECT_NEAR(back.mean / there.mean, 1,
              5 * std::hypot(there.std_error / there.mean, back.std_error / back.mean) + 2e-3);
  EXPECT_GT(std::fabs(coupling(ghost, main, 0.5).mean / there.mean - 1),
            0.3);  // control: another share to receive with
}

}  // namespace
}  // namespace straytrace::testing::trace_lit_scenes
