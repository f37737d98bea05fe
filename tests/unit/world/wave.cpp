// SPDX-License-Identifier: BSD-3-Clause
// The table `wave`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/message_of.hpp"
#include "unit/world/built_scene.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Beam 0 is a spot, beam 1 the cavity of E and I, in this order.
constexpr char cavity_arm[] =
    "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 1 ppm}}, black: {}}\n"
    "bodies: {b: {motion: still}}\nscene:\n"
    "  - {name: I, use: mirror, radius: 17 cm, radius_of_curvature: 1420 m, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],"
    " body: b, material: m}\n"
    "  - {name: E, use: mirror, radius: 17 cm, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3000 m], facing: [0, 0, -1],"
    " body: b, material: m}\n"
    "  - {name: ring_one, shape: {disk: {inner_radius: 15 cm, outer_radius: 50 cm}}, at: [3 mm, 4 mm, 1000 m],"
    " facing: [0, 0, 1], body: b, material: black}\n"
    "  - {name: ring_two, shape: {cone: {inner_radius: 40 cm, outer_radius: 50 cm, half_angle: 45 deg}},"
    " at: [0 m, 0 m, 2000 m], facing: [0, 0, 1], body: b, material: black}\n"
    "  - {name: wall, shape: {cylinder: {radius: 60 cm, from: 1 m, to: 2999 m}}, body: b, material: m}\n"
    "beams: {lamp: {on: wall, radius: 1 cm, travel: [1, 0, 0], centre: [60 cm, 0 m, 5 m]}, arm: {cavity: [E, I]}}\n"
    "ports: {I: {beam: arm, at: I}, E: {beam: arm, at: E}}\n";

World wave_world(std::string const& more, std::string const& arm = cavity_arm) {
  return testing::built({{"a.yaml", arm + more}, {"maps/i.h5", "heights"}, {"empty.h5", ""}}).world;
}
std::string wave_problem(std::string const& more, std::string const& arm = cavity_arm) {
  return test::message_of([&] { wave_world(more, arm); });
}
std::string with_map(std::string const& map) { return wave_problem("wave: {beam: arm, maps: {I: " + map + "}}\n"); }

TEST(ReadWave, ReadsTheKeys) {
  World const w = wave_world(
      "wave:\n  beam: arm\n  crossover: 100 urad\n  baffles: [\"ring*\", ring_two]\n"
      "  grid: {points: 1000, window: 2 m}\n"
      "  maps: {I: {file: maps/i.h5, remove: [tilt, curvature]}, E: {spectrum: material, seed: 7}}\n"
      "  tolerance: {radius: 1 mm, centre: 2 mm, place: 5 mm}\n  draws: 5\n  map_draws: 3\n");
  WaveSettings const& wave = w.wave;
  EXPECT_TRUE(wave.present);
  EXPECT_EQ(wave.beam, 1u);
  EXPECT_EQ(wave.beam_name, "arm");
  EXPECT_EQ(w.name_of(wave.mirrors[0].surface), "E");  // in the order of the cavity, not of the scene
  EXPECT_EQ(w.name_of(wave.mirrors[1].surface), "I");
  EXPECT_DOUBLE_EQ(wave.crossover.value(), 1e-4);
  EXPECT_EQ(wave.groups, (std::vector<std::string>{"ring_one", "ring_two"}));
  EXPECT_EQ(wave.points, 1000u);
  EXPECT_EQ(wave.window, 2);
  EXPECT_EQ(wave.mirrors[0].heights, WaveSettings::Heights::material);
  EXPECT_EQ(wave.mirrors[0].seed, 7u);
  EXPECT_EQ(wave.mirrors[0].removed, (WaveSettings::Removed{true, true, false, false}));
  EXPECT_EQ(wave.mirrors[1].heights, WaveSettings::Heights::file);
  EXPECT_EQ(wave.mirrors[1].file, "maps/i.h5");
  EXPECT_EQ(wave.mirrors[1].bytes, "heights");
  EXPECT_EQ(wave.mirrors[1].removed, (WaveSettings::Removed{false, true, true, false}));
  EXPECT_EQ(wave.tolerance.radius, 1e-3);
  EXPECT_EQ(wave.tolerance.centre, 2e-3);
  EXPECT_EQ(wave.tolerance.place, 5e-3);
  EXPECT_EQ(wave.draws, 5u);
  EXPECT_EQ(wave.map_draws, 3u);
  // Surfaces, materials and modes are the same; the table is in the hash of the model.
  EXPECT_EQ(w.fingerprint(), wave_world("").fingerprint());
}

TEST(ReadWave, Defaults) {
  EXPECT_FALSE(wave_world("").wave.present);
  WaveSettings const wave = wave_world("wave: {beam: arm}\n").wave;
  EXPECT_TRUE(wave.present && wave.groups.empty() && !wave.crossover && !wave.tolerance.any());
  EXPECT_EQ(wave.points, 0u);
  EXPECT_EQ(wave.window, 0);
  EXPECT_EQ(wave.draws, 32u);  // of the roll of a random mirror
  EXPECT_EQ(wave.map_draws, 1u);
  for (WaveSettings::Mirror const& m : wave.mirrors) {
    EXPECT_EQ(m.heights, WaveSettings::Heights::material);
    EXPECT_EQ(m.seed, 1u);
  }
  std::string const ring = "wave: {beam: arm, baffles: ring_one, tolerance: {radius: ";
  EXPECT_EQ(wave_world(ring + "1 mm}}\n").wave.draws, 32u);
  std::string const perfect = "maps: {I: {spectrum: none}, E: {spectrum: none}}";
  EXPECT_EQ(wave_world(ring + "1 mm}, " + perfect + "}\n").wave.draws, 32u);
  EXPECT_EQ(wave_world(ring + "0 mm}, " + perfect + "}\n").wave.draws, 1u);
  EXPECT_EQ(wave_world("wave: {beam: arm, maps: {I: {spectrum: none}}}\n").wave.mirrors[1].heights,
            WaveSettings::Heights::none);
  EXPECT_EQ(wave_world("wave: {beam: arm, maps: {I: {remove: []}}}\n").wave.mirrors[1].removed,
            (WaveSettings::Removed{false, false, false, false}));
}

// The run file contains the map, so that the run can be repeated from it.
TEST(ReadWave, KeepsTheFileOfAMap) {
  FileTexts const texts{{"a.yaml", cavity_arm + std::string("wave: {beam: arm, maps: {I: {file: maps/i.h5}}}\n")},
                        {"maps/i.h5", "heights"}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  build_world(scene);
  EXPECT_EQ(scene.files().at("maps/i.h5"), "heights");
}

TEST(ReadWave, AWrongBeamIsExplained) {
  EXPECT_THAT(wave_problem("wave: {crossover: 1 mrad}\n"), HasSubstr("key 'beam' (text) is missing in 'wave'"));
  EXPECT_THAT(wave_problem("wave: {beam: amr}\n"),
              AllOf(HasSubstr("beam 'amr' is not defined"), HasSubstr("did you mean 'arm'?")));
  EXPECT_THAT(wave_problem("wave: {beam: lamp}\n"),
              AllOf(HasSubstr("beam 'lamp' is not the mode of a cavity"), HasSubstr("beams that are cavities: arm")));
  // The error of a cavity is the only one, but for keys that are wrong with any cavity.
  std::string broken = cavity_arm;
  broken.replace(broken.find("[E, I]"), 6, "[F, I]");
  EXPECT_THAT(wave_problem("wave: {beam: arm, maps: {I: {seed: 2}}}\n", broken),
              AllOf(HasSubstr("'F' is not a surface"), Not(HasSubstr("mirror of the cavity 'arm'"))));
  EXPECT_THAT(wave_problem("wave: {beam: arm, maps: {ring_one: {seed: 2}}}\n", broken),
              AllOf(HasSubstr("'F' is not a surface"), HasSubstr("'ring_one' is not a mirror of the cavity 'arm'")));
}

TEST(ReadWave, WrongBafflesAreExplained) {
  EXPECT_THAT(wave_problem("wave: {beam: arm, baffles: wall}\n"),
              AllOf(HasSubstr("'wall' has no inner edge"), HasSubstr("ring_one, ring_two")));
  EXPECT_THAT(wave_problem("wave: {beam: arm, baffles: ring_ome}\n"), HasSubstr("did you mean 'ring_one'?"));
  std::string const edges = "edges: {surfaces: ring_one}\n";
  EXPECT_THAT(wave_problem(edges + "wave: {beam: arm, baffles: \"ring*\"}\n"),
              AllOf(HasSubstr("'wave' and 'edges' count the same light twice, at the inner edges of ring_one"),
                    HasSubstr("remove 'edges'")));
  EXPECT_EQ(wave_problem(edges + "wave: {beam: arm, baffles: ring_two}\n"), "no error");  // control
}

TEST(ReadWave, WrongNumbersAreExplained) {
  auto const with_points = [](std::string const& points) {
    return wave_problem("wave: {beam: arm, grid: {points: " + points + "}}\n");
  };
  EXPECT_THAT(with_points("1022"), AllOf(HasSubstr("'points' must be even"), HasSubstr("write 1000 or 1024")));
  EXPECT_THAT(with_points("75"), AllOf(HasSubstr("'points' must be even"), HasSubstr("write 72 or 80")));
  EXPECT_THAT(with_points("62"), HasSubstr("'points' must be between 64 and 8192"));
  EXPECT_THAT(with_points("8194"), HasSubstr("'points' must be between 64 and 8192"));
  for (char const* const points : {"64", "90", "8192"}) EXPECT_EQ(with_points(points), "no error") << points;
  EXPECT_THAT(wave_problem("wave: {beam: arm, grid: {window: -1 m}}\n"), HasSubstr("'window' must be between"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, grid: {widow: 1 m}}\n"), HasSubstr("did you mean 'window'?"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, crossover: 1 m}\n"), HasSubstr("'crossover' is an angle"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, crossover: 0}\n"), HasSubstr("'crossover' must be between"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, crossovr: 1 mrad}\n"), HasSubstr("did you mean 'crossover'?"));
  std::string const ring = "wave: {beam: arm, baffles: ring_one, tolerance: ";
  EXPECT_THAT(wave_problem(ring + "{radius: -1 mm}}\n"), HasSubstr("'radius' must be between 0 and"));
  EXPECT_THAT(wave_problem(ring + "{radus: 1 mm}}\n"), HasSubstr("did you mean 'radius'?"));
  EXPECT_THAT(wave_problem(ring + "{radius: 1 mm}, draws: 0}\n"), HasSubstr("'draws' must be between 1 and"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, tolerance: {radius: 1 mm}}\n"),
              HasSubstr("'tolerance' without 'baffles'"));
  EXPECT_THAT(wave_problem("wave: {beam: arm, draws: 8, maps: {I: {spectrum: none}, E: {spectrum: none}}}\n"),
              HasSubstr("'draws' with mirrors of known heights and without 'tolerance'"));
  EXPECT_EQ(wave_problem("wave: {beam: arm, draws: 8}\n"), "no error");  // the roll of a mirror is drawn
  EXPECT_THAT(wave_problem("wave: {beam: arm, map_draws: 0}\n"), HasSubstr("'map_draws' must be between 1 and"));
  std::string const perfect = "wave: {beam: arm, map_draws: 2, maps: {E: {spectrum: none}, I: {spectrum: ";
  EXPECT_THAT(wave_problem(perfect + "none}}}\n"), HasSubstr("'map_draws' with perfect mirrors"));
  EXPECT_EQ(wave_problem(perfect + "material}}}\n"), "no error");  // control
}

TEST(ReadWave, WrongMapsAreExplained) {
  EXPECT_THAT(wave_problem("wave: {beam: arm, maps: {ring_one: {seed: 2}}}\n"),
              AllOf(HasSubstr("a.yaml:12:26: error: 'ring_one' is not a mirror of the cavity 'arm'"),
                    HasSubstr("its mirrors: E, I")));
  EXPECT_THAT(with_map("none"), HasSubstr("the map of 'I' is not a table"));
  EXPECT_THAT(with_map("{file: maps/i.h5, seed: 2}"), HasSubstr("'seed' is for random heights"));
  EXPECT_THAT(with_map("{file: maps/i.h5, spectrum: material}"), HasSubstr("'file' and 'spectrum' both"));
  EXPECT_THAT(with_map("{file: maps/j.h5}"), HasSubstr("cannot read file 'maps/j.h5'"));
  EXPECT_THAT(with_map("{file: empty.h5}"), HasSubstr("file 'empty.h5' is empty"));
  EXPECT_THAT(with_map("{spectrum: nine}"), HasSubstr("did you mean 'none'?"));
  EXPECT_THAT(with_map("{spectrum: none, seed: 2}"), HasSubstr("'seed' has no effect on a perfect mirror"));
  EXPECT_THAT(with_map("{spectrum: none, remove: tilt}"), HasSubstr("'remove' has no effect on a perfect mirror"));
  EXPECT_THAT(with_map("{remove: [piston, tlit]}"),
              AllOf(HasSubstr("'tlit' cannot be removed from a map"), HasSubstr("did you mean 'tilt'?")));
  EXPECT_THAT(with_map("{seeds: 2}"), HasSubstr("did you mean 'seed'?"));
  EXPECT_EQ(with_map("{file: maps/i.h5, remove: tilt}"), "no error");
}

TEST(ReadWave, ReportsAllProblemsAtOnce) {
  EXPECT_THAT(wave_problem("wave: {beam: amr, crossover: 1 m, baffles: wall, grid: {points: 70}, draws: 0,"
                           " maps: {I: {seed: -1}}, colour: red}\n"),
              AllOf(HasSubstr("'amr'"), HasSubstr("'crossover'"), HasSubstr("'wall'"), HasSubstr("'points'"),
                    HasSubstr("'draws'"), HasSubstr("'seed'"), HasSubstr("'colour'"), HasSubstr("7 errors.")));
}

TEST(ReadWave, MirrorsAndInput) {
  WaveSettings const wave =
      wave_world(
          "wave:\n  beam: arm\n"
          "  mirrors: {I: {tilt: [0.1 urad, -2 urad], shift: [1 mm, 0 mm], transmission: 1.4 %,"
          " loss: 30 ppm}}\n"
          "  input: {wavefront_curvature: -0.5 /km, tilt: [1 urad, 2 urad], shift: [0 m, 3 mm]}\n")
          .wave;
  WaveSettings::Mirror const &other = wave.mirrors[0], &input = wave.mirrors[1];  // in the order of the cavity
  EXPECT_FALSE(other.misaligned() || other.transmission);
  EXPECT_TRUE(input.misaligned());
  EXPECT_DOUBLE_EQ(input.tilt[0], 1e-7);
  EXPECT_DOUBLE_EQ(input.tilt[1], -2e-6);
  EXPECT_EQ(input.shift, (std::array<double, 2>{1e-3, 0}));
  EXPECT_DOUBLE_EQ(input.transmission.value(), 0.014);
  EXPECT_DOUBLE_EQ(input.loss, 30e-6);
  ASSERT_TRUE(wave.input);
  EXPECT_FALSE(wave.input->radius);
  EXPECT_DOUBLE_EQ(wave.input->wavefront_curvature.value(), -5e-4);
  EXPECT_DOUBLE_EQ(wave.input->tilt[1], 2e-6);
  EXPECT_DOUBLE_EQ(wave.input->shift[1], 3e-3);
  EXPECT_FALSE(wave_world("wave: {beam: arm}\n").wave.input);
}

TEST(ReadWave, WrongMirrorsAndInputs) {
  auto const with = [](std::string const& more) { return wave_problem("wave: {beam: arm, " + more + "}\n"); };
  EXPECT_EQ(with("mirrors: {I: {tilt: [1 urad, 0 rad]}}"), "no error");  // control
  EXPECT_THAT(with("mirrors: {I: {tilt: [1 urad, 2 mrad]}}"), HasSubstr("at most 0.001 rad"));
  EXPECT_THAT(with("mirrors: {I: {shift: 1 mm}}"), HasSubstr("shift"));
  EXPECT_THAT(with("mirrors: {I: {transmission: 90 %, loss: 20 %}}"), HasSubstr("holds no light"));
  EXPECT_THAT(with("mirrors: {X: {tilt: [1 urad, 0 rad]}}"), HasSubstr("'X' is not a mirror of the cavity"));
  EXPECT_THAT(with("mirrors: {I: 1 urad}"), HasSubstr("is not a table"));
  EXPECT_THAT(with("mirrors: {I: {tlit: [1 urad, 0 rad]}}"), HasSubstr("tilt"));
  EXPECT_THAT(with("input: {radius: 1 um, waist: 3 mm}"), HasSubstr("waist"));
}

}  // namespace
}  // namespace straytrace::testing
