// SPDX-License-Identifier: BSD-3-Clause
// straytrace wave, and a run of a scene with a table `wave` (docs/theory/wave.md).
#include "cli/wave/wave_output.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "results/results.hpp"
#include "scenes/answers.hpp"
#include "session/light/cavity_waves.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::app_wave {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

// The grid holds the light that meets one of the two edges.
std::string scene_text(std::string const& grid = "{points: 256, window: 0.5 m}") {
  KilometreArm arm;
  arm.baffles =
      "  - {name: baffle_near, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [0 m, 0 m, 300 m],"
      " facing: [0, 0, 1], body: pipe, material: dark}\n"
      "  - {name: baffle_mid, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [0 m, 0 m, 500 m],"
      " facing: [0, 0, 1], body: pipe, material: dark}\n"
      "  - {name: wall, shape: {cylinder: {radius: 30 cm, from: 0 m, to: 1000 m}}, body: pipe, material: dark}\n";
  arm.wave = "wave: {beam: arm, baffles: \"baffle*\", crossover: 120 urad, grid: " + grid + "}\n";
  return edited(arm.text(), "  black: {}\n", "  dark: {scatter: {model: lambertian, tis: 10 %}}\n") +
         "interferometer: {preset: fabry-perot-michelson, arm_length: 1 km, mirror_mass: 42 kg,"
         " input_transmission: 1.4 %}\n"
         "noise: {band: [10 Hz, 100 Hz], points_per_decade: 5}\n";
}

class WaveCommand : public ::testing::Test {
 protected:
  WaveCommand() { write_text(scene_, scene_text()); }
  Folder const folder_;
  std::string const scene_ = folder_ / "arm.yaml";
};

// With a GPU the losses of the CPU to 1e-9 of themselves, otherwise a reason and a remedy.
TEST_F(WaveCommand, FieldsOnCudaAgreeOrGiveAReason) {
  auto const solved = [&](std::string const& backend) {
    return straytrace({"wave", scene_, "--quiet", "--backend", backend, "-o", folder_ / backend + ".h5", "--force"});
  };
  auto const record = [&](std::string const& backend) { return *read_run(folder_ / backend + ".h5").about.waves; };
  Finished const cuda = solved("cuda"), unknown = solved("mpi"), cpu = solved("cpu");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("fields cannot be computed on 'mpi'"));
  ASSERT_EQ(cpu.code, 0) << cpu.err;
  EXPECT_EQ(record("cpu").device, "cpu");
  if (cuda.code == 0) {
    EXPECT_NEAR(record("cuda").loss(), record("cpu").loss(), 1e-9 * record("cpu").loss());
    EXPECT_NE(record("cuda").device, "cpu");
    return;
  }
  EXPECT_EQ(cuda.code, 2);
  EXPECT_THAT(cuda.err, AnyOf(HasSubstr("no GPU"), HasSubstr("built without cuFFT")));
  EXPECT_THAT(cuda.err, HasSubstr("--backend cpu"));
  EXPECT_FALSE(fs::exists(folder_ / "cuda.h5"));
}

TEST_F(WaveCommand, PrintsItsParts) {
  Finished const all = straytrace({"wave", scene_, "--quiet"});
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(all.err, "");
  for (char const* const part :
       {"cavity arm: 1000 m, grid of 256 x 256 points over 0.5 m, which carries angles up to 272.4 urad",
        "crossover angle 120 urad: 1 of 2 inner edges are within it, seen from both mirrors",
        "mirror I: radius of the mode 20.58 mm; heights below the crossover angle ", "loss per round trip",
        "past the rim of I, and scattered", "past the rim of E, and scattered", "on baffles, towards E",
        "on baffles, towards I", "at angles that reach no opening", "smooth mirrors without baffles lose ",
        "Modes of the mirrors without baffles", "HG00  1.0000", "per displacement of an inner edge (eq. W.14)",
        "Light on baffles in W", "not checked; --grid-check solves again", "residual ", "one draw; 'map_draws'",
        "scatter of second order"})
    EXPECT_THAT(all.out, HasSubstr(part));
  EXPECT_THAT(all.out, ContainsRegex("\nbaffle_mid +500 +90 +90 +wave +[0-9]"));
  EXPECT_THAT(all.out, ContainsRegex("\nbaffle_near +300 +150 +64.3 +speckle +- +- +- +- +[0-9]"));
  EXPECT_THAT(all.out, Not(HasSubstr("more rows")));
  EXPECT_THAT(all.out, HasSubstr("The same over 32 draws (1 of the heights of the mirrors)"));  // with the roll of one
  EXPECT_THAT(all.out, Not(HasSubstr("mean over 1 draws")));
  Finished const one = straytrace({"wave", scene_, "--quiet", "--show", "1", "--order", "0"});
  EXPECT_THAT(one.out, AllOf(HasSubstr("and 1 more; --show N has more rows"), Not(HasSubstr("HG01"))));
}

TEST_F(WaveCommand, PrintsSpreadsAndErrors) {
  write_text(scene_, edited(scene_text(), "wave: {", "wave: {map_draws: 2, "));
  Words const command{"wave", scene_, "--quiet", "--order", "0", "--grid-check", "--by-frequency"};
  Finished const all = straytrace(command);
  ASSERT_EQ(all.code, 0) << all.err;
  for (char const* const part :
       {"share +W +median +5 % +95 % +finer grid", "mean over 2 draws of the heights of the mirrors",
        "The same over 64 draws \\(2 of the heights", "\nbaffle_mid +500 +[0-9.e-]+ +[0-9.e-]+",
        "384 points change the loss by [+-]", "levers of edges by up to [0-9]", "2 draws, above",
        "Loss per round trip by the spatial frequency", "56.4 to 113 /m +120 ", "above 113 /m ", "between bands "})
    EXPECT_THAT(all.out, ContainsRegex(part)) << part;
  auto const values = answer(command);
  EXPECT_EQ(values["grid_check"]["points"], 384);
  ASSERT_EQ(values["draws"].size(), 2u);
  double const one = values["draws"][0]["loss"], two = values["draws"][1]["loss"];
  EXPECT_NE(one, two);
  EXPECT_NEAR(values["loss"].get<double>(), (one + two) / 2, 1e-15);
  EXPECT_EQ(values["loss_of_draws"]["percentile_95"], std::max(one, two));
  EXPECT_EQ(values["edges"][1]["levers"].size(), 2u * (1 + 32));
  EXPECT_EQ(values["edges"][1]["sector_shares_towards_mirror2"].size(), 32u);
  auto const& bands = values["by_frequency"];
  double sum = bands["smooth"].get<double>() + bands["beyond"].get<double>();
  for (auto const& band : bands["bands"]) sum += band["loss"].get<double>();
  EXPECT_NEAR(sum / one, 1, 0.1);  // without interference between bands
  EXPECT_EQ(bands["all"], one);
}

TEST_F(WaveCommand, JsonHasItsKeysAndBalance) {
  auto const all = answer({"wave", scene_, "--quiet"});
  for (char const* const key :
       {"beam", "length_m", "points", "window_m", "crossover_rad", "loss", "loss_of_smooth_mirrors", "residual",
        "round_trips", "beyond_band", "mirrors", "modes", "edges"})
    EXPECT_TRUE(all.contains(key)) << key;
  for (auto const& m : all["mirrors"]) EXPECT_EQ(m["rotation_per_rad"].size(), 3u);
  ASSERT_EQ(all["edges"].size(), 2u);
  double lost = all["beyond_band"];
  for (auto const& m : all["mirrors"]) lost += m["power_share_lost"].get<double>();
  for (auto const& r : all["edges"])
    lost += r["power_share_towards_mirror1"].get<double>() + r["power_share_towards_mirror2"].get<double>();
  EXPECT_NEAR(lost / all["loss"].get<double>(), 1, 1e-4);
  auto const &near = all["edges"][0], &mid = all["edges"][1];  // in order of place
  EXPECT_EQ(near["method"], "speckle");
  EXPECT_EQ(near["levers"].size(), 0u);
  EXPECT_EQ(mid["method"], "wave");
  ASSERT_EQ(mid["levers"].size(), 33u);  // as in the scene, then by draws of the roll of a mirror
  EXPECT_EQ(mid["levers"][0]["displacement_per_m"].size(), 3u);
  EXPECT_EQ(mid["levers"][0]["rotation_per_rad"].size(), 3u);
  // Tolerances add their draws; threads change nothing.
  Words const drawn{"wave", scene_, "--quiet", "--format", "json"};
  Words other = drawn;
  other.insert(other.end(), {"--threads", "1"});
  EXPECT_EQ(straytrace(drawn).out, straytrace(other).out);
  write_text(scene_, edited(scene_text(), "wave: {", "wave: {tolerance: {radius: 1 mm}, draws: 2, "));
  EXPECT_EQ(answer({"wave", scene_, "--quiet"})["edges"][1]["levers"].size(), 3u);
}

// At resonance the Airy function (eq. 6.4) with the loss of the round trip, for the mode itself as input.
TEST_F(WaveCommand, DetuningOfTheInputBeam) {
  std::string const csv = folder_ / "detuning.csv";
  auto const all = answer({"wave", scene_, "--quiet", "--detuning", "-0.1..0.1:5", "--csv", csv});
  auto const& driven = all["driven"];
  ASSERT_EQ(driven["detunings"].size(), 5u);
  auto const reflectivity = [&](int i) { return 1 - driven["mirrors"][i]["transmission"].get<double>(); };
  double const trip = std::sqrt(reflectivity(0) * reflectivity(1) * (1 - all["loss"].get<double>()));
  EXPECT_DOUBLE_EQ(reflectivity(0), 1 - 0.014);  // of the interferometer
  double const gain = driven["detunings"][2]["circulating"];
  EXPECT_NEAR(gain / (0.014 / std::pow(1 - trip, 2)), 1, 1e-3);
  EXPECT_LT(driven["detunings"][0]["circulating"].get<double>(), 0.01 * gain);
  EXPECT_LT(driven["field_error"].get<double>(), 1e-4);
  EXPECT_THAT(text_of(csv), HasSubstr("detuning,detuning [Hz],circulating,reflected,transmitted,order 0,order 1"));
  EXPECT_THAT(straytrace({"wave", scene_, "--quiet", "--detuning", "0,10kHz"}).err, HasSubstr("detuning"));
  EXPECT_THAT(straytrace({"wave", scene_, "--quiet", "--detuning", "0"}).out,
              HasSubstr("Field driven through I, which transmits 0.014"));
  EXPECT_THAT(error_text({"wave", scene_, "--quiet", "--csv", csv}), HasSubstr("or for example --detuning"));
  EXPECT_THAT(error_text({"wave", scene_, "--quiet", "--detuning", "1kg"}), HasSubstr("is not a unit of frequency"));
}

// Each mistake has its reason, and all are reported at once. 1e-4 of the frequency of the light is 1.9e5 free spectral
// ranges of 1 km.
TEST_F(WaveCommand, DetuningErrorsHaveTheirReasons) {
  auto const said = [&](std::string const& detuning, Words more = {}) {
    Words words{"wave", scene_, "--quiet", "--detuning", detuning};
    words.insert(words.end(), more.begin(), more.end());
    return error_text(words);
  };
  EXPECT_THAT(said("0.5..-0.5:11"), HasSubstr("error: '--detuning=0.5..-0.5:11': the range runs downwards"));
  EXPECT_THAT(said("1..2"), HasSubstr("'--detuning=1..2': the range has no number of values"));
  EXPECT_THAT(said("-1..1:1"), HasSubstr("a range has 2 to 10000 values"));
  EXPECT_THAT(said(""), HasSubstr("'--detuning=': a value is missing"));
  EXPECT_THAT(said("1e300..2e300:3"), AllOf(HasSubstr("'1e+300' is more than 0.0001 of the frequency of the light"),
                                            HasSubstr("stay within 1.88e+05 free spectral ranges")));
  std::string const all = said("1Hz,x,2MW,1e400Hz,1e12Hz", {"--plot", folder_ / "a.pdf"});
  EXPECT_THAT(all, AllOf(HasSubstr("'x' is not a number"), HasSubstr("'2MW' has another unit than the first value"),
                         HasSubstr("'1e400Hz' is outside the range of double precision"),
                         HasSubstr("'1e12Hz' is more than 0.0001"), HasSubstr("--plot"), Not(HasSubstr("'1Hz'"))));
}

// A file that the scene reads is an input of the command. Control: another name.
TEST_F(WaveCommand, OutputsAreNoFilesOfTheScene) {
  std::string map = "x [mm], y [mm], height [nm]\n";
  for (int i = 0; i < 81; ++i) map += fmt::format("{}, {}, 1\n", 20 * (i % 9 - 4), 20 * (i / 9 - 4));
  write_text(folder_ / "map.csv", map);
  write_text(scene_, edited(scene_text(), "wave: {", "wave: {maps: {I: {file: map.csv}}, "));
  EXPECT_THAT(error_text({"wave", scene_, "--quiet", "--detuning", "0", "--csv", folder_ / "map.csv"}),
              HasSubstr("map.csv' is also another file of this command"));
  EXPECT_EQ(text_of(folder_ / "map.csv"), map);
  // As in every command, a table replaces a file of its name; only run files are kept from other models (--force).
  write_text(folder_ / "new.csv", "old");
  EXPECT_EQ(straytrace({"wave", scene_, "--quiet", "--detuning", "0", "--csv", folder_ / "new.csv"}).code, 0);
  EXPECT_THAT(text_of(folder_ / "new.csv"), HasSubstr("circulating"));
}

TEST_F(WaveCommand, SeamNeedsMotion) {
  std::string const moving = "motion: {x: {peterson: typical}, others: still}";
  write_text(scene_, edited(scene_text(), moving, "motion: still"));
  EXPECT_THAT(error_text({"wave", scene_, "--quiet", "--seam", "--histories", "1e9"}),
              HasSubstr("nothing moves, so there is no noise to compare"));
}

// The field of an earlier run is taken while its key is that of the scene: the eigenvalue, which is falsified here,
// shows where it comes from.
TEST_F(WaveCommand, FieldOfTheSameCavityIsNotSolvedAgain) {
  SceneOptions quiet;
  quiet.quiet = true;
  Model model = read_model(scene_, {});
  ArmWaves const solved = solved_or_known(model, 1, quiet);
  auto falsified = std::make_shared<WaveRecord>(*model.waves);
  falsified->eigenvalue *= 0.5;
  model.waves = falsified;
  EXPECT_EQ(solved_or_known(model, 1, quiet).mode.eigenvalue, 0.5 * solved.mode.eigenvalue);
  write_text(scene_, edited(scene_text(), "120 urad", "121 urad"));
  Model other = read_model(scene_, {});
  other.waves = falsified;
  EXPECT_NE(other.world.wave.crossover, model.world.wave.crossover);
  EXPECT_GT(std::abs(solved_or_known(other, 1, quiet).mode.eigenvalue), 0.9);  // control: another cavity is solved
  EXPECT_NE(other.waves->key, falsified->key);
  // The crossover angle that `wave --seam` varies is not in the scene.
  model.waves = falsified;
  model.world.wave.crossover = 130e-6;
  model.arm = planned_arm(model.world, model.world.wave);
  EXPECT_GT(std::abs(solved_or_known(model, 1, quiet).mode.eigenvalue), 0.9);
}

// Paths start and end in the field, so that its table is a part of the model; numbers of the noise are not.
TEST_F(WaveCommand, AnotherTableIsAnotherModel) {
  auto const map = [&](char const* height) {
    std::string text = "x [mm], y [mm], height [nm]\n";
    for (int i = 0; i < 81; ++i) text += fmt::format("{}, {}, {}\n", 20 * (i % 9 - 4), 20 * (i / 9 - 4), height);
    write_text(folder_ / "map.csv", text);
  };
  auto const hash = [&](std::string const& text) {
    write_text(scene_, text);
    return read_model(scene_, {}).hash();
  };
  std::string const text = scene_text(), was = hash(text);
  for (auto const& [from, to] : {std::pair{"120 urad", "121 urad"},
                                 {"points: 256", "points: 288"},
                                 {"window: 0.5 m", "window: 0.51 m"},
                                 {"wave: {", "wave: {draws: 4, "},
                                 {"wave: {", "wave: {map_draws: 2, "},
                                 {"wave: {", "wave: {tolerance: {radius: 1 mm}, "},
                                 {"wave: {", "wave: {maps: {I: {seed: 2}}, "},
                                 {"baffles: \"baffle*\"", "baffles: baffle_mid"}})
    EXPECT_NE(hash(edited(text, from, to)), was) << to;
  EXPECT_EQ(hash(edited(text, "points_per_decade: 5", "points_per_decade: 6")), was);  // control
  std::string const mapped = edited(text, "wave: {", "wave: {maps: {I: {file: map.csv}}, ");
  map("1");
  std::string const with_map = hash(mapped);
  EXPECT_EQ(hash(mapped), with_map);
  map("2");
  EXPECT_NE(hash(mapped), with_map);
}

TEST_F(WaveCommand, RunOfAnotherTableIsNotResumed) {
  std::string const run = folder_ / "run.h5";
  auto const traced = [&](char const* crossover, char const* histories) {
    write_text(scene_, edited(scene_text(), "120 urad", crossover));
    return straytrace({"trace", scene_, "-o", run, "--histories", histories, "--quiet"});
  };
  ASSERT_EQ(traced("120 urad", "4000").code, 0);
  std::string const bytes = text_of(run);
  Finished const refused = traced("121 urad", "8000");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("run.h5' contains a run of another model or seed"));
  EXPECT_EQ(text_of(run), bytes);
  EXPECT_EQ(traced("120 urad", "8000").code, 0);  // control: the same table
}

TEST_F(WaveCommand, RunFileWithoutHistoriesIsResumed) {
  std::string const field = folder_ / "field.h5", whole = folder_ / "whole.h5";
  Finished const wave = straytrace({"wave", scene_, "-o", field, "--fields", "--quiet"});
  ASSERT_EQ(wave.code, 0) << wave.err;
  EXPECT_THAT(straytrace({"noise", field, "--quiet"}).out, HasSubstr("wave"));
  ASSERT_EQ(straytrace({"trace", scene_, "-o", field, "--histories", "4000", "--quiet"}).code, 0);
  ASSERT_EQ(straytrace({"trace", scene_, "-o", whole, "--histories", "4000", "--quiet"}).code, 0);
  RunFile const resumed = read_run(field), anew = read_run(whole);
  ASSERT_TRUE(resumed.about.waves && anew.about.waves);
  EXPECT_EQ(resumed.about.waves->fields.size(), 2u);
  EXPECT_EQ(anew.about.waves->fields.size(), 0u);
  EXPECT_EQ(resumed.about.waves->key, anew.about.waves->key);
  ASSERT_EQ(resumed.trace.coupling.classes.size(), anew.trace.coupling.classes.size());
  for (std::size_t i = 0; i < anew.trace.coupling.classes.size(); ++i)
    EXPECT_EQ(resumed.trace.coupling.classes[i].coupling.mean, anew.trace.coupling.classes[i].coupling.mean);
  EXPECT_THAT(error_text({"wave", scene_, "-o", field, "--quiet"}), HasSubstr("histories, which would be lost"));
}

// A run without the field, as other programs may write it.
TEST_F(WaveCommand, ReportShowsTheProgressOfAMissingField) {
  std::string const run = folder_ / "run.h5";
  write_text(scene_, scene_text("{points: 1024, window: 0.5 m}"));
  ASSERT_EQ(straytrace({"trace", scene_, "-o", run, "--histories", "4000", "--quiet"}).code, 0);
  auto const said = [&] {
    Finished const report = straytrace({"report", run, "-o", folder_ / "report.html", "--pictures", "convergence"});
    EXPECT_EQ(report.code, 0);
    return report.err;
  };
  EXPECT_THAT(said(), Not(HasSubstr("wave: ")));  // control: the run has it
  RunFile file = read_run(run);
  file.about.waves.reset();
  write_run(run, file.content());
  EXPECT_THAT(said(), HasSubstr("wave: "));
}

// The mode cleaner with smaller apertures, on a grid of fewer points.
std::string narrow_ring() {
  std::string text = text_of(source_folder + "/examples/mode_cleaner.yaml");
  auto const all = [&](std::string const& from, std::string const& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  all("outer_radius: 60 mm", "outer_radius: 20 mm");
  all("inner_radius: 30 mm", "inner_radius: 15 mm");
  all("crossover: 1 mrad", "crossover: 0.5 mrad");
  return text;
}

// One curved mirror of 27.24 m, 32.9461 m around: orders across the plane lag by arccos(1 - L/RoC), those in it by half
// a turn more, with an odd number of mirrors (eq. W.53); astigmatism at 0.8 deg is small.
TEST_F(WaveCommand, RingHasItsLossesAndPhases) {
  std::string const ring = source_folder + "/examples/mode_cleaner.yaml";
  auto const all = answer({"wave", ring, "--quiet", "--order", "1"});
  ASSERT_EQ(all["stops"].size(), 5u);  // three mirrors, and the baffle on both legs
  double sum = all["beyond_band"].is_null() ? 0 : all["beyond_band"].get<double>();
  for (auto const& stop : all["stops"])
    if (!stop["power_share_lost"].is_null()) sum += stop["power_share_lost"].get<double>();
  EXPECT_LT(deviation(sum, all["loss"].get<double>()), 1e-6);
  EXPECT_NEAR(all["loss"].get<double>(), 3 * 10e-6, 3e-8);  // tis of three mirrors, two of them at 44.6 deg
  double const lag = std::acos(1 - 32.9461 / 27.24) / (2 * 3.14159265358979);
  for (auto const& mode : all["modes"]) {
    double const phase = mode["phase_turns"], expected = mode["phase_by_ray_matrix_turns"];
    EXPECT_NEAR(phase, expected, 1e-4);
    if (mode["order"] == 1) {
      EXPECT_NEAR(std::fabs(phase), mode["n"] == 1 ? 0.5 - lag : lag, 1e-3);
      EXPECT_GT(std::fabs(std::fabs(phase) - (mode["n"] == 1 ? lag : 0.5 - lag)), 0.01);  // negative control
    }
  }
  ASSERT_EQ(all["levers"]["surfaces"].size(), 4u);  // the baffle once
  EXPECT_EQ(all["levers"]["surfaces"][0]["displacement_per_m"].size(), 3u);
  EXPECT_EQ(all["levers"]["bodies"].size(), 1u);
  EXPECT_THAT(error_text({"wave", ring, "--quiet", "--seam"}), HasSubstr("work for two-mirror cavities only"));
  std::string const wrong = folder_ / "ring.yaml", narrow = folder_ / "narrow.yaml", field = folder_ / "ring.h5";
  write_text(narrow, narrow_ring());
  Finished const solved = straytrace({"wave", narrow, "-o", field, "--order", "0", "--quiet", "--grid-check"});
  ASSERT_EQ(solved.code, 0) << solved.err;
  EXPECT_THAT(solved.out, ContainsRegex("[0-9]+ points change the loss by [+-][0-9.e-]+ of itself, phases of modes"));
  EXPECT_THAT(solved.out, ContainsRegex("share +W +finer grid"));
  RunFile const kept = read_run(field);
  ASSERT_TRUE(kept.about.ring);
  EXPECT_EQ(kept.about.ring->surfaces.size(), 4u);
  EXPECT_EQ(kept.about.ring->surfaces[0].body, "stack");
  ASSERT_TRUE(kept.about.ring->grid_check);
  EXPECT_EQ(kept.about.ring->grid_check->losses.taken.size(), 4u);
  write_text(wrong, edited(text_of(ring), "crossover: 1 mrad", "crossover: 1 mrad, grid: {points: 64}"));
  EXPECT_THAT(error_text({"check", wrong, "--quiet"}),
              AllOf(HasSubstr("ring.yaml:31:"), HasSubstr("does not carry a crossover angle")));
}

// eq. W.52 at the resonance of a ring of two equal mirrors that transmit, to first order in transmission and loss.
TEST_F(WaveCommand, RingIsDriven) {
  std::string const ring = folder_ / "narrow.yaml";
  write_text(ring, narrow_ring());
  auto const all = answer({"wave", ring, "--quiet", "--order", "1", "--detuning", "0,0.1"}), driven = all["driven"];
  double const t = 0.006, half = all["loss"].get<double>() / 2;
  ASSERT_EQ(driven["mirrors"].size(), 3u);
  EXPECT_EQ(driven["mirrors"][0]["name"], "MC1");
  EXPECT_EQ(driven["mirrors"][2]["name"], "MC3");
  auto const& at = driven["detunings"];
  EXPECT_NEAR(at[0]["reflected"].get<double>(), std::pow(half / (t + half), 2), 1e-6);
  EXPECT_NEAR(at[0]["ports"][1].get<double>(), std::pow(t / (t + half), 2), 1e-4);
  EXPECT_GT(std::fabs(at[0]["ports"][1].get<double>() - 1), 2e-3);  // control: without the loss
  EXPECT_EQ(at[0]["ports"][0].get<double>(), 0);
  EXPECT_GT(at[1]["reflected"].get<double>(), 0.99);
  std::string const unknown = folder_ / "unknown.yaml";
  write_text(unknown, edited(narrow_ring(), "MC1: {transmission: 0.6 %}, ", ""));
  EXPECT_THAT(error_text({"wave", unknown, "--quiet", "--detuning", "0"}),
              HasSubstr("a driven cavity needs the transmission of 'MC1'"));
  EXPECT_THAT(error_text({"wave", ring, "--quiet", "--plot", "a.png"}), HasSubstr("work for two-mirror cavities only"));
}

TEST_F(WaveCommand, WhatIsMissingIsExplained) {
  std::string const text = scene_text(), none = text.substr(0, text.find("wave: {"));
  write_text(scene_, none + text.substr(text.find("interferometer: {")));
  EXPECT_THAT(error_text({"wave", scene_}),
              AllOf(HasSubstr("has no table 'wave'"), HasSubstr("add for example 'wave:")));
  write_text(scene_, scene_text("{points: 216, window: 0.5 m}"));
  EXPECT_THAT(error_text({"wave", scene_, "--quiet"}),
              HasSubstr("state 'points: 240' in 'grid', or a 'crossover' of at most"));
  EXPECT_THAT(error_text({"wave", folder_ / "none.yaml"}), HasSubstr("none.yaml"));
}

// "arm.yaml:12:34: error: " of the value at this text.
std::string error_at(std::string const& text, std::string const& value) {
  std::size_t const at = text.find(value), line = text.rfind('\n', at);
  return fmt::format("arm.yaml:{}:{}: error: ", 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'),
                     at - line);
}

// The share of a centred Gaussian beam in a circle is 1 - exp(-2 R^2/w^2): 0.245 for 75 mm and 20 cm.
TEST_F(WaveCommand, InputBesideTheMirrorIsNoInput) {
  auto const checked = [&](std::string const& input) {
    write_text(scene_, edited(scene_text(), "wave: {", "wave: {input: {" + input + "}, "));
    return straytrace({"check", scene_});
  };
  Finished const beside = checked("shift: [0.2 m, 0 m]");
  EXPECT_EQ(beside.code, 2);
  EXPECT_THAT(beside.err, AllOf(HasSubstr(error_at(text_of(scene_), "[0.2 m")),
                                HasSubstr("less than 1e-6 of the power of the input beam falls on 'I'")));
  Finished const wide = checked("radius: 20 cm");
  EXPECT_EQ(wide.code, 0);
  EXPECT_THAT(wide.err, HasSubstr("warning: only 0.25 of the power of the input beam falls on 'I'"));
  EXPECT_THAT(checked("shift: [75 mm, 0 m]").err, HasSubstr("warning: only 0.4"));  // less than half, of a curved edge
  EXPECT_THAT(checked("shift: [20 mm, 0 m]").err, Not(HasSubstr("input beam")));
}

// Edges of 45 mm, 2.2 to 2.4 radii of the mode: one warning for all six. An error for one that is off the axis.
TEST_F(WaveCommand, EdgesOfOneKindShareAWarning) {
  auto const warned = [&](std::string const& place) {
    std::string const text = edited(scene_text(), "crossover: 120 urad", "crossover: 60 urad");
    write_text(scene_, edited(text, "at: [0 m, 0 m, 300 m]", place));
    return straytrace({"check", scene_}).err;
  };
  std::string const all = warned("at: [0 m, 0 m, 0 m], repeat: {along: z, count: 5, from: 300 m, to: 340 m}");
  EXPECT_THAT(all,
              HasSubstr("the inner edges of 'baffle_near' at 300 m, 'baffle_near' at 310 m, 'baffle_near' at 320 m "
                        "and 3 others come within 2."));
  std::string const mean = "the mean over speckle";
  EXPECT_EQ(all.find(mean), all.rfind(mean));
  EXPECT_THAT(warned("at: [11 mm, 0 m, 300 m]"),
              HasSubstr("error: the inner edge of 'baffle_near' at 300 m is 0.011 m off the axis of the cavity"));
}

TEST(WaveOutput, PhasesOfZeroHaveNoMinus) {
  EXPECT_EQ(cli::phase_text(-4.9e-6), "+0.00000");
  EXPECT_EQ(cli::phase_text(-5.1e-6), "-0.00001");  // negative control
  EXPECT_EQ(cli::phase_text(-0.25), "-0.25000");
}

TEST_F(WaveCommand, ShiftBeyondTheApertureIsToldAlone) {
  write_text(scene_, edited(scene_text(), "wave: {", "wave: {mirrors: {E: {shift: [1 m, 0 m]}}, "));
  EXPECT_THAT(error_text({"check", scene_}),
              AllOf(HasSubstr(error_at(text_of(scene_), "[1 m") + "a shift of 1 m exceeds the clear aperture of 'E', "
                                                                  "whose radius is 0.075 m"),
                    HasSubstr("\n1 error. Nothing was run.")));
}

// All of them, each at the key that causes it, before any field; with its key right, no error is left.
TEST_F(WaveCommand, CheckFindsErrorsAtTheirKeys) {
  std::string const more =
      "wave: {\n  tolerance: {radius: 1 cm},\n"
      "  maps: {I: {spectrum: none, defects: [{ripple: {amplitude: 1 nm peak, period: 8 mm}}]}}, ";
  std::string const wrong = edited(scene_text("{points: 64, window: 0.2 m}"), "wave: {", more);
  write_text(scene_, wrong);
  std::string const said = error_text({"check", scene_});
  EXPECT_THAT(said, HasSubstr(error_at(wrong, "1 cm}") + "a tolerance of 0.01 m is too large"));
  EXPECT_THAT(said, HasSubstr(error_at(wrong, "[{ripple") + "a ripple of 0.008 m scatters to 133 urad"));
  EXPECT_THAT(said, HasSubstr(error_at(wrong, "64, window") + "a grid of 64 points over 0.2 m does not carry"));
  EXPECT_THAT(said, HasSubstr(error_at(wrong, "0.2 m}") + "a window of 0.2 m is too narrow"));
  EXPECT_THAT(said, HasSubstr("\n4 errors. Nothing was run."));
  EXPECT_EQ(error_text({"wave", scene_}), said);
  EXPECT_EQ(error_text({"run", scene_, "-o", folder_ / "out"}), said);
  std::string right = edited(edited(wrong, "1 cm}", "1 mm}"), "period: 8 mm", "period: 9 mm");
  write_text(scene_, edited(right, "{points: 64, window: 0.2 m}", "{points: 256, window: 0.5 m}"));
  EXPECT_EQ(straytrace({"check", scene_, "--quiet"}).code, 0);
  // The range of a number is printed in the unit of the scene.
  write_text(scene_, edited(wrong, "crossover: 120 urad", "crossover: 0.5 urad"));
  EXPECT_THAT(error_text({"check", scene_}), HasSubstr("must be between 1 urad and 100000 urad, got \"0.5 urad\""));
}

TEST_F(WaveCommand, CheckFindsErrorsInMaps) {
  auto const map = [&](double step, std::string const& more) {
    std::string text = "x [mm], y [mm], height [nm]\n";
    for (int i = 0; i < 81; ++i) text += fmt::format("{}, {}, 1\n", step * (i % 9 - 4), step * (i / 9 - 4));
    write_text(folder_ / "map.csv", text + more);
  };
  std::string const scene = edited(scene_text(), "wave: {", "wave: {maps: {I: {file: map.csv}}, ");
  write_text(scene_, scene);
  map(20, "80, 80, 2\n");
  EXPECT_THAT(error_text({"check", scene_}), HasSubstr("map.csv:83:0: error: this point has a height already"));
  map(5, "");
  EXPECT_THAT(error_text({"check", scene_}),
              HasSubstr(error_at(scene, "map.csv") + "map.csv: the map covers a disc of "
                                                     "radius 0.02 m, less than twice the radius"));
  map(20, "");
  EXPECT_EQ(straytrace({"check", scene_, "--quiet"}).code, 0);
}

TEST_F(WaveCommand, CheckPrintsThePlan) {
  EXPECT_THAT(straytrace({"check", scene_, "--quiet"}).out,
              HasSubstr("wave arm: crossover angle 120 urad; 1 of 2 inner edges within it, seen from both mirrors\n"
                        "  grid of 256 x 256 points over 0.5 m, which carries 272.4 urad; the field needs 0.031 GB"));
  write_text(scene_,
             edited(edited(scene_text(), "crossover: 120 urad, ", ""), ", grid: {points: 256, window: 0.5 m}", ""));
  EXPECT_THAT(straytrace({"check", scene_, "--quiet"}).out,
              ContainsRegex("crossover angle [0-9.]+ urad \\(automatic\\); .*\n"
                            "  grid of [0-9]+ x [0-9]+ points \\(automatic\\) over [0-9.]+ m \\(automatic\\)"));
  auto const found = answer({"check", scene_, "--quiet"})["wave"];
  EXPECT_EQ(found["points_automatic"], true);
  EXPECT_EQ(found["inner_edges"], 2);
}

// Rows of their own kinds, neither of them an upper bound, as the program and its Python package print them.
TEST_F(WaveCommand, RunHasRowsOfTheirKinds) {
  Finished const run = straytrace({"run", scene_, "-o", folder_ / "out", "--histories", "4000", "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Kinds other than scattered are computed, not sampled"));
  EXPECT_THAT(run.out, ContainsRegex("E·S > baffle_mid·E > I·S +I +wave "));
  EXPECT_THAT(run.out, ContainsRegex("E·S > baffle_near·E > I·S +I +speckle "));
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("1 inner edge in the field of the cavity"), HasSubstr("mean over random mirrors")));
  EXPECT_THAT(run.out, AllOf(HasSubstr("h = "), Not(HasSubstr("at most ")), Not(HasSubstr("upper bound"))));
  EXPECT_THAT(text_of(folder_ / "out/h_asd.txt"), Not(HasSubstr("AT MOST")));
  EXPECT_THAT(text_of(folder_ / "out/paths.csv"), AllOf(HasSubstr(",itself,wave,"), HasSubstr(",itself,speckle,")));
  EXPECT_THAT(straytrace({"noise", folder_ / "out/run.h5", "--format", "json"}).out,
              Not(HasSubstr("\"at_most\": true")));
  EXPECT_THAT(straytrace({"paths", folder_ / "out/run.h5"}).out, HasSubstr("baffle_near·E"));
  std::string const reader =
      "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" + source_folder +
      "/python' timeout 60 /usr/bin/python3 -c \"import straytrace; r = straytrace.open('" + (folder_ / "out/run.h5") +
      "').routes; k = list(r.kind); assert {'wave', 'speckle'} <= set(k); assert r.sigma[k.index("
      "'wave')] == 0\"";
  EXPECT_EQ(std::system(reader.c_str()), 0);
}

}  // namespace
}  // namespace straytrace::testing::app_wave
