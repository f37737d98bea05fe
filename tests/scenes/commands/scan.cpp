// SPDX-License-Identifier: BSD-3-Clause
// straytrace scan: tables over parameters, runs kept by hash, requirements from a line.
#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing::app_scan {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

// The scene with few rings, motion as a parameter, and its own line: 10 / f^2 in units of 1e-30.
class Scan : public ::testing::Test {
 protected:
  Scan() {
    std::string text =
        edited(text_of(et_hf), "  rings: 1500", "  rings: 20\n  moves: 1e-15 m/sqrt(Hz)\n  black: 1e-4 /sr");
    text = edited(text, "asd: 1e-15 m/sqrt(Hz)", "asd: moves");
    text = edited(text, "brdf: 1e-4 /sr}", "brdf: black}");
    text = edited(text, "points_per_decade: 400}", "points_per_decade: 10}");
    text = edited(text, "band: [2.5 Hz", "compare: [line.txt], margin: 1, band: [2.5 Hz");
    write_text(scene, text);
    write_text(folder / "line.txt", "# frequency_Hz asd\n1 1e-27\n1000 1e-27\n");
  }
  Finished run(Words words) const {
    words.insert(words.begin(), {"scan", scene});
    words.insert(words.end(), {"--histories", "140000", "--quiet"});
    return straytrace(words);
  }
  Json json(Words words) const {
    words.insert(words.end(), {"--format", "json"});
    Finished const r = run(words);
    EXPECT_EQ(r.code, 0) << r.err;
    return Json::parse(r.out, nullptr, false);
  }

  Folder const folder;
  std::string const scene = folder / "arm.yaml";
};

std::string digits(double x) {
  std::ostringstream text;
  text.precision(12);
  text << x;
  return text.str();
}

double h(Json const& table, std::size_t point) { return table["points"][point]["strain"][0]["value"].get<double>(); }

TEST_F(Scan, TableOverParameters) {
  Json const j = json({"moves=1e-15 m/sqrt(Hz),2e-15 m/sqrt(Hz)", "black=1e-4/sr..4e-4/sr:2", "-o", folder / "out"});
  ASSERT_EQ(j["points"].size(), 4u);
  EXPECT_TRUE(j["complete"].get<bool>());
  // Linear coupling and one scatter on the rings: h ~ motion, h ~ sqrt(BRDF). Equal motion: the same light.
  EXPECT_NEAR(h(j, 1) / h(j, 0), 2, 0.05);
  EXPECT_NEAR(h(j, 2) / h(j, 0), 2, 1e-9);
  EXPECT_EQ(j["points"][0]["from"], "traced");
  EXPECT_EQ(j["points"][2]["from"], "same trace");
  EXPECT_EQ(j["points"][0]["model_hash"], j["points"][2]["model_hash"]);
  EXPECT_NE(j["points"][0]["model_hash"], j["points"][1]["model_hash"]);
  for (char const* name : {"scan.csv", "scan.json", "scan.txt"})
    EXPECT_TRUE(fs::exists(folder / "out/" + name)) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out/runs"), fs::directory_iterator()), 2);
  // The same command takes what is there, with the same numbers.
  Json const again =
      json({"moves=1e-15 m/sqrt(Hz),2e-15 m/sqrt(Hz)", "black=1e-4/sr..4e-4/sr:2", "-o", folder / "out"});
  EXPECT_EQ(again["points"][0]["from"], "stored");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(h(again, i), h(j, i));
  std::istringstream csv(text_of(folder / "out/scan.csv"));
  std::size_t rows = 0;
  for (std::string line; std::getline(csv, line);) rows += !line.starts_with('#');
  EXPECT_EQ(rows, 5u);
}

TEST_F(Scan, WrongWords) {
  struct {
    Words words;
    std::string says;
  } const wrong[] = {{{}, "nothing to scan"},
                     {{"black=1e-4/sr..4e-4/sr"}, "number of values"},
                     {{"black=1e-4/sr..4 cm:3"}, "same unit"},
                     {{"black=1e-4/sr..4e-4/sr:3:lg"}, "':3:lg' is not a number of values, with or without ':log'"},
                     {{"black=1,5e-4/sr..4e-4/sr:3"}, "write 'black=1.5e-4/sr..4e-4/sr:3'"},
                     {{"black=1e-999/sr..4e-4/sr:3"}, "a range runs from a number to a number"},
                     {{"=3"}, "does not name a parameter"},
                     {{"black=1e-4/sr,"}, "a value is missing"},
                     {{"black=1e-4/sr,2e-4/sr", "black=1e-3/sr"}, "given twice"},
                     {{"blck=1e-4/sr"}, "blck"},
                     {{"--invert", "colour(baffle)"}, "is not valid"},
                     {{"--invert", "brdf(bafle)"}, "did you mean 'baffle'?"},
                     {{"--invert", "motion(tube)"}, "body 'tube' does not exist"},
                     {{"--invert", "param(black)"}, "needs one search range"},
                     {{"--invert", "brdf(baffle)", "--margin", "much"}, "is not a margin"},
                     {{"--invert", "brdf(baffle)", "--margin", "1e999"}, "is not a margin"},
                     {{"--invert", "brdf(baffle)", "black=1e-4/sr"}, "with -p"},
                     {{"--invert", "brdf(baffle)", "--csv", "a.csv"}, "--invert does not go with --csv"},
                     {{"--invert", "brdf(nix)", "--margin", "much"}, "material that scatters 'nix' does not exist"},
                     {{"--invert", "brdf(nix)", "--margin", "much"}, "'much' is not a margin"},
                     {{"--invert", "colour(nix)", "--against", "adv-lol"}, "'colour(nix)' is not valid"},
                     {{"--invert", "colour(nix)", "--against", "adv-lol"}, "adv-lol"}};
  for (auto const& w : wrong) {
    Finished const r = run(w.words);
    EXPECT_EQ(r.code, 2) << w.says;
    EXPECT_THAT(r.err, HasSubstr(w.says));
  }
}

// The errors of words, parameters and options at once. Control: `black` alone is sound.
TEST_F(Scan, AllWrongWordsAreNamed) {
  Finished const r = run({"black=1e-4/sr,2e-4/sr", "blck=1,2", "bar", "--jobs", "2", "--margin", "much"});
  EXPECT_EQ(r.code, 2);
  for (char const* says :
       {"blck", "'bar' does not name a parameter", "--jobs needs a folder", "'much' is not a margin"})
    EXPECT_THAT(r.err, HasSubstr(says));
  EXPECT_EQ(run({"black=1e-4/sr,2e-4/sr"}).code, 0);
}

// All points are read before the first is traced, which would not end. Control: sound points are traced.
TEST_F(Scan, BadPointsAreToldBeforeAnyTrace) {
  Finished const bad =
      straytrace({"scan", scene, "rings=20,21,-5", "black=1e-4/sr,-2/sr", "--histories", "1e12", "-o", folder / "out"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("at the point rings=20, black=-2/sr; rings=21, black=-2/sr"));
  EXPECT_THAT(bad.err, HasSubstr("at the point rings=-5, black=1e-4/sr"));
  EXPECT_THAT(bad.err, Not(HasSubstr("scan  1 of")));
  EXPECT_FALSE(fs::exists(folder / "out"));
  write_text(folder / "points.csv", "rings\n20\n21\n-5\n");
  Finished const row = straytrace({"scan", scene, "--points", folder / "points.csv", "--histories", "1e12"});
  EXPECT_EQ(row.code, 2);
  EXPECT_THAT(row.err, HasSubstr("at the point rings=-5"));
  EXPECT_THAT(row.err, Not(HasSubstr("scan  1 of")));
  Finished const good = straytrace({"scan", scene, "rings=20,21", "--histories", "4096"});
  EXPECT_EQ(good.code, 0) << good.err;
  EXPECT_THAT(good.err, HasSubstr("scan  1 of 2"));
}

// One fault in all points is one error; another fault is another error.
TEST_F(Scan, AFaultOfAllPointsIsToldOnce) {
  auto const errors = [&](Words words) {
    words.insert(words.begin(), {"scan", scene});
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2);
    std::size_t n = 0;
    for (std::size_t at = r.err.find("error: "); at != r.err.npos; at = r.err.find("error: ", at + 1)) ++n;
    return std::pair(n, r.err);
  };
  auto const [units, said] = errors({"black=1e-4,2e-4,10e-4"});
  EXPECT_EQ(units, 1u) << said;
  EXPECT_THAT(said, HasSubstr("at the point black=1e-4; black=2e-4; black=10e-4"));
  write_text(folder / "points.csv", "black\n1e-4\n2e-4\n");
  EXPECT_EQ(errors({"--points", folder / "points.csv"}).first, 1u);
  EXPECT_EQ(errors({"black=1e-4,-2/sr"}).first, 2u);
}

// Without a design curve nothing is traced, which would not end. Control: with one, the search begins.
TEST_F(Scan, InvertNeedsALineBeforeAnyTrace) {
  Words words{"scan", et_hf, "--invert", "param(rings)", "rings=20..40"};
  auto const with = [&](Words const& more) {
    Words all = words;
    all.insert(all.end(), more.begin(), more.end());
    return straytrace(all);
  };
  Finished const bare = with({"--histories", "1e12"});
  EXPECT_EQ(bare.code, 2);
  EXPECT_THAT(bare.err, HasSubstr("there is no line to compare with\n  name a design curve, for example --against"));
  EXPECT_THAT(bare.err, Not(HasSubstr("scan  rings")));
  EXPECT_THAT(with({"--histories", "4096", "--against", "et-d"}).err, HasSubstr("scan  rings = 20"));
}

// The line at a factor of what the total is at its worst frequency.
TEST_F(Scan, RequirementsFromOneRun) {
  double const worst = json({"moves=1e-15 m/sqrt(Hz)"})["points"][0]["worst_ratio"]["value"].get<double>();
  std::string const margin = digits(worst / 2);
  auto const scale = [&](std::string const& what) {
    return json({"--invert", what, "--margin", margin})["answer"]["scale"].get<double>();
  };
  EXPECT_NEAR(scale("brdf(mirror)"), 0.5, 1e-4);     // h ~ beta: two scatters
  EXPECT_NEAR(scale("brdf(baffle)"), 0.25, 1e-4);    // h ~ sqrt(beta)
  EXPECT_NEAR(scale("motion(baffles)"), 0.5, 2e-3);  // linear
  Json const never = json({"--invert", "motion(mirror)", "--margin", margin});
  EXPECT_EQ(never["answer"]["verdict"], "never");
  EXPECT_EQ(json({"--invert", "motion(mirror)", "--margin", digits(2 * worst)})["answer"]["verdict"], "always");
  Finished const text = run({"--invert", "brdf(baffle)", "--margin", margin, "--per-frequency"});
  EXPECT_THAT(text.out, HasSubstr("Scattered share at normal incidence: 0.000314 now"));
  EXPECT_THAT(text.out, HasSubstr("largest factor"));
}

TEST_F(Scan, RequirementOfAParameterIsAnInterval) {
  double const worst = json({"moves=1e-15 m/sqrt(Hz)"})["points"][0]["worst_ratio"]["value"].get<double>();
  Json const j = json({"--invert", "param(moves)", "moves=0.1e-15 m/sqrt(Hz)..2e-15 m/sqrt(Hz)", "--margin",
                       digits(worst), "--tolerance", "0.2"})["answer"];
  EXPECT_EQ(j["verdict"], "found");
  EXPECT_EQ(j["complete"], true);
  EXPECT_LT(j["meets"].get<double>(), 1e-15);
  EXPECT_GT(j["exceeds"].get<double>(), 1e-15);
  EXPECT_EQ(json({"--invert", "param(moves)", "moves=0.1e-15 m/sqrt(Hz)..0.2e-15 m/sqrt(Hz)", "--margin",
                  digits(worst)})["answer"]["verdict"],
            "always");
}

// The first half falls on the line itself, where errors leave a doubt: both ends close in on it all the same. Control:
// an answer that ends at the first doubt is as wide as the range.
TEST_F(Scan, RequirementClosesInOnTheDoubtFromBothSides) {
  double const worst = json({"moves=1e-15 m/sqrt(Hz)"})["points"][0]["worst_ratio"]["value"].get<double>();
  Json const j = json({"--invert", "param(moves)", "moves=0.1e-15 m/sqrt(Hz)..1.9e-15 m/sqrt(Hz)", "--margin",
                       digits(worst)})["answer"];
  EXPECT_EQ(j["verdict"], "found");
  EXPECT_EQ(j["limited_by_errors"], true);
  EXPECT_LT(j["meets"].get<double>(), 1e-15);
  EXPECT_GT(j["exceeds"].get<double>(), 1e-15);
  EXPECT_LT(j["exceeds"].get<double>() - j["meets"].get<double>(), 0.3e-15) << "control: 1.8e-15";
}

// Most of the time of these points passes between the traces, where Ctrl-C must not lose the table
// (docs/reference/commands.md). A parameter of this length fills the page by which the program may be ahead of its
// reader with six points: it cannot end before it is interrupted, however late that is.
TEST_F(Scan, InterruptedBetweenTracesItResumesThere) {
  std::string const name = "black" + std::string(600, 'k');
  std::string const text = edited(text_of(scene), "  black: 1e-4 /sr", "  " + name + ": 1e-4 /sr");
  write_text(scene, edited(text, "brdf: black}", "brdf: " + name + "}"));
  Words const words{"scan", scene, name + "=1e-5 /sr..1e-3 /sr:40", "--histories", "4096", "-o", folder / "scan"};
  Program running(words, {.paced = true});
  ASSERT_TRUE(running.says("scan  4 of 40"));
  running.interrupt();
  Finished const stopped = running.wait();
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("same command"));
  Json const part = Json::parse(text_of(folder / "scan/scan.json"), nullptr, false);
  EXPECT_EQ(part["complete"], false);
  ASSERT_GE(part["points"].size(), 3u);
  Words again = words;
  again.insert(again.end(), {"--format", "json", "--quiet"});
  Finished const whole = straytrace(again);
  EXPECT_EQ(whole.code, 0) << whole.err;
  Json const table = Json::parse(whole.out, nullptr, false);
  EXPECT_EQ(table["complete"], true);
  ASSERT_EQ(table["points"].size(), 40u);
  EXPECT_EQ(table["points"][0]["strain"], part["points"][0]["strain"]);
}

TEST_F(Scan, AnInterruptedSearchPrintsItsInterval) {
  double const worst = json({"moves=1e-15 m/sqrt(Hz)"})["points"][0]["worst_ratio"]["value"].get<double>();
  Program running({"scan", scene, "--invert", "param(moves)", "moves=0.1e-15 m/sqrt(Hz)..1e-11 m/sqrt(Hz)", "--margin",
                   digits(worst), "--tolerance", "1e-5", "--histories", "140000", "-o", folder / "search"});
  ASSERT_TRUE(running.says("moves = 5.00005e-12"));  // the first after both ends, of a dozen
  running.interrupt();
  Finished const stopped = running.wait();
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.out, HasSubstr("Stopped before the requested width"));
  EXPECT_THAT(stopped.err, HasSubstr("same command"));
}

}  // namespace
}  // namespace straytrace::testing::app_scan
