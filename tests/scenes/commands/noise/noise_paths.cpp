// SPDX-License-Identifier: BSD-3-Clause
// Results computed from a run without tracing: noise with its own or other motion, and the table of routes.
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_noise_paths {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using Curve = std::vector<std::vector<double>>;  // rows of h_asd.txt
Curve curve_in(std::string const& file) {
  Curve curve;
  std::istringstream in(text_of(file));
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    curve.emplace_back();
    for (std::string word; words >> word;) curve.back().push_back(std::stod(word));
  }
  return curve;
}

// Largest relative difference of h_mean; infinite for curves that cannot be compared.
double difference(Curve const& a, Curve const& b) {
  if (a.empty() || a.size() != b.size()) return infinity;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].size() != 17 || a[i][0] != b[i][0] || !(a[i][1] > 0)) return infinity;
    largest = std::max(largest, std::fabs(a[i][1] / b[i][1] - 1));
  }
  return largest;
}

// Fields of a CSV line; quoted fields may hold commas.
Words fields(std::string const& line) {
  Words all{""};
  bool quoted = false;
  for (char const c : line)
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      all.emplace_back();
    else
      all.back() += c;
  return all;
}

// Titles of paths.csv; leaves `in` at the first row.
Words titles_of(std::istringstream& in) {
  std::string line;
  while (std::getline(in, line) && line.starts_with('#')) {
  }
  return fields(line);
}

// Names of columns with any frequency written as 10 Hz.
std::set<std::string> at_10_hz(Words const& names) {
  std::set<std::string> all;
  for (std::string const& name : names) all.insert(std::regex_replace(name, std::regex("[0-9]+Hz"), "10Hz"));
  return all;
}

// Columns of paths.csv in the table of docs/reference/run_file.md: the words in code font of the first cell of each
// row.
Words documented_columns() {
  std::string const page = text_of(source_folder + "/docs/reference/run_file.md");
  std::size_t const begin = page.find("\n## paths.csv"), end = page.find("\n## ", begin + 1);
  std::istringstream in(page.substr(begin, end - begin));
  std::regex const code("`([A-Za-z0-9_]+)`");
  Words all;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("| `")) continue;
    std::string const cell = line.substr(0, line.find(" | "));
    for (std::sregex_iterator i(cell.begin(), cell.end(), code); i != std::sregex_iterator(); ++i)
      all.push_back((*i)[1]);
  }
  return all;
}

// Sum of a column of paths.csv over the resolved rows.
double column_sum(std::string const& csv, std::string const& title) {
  std::istringstream in(csv);
  std::string line;
  Words const titles = titles_of(in);
  auto const at = std::size_t(std::find(titles.begin(), titles.end(), title) - titles.begin());
  if (at == titles.size()) return not_a_number;
  double sum = 0;
  while (std::getline(in, line)) {
    Words const row = fields(line);
    if (row.size() != titles.size()) return not_a_number;
    if (double const x = std::stod(row[at]); !std::isnan(x)) sum += x;
  }
  return sum;
}

void expect_shares(std::string const& run_file) {
  Finished const csv = straytrace({"paths", run_file, "--csv"});
  EXPECT_EQ(csv.code, 0);
  EXPECT_NEAR(column_sum(csv.out, "share_percent"), 100, 1e-9);
  EXPECT_GT(std::fabs(column_sum(csv.out, "effective_scores") - 100), 1);  // negative control: another column
  std::istringstream lines(csv.out);
  Words const titles = titles_of(lines);
  EXPECT_EQ(at_10_hz(titles), at_10_hz(documented_columns()));
  EXPECT_NE(at_10_hz(Words(titles.begin() + 1, titles.end())), at_10_hz(documented_columns()));  // control: one less
  Finished const text = straytrace({"paths", run_file, "--format", "json"});
  auto const json = nlohmann::json::parse(text.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << text.out;
  double sum = 0;
  for (auto const& route : json["routes"])
    if (route["resolved"]) sum += route["share"]["value"].get<double>();
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_GE(json["routes"].size(), 4u);
  EXPECT_EQ(straytrace({"paths", run_file, "--show", "1"}).code, 0);
}

void expect_other_motion(Folder const& folder, Curve const& own) {
  std::string const run = folder / "run/run.h5";
  ASSERT_EQ(straytrace({"noise", run, "--motion", storm, "-o", folder / "storm"}).code, 0);
  Curve const loud = curve_in(folder / "storm/h_asd.txt");
  EXPECT_GT(difference(loud, own), 0.5);  // also the control of the equality of curves
  // The file that was written remembers its motion.
  ASSERT_EQ(straytrace({"noise", folder / "storm/run.h5", "-o", folder / "again"}).code, 0);
  EXPECT_LT(difference(curve_in(folder / "again/h_asd.txt"), loud), 1e-12);
  EXPECT_EQ(data_hash(folder / "again/run.h5"), data_hash(folder / "storm/run.h5"));

  struct {
    std::string from, to, says;
  } const wrong[] = {{"  towers: {motion: still}\n", "", "body 'towers' has no motion"},
                     {"width: 0.08 Hz", "width: 0.08", "without a unit"},
                     {"exponent: -2", "exponnent: -2", "did you mean 'exponent'?"}};
  for (auto const& w : wrong) {
    write_text(folder / "m.yaml", edited(text_of(storm), w.from, w.to));
    Finished const r = straytrace({"noise", run, "--motion", folder / "m.yaml", "-o", folder / "none"});
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.err, HasSubstr(w.says));
    EXPECT_FALSE(fs::exists(folder / "none"));
  }
  write_text(folder / "m.yaml", "straytrace: 1\ntitle: nothing\n");
  EXPECT_THAT(straytrace({"noise", run, "--motion", folder / "m.yaml"}).err, HasSubstr("this file replaces nothing"));
  EXPECT_EQ(straytrace({"noise", run, "--motion", folder / "absent.yaml"}).code, 2);
  // A file with the name of one the run holds would take its place.
  write_text(folder / "virgo_arm.yaml", text_of(storm));
  Finished const clash = straytrace({"noise", run, "--motion", folder / "virgo_arm.yaml", "-o", folder / "none"});
  EXPECT_EQ(clash.code, 2);
  EXPECT_THAT(clash.err, HasSubstr("rename the new file"));
}

TEST(NoiseAndPaths, OfOneRun) {
  Folder const folder;
  std::string const run = folder / "run/run.h5";
  ASSERT_EQ(straytrace({"run", virgo_arm, "-o", folder / "run", "--histories", "280000"}).code, 0);
  Curve const own = curve_in(folder / "run/h_asd.txt");
  EXPECT_EQ(own.size(), 138u);  // 60 per decade from 5 Hz to 1 kHz

  Finished const r = straytrace({"noise", run, "-o", folder / "noise"});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("without tracing"));
  EXPECT_LT(difference(curve_in(folder / "noise/h_asd.txt"), own), 1e-12);
  EXPECT_EQ(data_hash(folder / "noise/run.h5"), data_hash(run));
  auto const json = nlohmann::json::parse(straytrace({"noise", run, "--format", "json"}).out, nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["total_strain"].size(), 3u);

  expect_other_motion(folder, own);
  expect_shares(run);
  Finished const outside = straytrace({"paths", run, "--band", "1.5 kHz..2 kHz"});
  EXPECT_EQ(outside.code, 2);
  EXPECT_THAT(outside.err, HasSubstr("--band: the noise of the run covers 5 to"));
  EXPECT_EQ(straytrace({"paths", run, "--band", "900 Hz..2 kHz"}).code, 0);  // negative control
}

// A coupling table alone, and noise from it: the same as both at once.
TEST(NoiseAndPaths, TraceThenNoiseIsRun) {
  Folder const folder;
  Words const how{"-p", "rings=40", "--histories", "200000"};
  auto const with = [&](Words words) {
    words.insert(words.end(), how.begin(), how.end());
    return straytrace(words);
  };
  ASSERT_EQ(with({"run", et_hf, "-o", folder / "run"}).code, 0);
  ASSERT_EQ(with({"trace", et_hf, "-o", folder / "table.h5"}).code, 0);
  EXPECT_FALSE(read_run(folder / "table.h5").noise);
  EXPECT_EQ(straytrace({"paths", folder / "table.h5"}).code, 0);
  ASSERT_EQ(straytrace({"noise", folder / "table.h5", "-o", folder / "noise"}).code, 0);
  EXPECT_EQ(data_hash(folder / "noise/run.h5"), data_hash(folder / "run/run.h5"));
  EXPECT_NE(data_hash(folder / "table.h5"), data_hash(folder / "run/run.h5"));
}

// By route: the body that moves it most, and its phase sensitivity in rad/m.
std::map<std::string, std::pair<std::string, double>> moved_by(Words const& words) {
  std::map<std::string, std::pair<std::string, double>> all;
  auto const json = nlohmann::json::parse(straytrace(words).out, nullptr, false);
  EXPECT_TRUE(json.is_object());
  for (auto const& route : json["routes"]) {
    if (route["resolved"] && route["phase_sensitivity_rad_per_m"].is_number())
      all[route["id"]] = {route["moving_body"], route["phase_sensitivity_rad_per_m"]};
  }
  return all;
}

// A run that was projected with another motion is read with that motion by every command: here only mirrors move.
TEST(NoiseAndPaths, NameTheBodyOfTheMotionThatWasProjected) {
  Folder const folder;
  std::string const run = folder / "run.h5", other = folder / "other.h5";
  ASSERT_EQ(straytrace({"run", virgo_arm, "-o", run, "--histories", "140000"}).code, 0);
  write_text(folder / "mirrors.yaml",
             "straytrace: 1\nbodies:\n"
             "  ITM:\n    motion:\n"
             "      z: {power-law: {asd: 1e-13 m/sqrt(Hz), at: 1 Hz, exponent: -2, from: 1 Hz, to: 2 kHz}}\n"
             "      others: still\n"
             "  ETM: {motion: still}\n  tube: {motion: still}\n  towers: {motion: still}\n");
  ASSERT_EQ(straytrace({"noise", run, "--motion", folder / "mirrors.yaml", "-o", other}).code, 0);
  auto const projected = moved_by({"noise", other, "--format", "json"});
  ASSERT_GE(projected.size(), 4u);
  EXPECT_EQ(moved_by({"paths", other, "--format", "json"}), projected);
  EXPECT_EQ(moved_by({"run", other, "-o", folder / "again.h5", "--format", "json"}), projected);
  auto const names_mirror = [](auto const& all) {
    return std::all_of(all.begin(), all.end(), [](auto const& route) { return route.second.first == "ITM"; });
  };
  EXPECT_TRUE(names_mirror(projected));
  EXPECT_THAT(straytrace({"explain", "h", other, "--path", "1"}).out, HasSubstr("moved by ITM"));
  // Control: with the motion of the scene it is the tube, with phase sensitivities unlike those of a mirror.
  EXPECT_FALSE(names_mirror(moved_by({"paths", run, "--format", "json"})));
  EXPECT_NE(moved_by({"paths", run, "--format", "json"}), projected);
}

// A wall that shakes at 10 Hz and nowhere else: the bin of the line has its power (closed form of docs/theory/arm.md,
// eq. 8.10: 1.3025e-24/sqrt(2) rms for one hit, more hits add), all others have none. Control: the bin below.
TEST(NoiseAndPaths, ALineIsReadFromItsBin) {
  Folder const folder;
  Finished const r = straytrace({"run", source_folder + "/examples/arm_tube.yaml", "-o", folder / "run", "--quiet"});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("; at 10 Hz a line of "));
  EXPECT_THAT(r.out, Not(HasSubstr("h = 0 ")));
  Curve const curve = curve_in(folder / "run/h_asd.txt");
  std::size_t i = 0;
  while (i < curve.size() && curve[i][1] == 0) ++i;
  ASSERT_LT(i + 1, curve.size());
  EXPECT_EQ(curve[i + 1][1], 0);
  auto const json = nlohmann::json::parse(straytrace({"noise", folder / "run/run.h5", "--format", "json"}).out);
  auto const& at_10 = json["total_strain"][0];
  EXPECT_NEAR(at_10["value"].get<double>() / curve[i][1], 1, 1e-8);
  double const rms = at_10["line_rms"]["value"],
               width = at_10["line_rms"]["bin_Hz"][1].get<double>() - at_10["line_rms"]["bin_Hz"][0].get<double>();
  EXPECT_NEAR(rms, at_10["value"].get<double>() * std::sqrt(width), 1e-9 * rms);
  EXPECT_GT(rms, 1.3025e-24 / std::sqrt(2));
  EXPECT_LT(rms, 1.5 * 1.3025e-24 / std::sqrt(2));
  Finished const budget = straytrace({"budget", folder / "run/run.h5", "--at", "10 Hz", "--format", "json"});
  EXPECT_THAT(budget.out, HasSubstr(at_10["value"].dump().substr(0, 8))) << budget.err;
  EXPECT_EQ(curve[i - 1][1], 0);  // negative control
}

TEST(NoiseAndPaths, OfASceneNameTheCommandForARun) {
  for (Words const& words :
       {Words{"paths", virgo_arm}, Words{"noise", virgo_arm}, Words{"explain", "h", virgo_arm},
        Words{"couple", "predict", virgo_arm, "--body", "tube"}, Words{"maps", virgo_arm, "-o", "m"}}) {
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2) << words[0];
    EXPECT_THAT(r.err, HasSubstr("trace it first: straytrace run " + virgo_arm)) << words[0];
  }
  EXPECT_THAT(straytrace({"paths", source_folder + "/README.md"}).err,
              Not(HasSubstr("trace it first")));  // negative control
}

}  // namespace
}  // namespace straytrace::testing::app_noise_paths
