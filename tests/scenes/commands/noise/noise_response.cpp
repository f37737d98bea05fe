// SPDX-License-Identifier: BSD-3-Clause
// straytrace noise --response: other responses of ports on a finished run.
#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_noise_response {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Columns h_mean, phase_only and amplitude_only of h_asd.txt.
struct Columns {
  std::vector<double> mean, phase, amplitude;
};
Columns columns_of(std::string const& file) {
  Columns c;
  std::istringstream lines(text_of(file));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<double> values;  // a word may be 'nan', which a stream does not read as a number
    std::istringstream words(line);
    for (std::string word; words >> word;) values.push_back(std::stod(word));
    c.mean.push_back(values.at(1)), c.phase.push_back(values.at(11)), c.amplitude.push_back(values.at(12));
  }
  return c;
}

std::string response_of(std::string const& port, std::string const& table) {
  return "straytrace: 1\ninterferometer:\n  responses: {" + port + ": {" + table +
         ", columns: [Hz, re, im], unit: strain}}\n";
}

struct NoiseResponse : ::testing::Test {
  Folder const folder;
  std::string const run = folder / "run/run.h5";
  static void SetUpTestSuite() {
    traced = std::make_unique<Folder>();
    ASSERT_EQ(straytrace({"run", virgo_arm, "-o", *traced / "run", "--histories", "131072", "--quiet"}).code, 0);
  }
  static void TearDownTestSuite() { traced.reset(); }
  static inline std::unique_ptr<Folder> traced;
  void SetUp() override {
    fs::copy(*traced / "run", folder / "run", fs::copy_options::recursive);
    // Of light inside an arm: h = lambda/(4 pi L) Im s (eq. 9.1), twice that, and nothing for Re s.
    double const k = 1.064e-6 / (4 * std::acos(-1.0) * 2999.8);
    write_text(folder / "one.txt",
               "1 " + std::to_string(k * 1e12) + "e-12 0\n2000 " + std::to_string(k * 1e12) + "e-12 0\n");
    write_text(folder / "two.txt",
               "1 0 " + std::to_string(2e12 * k) + "e-12\n2000 0 " + std::to_string(2e12 * k) + "e-12\n");
    write_text(folder / "zero.txt", "1 1e-40 0\n2000 1e-40 0\n");
  }
  Columns projected(Words words, std::string const& out) const {
    words.insert(words.end(), {"-o", folder / out, "--quiet"});
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return columns_of(folder / (out + "/h_asd.txt"));
  }
  std::string projected_run(Words words, std::string const& out) const {  // its run file
    words.insert(words.begin(), {"noise", run});
    projected(words, out);
    return folder / (out + "/run.h5");
  }
  std::string both(std::string const& name, std::string const& file) const {
    std::string const table = "phase: " + file + ", columns: [Hz, re, im], unit: strain";
    write_text(folder / name,
               "straytrace: 1\ninterferometer: {responses: {ITM: {" + table + "}, ETM: {" + table + "}}}\n");
    return folder / name;
  }
};

TEST_F(NoiseResponse, ReplacesThatOfTheScene) {
  Columns const own = columns_of(folder / "run/h_asd.txt"),
                one = projected({"noise", run, "--response", both("one.yaml", "one.txt")}, "one"),
                two = projected({"noise", run, "--response", both("two.yaml", "two.txt")}, "two");
  ASSERT_EQ(own.mean.size(), one.mean.size());
  for (std::size_t i = 0; i < own.mean.size(); ++i) {
    EXPECT_NEAR(one.phase[i] / own.phase[i], 1, 2e-6);  // the text of the numbers has seven digits
    EXPECT_EQ(one.amplitude[i], 0);
    EXPECT_NEAR(two.mean[i] / one.mean[i], 2, 1e-6);  // the modulus counts
  }
  EXPECT_GT(std::fabs(own.mean.front() / own.phase.front() - 1), 0.1);  // control: the scene has radiation pressure
}

// Each file that the line names is there. Control: --quiet and JSON do not print the line.
TEST_F(NoiseResponse, NamesTheFilesItWrites) {
  std::string const out = folder / "told";
  Finished const r = straytrace({"noise", run, "-o", out});
  std::size_t const at = r.err.find("results in " + out + ":");
  ASSERT_NE(at, r.err.npos) << r.err;
  std::istringstream names(r.err.substr(at + out.size() + 12, r.err.find('\n', at) - at - out.size() - 12));
  std::size_t n = 0;
  for (std::string name; names >> name; ++n) EXPECT_TRUE(fs::exists(fs::path(out) / name)) << name;
  EXPECT_EQ(n, std::size_t(std::distance(fs::directory_iterator(out), fs::directory_iterator())));
  EXPECT_THAT(straytrace({"noise", run, "-o", folder / "told.h5"}).err,
              HasSubstr("run file: " + (folder / "told.h5") + "\n"));
  for (Words const& more : {Words{"--quiet"}, Words{"--format", "json"}}) {
    Words words{"noise", run, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    Finished const silent = straytrace(words);
    EXPECT_THAT(silent.out + silent.err, Not(HasSubstr("results in")));
  }
}

TEST_F(NoiseResponse, LeavesOtherPortsAndIsRemembered) {
  write_text(folder / "itm.yaml", response_of("ITM", "phase: zero.txt, amplitude: zero.txt"));
  write_text(folder / "etm.yaml", response_of("ETM", "phase: zero.txt, amplitude: zero.txt"));
  Columns const own = columns_of(folder / "run/h_asd.txt"),
                without_itm = projected({"noise", run, "--response", folder / "itm.yaml"}, "without_itm"),
                without_etm = projected({"noise", run, "--response", folder / "etm.yaml"}, "without_etm");
  for (std::size_t i = 0; i < own.mean.size(); ++i)  // powers of the two ports add
    EXPECT_NEAR(std::hypot(without_itm.mean[i], without_etm.mean[i]) / own.mean[i], 1, 1e-6);
  // The file that was written holds the responses; motion and a second response come on top.
  std::string const kept = folder / "without_itm/run.h5";
  projected({"noise", kept}, "again");
  EXPECT_EQ(data_hash(folder / "again/run.h5"), data_hash(kept));
  Columns const none = projected({"noise", kept, "--response", folder / "etm.yaml"}, "none");
  EXPECT_LT(none.mean.front(), 1e-9 * own.mean.front());
  Columns const loud = projected({"noise", run, "--motion", storm, "--response", both("one.yaml", "one.txt")}, "loud"),
                storms = projected({"noise", run, "--motion", storm}, "storms");
  EXPECT_NEAR(loud.mean.front() / storms.phase.front(), 1, 2e-6);
  projected({"noise", folder / "loud/run.h5"}, "loud_again");
  EXPECT_EQ(data_hash(folder / "loud_again/run.h5"), data_hash(folder / "loud/run.h5"));
}

// Control: --set without --response.
TEST_F(NoiseResponse, ActsTogetherWithASetting) {
  auto const h = [&](Words words) {
    words.insert(words.begin(), {"noise", run, "--quiet", "--format", "json"});
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out).at("total_strain").at(0).at("value").get<double>();
  };
  Words const response{"--response", both("two.yaml", "two.txt")}, set{"--set", "test_mass=x1"};
  Words together = response;
  together.insert(together.end(), set.begin(), set.end());
  EXPECT_NEAR(h(together) / h(response), 1, 1e-12);
  EXPECT_GT(std::fabs(h(set) / h(response) - 1), 0.1);
}

// Another motion does not change what the interferometer makes of the light: the response stays, unless the motion file
// describes the interferometer. Controls: unchanged, with the response of the scene; the response of another file.
TEST_F(NoiseResponse, StaysWithAnotherMotion) {
  std::string const quiet = projected_run({"--response", both("one.yaml", "one.txt")}, "quiet");
  Columns const kept = projected({"noise", quiet, "--motion", storm}, "kept"),
                at_once = projected({"noise", run, "--motion", storm, "--response", folder / "one.yaml"}, "at_once"),
                dropped = projected({"noise", run, "--motion", storm}, "dropped");
  ASSERT_EQ(kept.mean.size(), at_once.mean.size());
  for (std::size_t i = 0; i < kept.mean.size(); ++i) EXPECT_EQ(kept.mean[i], at_once.mean[i]);
  EXPECT_GT(std::fabs(kept.mean.front() / dropped.mean.front() - 1), 0.1);
  projected({"noise", folder / "kept/run.h5"}, "kept_again");
  EXPECT_EQ(data_hash(folder / "kept_again/run.h5"), data_hash(folder / "kept/run.h5"));
  Columns const two = projected({"noise", quiet, "--motion", both("two.yaml", "two.txt")}, "two"),
                one = columns_of(folder / "quiet/h_asd.txt");
  EXPECT_NEAR(two.mean.front() / one.mean.front(), 2, 1e-6);
}

TEST_F(NoiseResponse, WrongFilesAreErrors) {
  auto const rejected = [&](std::string const& text, std::vector<std::string> const& says) {
    write_text(folder / "bad.yaml", text);
    Finished const done = straytrace({"noise", run, "--response", folder / "bad.yaml", "-o", folder / "no"});
    EXPECT_EQ(done.code, 2);
    for (std::string const& s : says) EXPECT_THAT(done.err, HasSubstr(s));
    EXPECT_FALSE(fs::exists(folder / "no"));
  };
  rejected("straytrace: 1\n", {"this file contains no responses"});
  rejected(text_of(storm), {"this file contains no responses"});
  rejected(response_of("ITM", "phase: one.txt") + "noise: {band: [5 Hz, 1 kHz]}\n",
           {"bad.yaml:4:", "a file of responses must not contain other tables"});
  rejected("straytrace: 1\ninterferometer: {responses: {}, mirror_mass: 40 kg}\n", {"mirror_mass"});
  rejected(response_of("ITN", "phase: one.txt"), {"bad.yaml:3:", "ITN", "ITM"});
  rejected(response_of("ITM", "phase: none.txt"), {"bad.yaml:3:", "none.txt"});
  rejected("straytrace: 1\ninterferometer: {responses: {ITM: {phase: one.txt, columns: [Hz, re, im]}}}\n",
           {"bad.yaml:2:", "unit"});
}

// Another motion into the folder of the run replaces the files of the run, with a message; in another folder nothing is
// replaced.
TEST_F(NoiseResponse, IntoTheFolderOfTheRunItself) {
  auto const said = [&](Words const& words) {
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return done.err;
  };
  EXPECT_THAT(said({"noise", run, "-o", folder / "run"}), Not(HasSubstr("the run itself")))
      << "control: its own motion";
  EXPECT_THAT(said({"noise", run, "--motion", storm, "-o", folder / "storm"}), Not(HasSubstr("the run itself")));
  EXPECT_THAT(said({"noise", run, "--motion", storm, "-o", folder / "run"}),
              HasSubstr("is the folder of the run itself: its results and run file are now those of storm.yaml"));
}

}  // namespace
}  // namespace straytrace::testing::app_noise_response
