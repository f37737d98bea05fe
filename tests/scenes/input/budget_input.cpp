// SPDX-License-Identifier: BSD-3-Clause
// Errors of straytrace budget and names of its inputs: inputs given twice, bad detector files, folders.
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include <unistd.h>

#include "scenes/program.hpp"

namespace straytrace::testing::app_budget_input {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::size_t count_of(std::string const& text, std::string const& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++n;
  return n;
}

// Exit code 2, an empty stdout, the given number of messages, each of the texts in them.
void rejected(Words words, std::vector<std::string> const& texts, std::size_t messages = 1) {
  words.insert(words.begin(), "budget");
  Finished const done = straytrace(words);
  EXPECT_EQ(done.code, 2) << done.out;
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(count_of(done.err, "error: "), messages) << done.err;
  for (std::string const& text : texts) EXPECT_THAT(done.err, HasSubstr(text));
}

struct Runs : ::testing::Test {
  static void SetUpTestSuite() {
    folder = new Folder;
    for (std::string const seed : {"1", "2"})
      ASSERT_EQ(straytrace({"run", virgo_arm, "-o", *folder / ("seed" + seed), "--histories", "131072", "--seed", seed,
                            "--quiet"})
                    .code,
                0);
    fs::copy_file(*folder / "seed1/run.h5", *folder / "copy.h5");
    ASSERT_EQ(straytrace({"run", virgo_arm, "-o", *folder / "narrow", "-p", "rim=48cm", "--histories", "131072",
                          "--seed", "2", "--quiet"})
                  .code,
              0);
    ASSERT_EQ(straytrace({"run", virgo_arm, "-o", *folder / "few", "--histories", "4096", "--quiet"}).code, 0);
    fs::copy_file(*folder / "few/run.h5", *folder / "few.h5");
  }
  static void TearDownTestSuite() { delete folder; }
  static Folder* folder;
  static std::string at(std::string const& name) { return *folder / name; }
};
Folder* Runs::folder = nullptr;

TEST_F(Runs, GivenTwiceAreErrors) {
  rejected({"adv", at("seed1/run.h5"), at("seed1/run.h5")}, {"given twice", "name each input once"});
  rejected({"adv", at("seed1/run.h5"), at("seed1/../seed1/run.h5")}, {"given twice"});
  rejected({"adv", at("seed1/run.h5"), at("copy.h5")}, {"contain the same noise, 'StrayLight'", "copy.h5"});
  rejected({at("few/run.h5"), at("few.h5")}, {"contain the same noise"});  // no row is resolved: the content decides
  // Control: baffles of another width scatter other light.
  EXPECT_EQ(straytrace({"budget", "adv", at("seed1/run.h5"), at("narrow/run.h5"), "--quiet"}).code, 0);
}

TEST_F(Runs,
       LightOfOneSceneIsNotAddedToItself) {  // a second seed estimates the same light: its sum is sqrt(2) too loud
  rejected({"adv", at("seed1/run.h5"), at("seed2/run.h5")},
           {"seed1/run.h5' and", "seed2/run.h5' contain the stray light of one scene", "pick one", "--compare"});
  Finished const beside = straytrace(
      {"budget", "adv", at("seed1/run.h5"), "--compare", at("seed2/run.h5"), "--at", "10 Hz", "--format", "json"});
  ASSERT_EQ(beside.code, 0) << beside.err;
  Json const all = Json::parse(beside.out)["at"], other = all["curves"][0];
  EXPECT_EQ(other["name"], "seed2/run.h5");
  double const one = all["noises"].back()["strain"][0];
  EXPECT_NEAR(other["strain"][0].get<double>() / one, 1, 0.3);  // the same light, within the errors of both
}

TEST_F(Runs, BudgetsThatContainAGivenRunOrDetectorAreErrors) {
  ASSERT_EQ(straytrace({"budget", "adv", at("seed1/run.h5"), "--export", "pygwinc", "-o", at("out"), "--quiet"}).code,
            0);
  rejected({at("seed1/run.h5"), at("out/budget.hdf5")}, {"contain the same noise, 'StrayLight'"});
  rejected({"adv", at("out/budget.hdf5")}, {"'adv' and", "'CoatingBrownian'", "--compare"});
  rejected({at("seed2/run.h5"), at("out/budget.hdf5")}, {"light of one scene"});  // the exported file names its model
  EXPECT_EQ(straytrace({"budget", at("out/budget.hdf5"), at("narrow/run.h5"), "--quiet"}).code, 0);
}

TEST_F(Runs, EqualTitlesAreDistinguishedByFolderOrFile) {
  Finished const done = straytrace({"budget", at("seed1/run.h5"), at("narrow/run.h5"), "--format", "json", "--quiet"});
  ASSERT_EQ(done.code, 0) << done.err;
  Json const all = Json::parse(done.out), noises = all["at"]["noises"];
  ASSERT_EQ(noises.size(), 2u);
  EXPECT_EQ(noises[0]["name"], "StrayLight-seed1");
  EXPECT_EQ(noises[1]["name"], "StrayLight-narrow");
  EXPECT_NE(noises[0]["what"], noises[1]["what"]);
  EXPECT_EQ(all["runs"][1]["seed"], 2);
  EXPECT_EQ(all["runs"][1]["file"], "narrow/run.h5");
  fs::copy_file(at("narrow/run.h5"), at("other.h5"), fs::copy_options::overwrite_existing);
  Finished const files = straytrace({"budget", at("copy.h5"), at("other.h5"), "--quiet"});
  EXPECT_THAT(files.out, HasSubstr("StrayLight-copy"));
  EXPECT_THAT(files.out, HasSubstr("StrayLight-other"));
}

TEST_F(Runs, DamagedFilesAreCalledDamaged) {
  std::string const whole = text_of(at("seed1/run.h5"));
  write_text(at("short.h5"), whole.substr(0, whole.size() / 2));
  write_text(at("garbled.hdf5"), "XXXX" + whole.substr(600));
  write_text(at("cut.hdf5"), whole.substr(512, 4000));
  rejected({"adv", at("short.h5")}, {"short.h5", "damaged"});
  rejected({"adv", at("garbled.hdf5")}, {"garbled.hdf5", "damaged"});
  rejected({"adv", at("cut.hdf5")}, {"cut.hdf5", "damaged"});
  rejected({"adv", at("short.h5"), at("garbled.hdf5"), "aligo"}, {"short.h5", "garbled.hdf5", "second detector"}, 3);
}

TEST(BudgetInput, ErrorsOfDetectorsAreReportedOnce) {
  Folder const folder;
  auto const file = [&](std::string const& text) {
    write_text(folder / "mine.yaml", "extends: aligo\n" + text);
    return folder / "mine.yaml";
  };
  rejected({file("Laser: {Power: 25}\nOptics: {Loss: 1e-5}\nLaser: {Power: 50}\n")},
           {"mine.yaml:4:1", "'Laser' is given twice", "keep one"});
  rejected({file("Optics: {ITM: {Transmittance: 0.01, Transmittance: 0.02}}\n")}, {"mine.yaml:2:", "twice"});
  rejected({file("Squeezer: {AmplitudedB: -10}\n")},
           {"mine.yaml:2:25", "'Squeezer.AmplitudedB' is -10", "from 0 to 60"});
  rejected({file("Squeezer: {Type: Freq dependent, AmplitudedB: 6}\n")}, {"not a kind of squeezing", "Freq Dependent"});
  rejected({file("Materials: {MassRadius: 0.05}\n")}, {"smaller than the beam", "0.062 m at the end mirrors"});
  rejected({file("Optics: {ITM: {Transmittance: 1}}\n")}, {"'Optics.ITM.Transmittance' is 1", "above 0 and below 1"});
  rejected({file("Optics: {ETM: {Transmittance: -1e-6}}\n")}, {"from 0 and below 1"});
  rejected({file("Suspension: {Temp: 0}\n")}, {"'Suspension.Temp' is 0", "above 0"});
  rejected({file("Materials: {Substrate: {Temp: 0}}\n")}, {"'Materials.Substrate.Temp' is 0"});
  rejected({file("Laser: {Power: much}\n")}, {"'Laser.Power' is a number, got \"much\""});
  rejected({file("Laser: {Power: -1}\n")}, {"'Laser.Power' is -1"});
  rejected({file("Infrastructure: {Length: 0}\n")}, {"'Infrastructure.Length' is 0", "above 0"});
  rejected({file("Laser: {Power: 1, ArmPower: 2}\n")}, {"both Laser.Power and Laser.ArmPower"});
  rejected({file("Curves: [{name: a, file: x}, {name: a, file: y}]\n")}, {"a second curve is named 'a'"});
  rejected({file("Seismic: {RayleighWaveSpeed: 1000}\n")}, {"slower than s waves"});
  rejected({"aligo", "--at", "1e300 Hz"}, {"'1e300 Hz' is not between 1 uHz and 1 MHz"});
  rejected({"aligo", "--band", "1e-9 Hz, 1 kHz"}, {"not between"});
}

TEST(BudgetInput, PowerStatedLaterReplacesThePreset) {  // the example of the help, on a preset with ArmPower
  auto const arm = [](Words const& words) {
    Words all{"budget", "adv", "--at", "1 kHz", "--format", "json"};
    all.insert(all.end(), words.begin(), words.end());
    Finished const done = straytrace(all);
    EXPECT_EQ(done.code, 0) << done.err;
    return Json::parse(done.out)["at"]["lines"][0]["strain"][0].get<double>();  // shot noise
  };
  double const design = arm({}), quarter = arm({"-p", "Laser.ArmPower=162.5e3"});
  EXPECT_NEAR(quarter / design, 2, 1e-9);  // shot noise goes with one over the root of the power
  EXPECT_NEAR(arm({"-p", "Laser.Power=25"}) / arm({"-p", "Laser.Power=100"}), 2, 1e-9);
  Folder const folder;
  EXPECT_EQ(straytrace({"budget", "adv", "-p", "Laser.Power=25", "--export", "pygwinc", "-o", folder / "out"}).code, 0);
}

TEST(BudgetInput, TitleOfTheFileIsShown) {
  Folder const folder;
  write_text(folder / "mine.yaml", "extends: aligo\ntitle: Advanced LIGO with 25 W\nLaser: {Power: 25}\n");
  EXPECT_THAT(straytrace({"budget", folder / "mine.yaml"}).out, HasSubstr("noise budget of Advanced LIGO with 25 W\n"));
  write_text(folder / "mine.yaml", "extends: aligo\nLaser: {Power: 25}\n");
  EXPECT_THAT(straytrace({"budget", folder / "mine.yaml"}).out, HasSubstr("noise budget of mine.yaml\n"));
}

TEST(BudgetInput, UnwritableOutputLeavesNoFiles) {
  Folder const folder;
  write_text(folder / "file", "");
  rejected({"aligo", "-o", folder / "file/out"}, {"cannot make the folder", "-o"});
  rejected({"alogo", "-o", folder / "deep/deeper"}, {"did you mean"});
  EXPECT_FALSE(fs::exists(folder / "deep"));  // made before reading, removed after the error
  fs::create_directories(folder / "taken/budget.json");
  rejected({"aligo", "-o", folder / "taken"}, {"'budget.json' is a folder"});
  EXPECT_FALSE(fs::exists(folder / "taken/budget.txt"));
  if (::geteuid() != 0) {
    fs::create_directory(folder / "closed");
    ::chmod(std::string(folder / "closed").c_str(), 0500);
    rejected({"aligo", "-o", folder / "closed/new"}, {"cannot make the folder"});
    rejected({"aligo", "-o", folder / "closed"}, {"cannot write to the folder"});
  }
}

TEST(BudgetInput, JsonHoldsForProblemsAndWarnings) {
  Folder const folder;
  auto const list_of = [](Words const& words, int code) {
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, code) << done.err;
    return Json::parse(done.err);
  };
  Json const two = list_of({"budget", "alogo", "kagro", "--format", "json"}, 2);
  EXPECT_EQ(two.size(), 2u);
  EXPECT_EQ(list_of({"budget", "aligo", "--nonsense", "--format", "json"}, 2)[0]["severity"], "error");
  write_text(folder / "one_index.yaml", "extends: aligo\nMaterials: {Coating: {Indexlown: 2.09}}\n");
  Json const numerical = list_of({"budget", folder / "one_index.yaml", "--format", "json"}, 3);
  EXPECT_THAT(numerical[0]["what"].get<std::string>(), HasSubstr("doublets"));
  ASSERT_EQ(straytrace({"run", virgo_arm, "-o", folder / "run", "--histories", "4096", "--quiet"}).code, 0);
  Json const warning = list_of({"budget", folder / "run/run.h5", "--format", "json"}, 0);
  EXPECT_EQ(warning[0]["severity"], "warning");
  EXPECT_THAT(warning[0]["what"].get<std::string>(), HasSubstr("without a detector"));
  Finished const both = straytrace({"paths", folder / "run/run.h5", "--format", "json", "--csv"});
  EXPECT_EQ(both.code, 2);
  EXPECT_THAT(both.err, HasSubstr("exclude each other"));
}

}  // namespace
}  // namespace straytrace::testing::app_budget_input
