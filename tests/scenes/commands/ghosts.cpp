// SPDX-License-Identifier: BSD-3-Clause
// straytrace ghosts from the command line: the bench of the examples, a bench behind an end mirror, wrong input.
#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing::app_ghosts {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
std::string const bench = source_folder + "/examples/bench.yaml";

// A face that sends R back, 1 m behind an end mirror of transmission T, moving along z with a flat spectrum.
std::string const end_bench = R"(straytrace: 1
materials:
  hr: {specular: {reflect: 1 - 4 ppm, transmit: 4 ppm}, scatter: {model: lambertian, tis: 1e-9}}
  ar: {specular: {reflect: 0.1 %, transmit: 99.9 %}}
bodies:
  ITM: {motion: still}
  ETM: {motion: still}
  bench: {motion: {z: {power-law: {asd: 1e-12 m/sqrt(Hz), at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}, others: still}}
scene:
  - {name: ITM, shape: {cap: {curvature: 1/(1420 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],
     body: ITM, material: hr}
  - {name: ETM, shape: {cap: {curvature: 1/(1683 m), outer_radius: 17 cm}}, at: [0 m, 0 m, 3 km], facing: [0, 0, -1],
     body: ETM, material: hr}
  - {name: plate, shape: {cap: {curvature: 1/(1684 m), outer_radius: 0.3 m}}, at: [0 m, 0 m, 3001 m],
     facing: [0, 0, -1], body: bench, material: ar}
beams: {arm: {cavity: [ITM, ETM], power: 100 kW}}
ports: {ITM: {beam: arm, at: ITM}, ETM: {beam: arm, at: ETM}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %}
)";

json ghosts_of(std::string const& scene, Words words) {
  words.insert(words.begin(), {"ghosts", scene, "--format", "json", "--quiet"});
  Finished const done = straytrace(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return json::parse(done.out, nullptr, false);
}

TEST(GhostCommand, bench_is_listed_and_its_energy_balance_closes) {
  Finished const text = straytrace({"ghosts", bench, "--order", "2"});
  EXPECT_EQ(text.code, 0);
  for (char const* part : {"main > photodiode/sensor·land", "main > pick_off/back·R > pick_off/front·R > ",
                           "mitigation ranking", "Energy balance of 1 W", "32 of order 2"})
    EXPECT_THAT(text.out, HasSubstr(part));
  json const beam = ghosts_of(bench, {"--order", "2", "--show", "100"}).at(0);
  EXPECT_NEAR(beam["energy_balance"]["total"].get<double>(), 1, 1e-12);
  EXPECT_EQ(beam["ghosts"].size(), 42u);
  EXPECT_EQ(beam["count"], 41);
  Finished const csv = straytrace({"ghosts", bench, "--order", "2", "--csv", "--quiet"});
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 43);                            // a title and all rows
  EXPECT_EQ(csv.out, straytrace({"ghosts", bench, "--order", "2", "--csv", "--quiet"}).out);  // the same bits
}

// f = T R T (eq. 5.4) with the overlap of a face that nearly fits the wavefront; in the band where the phase rules,
// h = (lambda/4 pi L) sqrt(f) 2 k x (eq. 9.1, mean over the static phase, two arms).
TEST(GhostCommand, strain_of_a_face_behind_an_end_mirror) {
  Folder const folder;
  write_text(folder / "end.yaml", end_bench);
  json const beam = ghosts_of(folder / "end.yaml", {"--beam", "ETM", "--floor", "1e-22", "--by", "strain"}).at(0);
  json const& ghost = beam["ghosts"].at(1);  // the first is the main beam
  EXPECT_EQ(ghost["route"], "main > plate·R > ETM·T > cavity");
  double const f = ghost["recoupled"], k = 2 * M_PI / 1.064e-6;
  EXPECT_NEAR(f / (4e-6 * 4e-6 * 1e-3), 1, 2e-2);
  double const phase = 1.064e-6 / (4 * M_PI * 3000) * std::sqrt(f) * 2 * k * 1e-12;
  double const h = ghost["strain"]["100"];
  EXPECT_NEAR(h / phase, 1, 0.03);                                // radiation pressure adds a little in quadrature
  EXPECT_GT(ghost["strain"]["10"].get<double>(), 3 * phase);      // and much here
  EXPECT_NEAR(beam["strain"]["100"].get<double>() / h, 1, 1e-2);  // nothing else counts
  EXPECT_GT(std::fabs(h / (std::sqrt(2) * phase) - 1), 0.2);      // control: amplitudes of the two arms added
}

// The table `ghosts` includes them in a run, together with the scattered light and through the same noise stage.
TEST(GhostCommand, ghosts_are_routes_of_a_run) {
  Folder const folder;
  write_text(folder / "end.yaml", end_bench + "ghosts: {floor: 1e-22}\n");
  write_text(folder / "wrong.yaml", end_bench + "ghosts: {flor: 1e-22}\n");
  write_text(folder / "without.yaml", end_bench);
  EXPECT_EQ(straytrace({"trace", folder / "end.yaml", "-o", folder / "a.h5", "--histories", "4096", "--quiet"}).code,
            0);
  EXPECT_EQ(
      straytrace({"trace", folder / "without.yaml", "-o", folder / "b.h5", "--histories", "4096", "--quiet"}).code, 0);
  std::string const rows = straytrace({"paths", folder / "a.h5", "--csv"}).out;
  EXPECT_THAT(rows, HasSubstr("ghost"));
  EXPECT_THAT(rows, HasSubstr("ETM·T > plate·R > ETM·T"));
  EXPECT_THAT(straytrace({"paths", folder / "b.h5", "--csv"}).out,
              Not(HasSubstr("plate·R > ETM·T")));  // negative control
  Finished const wrong = straytrace({"check", folder / "wrong.yaml"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'floor'?"));
}

TEST(GhostCommand, writes_files) {
  Folder const folder;
  Finished const done =
      straytrace({"ghosts", bench, "--order", "1", "-o", folder / "out", "--quiet"}, {.picture = true});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(text_of(folder / "out/ghosts.txt"), done.out);
  EXPECT_EQ(json::parse(text_of(folder / "out/ghosts.json")).at(0)["beam"], "input");
  EXPECT_THAT(text_of(folder / "out/ghosts.csv"), HasSubstr("main > lens_1/front·R > "));
  EXPECT_GT(fs::file_size(folder / "out/ghosts.png"), 5000u);
}

// Ctrl-C leaves a valid part: the energy balance closes with what was not followed, and every row is whole.
TEST(GhostCommand, an_interrupted_run_is_valid) {
  Folder const folder;
  std::string scene =
      "straytrace: 1\nmaterials: {half: {specular: {reflect: 10 %, transmit: 90 %}}}\n"
      "bodies: {b: {motion: still}}\nscene:\n";
  for (int z = 1; z <= 8; ++z)
    scene += "  - {name: p" + std::to_string(z) + ", shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, " +
             std::to_string(z) + " m], facing: [0, 0, -1], body: b, material: half}\n";
  write_text(
      folder / "a.yaml",
      scene + "beams: {laser: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 50 mm}}\nreceivers: {D: {on: p8}}\n");
  Words const words{"ghosts", folder / "a.yaml", "--floor", "1e-30", "-o", folder / "out"};
  Program long_run(words);
  EXPECT_TRUE(long_run.says("ghosts  beam laser  table"));
  EXPECT_FALSE(fs::exists(folder / "out/ghosts.csv"));  // it appears complete or not at all
  long_run.interrupt();
  Finished const done = long_run.wait();
  EXPECT_EQ(done.code, 85) << done.err;
  EXPECT_THAT(done.out, HasSubstr("Stopped early: "));
  json const beam = json::parse(text_of(folder / "out/ghosts.json")).at(0);
  EXPECT_FALSE(beam["complete"]);
  EXPECT_NEAR(beam["energy_balance"]["total"].get<double>(), 1, 1e-10);
  double const stopped = beam["energy_balance"]["stopped"];
  EXPECT_GT(stopped, 0);
  EXPECT_LT(stopped, 1);
  std::string const csv = text_of(folder / "out/ghosts.csv");
  std::ptrdiff_t const order0 = 1;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), beam["count"].get<std::ptrdiff_t>() + order0 + 1);
  Finished const short_run = straytrace({"ghosts", folder / "a.yaml", "--order", "1", "--quiet"});  // negative control
  EXPECT_EQ(short_run.code, 0);
  EXPECT_THAT(short_run.out, Not(HasSubstr("Stopped early")));
}

// In bytes, of the rows of a table.
std::size_t widest_row(std::string const& text) {
  std::size_t widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find("main > ") != line.npos) widest = std::max(widest, line.size());
  return widest;
}

// Ways of many surfaces are cut short for people only; one of the main beam's ends is shown however many ghosts are.
TEST(GhostCommand, rows_are_for_people) {
  Finished const text = straytrace({"ghosts", bench, "--order", "2", "--show", "1", "--quiet"});
  EXPECT_THAT(text.out, HasSubstr("40 more ghosts; --show N has more rows."));
  EXPECT_THAT(text.out, HasSubstr("main > lens_1/front·R > box·land"));
  EXPECT_EQ(straytrace({"ghosts", bench, "--order", "0", "--quiet"}).code, 0);  // the main beam alone
  Finished const deep = straytrace({"ghosts", bench, "--floor", "1e-13", "--show", "2000", "--quiet"});
  EXPECT_THAT(deep.out, AllOf(HasSubstr("… > "), HasSubstr("…: steps of a long route that are left out here")));
  EXPECT_LT(widest_row(deep.out), 190u);  // of routes of up to 300 characters
  std::string const csv = straytrace({"ghosts", bench, "--floor", "1e-13", "--csv", "--quiet"}).out;
  EXPECT_THAT(csv, Not(HasSubstr("…")));
  EXPECT_GT(widest_row(csv), 300u);
}

TEST(GhostCommand, errors_state_a_remedy) {
  auto const says = [](Words const& words, std::string const& what, std::string const& remedy) {
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 2);
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr(what));
    EXPECT_THAT(done.err, HasSubstr(remedy));
  };
  says({"ghosts", bench, "--by", "strain"}, "--by strain needs h", "use --by recoupled");
  says({"ghosts", bench, "--beam", "inptu"}, "beam 'inptu' is not launched", "did you mean 'input'?");
  says({"ghosts", bench, "--floor", "0"}, "'0' is not a power ratio above 0", "write for example 1e-15");
  says({"ghosts", bench, "--show", "0"}, "'0' is not a whole number from 1", "write for example 50");
  says({"apertures", virgo_arm, "--show", "0"}, "'0' is not a whole number from 1", "write for example 20");
  says({"ghosts", bench, "--order", "two"}, "'two' is not a whole number", "write for example 2");
  says({"ghosts", bench, "--by", "size"}, "--by cannot be 'size'", "see straytrace ghosts --help");
  Folder const folder;
  write_text(folder / "even.yaml", edited(text_of(bench), "radius: waist,", "radius: waist, profile: even,"));
  says({"ghosts", folder / "even.yaml", "--quiet"}, "no Gaussian beam to launch", "leave its profile Gaussian");
}

}  // namespace
}  // namespace straytrace::testing::app_ghosts
