// SPDX-License-Identifier: BSD-3-Clause
// straytrace library, and the examples that are written on it.
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(LibraryCommand, ListsAndPrints) {
  Finished const all = straytrace({"library", "--format", "json"});
  ASSERT_EQ(all.code, 0) << all.err;
  auto const list = nlohmann::json::parse(all.out);
  for (auto const& e : list) {
    EXPECT_FALSE(e["text"].get<std::string>().empty()) << e["name"];
    if (e["kind"] != "material" || e["include"] == "library/materials/end_bench_2018.yaml") continue;
    EXPECT_NE(e["status"], "") << e["name"] << " says how far it can be trusted";
    EXPECT_NE(e["source"], "") << e["name"] << " says where it is from";
  }
  Finished const one = straytrace({"library", "oxidised_steel"});
  EXPECT_THAT(one.out, HasSubstr("# include: [library/materials/metals.yaml]\n  oxidised_steel:\n"));
  EXPECT_THAT(one.out, HasSubstr("LIGO-L1100197"));
  EXPECT_THAT(one.out, Not(HasSubstr("ar_steel")));
  EXPECT_THAT(straytrace({"library", "oxydised_steel"}).err, HasSubstr("did you mean 'oxidised_steel'?"));
  EXPECT_EQ(straytrace({"library", "oxydised_steel"}).code, 2);
  EXPECT_THAT(straytrace({"library", "--kind", "detector"}).out, HasSubstr("16 numbers, 2 assumed"));
}

TEST(LibraryCommand, CopiesAndTheCopyIsUsed) {
  Folder const folder;
  ASSERT_EQ(straytrace({"library", "oxidised_steel", "--copy", folder.path()}).code, 0);
  std::string const copy = folder / "library/materials/metals.yaml";
  Finished const again = straytrace({"library", "--copy", folder.path()});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("metals.yaml' exists"));
  EXPECT_FALSE(fs::exists(folder / "library/arm.yaml")) << "all files or none";
  std::string text = text_of(copy);
  write_text(copy, text.replace(text.find("1e-2 /sr"), 8, "5e-2 /sr"));
  write_text(folder / "a.yaml",
             "straytrace: 1\ninclude: [library/materials.yaml]\nmaterials: {m: {like: steel_ebonol}}\n");
  EXPECT_THAT(straytrace({"inspect", "m", folder / "a.yaml"}).out, HasSubstr("[0.001, 0.003, 0.05] /sr"));
  // --force replaces a copy, edited or not, but no file of another kind.
  write_text(folder / "library/arm.yaml", "notes of mine\n");
  Finished const other = straytrace({"library", "--copy", folder.path(), "--force"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("arm.yaml' exists and is not a file of the library"));
  EXPECT_EQ(text_of(folder / "library/arm.yaml"), "notes of mine\n");
  EXPECT_EQ(text_of(copy), text) << "all files or none";
  fs::remove(folder / "library/arm.yaml");
  EXPECT_EQ(straytrace({"library", "--copy", folder.path(), "--force"}).code, 0);
  EXPECT_NE(text_of(copy), text);
}

std::string hash_of(Words words) {
  words.insert(words.begin(), "check");
  words.insert(words.end(), {"--format", "json"});
  return nlohmann::json::parse(straytrace(words).out)["model_hash"];
}

// The example on the library and the arm written out are one model, and its run file needs no library.
TEST(LibraryExamples, VirgoArmIsTheArmWrittenOut) {
  EXPECT_EQ(hash_of({virgo_arm}), hash_of({written_arm}));
  EXPECT_NE(hash_of({virgo_arm, "-p", "rim=49.4cm"}), hash_of({written_arm})) << "negative control";
  Folder const folder;
  std::string const first = folder / "first", again = folder / "again";
  ASSERT_EQ(straytrace({"run", virgo_arm, "-o", first, "--histories", "4096", "--quiet"}).code, 0);
  Finished const made = straytrace({"run", first + "/run.h5", "-o", again, "--quiet"}, {folder.path()});
  ASSERT_EQ(made.code, 0) << made.err;
  std::string const routes = straytrace({"paths", first + "/run.h5"}).out;
  EXPECT_THAT(routes, HasSubstr("other > ITM"));
  EXPECT_EQ(routes, straytrace({"paths", again + "/run.h5"}).out);
}

TEST(LibraryExamples, AssumedNumbersAreListedWhereTheyAct) {
  Finished const check = straytrace({"check", virgo_arm});
  EXPECT_THAT(check.out, HasSubstr("parameter first_baffle = 10 m: assumed"));
  EXPECT_THAT(check.out, HasSubstr("material test_mass: assumed"));
  EXPECT_THAT(check.out, Not(HasSubstr("mirror_kagra")));
  EXPECT_EQ(check.err, "") << "what is not used does not warn";
  EXPECT_THAT(straytrace({"check", virgo_arm, "-p", "first_baffle=12m"}).out, Not(HasSubstr("first_baffle")));
}

// E.1 as a user meets it: the line at 10 Hz of an empty tube, on average over static phases. One and
// three wall hits count, even orders cancel (eq. 8.10). Controls: a wall that reflects 90 %, and static phases of 0.
double line_at_10_hz(std::string const& scene, Words const& options, double& error) {
  Folder const folder;
  Words words{"run", scene, "-o", folder / "out", "--quiet"};
  words.insert(words.end(), options.begin(), options.end());
  EXPECT_EQ(straytrace(words).code, 0);
  std::istringstream in(text_of(folder / "out/h_asd.txt"));
  std::vector<std::array<double, 3>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream numbers(line);
    auto& [f, h, low] = rows.emplace_back();
    numbers >> f >> h >> low;
  }
  double const ratio = std::sqrt(rows.at(1)[0] / rows.at(0)[0]);  // of an edge to the centre of its bin
  for (auto const& [f, h, low] : rows)
    if (f / ratio <= 10 && 10 < f * ratio) {
      double const width = std::sqrt(f * (ratio - 1 / ratio));
      error = (h - low) * width;
      return h * width;
    }
  return 0;
}

TEST(LibraryExamples, LineOfTheEmptyTubeE1) {
  std::string const scene = source_folder + "/examples/arm_tube.yaml";
  auto const log_of = [](int m) { return std::log((2 * m * 0.6 + 0.175) / (2 * m * 0.6 - 0.175)); };
  double const zero_phase = 1.3025e-24 * std::sqrt(1 + log_of(3) / log_of(1)), expected = zero_phase / std::sqrt(2);
  double error = 0;
  double const line = line_at_10_hz(scene, {}, error);
  EXPECT_LT(error, 0.02 * expected);
  EXPECT_NEAR(line, expected, 4 * error);
  EXPECT_GT(std::fabs(line - zero_phase), 4 * error);
  EXPECT_GT(std::fabs(line_at_10_hz(scene, {"-p", "reflectance=90 %"}, error) - expected), 4 * error);
}

// E.1: the bare tube leads light from mirror to mirror; baffles by the shadow rule take all of it away,
// and a ring that faces the mirror gives it back.
TEST(LibraryExamples, BafflesHideTheWall) {
  Folder const folder;
  auto const routes = [&](std::string const& name) {
    Finished const run = straytrace({"trace", source_folder + "/examples/" + name + ".yaml", "-o",
                                     folder / (name + ".h5"), "--histories", "131072", "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    return straytrace({"paths", folder / (name + ".h5"), "--show", "200"}).out;
  };
  EXPECT_THAT(routes("virgo_tube"), HasSubstr("ITM·S > tube·R > ETM·S"));
  std::string const baffled = routes("virgo_arm");
  for (char const* by_the_wall : {"ITM·S > tube", "ETM·S > tube"}) EXPECT_THAT(baffled, Not(HasSubstr(by_the_wall)));
  EXPECT_THAT(baffled, HasSubstr("ITM·S > baffles_in·S > ITM·S"));
  EXPECT_THAT(routes("virgo_defect"), HasSubstr("ITM·S > ring·R > ITM·S"));
}

}  // namespace
}  // namespace straytrace::testing
