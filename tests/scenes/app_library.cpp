// SPDX-License-Identifier: BSD-3-Clause
// straytrace library, and the examples that are written on it.
#include <nlohmann/json.hpp>

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
}

// The numbers of a curve without what tells runs apart.
std::string curve(std::string const& file) {
  std::istringstream in(text_of(file));
  std::string rows;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with('#')) rows += line + '\n';
  return rows;
}

// The example on the library and the arm written out are the same to the last bit, and its run file needs no library.
TEST(LibraryExamples, VirgoArmIsTheArmWrittenOut) {
  Folder const folder;
  for (auto const& [scene, name] : {std::pair(virgo_arm, "library"), {written_arm, "written"}})
    ASSERT_EQ(straytrace({"run", scene, "-o", folder / name, "--histories", "32768", "--quiet"}).code, 0);
  std::string const one = curve(folder / "library/h_asd.txt");
  EXPECT_GT(one.size(), 1000u);
  EXPECT_EQ(one, curve(folder / "written/h_asd.txt"));
  ASSERT_EQ(straytrace({"run", folder / "library/run.h5", "-o", folder / "again", "--quiet"}).code, 0);
  EXPECT_EQ(one, curve(folder / "again/h_asd.txt"));
  ASSERT_EQ(
      straytrace({"run", virgo_arm, "-o", folder / "twin", "-p", "rim=49.4cm", "--histories", "32768", "--quiet"}).code,
      0);
  EXPECT_NE(one, curve(folder / "twin/h_asd.txt"));
}

TEST(LibraryExamples, AssumedNumbersAreSaidWhereTheyAct) {
  Finished const check = straytrace({"check", virgo_arm});
  EXPECT_THAT(check.out, HasSubstr("parameter first_baffle = 10 m: assumed"));
  EXPECT_THAT(check.out, HasSubstr("material test_mass: assumed"));
  EXPECT_THAT(check.out, Not(HasSubstr("mirror_kagra")));
  EXPECT_EQ(check.err, "") << "what is not used does not warn";
  EXPECT_THAT(straytrace({"check", virgo_arm, "-p", "first_baffle=12m"}).out, Not(HasSubstr("first_baffle")));
}

// What the baffles do: the wall of the bare tube is the first thing in every route; behind baffles in none of one
// bounce.
TEST(LibraryExamples, BafflesTakeTheWallAway) {
  Folder const folder;
  auto const routes = [&](std::string const& name) {
    Finished const run = straytrace({"trace", source_folder + "/examples/" + name + ".yaml", "-o",
                                     folder / (name + ".h5"), "--histories", "65536", "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    return straytrace({"paths", folder / (name + ".h5"), "--show", "200"}).out;
  };
  EXPECT_THAT(routes("virgo_tube"), HasSubstr("ITM·S > tube·S > ETM·S"));
  std::string const baffled = routes("virgo_arm");
  for (char const* by_the_wall : {"ITM·S > tube", "ETM·S > tube"}) EXPECT_THAT(baffled, Not(HasSubstr(by_the_wall)));
  EXPECT_THAT(baffled, HasSubstr("ITM·S > baffles_in·S > ITM·S"));
  EXPECT_THAT(routes("virgo_defect"), HasSubstr("ITM·S > ring·R > ITM·S"));
}

}  // namespace
}  // namespace straytrace::testing
