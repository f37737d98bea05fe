// SPDX-License-Identifier: BSD-3-Clause
// print, explain, diff: what people read about the language and their models.
#include <fmt/format.h>

#include <cmath>

#include "base/every_module.hpp"
#include "scenes/answers.hpp"
#include "session/interrupt.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string const baffle = R"(straytrace: 1
params: {opening: 20 cm}
materials: {hr: {scatter: {model: lambertian, tis: 5 ppm}}, wall: {scatter: {model: lambertian, brdf: 1e-2 /sr}}}
bodies:
  ITM: {motion: still}
  ETM: {motion: still}
  baffle: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: -1, from: 1 Hz, to: 1 kHz}}, others: still}}
scene:
  - {name: ITM, use: mirror, at: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius_of_curvature: 1420 m, body: ITM, material: hr}
  - {name: ETM, use: mirror, at: [0 m, 0 m, 3 km], facing: [0, 0, -1], radius_of_curvature: 1683 m, body: ETM, material: hr}
  - {name: baffle, shape: {disk: {inner_radius: opening, outer_radius: 50 cm}}, at: [0 m, 0 m, 100 m], facing: [0, 0, -1], side: front, body: baffle, material: wall}
beams: {arm: {cavity: [ITM, ETM]}}
ports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %, arm_power: 650 kW}
trace: {histories: 131072}
)";

std::string hash_of(std::string const& scene) { return answer({"check", scene, "--quiet"})["model_hash"]; }

// The printed text is the same model, to the bit; with one default changed it is another model.
TEST(Print, ReadsBackAsTheSameModel) {
  Folder const folder;
  for (char const* name : {"virgo_arm", "pipe", "bench", "et_hf_edges"}) {
    std::string const scene = fmt::format("{}/examples/{}.yaml", source_folder, name);
    Finished const printed = straytrace({"print", "--quiet", scene});
    ASSERT_EQ(printed.code, 0) << printed.err;
    fs::create_directories(folder / "data");
    fs::copy(source_folder + "/examples/data", folder / "data", fs::copy_options::overwrite_existing);
    write_text(folder / "again.yaml", printed.out);
    EXPECT_EQ(hash_of(folder / "again.yaml"), hash_of(scene)) << name;
  }
  write_text(folder / "a.yaml", baffle);
  std::string const printed = straytrace({"print", folder / "a.yaml"}).out;
  write_text(folder / "b.yaml", edited(printed, "inner_radius: 0.2 m", "inner_radius: 0.21 m"));
  EXPECT_NE(hash_of(folder / "b.yaml"), hash_of(folder / "a.yaml"));
}

TEST(Print, StatesTheOriginOfEachValue) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  std::string const text = straytrace({"print", "--resolved", folder / "a.yaml", "-p", "opening=21cm"}).out;
  EXPECT_THAT(text, HasSubstr("inner_radius: 0.21 m                  # a.yaml:11, opening"));
  EXPECT_THAT(text, HasSubstr("# depolarise: 1                           # default"));
  EXPECT_EQ(straytrace({"check", "--resolved", folder / "a.yaml", "-p", "opening=21cm"}).out, text);
  auto const json = answer({"print", folder / "a.yaml"});
  EXPECT_EQ(json["model"]["role"], "a model");
}

TEST(Explain, AKeyHasTypeRangeDefaultExampleAndPage) {
  auto const all = answer({"explain", "cone.half_angle"});
  ASSERT_EQ(all.size(), 1u);
  for (char const* fact : {"type", "range", "default", "example", "page", "text"})
    EXPECT_FALSE(all[0][fact].empty()) << fact;
  EXPECT_GT(answer({"explain", "half_angle"}).size(), 3u);
  EXPECT_THAT(straytrace({"explain", "beam"}).out, HasSubstr("wavelength"));
  EXPECT_THAT(straytrace({"explain", "lens.radius_1"}).out, HasSubstr("default  0 m"));
  EXPECT_THAT(error_text({"explain", "conne.half_angel"}), HasSubstr("did you mean 'cone.half_angle'?"));
  EXPECT_THAT(error_text({"explain", "cone.half_angel"}), HasSubstr("did you mean 'cone.half_angle'?"));
}

TEST(Explain, ThingsOfTheLibraryAndTheirNumbers) {
  auto const rim = answer({"explain", "virgo_baffle.inner_radius"});
  EXPECT_EQ(rim["default"], "49.5 cm");
  EXPECT_THAT(rim["source"].get<std::string>(), HasSubstr("Virgo specification"));
  EXPECT_EQ(answer({"explain", "adv.arm_power"})["default"], "650 kW");
  EXPECT_EQ(answer({"explain", "dlc"})["status"], "assumed");
  std::string const rejected = error_text({"explain", "baffle.aperture"});  // no part has this name alone
  EXPECT_THAT(rejected, HasSubstr("conical_baffle"));
  EXPECT_THAT(rejected, HasSubstr("inner_radius"));
  EXPECT_THAT(error_text({"explain", "lens.diametre"}), HasSubstr("did you mean 'lens.diameter'?"));
}

TEST(Explain, UnitsAndMessages) {
  EXPECT_EQ(straytrace({"explain", "unit m/sqrt(Hz)"}).out, straytrace({"explain", "unit", "m/sqrt(Hz)"}).out);
  EXPECT_EQ(straytrace({"explain", "m/sqrt(Hz)"}).out, straytrace({"explain", "unit", "m/sqrt(Hz)"}).out);
  EXPECT_NEAR(answer({"explain", "unit", "arcsec"})["si"].get<double>(), 4.84813681e-6, 1e-14);
  EXPECT_THAT(error_text({"explain", "unit", "metre"}), HasSubstr("did you mean 'm'?"));
  EXPECT_THAT(straytrace({"explain", "arm.yaml:8:29: error: \"10 um\" does not say which amplitude it is"}).out,
              HasSubstr("... peak"));
  EXPECT_THAT(error_text({"explain", "xyzzy plugh"}), HasSubstr("is unknown in the language"));
}

// What tables print beside numbers, and remedies without what is put into them.
TEST(Explain, MarksAndRemediesRead) {
  EXPECT_THAT(straytrace({"explain", "at most"}).out, HasSubstr("an upper bound"));
  EXPECT_EQ(answer({"explain", "at most"})["page"], "docs/theory/errors.md");
  std::string const said = straytrace({"explain", "'metre' is not a unit"}).out;
  EXPECT_THAT(said, HasSubstr("remedy   known units: ..."));
  for (char const* raw : {"{}", "......", " | "}) EXPECT_THAT(said, Not(HasSubstr(raw)));
}

// Every column of the path table, by its key and as text prints it, and the words in its cells and beside it. Control:
// a word of no table.
TEST(Explain, WordsOfTablesAreKnown) {
  EXPECT_THAT(answer({"explain", "C_rev"})["text"].get<std::string>(), HasSubstr("reversed route"));
  EXPECT_EQ(answer({"explain", "sensitivity"})["column"], "phase_sensitivity");
  EXPECT_EQ(answer({"explain", "coupling_sigma"})["text"], "one standard error");
  EXPECT_EQ(answer({"explain", "edge"})["page"], "docs/theory/diffraction.md");
  for (char const* word :
       {"C_rev", "sensitivity", "moves", "mixed", "linear", "edge", "ghost", "hint", "beside", "incidence",
        "no light seen", "one realisation", "input uncertainty", "bound_share", "coherent", "share/%", "h(10 Hz)"})
    EXPECT_EQ(straytrace({"explain", word}).code, 0) << word;
  for (char const* word : {"emitted", "escaped", "truncated", "roulette", "sampling", "figure of merit", "speckle"})
    EXPECT_EQ(answer({"explain", word})["mark"], word);
  EXPECT_EQ(answer({"explain", "only 47 effective scores"})["mark"], "effective scores");
  EXPECT_EQ(answer({"explain", "variance of variance is 0.27"})["mark"], "variance of variance");
  EXPECT_EQ(straytrace({"explain", "C_reversed"}).code, 2) << "control";
  EXPECT_EQ(straytrace({"explain", "9 ghosts nearby"}).code, 2) << "control: a mark of one word inside a text";
}

// S = 1/2 kappa^2 S_x where motion is small (docs/theory/spectra.md, eq. 7.2): here S_x = (1e-12 (f/10 Hz)^-1)^2
// m^2/Hz, of the one body that moves, and the paths of a flat baffle 100 m away have kappa within 1e-3 of their rms.
// Their product is h.
TEST(Explain, TheChainOfAPathIsItsStrain) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  ASSERT_EQ(straytrace({"run", folder / "a.yaml", "-o", folder / "a", "--quiet"}).code, 0);
  auto const a = answer({"explain", "h", folder / "a/run.h5", "--path", "1", "--at", "40"});
  auto const value = [&](char const* name) { return a["factors"][name]["value"].get<double>(); };
  double const hz = a["hz"], asd = 1e-12 * 10 / hz;
  EXPECT_NEAR(value("S") / (0.5 * std::pow(value("kappa") * asd, 2)), 1, 3e-3);
  double const product = value("C") * value("C_rev") * value("N") *
                         (std::pow(value("T_phase"), 2) + std::pow(value("T_amplitude"), 2)) * value("S");
  EXPECT_NEAR(std::sqrt(product) / value("h"), 1, 1e-12);
  auto const routes = answer({"paths", folder / "a/run.h5"});
  EXPECT_EQ(a["route"], routes["routes"][0]["sequence"]);
  for (auto const& column : routes["columns"]) {
    std::string const key = column["key"];
    EXPECT_EQ(straytrace({"explain", key}).code, 0) << key;
  }
  EXPECT_THAT(error_text({"explain", "h", folder / "a/run.h5", "--path", "900"}), HasSubstr("has no path 900"));
  EXPECT_THAT(error_text({"explain", "h", folder / "a/run.h5", "--at", "1e5"}), HasSubstr("outside the band"));
}

TEST(Diff, SpellingMakesNoDifference) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  std::string other = edited(baffle, "{opening: 20 cm}", "{hole: 0.2 m}");
  other = edited(other, "inner_radius: opening", "inner_radius: hole  ");
  other = edited(other, "3 km, mirror_mass", "3000 m, mirror_mass");
  other = edited(other, "[0 m, 0 m, 3 km]", "[0 m, 0 m, 3 km - 0 m]");
  other =
      edited(other, "{model: lambertian, tis: 5 ppm}", "[{tis: 5e-6, model: lambertian, through: off, source: me}]");
  other =
      edited(other, "beams: {arm: {cavity: [ITM, ETM]}}", "beams: {arm: {cavity: [ITM, ETM], wavelength: 1064 nm}}");
  write_text(folder / "b.yaml", other + "# the same\n");
  EXPECT_EQ(straytrace({"diff", folder / "a.yaml", folder / "b.yaml"}).out,
            "no physical difference between the models\n");
  EXPECT_EQ(hash_of(folder / "a.yaml"), hash_of(folder / "b.yaml"));
}

// Each edit is seen, alone, in its section; none of them would leave the list empty.
TEST(Diff, EachPhysicalDifferenceIsFound) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  struct Edit {
    char const *from, *to, *section, *key;
  };
  for (Edit const& e :
       {Edit{"1e-2 /sr", "2e-2 /sr", "materials", "scatter"}, Edit{"20 cm", "21 cm", "scene", "inner_radius"},
        Edit{"exponent: -1", "exponent: -2", "bodies", "exponent"},
        Edit{"0 m, 100 m]", "0 m, 101 m]", "scene", "at[2]"},
        Edit{"{cavity: [ITM, ETM]}", "{cavity: [ITM, ETM], power: 1 W}", "beams", "power"},
        Edit{"1.4 %", "1.5 %", "interferometer", "input_transmission"},
        Edit{"material: wall", "material: hr", "scene", "material"},
        Edit{"histories: 131072", "histories: 4096", "trace", "histories"}}) {
    write_text(folder / "b.yaml", edited(baffle, e.from, e.to));
    auto const models = answer({"diff", folder / "a.yaml", folder / "b.yaml"})["models"];
    ASSERT_EQ(models.size(), 1u) << e.to << models;
    EXPECT_EQ(models[0]["section"], e.section);
    EXPECT_THAT(models[0]["key"].get<std::string>(), HasSubstr(e.key));
  }
  write_text(folder / "c.yaml", baffle + "wave: {beam: arm}\n");
  write_text(folder / "d.yaml", baffle + "wave: {beam: arm, crossover: 100 urad}\n");
  auto const models = answer({"diff", folder / "c.yaml", folder / "d.yaml"})["models"];
  ASSERT_EQ(models.size(), 1u) << models;
  EXPECT_EQ(models[0]["section"], "wave");
  EXPECT_THAT(models[0]["key"].get<std::string>(), HasSubstr("crossover"));
}

// A parameter that moves many instances is reported once, by its name and in common units, before its consequences.
TEST(Diff, CausesComeFirstAndAreReadable) {
  Folder const folder;
  std::string const rings =
      edited(baffle, "0 m, 100 m]", "0 m, first], repeat: {count: 20, along: z, from: 0 m, pitch: 1 m}");
  std::string const many = edited(rings, "{opening: 20 cm}", "{opening: 20 cm, first: 100 m}");
  write_text(folder / "a.yaml", many);
  Finished const d = straytrace({"diff", folder / "a.yaml", folder / "a.yaml"});
  EXPECT_EQ(d.out, "no physical difference between the models\n") << d.err;
  write_text(folder / "b.yaml", edited(many, "20 cm, first", "19.5 cm, first"));
  std::string const text = straytrace({"diff", folder / "a.yaml", folder / "b.yaml"}).out;
  EXPECT_TRUE(text.starts_with("parameters\n  opening: 20 cm -> 19.5 cm\nscene\n")) << text;
  EXPECT_THAT(text, HasSubstr("20 cm -> 19.5 cm (20 instances)"));
  std::string const stated = edited(many, "{opening: 20 cm, first", "{opening: {value: 20 cm, source: me}, first");
  write_text(folder / "d.yaml", stated);
  EXPECT_THAT(straytrace({"diff", folder / "d.yaml", folder / "b.yaml"}).out, HasSubstr("opening: 20 cm -> 19.5 cm\n"));
  write_text(folder / "c.yaml", edited(many, "pitch: 1 m", "pitch: 1.1 m"));
  std::string const moved = straytrace({"diff", folder / "a.yaml", folder / "c.yaml"}).out;
  EXPECT_THAT(moved, HasSubstr("19 instances, by 0.1 m to 1.9 m; the first: "));
  EXPECT_LT(std::count(moved.begin(), moved.end(), '\n'), 5) << moved;  // control: JSON has them one by one
  EXPECT_GE(answer({"diff", folder / "a.yaml", folder / "c.yaml"})["models"].size(), 19u);
}

TEST(Messages, NearMissesAreShownCorrected) {
  Folder const folder;
  write_text(folder / "m.yaml", "straytrace: 1\nbodies: {b: {motion: {asd: 1e-12 m/sqrt(Hz)}}}\n");
  std::string const told = error_text({"check", folder / "m.yaml"});
  EXPECT_THAT(told, HasSubstr("z: {asd: ...}"));
  EXPECT_THAT(told, HasSubstr("1 error."));
  EXPECT_THAT(straytrace({"explain", "coupling"}).out, HasSubstr("column of the path table"));
  EXPECT_THAT(straytrace({"explain", "brdf"}).out, Not(HasSubstr("(1/sr) (1/sr)")));
  EXPECT_THAT(straytrace({"explain", "brdf"}).out, HasSubstr("BRDF (1/sr)"));
}

// Twice the BRDF is twice the power and sqrt(2) of the strain (docs/theory/path_integral.md, eq. 1.1); the same seed,
// so hardly any error.
TEST(Diff, RunsDifferBySigmas) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  write_text(folder / "b.yaml", edited(baffle, "1e-2 /sr", "2e-2 /sr"));
  for (char const* name : {"a", "b"})
    ASSERT_EQ(straytrace({"run", folder / (std::string(name) + ".yaml"), "-o", folder / name, "--quiet"}).code, 0);
  auto const d = answer({"diff", folder / "a/run.h5", folder / "b/run.h5"});
  ASSERT_EQ(d["models"].size(), 1u);
  for (auto const& band : d["results"]["bands"]) {
    EXPECT_NEAR(band["after"]["value"].get<double>() / band["before"]["value"].get<double>(), std::sqrt(2), 0.02);
    EXPECT_GT(band["sigmas"].get<double>(), 10);
  }
  auto const same = answer({"diff", folder / "a/run.h5", folder / "a/run.h5"});
  EXPECT_TRUE(same["models"].empty());
  for (auto const& band : same["results"]["bands"]) EXPECT_EQ(band["sigmas"], 0);
}

// Twice the motion of the same light is twice h (docs/theory/path_integral.md, eq. 1.3): the change is h, and so is its
// relative error. Control: errors taken as independent, sqrt(5) times too large.
TEST(Diff, SameHistoriesErrAlike) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  ASSERT_EQ(straytrace({"run", folder / "a.yaml", "-o", folder / "a", "--quiet"}).code, 0);
  std::string const bodies = baffle.substr(baffle.find("bodies:"), baffle.find("scene:") - baffle.find("bodies:"));
  write_text(folder / "more.yaml", "straytrace: 1\n" + edited(bodies, "1e-12 m", "2e-12 m"));
  Finished const more =
      straytrace({"noise", folder / "a/run.h5", "--motion", folder / "more.yaml", "-o", folder / "b", "--quiet"});
  ASSERT_EQ(more.code, 0) << more.err;
  auto const results = answer({"diff", folder / "a/run.h5", folder / "b/run.h5"})["results"];
  EXPECT_TRUE(results["same_histories"]);
  for (auto const& band : results["bands"]) {
    double const h = band["before"]["value"], error = band["before"]["sigma"];
    EXPECT_NEAR(band["after"]["value"].get<double>() / h, 2, 1e-3);
    EXPECT_NEAR(band["sigmas"].get<double>() / (h / error), 1, 0.2);
  }
}

// Shared spectra have h to a relative error of 5e-4: motion larger by 2e-5 is not a change, by 2 % it is, although
// both are of the same light. Control: what the errors of the light alone leave, 2e-5 h over 2e-5 sigma, some hundred
// sigmas.
TEST(Diff, ChangesBelowTheSpectraErrorAreNotReported) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  ASSERT_EQ(straytrace({"run", folder / "a.yaml", "-o", folder / "a", "--quiet"}).code, 0);
  std::string const bodies = baffle.substr(baffle.find("bodies:"), baffle.find("scene:") - baffle.find("bodies:"));
  auto const sigmas = [&](char const* asd) {
    write_text(folder / "more.yaml", "straytrace: 1\n" + edited(bodies, "1e-12 m", asd));
    EXPECT_EQ(straytrace({"noise", folder / "a/run.h5", "--motion", folder / "more.yaml", "-o", folder / asd}).code, 0);
    auto const results = answer({"diff", folder / "a/run.h5", folder / (std::string(asd) + "/run.h5")})["results"];
    EXPECT_TRUE(results["same_histories"]);
    double most = 0;
    for (char const* of : {"bands", "routes"})
      for (auto const& change : results[of])
        if (change["sigmas"].is_number()) most = std::fmax(most, std::fabs(change["sigmas"].get<double>()));
    return most;
  };
  EXPECT_EQ(sigmas("1.00002e-12 m"), 0);
  EXPECT_GT(sigmas("1.02e-12 m"), 10);
}

// A line below the band moves the baffle, and makes nothing in the band. Controls: the baffle still, and so much motion
// that it wraps into the band (phase 2k x 20 um).
TEST(Messages, ZeroNoiseStatesWhetherAnythingMoves) {
  Folder const folder;
  std::size_t const from = baffle.find("{power-law"), to = baffle.find("}}, others") + 2;
  auto const headline = [&](std::string const& motion) {
    std::string text = baffle;
    text.replace(from, to - from, motion);
    write_text(folder / "a.yaml", edited(text, "131072", "4096"));
    return straytrace({"run", folder / "a.yaml", "-o", folder / "a", "--quiet", "--force"}).out;
  };
  std::string const moves = "bodies on its routes move at other frequencies", still = "nothing on its routes moves";
  std::string const below = headline("{sine: {frequency: 1 Hz, amplitude: 1e-13 m peak}}");
  EXPECT_THAT(below, HasSubstr(moves));
  EXPECT_THAT(below, Not(HasSubstr(still)));
  EXPECT_THAT(headline("still"), HasSubstr(still));
  EXPECT_THAT(headline("{sine: {frequency: 1 Hz, amplitude: 2e-5 m peak}}"), HasSubstr("stray light h = "));
}

// 0.9 s of preparation, then a quarter in a second: three seconds are left. Control: preparation counted, half an hour.
TEST(Messages, TimeLeftIsThatOfTheWorkItself) {
  TimeLeft left;
  EXPECT_TRUE(std::isnan(left.at(0.9, 0.0005)));
  EXPECT_NEAR(left.at(1.9, 0.2505), 3, 0.01);
  EXPECT_GT(0.9 * (1 / 0.0005 - 1), 1700);
}

TEST(Messages, WarningsComeAsJsonWithTheirPlaces) {
  Folder const folder;
  write_text(folder / "a.yaml",
             edited(baffle, "  ITM: {motion: still}", "  ITM: {motion: still}\n  idle: {motion: still}"));
  Finished const f = straytrace({"check", folder / "a.yaml", "--format", "json"});
  EXPECT_EQ(f.code, 0);
  auto const told = nlohmann::json::parse(f.err);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0]["severity"], "warning");
  EXPECT_EQ(told[0]["line"], 6);
  EXPECT_EQ(told[0]["end_column"].get<int>(), told[0]["column"].get<int>() + told[0]["width"].get<int>());
  for (char const* key : {"file", "what", "suggestion"}) EXPECT_FALSE(told[0][key].empty()) << key;
}

TEST(Messages, MisuseHasOneFormOfMessage) {
  EXPECT_THAT(error_text({"run", virgo_arm, "--seed", "1", "--seed", "2", "-o", "x"}),
              HasSubstr("--seed appears 2 times\n  give it once"));
  EXPECT_THAT(error_text({"check", virgo_arm, "--format", "jsn"}), HasSubstr("did you mean 'json'?"));
  EXPECT_THAT(error_text({"noise", "run.h5", "--motion"}), HasSubstr("--motion needs a value"));
  EXPECT_THAT(error_text({"check"}), HasSubstr("'scene' is missing\n  write straytrace check scene"));
  EXPECT_THAT(error_text({"paths", "run.h5", "--show", "-3"}), HasSubstr("is not a whole number"));
  Folder const folder;
  write_text(folder / "m.yaml", "straytrace: 1\nbodys: {b: {motion: still}}\n");
  std::string const told = error_text({"check", folder / "m.yaml"});
  EXPECT_THAT(told, HasSubstr("did you mean 'bodies'?"));
  EXPECT_THAT(told, Not(HasSubstr("the scene has no beam")));
  write_text(folder / "v.yaml", "straytrace: 2\n");
  EXPECT_THAT(error_text({"check", "--migrate", folder / "v.yaml"}), HasSubstr("newer than this program"));
  EXPECT_THAT(straytrace({"check", "--migrate", virgo_arm}).out, HasSubstr("nothing to rewrite"));
}

// Points of a file, traced by two processes and one after the other: the same table; what differs is only who traced.
TEST(ScanJobs, TheSameBitsInAnyNumber) {
  Folder const folder;
  write_text(folder / "a.yaml", baffle);
  write_text(folder / "points.csv", "# three\nopening [cm]\n20\n21\n22\n");
  for (char const* jobs : {"1", "3"})
    ASSERT_EQ(straytrace({"scan", folder / "a.yaml", "--points", folder / "points.csv", "--jobs", jobs, "-o",
                          folder / jobs, "--quiet"})
                  .code,
              0);
  std::string const alone = text_of(folder / "1/scan.csv");
  EXPECT_EQ(text_of(folder / "3/scan.csv"), alone);
  EXPECT_THAT(alone, HasSubstr("21 cm,"));
  EXPECT_THAT(error_text({"scan", folder / "a.yaml", "--points", folder / "points.csv", "--jobs", "2"}),
              HasSubstr("name one with -o"));
  write_text(folder / "bad.csv", "opening [cm]\nwide\n20, 21\n");
  std::string const told = error_text({"scan", folder / "a.yaml", "--points", folder / "bad.csv"});
  EXPECT_THAT(told, HasSubstr(":2:1: error: 'wide' is not a number"));
  EXPECT_THAT(told, HasSubstr(":3:1: error: 2 values, but the header has 1 column"));
}

}  // namespace
}  // namespace straytrace::testing
