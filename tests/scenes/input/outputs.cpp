// SPDX-License-Identifier: BSD-3-Clause
// An output that cannot be written, would overwrite an input, or has an ending that no command writes is an error
// before any work.
#include "scenes/answers.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Outputs : public ::testing::Test {
 protected:
  Outputs() {
    fs::copy_file(et_hf, scene);
    fs::copy_file(data("dump_bsdf.csv"), scatter);
    fs::copy_file(data("shaken.csv"), record);
    write_text(points, "rings\n40\n");
    Finished const f = traced(run);
    EXPECT_EQ(f.code, 0) << f.err;
  }
  Finished traced(std::string const& out, Words const& more = {}) const {
    Words words{"trace", scene, "-p", "rings=40", "-o", out, "--histories", "4096", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return straytrace(words, {folder.path()});
  }

  Folder const folder;
  std::string const scene = folder / "a.yaml", scatter = folder / "dump.csv", record = folder / "record.csv",
                    points = folder / "points.csv", run = folder / "a.h5";
};

// Every input keeps its bytes. Control: the same commands accept another name, see AcceptOtherNames.
TEST_F(Outputs, AreNoInputs) {
  fs::create_symlink(run, folder / "link.html");
  fs::create_symlink(scene, folder / "link.glb");
  fs::copy_file(points, folder / "scan.csv");
  struct {
    Words words;
    std::string input;
  } const all[] = {
      {{"report", run, "-o", folder / "link.html"}, run},
      {{"view", run, "-o", run}, run},
      {{"view", scene, "-o", folder / "./a.yaml"}, scene},
      {{"view", scene, "--glb", scene}, scene},
      {{"view", scene, "--glb", folder / "link.glb"}, scene},
      {{"inspect", scatter, "--plot", scatter}, scatter},
      {{"inspect", scatter, "--write", scatter}, scatter},
      {{"scan", scene, "--points", points, "--csv", points}, points},
      {{"scan", scene, "--points", folder / "scan.csv", "-o", folder.path()}, folder / "scan.csv"},
      {{"signal", "psd", record + "::any", "-o", record}, record},
      {{"signal", "convert", record, "-o", record}, record},
      {{"fringes", run, "--channel", record + "::any", "-o", record}, record},
      {{"project", run, "--channel", record + "::any", "--asd", record}, record},
      {{"couple", "noise", "--target", "any", "--injection", record + "@1..2", "--quiet", record, "--save", record},
       record},
      {{"trace", scene, "-p", "rings=40", "--histories", "4096", "-o", scene, "--force"}, scene}};
  for (auto const& w : all) {
    std::string const before = text_of(w.input);
    EXPECT_THAT(error_text(w.words), HasSubstr("is also another file of this command\n  choose another name"))
        << w.words[0] << ' ' << w.words[1];
    EXPECT_EQ(text_of(w.input), before) << w.words[0] << ' ' << w.words[1];
  }
}

TEST_F(Outputs, AcceptOtherNames) {
  for (Words const& words : {Words{"report", run, "-o", folder / "report.html", "--quiet"},
                             Words{"view", scene, "-o", folder / "view.html", "--quiet"},
                             Words{"view", scene, "--glb", folder / "view.glb", "--quiet"},
                             Words{"inspect", scatter, "--write", folder / "dump.ssdd"},
                             Words{"view", scene, "--vtk", folder / "vtk", "--glb", folder / "vtk/a.glb", "--quiet"}}) {
    Finished const f = straytrace(words);
    EXPECT_EQ(f.code, 0) << words[0] << ' ' << f.err;
  }
  EXPECT_TRUE(fs::exists(folder / "vtk/a.glb"));
  // A run is resumed in place, by its name as the output or without one.
  std::string const before = text_of(run);
  EXPECT_EQ(straytrace({"trace", run, "-o", run, "--histories", "8192", "--quiet"}).code, 0);
  EXPECT_NE(text_of(run), before);
}

// Only a run is replaced by a run. Controls: a run of another seed, a damaged run and an empty file.
TEST_F(Outputs, ReplaceNoFileOfAnotherKind) {
  std::string const photo = folder / "photo.jpg", strain = folder / "strain.hdf5";
  write_text(photo, "\xff\xd8\xff\xe0 JFIF");
  write_text(strain, "\x89HDF\r\n\x1a\n of another program");
  for (std::string const& file : {record, photo, strain}) {
    std::string const before = text_of(file);
    for (Words const& words : {Words{"trace", scene, "-p", "rings=40", "--histories", "4096", "-o", file, "--force"},
                               Words{"merge", run, "-o", file, "--force"}}) {
      EXPECT_THAT(error_text(words), AllOf(HasSubstr("'" + file + "' exists and is not a run file of straytrace"),
                                           HasSubstr("choose another name with -o, or remove the file first")))
          << words[0];
      EXPECT_EQ(text_of(file), before) << words[0] << ' ' << file;
    }
    EXPECT_THAT(traced(file).err, HasSubstr("it is not overwritten, even with --force"));
  }
  EXPECT_EQ(traced(run, {"--seed", "7", "--force"}).code, 0);
  std::string const whole = text_of(run);
  write_text(run, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(traced(run, {"--force"}).code, 0);
  write_text(run, "");
  EXPECT_EQ(traced(run, {"--force"}).code, 0);
}

// `report` and `view` do not replace another run or scene by a page.
TEST_F(Outputs, HaveAnEndingThatIsWritten) {
  std::string const other = folder / "other.yaml";
  fs::copy_file(et_hf, other);
  std::string const before = text_of(other);
  EXPECT_THAT(error_text({"report", run, "-o", other}),
              HasSubstr("does not have a known ending\n  end it with .html, .pdf, .png or .svg"));
  EXPECT_THAT(error_text({"view", scene, "-o", other}), HasSubstr("end it with .html"));
  EXPECT_THAT(error_text({"view", scene, "--glb", other}), HasSubstr("--glb: '" + other + "' does not have a known"));
  EXPECT_EQ(text_of(other), before);
}

// Options for a record of strain without one. Control: with it, they are read.
TEST_F(Outputs, OptionsOfARecordNeedIt) {
  std::string const said = error_text({"report", run, "--segment", "1 s", "--average", "mean", "-o", "a.doc"});
  EXPECT_THAT(said, HasSubstr("--segment, --average: there is no measured strain"));
  EXPECT_THAT(said, HasSubstr("end it with .html"));
  EXPECT_THAT(error_text({"report", run, "--measured", data("shaken.csv") + "::X", "--segment", "1 s"}),
              ::testing::Not(HasSubstr("there is no measured strain")));
}

// Refused before work: stdout is empty (see error_text) and no other output of the command exists.
TEST_F(Outputs, LieInFoldersThatExist) {
  std::string const nowhere = folder / "none/x.csv";
  for (Words const& words :
       {Words{"scan", scene, "--points", points, "--histories", "1e12", "--csv", nowhere},
        Words{"project", run, "-o", folder / "h.csv", "--asd", nowhere},
        Words{"project", run, "--spectrogram", nowhere}, Words{"signal", "psd", record, "-o", nowhere},
        Words{"fit", "--target", record, "--witness", record, "--subtract", folder / "none/x.hdf5"},
        Words{"couple", "noise", "--target", "any", "--injection", record, "--quiet", record, "--save", nowhere},
        Words{"render", scene, "-o", folder / "none/x.png"}, Words{"report", run, "-o", folder / "none/x.html"}})
    EXPECT_THAT(error_text(words), AllOf(HasSubstr("there is no folder '" + folder / "none"),
                                         HasSubstr("create it first, or choose another one")))
        << words[0];
  EXPECT_FALSE(fs::exists(folder / "h.csv"));
  // Control: once the folder exists, the record itself is at fault, or nothing is.
  fs::create_directory(folder / "none");
  EXPECT_THAT(straytrace({"signal", "psd", folder / "no_record.csv", "-o", nowhere}).err,
              AllOf(HasSubstr("no_record.csv"), Not(HasSubstr("there is no folder"))));
}

// A run and a scene are known by their content.
TEST_F(Outputs, AndInputsHaveAnyName) {
  std::string const dat = folder / "run.dat", txt = folder / "scene.txt";
  fs::copy_file(run, dat);
  fs::copy_file(scene, txt);
  for (Words const& words : {Words{"importance", dat}, Words{"trace", dat, "--histories", "4096", "--quiet"},
                             Words{"trace", dat, "--history", "1"}, Words{"view", dat, "-o", folder / "a.html"},
                             Words{"view", txt, "-o", folder / "b.html"}, Words{"inspect", txt},
                             Words{"render", dat, "-o", folder / "a.png", "--pixels", "16x12"},
                             Words{"run", dat, "-o", folder / "again", "--histories", "4096"}}) {
    Finished const f = straytrace(words);
    EXPECT_EQ(f.code, 0) << words[0] << ' ' << words[1] << ' ' << f.err;
  }
  // A run where text is needed; control: another binary file.
  write_text(folder / "binary.dat", std::string(100, '\0'));
  for (Words const& words :
       {Words{"check"}, Words{"ghosts"}, Words{"signal", "psd"}, Words{"noise", run, "--motion"}}) {
    Words with_run = words, with_binary = words;
    with_run.push_back(dat);
    with_binary.push_back(folder / "binary.dat");
    EXPECT_THAT(error_text(with_run), HasSubstr("this is a run file, but a text file is needed here")) << words[0];
    EXPECT_THAT(error_text(with_binary), HasSubstr("this is a binary file")) << words[0];
  }
}

}  // namespace
}  // namespace straytrace::testing
