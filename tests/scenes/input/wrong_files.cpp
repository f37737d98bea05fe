// SPDX-License-Identifier: BSD-3-Clause
// Files that are not what a command wants: one clear sentence, none of their bytes, and before any work.
#include "scenes/answers.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Commands that read text, with the file in question last.
std::vector<Words> readers() {
  Words const taps{"couple",  "taps", "--force", data("taps.csv") + "::HAMMER", "--target", data("taps.csv") + "::H",
                   "--quiet", "0..8"};
  Words list = taps;
  list.emplace_back("--list");
  return {{"scan", virgo_arm, "--histories", "1e12", "--points"},
          {"signal", "psd"},
          {"budget", "aligo", "--compare"},
          {"scan", virgo_arm, "--histories", "1e12", "--invert", "brdf(baffle)", "--against"},
          {"inspect"},
          {"check"},
          list};
}

TEST(WrongFiles, BytesOfBinaryFilesAreNotPrinted) {
  Folder const folder;
  std::string const binary = folder / "binary.csv", text = folder / "text.csv";
  write_text(binary, std::string("\x7f"
                                 "ELF\x02\x01\0\0 SECRET, 12\n13, 14\n",
                                 27));
  write_text(text, "SECRET: {, 12\n13, 14, 15\n");
  for (Words words : readers()) {
    Words other = words;
    words.push_back(binary);
    other.push_back(text);
    Finished const r = straytrace(words, {".", false, 20}), control = straytrace(other, {".", false, 20});
    EXPECT_EQ(r.code, 2) << words[0] << r.err;
    EXPECT_EQ(r.out, "") << words[0];
    EXPECT_THAT(r.err, AllOf(HasSubstr("binary.csv"), HasSubstr("binary file"), Not(HasSubstr("SECRET"))))
        << words[0] << " " << words[1];
    EXPECT_EQ(control.code, 2) << words[0] << control.err;
    EXPECT_THAT(control.err, Not(HasSubstr("binary file"))) << words[0] << " " << words[1];
  }
}

// In JSON the place is in fields of its own, not in the text.
TEST(WrongFiles, PlacesInRecordsAreFields) {
  Folder const folder;
  write_text(folder / "record.csv", "time [s],x [m]\n0,1\n1,2\n2,x\n3,y\n");
  Finished const r = straytrace({"signal", "psd", folder / "record.csv", "--format", "json"});
  EXPECT_EQ(r.code, 2);
  auto const list = nlohmann::json::parse(r.err);
  ASSERT_EQ(list.size(), 2u) << r.err;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(list[i]["file"], folder / "record.csv");
    EXPECT_EQ(list[i]["line"], 4 + i);
    EXPECT_EQ(list[i]["column"], 3);
    EXPECT_EQ(list[i]["what"], std::string(i ? "'y'" : "'x'") + " is not a number (comments start with #)");
  }
}

// As it was written: two files of one name stay distinct, and an editor opens the right one.
TEST(WrongFiles, AreNamedWithTheirPath) {
  Folder const folder;
  fs::create_directory(folder / "data");
  write_text(folder / "data/record.csv", "time [s],x [m]\n0,1\n1,2\n2,x\n");
  write_text(folder / "data/two.csv", "time [s],x [m],y [m]\n0,1,2\n1,2,3\n");
  write_text(folder / "data/list.mtl", "newmtl a\nReflect x 0\n");
  write_text(folder / "data/mesh.obj", "v 0 0 0\n");
  for (auto const& [words, said] :
       {std::pair{Words{"signal", "psd", "data/record.csv"}, "data/record.csv:4:3: error: 'x' is not a number"},
        std::pair{Words{"signal", "psd", "data/two.csv"}, "name one, for example data/two.csv::x"},
        std::pair{Words{"signal", "psd", "./data/record.csv"}, "./data/record.csv:4:3: error: "},
        std::pair{Words{"inspect", "data/list.mtl"}, "data/list.mtl"},
        std::pair{Words{"inspect", "data/mesh.obj"}, "data/mesh.obj"}}) {
    Finished const r = straytrace(words, {folder.path()});
    EXPECT_EQ(r.code, 2) << words.back();
    EXPECT_THAT(r.err, HasSubstr(said));
  }
}

TEST(WrongFiles, DecimalCommasAreNamed) {
  Folder const folder;
  write_text(folder / "list.csv", "place;start;duration\ntower;8,5;6\n");
  Words taps = readers().back();
  taps.push_back(folder / "list.csv");
  EXPECT_THAT(straytrace(taps).err, AllOf(HasSubstr("list.csv:1:6: error: columns are separated by ';'"),
                                          HasSubstr("not semicolons, and write decimal points")));
  Finished const until = straytrace({"run", virgo_arm, "-o", folder / "out", "--until", "h_total < 0,5 %, 10 min"});
  EXPECT_EQ(until.code, 2);
  EXPECT_THAT(until.err, AllOf(HasSubstr("decimal comma"), HasSubstr("write 'h_total < 0.5 %, 10 min'")));
  Finished const other = straytrace({"run", virgo_arm, "-o", folder / "out", "--until", "h_total < 5,10 min"});
  EXPECT_THAT(other.err, HasSubstr("decimal comma"));
  // Without the comma this is no stop rule either, so that it is not suggested.
  Finished const more =
      straytrace({"run", virgo_arm, "-o", folder / "out", "--until", "h_total < 5 %; foo; bar < 3,5 %"});
  EXPECT_THAT(more.err, AllOf(HasSubstr("decimal comma"), HasSubstr("write 'h_total < 5 %', 'routes < 10 %'")));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

// Names and numbers are checked before anything is read: the run does not exist.
TEST(WrongFiles, OptionsAreCheckedFirst) {
  for (auto const& [option, value, says] :
       {std::array{"--window", "foo", "'foo' is not a window"}, std::array{"--overlap", "150 %", "from 0 to below 100"},
        std::array{"--segment", "3,5 s", "--segment"}, std::array{"--stride", "2 m", "--stride"}})
    EXPECT_THAT(straytrace({"project", "none.h5", option, value}).err, HasSubstr(says));
  EXPECT_THAT(straytrace({"project", "none.h5", "--window", "hann"}).err, HasSubstr("there is no such file"));
}

// Errors of a table of points are at its lines, not in the command line.
TEST(WrongFiles, PointsOfAScanAreNamedByLineAndColumn) {
  Folder const folder;
  auto const said = [&](std::string const& table) {
    write_text(folder / "pts.csv", table);
    Finished const r = straytrace({"scan", written_arm, "--points", folder / "pts.csv", "--histories", "512"});
    EXPECT_EQ(r.code, 2);
    return r.err;
  };
  EXPECT_THAT(said("rim [cm]\n"), AllOf(HasSubstr("pts.csv: error: the table has no rows"), Not(HasSubstr(":0"))));
  EXPECT_THAT(said("lambda [nm], rimm [cm]\n1064, 49\n"),
              AllOf(HasSubstr("pts.csv:2:7: error: parameter 'rimm' is not defined"), Not(HasSubstr("command line"))));
}

// A run file of any size in place of a scene, whose size limit is no reason. Control: a large text.
TEST(WrongFiles, RunsAreNoScenes) {
  Folder const folder;
  std::string const large = folder / "large.yaml";
  write_text(large, "straytrace-run " + std::string((std::size_t{16} << 20) + 1, '\0'));
  Finished const run = straytrace({"check", large});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, AllOf(HasSubstr("it is a run file, not a scene"), Not(HasSubstr("larger"))));
  write_text(large, std::string((std::size_t{16} << 20) + 1, '#'));
  EXPECT_THAT(straytrace({"check", large}).err, HasSubstr("it is larger than 16 MB"));
}

}  // namespace
}  // namespace straytrace::testing
