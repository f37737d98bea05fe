// SPDX-License-Identifier: BSD-3-Clause
// straytrace optimise: least cost under a limit of the noise, against a scan of the same scene; what it writes.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/program.hpp"

namespace straytrace::testing::app_optimise {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

// Rings that scatter once: h ~ sqrt(brdf), and a line. The cost is that of blackness.
class Optimise : public ::testing::Test {
 protected:
  Optimise() {
    std::string text = edited(text_of(et_hf), "  rings: 1500", "  rings: 20\n  black: 1e-4 /sr\n  gap: 3 cm");
    text = edited(text, "brdf: 1e-4 /sr}", "brdf: black}");
    text = edited(text, "points_per_decade: 400}", "points_per_decade: 10}");
    text = edited(text, "band: [2.5 Hz", "compare: [line.txt], margin: 1, band: [2.5 Hz");
    text +=
        "optimise:\n  minimise: 1e-3 /sr / black + 0 * count(rings)\n  vary: {black: [1e-5 /sr, 1e-3 /sr]}\n"
        "  subject_to: [h_total < 1 x line.txt with 95 %]\n";
    write_text(scene, text);
    write_line(1);
  }
  // At a factor of 1 about twice the h of the scene.
  void write_line(double factor) const {
    std::string text = "# frequency_Hz asd\n";
    for (double const hz : {1.0, 10.0, 100.0, 1000.0})
      text += std::to_string(hz) + " " + Json(factor * 2.5e-31 * std::pow(hz / 10, -0.5)).dump() + "\n";
    write_text(folder / "line.txt", text);
  }
  Finished run(Words words, std::string const& out) const {
    words.insert(words.begin(), {"optimise", scene, "-o", folder / out});
    if (std::ranges::find(words, "--histories") == words.end()) words.insert(words.end(), {"--histories", "32768"});
    words.push_back("--quiet");
    return straytrace(words);
  }
  Json json(std::string const& out) const {
    return Json::parse(text_of(folder / out + "/optimise.json"), nullptr, false);
  }

  Folder const folder;
  std::string const scene = folder / "arm.yaml";
};

double number(std::string const& setting) { return std::stod(setting); }

TEST_F(Optimise, AgreesWithAScan) {
  Finished const r = run({"--histories", "131072"}, "out");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  Json const j = json("out");
  std::size_t const best = j["best"];
  Json const& searched = j["candidates"][j["finalists"][best]["candidate"].get<std::size_t>()];
  double const black = number(searched["settings"]["black"]), upper = searched["limits"][0]["upper"];
  EXPECT_LE(upper, 1);
  EXPECT_GT(upper, 0.98);  // it binds
  // Brute force, with the same seed: h^2 ~ black, so the largest that meets the line follows from any point of a scan.
  Json const scan = Json::parse(straytrace({"scan", scene, "black=1e-5/sr..1e-3/sr:9:log", "--histories", "131072",
                                            "--quiet", "--format", "json"})
                                    .out);
  Json const& limit = searched["limits"][0];
  double const q = limit["standard_errors"];
  for (Json const& point : scan["points"]) {
    double const ratio = point["worst_ratio"]["value"], sigma = point["worst_ratio"]["sigma"];
    double const own = number(point["settings"]["black"]);
    double const allowed = own * std::pow(ratio + q * sigma, -2);
    EXPECT_NEAR(black / allowed, 1, 0.05);
    bool const meets = ratio + q * sigma <= 1;
    EXPECT_LE(meets ? own : 0, black * 1.001);  // none that meets the line is cheaper
  }
  EXPECT_EQ(j["finalists"][best]["verdict"], "met");
  // The cost is 1e-3/black and h^2 ~ black: d cost/d ln limit = -2 cost (eq. O.9).
  double const price = j["finalists"][best]["prices_of_limits"][0]["per_ln_limit"];
  EXPECT_NEAR(price / searched["objective"].get<double>(), -2, 0.1);
  double const sigma = j["finalists"][best]["prices_of_limits"][0]["sigma"];
  EXPECT_GT(sigma, 0);  // the traces differ by more than a factor
  EXPECT_LT(sigma, -0.1 * price);
  EXPECT_THAT(r.out, HasSubstr("; 1 % more of it lowers the cost by about "));
  EXPECT_EQ(j["finalists"][best]["seed"], 2 + best);
  EXPECT_EQ(j["finalists"][best]["histories"].get<double>() / searched["histories"].get<double>(), 4);
  for (char const* file : {"best.yaml", "best/run.h5", "optimise.txt", "optimise.json", "candidates.csv"})
    EXPECT_TRUE(fs::exists(folder / "out/" + file)) << file;
  EXPECT_EQ(straytrace({"check", folder / "out/best.yaml"}).code, 0);
  EXPECT_EQ(straytrace({"noise", folder / "out/best/run.h5"}).code, 0);
}

// Negative control of the limit: a line ten times as high leaves the cheapest end of the range.
TEST_F(Optimise, AHighLineLeavesTheEndOfTheRange) {
  write_line(30);
  Finished const r = run({}, "high");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("'black' is at the upper end of its range"));
}

TEST_F(Optimise, NoneMeetsTheLine) {
  write_line(1e-3);
  Finished const r = run({}, "low");
  EXPECT_EQ(r.code, 4) << r.err;
  EXPECT_THAT(r.out, HasSubstr("meets the limits. The closest: black=1e-05"));
  EXPECT_TRUE(json("low")["best"].is_null());
  EXPECT_FALSE(fs::exists(folder / "low/best.yaml"));
  // The answer to another question stays. Control: --force.
  std::string const before = text_of(folder / "low/optimise.json");
  Finished const other = run({"--subject", "h_total < 0.9 x line with 95 %"}, "low");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("contains the answer to another question ('limits')"));
  EXPECT_EQ(text_of(folder / "low/optimise.json"), before);
  EXPECT_EQ(run({"--subject", "h_total < 0.9 x line with 95 %", "--force"}, "low").code, 4);
}

TEST_F(Optimise, SameBitsForThreadsAndAfterAStop) {
  ASSERT_EQ(run({"--threads", "1"}, "one").code, 0);
  ASSERT_EQ(run({"--threads", "2"}, "two").code, 0);
  EXPECT_EQ(run({"--max-time", "0.001s"}, "cut").code, 85);
  EXPECT_EQ(run({"--max-time", "0.001s"}, "cut").code, 85);
  ASSERT_EQ(run({}, "cut").code, 0);
  for (char const* file : {"candidates.csv", "optimise.json"}) {
    EXPECT_EQ(text_of(folder / "one/" + file), text_of(folder / "two/" + file));
    EXPECT_EQ(text_of(folder / "one/" + file), text_of(folder / "cut/" + file));
  }
  ASSERT_EQ(run({"--seed", "5"}, "other").code, 0);  // control: another seed, other numbers
  EXPECT_NE(text_of(folder / "one/candidates.csv"), text_of(folder / "other/candidates.csv"));
}

TEST_F(Optimise, ListsWithPrices) {
  std::string const text = text_of(scene);
  write_text(scene, edited(edited(text, "1e-3 /sr / black + 0 * count(rings)", "price(black)"), "[1e-5 /sr, 1e-3 /sr]",
                           "{values: [1e-3 /sr, 1e-5 /sr, 3e-6 /sr], price: [1, 4, 9]}"));
  ASSERT_EQ(run({}, "list").code, 0);
  Json const j = json("list");
  EXPECT_EQ(j["finalists"][j["best"].get<std::size_t>()]["settings"]["black"], "1e-5 /sr");
  EXPECT_EQ(j["candidates"].size(), 3u);
}

// A relation that fails is not traced. Control: without it the point is.
TEST_F(Optimise, RelationsBeforeTraces) {
  Words const range{"--vary", "black=1e-5/sr..1e-3/sr", "--minimise", "h_total"};
  Words bound = range;
  bound.insert(bound.end(), {"--subject", "black > 2e-5 /sr", "--subject", "gap > 1 cm"});
  ASSERT_EQ(run(bound, "bound").code, 0);
  Json const j = json("bound");
  double lowest = 1;
  for (Json const& c : j["candidates"])
    if (c["traced"]) lowest = std::min(lowest, number(c["settings"]["black"]));
  EXPECT_GE(lowest, 2e-5);
  EXPECT_LT(lowest, 2.2e-5);
  Words counted = range;  // 20 rings are not fewer than 20
  counted.insert(counted.end(), {"--subject", "count(rings) < 20"});
  EXPECT_EQ(run(counted, "counted").code, 4);
  counted.back() = "count(rings) <= 20";
  EXPECT_EQ(run(counted, "equal").code, 0);
  Words none = range;
  none.insert(none.end(), {"--subject", "gap > 1 cm"});
  ASSERT_EQ(run(none, "none").code, 0);
  EXPECT_THAT(text_of(folder / "none/candidates.csv"), HasSubstr("1e-05 /sr"));
}

// A material is chosen by its place, and best.yaml sets it there.
TEST_F(Optimise, MaterialsByPlace) {
  std::string text =
      edited(text_of(scene), "materials:\n", "materials:\n  dark: {scatter: {model: lambertian, brdf: 1e-6 /sr}}\n");
  text = edited(text, "1e-3 /sr / black + 0 * count(rings)", "price(scene.rings.material)");
  text = edited(text, "black: [1e-5 /sr, 1e-3 /sr]",
                "scene.rings.material: {values: [baffle, dark, drak], price: [1, 4, 9]}");
  write_text(scene, text);
  write_line(0.3);  // baffle, with its BRDF of 1e-4 /sr, misses it
  ASSERT_EQ(run({}, "place").code, 0);
  Json const j = json("place");
  EXPECT_EQ(j["finalists"][j["best"].get<std::size_t>()]["settings"]["scene.rings.material"], "dark");
  EXPECT_EQ(j["finalists"][j["best"].get<std::size_t>()]["objective"], 4);
  EXPECT_THAT(text_of(folder / "place/best.yaml"), HasSubstr("set:\n  scene.rings.material: dark\n"));
  Finished const read = straytrace({"print", folder / "place/best.yaml"});
  EXPECT_EQ(read.code, 0) << read.err;
  EXPECT_THAT(read.out, ::testing::ContainsRegex("material: dark"));
  std::string const page = text_of(folder / "place/optimise.html");
  for (char const* says : {"Best: scene.rings.material=dark", "Cost 4", "Traced anew", "&#39;drak&#39; is not defined"})
    EXPECT_THAT(page, HasSubstr(says));
  write_line(1);  // control: here it meets the line, and is cheaper
  ASSERT_EQ(run({}, "cheap").code, 0);
  EXPECT_THAT(text_of(folder / "cheap/best.yaml"), HasSubstr("scene.rings.material: baffle"));
}

// Rings of radii R/sqrt(q) and R sqrt(q): pi R^2 (q - 1/q) each.
TEST_F(Optimise, AreasAndPowers) {
  Words words{"--minimise", "area(rings)", "--vary", "gap=1cm..2cm"};
  double const q = std::exp(std::log((10e3 - 32.35) / 5e3) / 20), area = 20 * std::numbers::pi * 0.25 * (q - 1 / q);
  write_text(scene, edited(text_of(scene), "radius: 0.2 mm,", "radius: 0.2 mm, power: 100 kW,"));
  auto const limited = [&](std::string const& limit, std::string const& out) {
    Words all = words;
    all.insert(all.end(), {"--subject", limit});
    return run(all, out);
  };
  Finished const high = limited("power(rings) < 1 kW with 90 %", "high");
  ASSERT_EQ(high.code, 0) << high.out << high.err;
  Json const j = json("high");
  Json const& best = j["candidates"][j["finalists"][0]["candidate"].get<std::size_t>()];
  EXPECT_NEAR(best["objective"].get<double>() / area, 1, 1e-9);
  // The same light as the report of the run states.
  std::string const run_file = folder / "high/best/run.h5";
  Json const paths = Json::parse(straytrace({"noise", run_file, "--format", "json"}).out, nullptr, false);
  Json const& fresh = j["finalists"][0];
  double watts = 0;
  for (Json const& object : paths["objects"])
    if (object["name"] == "rings") watts = 100e3 * object["arriving"]["value"].get<double>();
  EXPECT_GT(watts, 0);
  EXPECT_NEAR(fresh["limits"][0]["ratio"]["value"].get<double>() * 1e3 / watts, 1, 1e-9);
  EXPECT_EQ(limited(fmt::format("power(rings) < {} W", 0.9 * watts), "low").code, 4);  // control
  Finished const wrong = limited("power(ring) < 1 m", "wrong");
  EXPECT_EQ(wrong.code, 2);
  for (char const* says : {"did you mean 'rings'?", "not a power"}) EXPECT_THAT(wrong.err, HasSubstr(says));
  write_text(scene, edited(text_of(scene), " power: 100 kW,", ""));
  EXPECT_THAT(limited("power(rings) < 1 kW", "none").err, HasSubstr("no beam of the scene states its power"));
}

TEST_F(Optimise, WrongWords) {
  struct {
    Words words;
    std::string says;
  } const wrong[] = {{{"--vary", "blck=1/sr..2/sr"}, "did you mean 'black'?"},
                     {{"--vary", "black=2e-5/sr..1e-5/sr"}, "does not go from a lower to a higher value"},
                     {{"--vary", "black=2e-5/sr..1e-5/sr"}, "write for example rim=30cm..49cm"},
                     {{"--minimise", "h_total +"}, "write h_total alone"},
                     {{"--subject", "h_totl < 0.1 x line with 95 %"}, "did you mean 'h_total'?"},
                     {{"--vary", "gap=1cm-2cm"}, "is one value, not a range"},
                     {{"--vary", "black=1e-5/sr..1 m"}, "is a BRDF (1/sr), not a length"},
                     {{"--vary", "gap=1..2"}, "'gap' is a length, but its range is a plain number"},
                     {{"--vary", "rings=1.5..3:integer"}, "does not end at whole numbers"},
                     {{"--vary", "=3..4"}, "does not name a parameter"},
                     {{"--minimise", "count(ring)"}, "did you mean 'rings'?"},
                     {{"--minimise", "cuont(rings)"}, "did you mean 'count'?"},
                     {{"--minimise", "price(gap)"}, "no varied parameter 'gap' has prices"},
                     {{"--subject", "h_total < 0.1"}, "'0.1' is not a curve"},
                     {{"--subject", "h_total < 0.1 x lin.txt"}, "did you mean 'line.txt'?"},
                     {{"--subject", "h_total < line between 1 m and 2 m"}, "not a frequency"},
                     {{"--subject", "h_total < line with 120 %"}, "between 50 % and 99.9 %"},
                     {{"--subject", "gap > 3 s"}, "compares"},
                     {{"--subject", "gap"}, "is not a limit"},
                     {{"--pareto", "--minimise", "h_total"}, "--pareto needs a cost"}};
  for (auto const& w : wrong) {
    Finished const r = run(w.words, "wrong");
    EXPECT_EQ(r.code, 2) << w.says << r.out;
    EXPECT_THAT(r.err, HasSubstr(w.says));
    EXPECT_FALSE(fs::exists(folder / "wrong"));
  }
  // All at once, of table and options, with their places.
  std::string const text = text_of(scene);
  write_text(scene, edited(edited(text, "count(rings)", "count(rngs)"), "with 95 %", "wth 95 %"));
  Finished const r = run({"--vary", "blck=1/sr..2/sr"}, "wrong");
  EXPECT_EQ(r.code, 2);
  for (char const* says : {"arm.yaml:", "did you mean 'rings'?", "is not a limit", "did you mean 'black'?"})
    EXPECT_THAT(r.err, HasSubstr(says));
  EXPECT_EQ(straytrace({"check", scene}).code, 2);
}

}  // namespace
}  // namespace straytrace::testing::app_optimise
