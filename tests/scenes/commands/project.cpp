// SPDX-License-Identifier: BSD-3-Clause
// straytrace project and fringes on a small run: files, choices, errors.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

#include "scenes/program.hpp"

namespace straytrace::testing::app_project {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A bench behind the end mirror, traced once: one route per surface, 1e5 histories.
class Projected : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<Folder>();
    write_text(*folder_ / "shaking.yaml",
               "straytrace: 1\nbodies:\n  ITM: {motion: still}\n  ETM: {motion: still}\n  bench: {motion: {z: {sine: "
               "{amplitude: 5 um peak, frequency: 1.14 Hz}}, others: still}}\n");
    Finished const traced = Program({"run", source_folder + "/examples/end_bench.yaml", "-o", *folder_ / "run",
                                     "--histories", "4e4", "--quiet"})
                                .wait();
    ASSERT_EQ(traced.code, 0) << traced.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string at(std::string const& name) { return *folder_ / name; }
  static Finished straytrace(Words words) { return Program(words).wait(); }
  static Words project(Words more) {
    Words all = {"project", at("run/run.h5"), "--motion", at("shaking.yaml"), "--duration", "8s", "--route", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

 private:
  static std::unique_ptr<Folder> folder_;
};
std::unique_ptr<Folder> Projected::folder_;

TEST_F(Projected, SwingingBenchMakesItsFringes) {  // case B3: 67.3 Hz from 10 um peak to peak at 1.14 Hz
  Finished const got = straytrace(project({"--format", "json", "--seed", "3"}));
  ASSERT_EQ(got.code, 0) << got.err;
  auto const answer = nlohmann::json::parse(got.out);
  EXPECT_GT(answer["largest_fringe_frequency"].get<double>(), 67.2);
  EXPECT_LT(answer["largest_fringe_frequency"].get<double>(), 70);  // phase sensitivities spread by 1 %
  EXPECT_EQ(answer["rate"].get<double>(), 1024);
  // 2k of 5 um peak on the sensor: 41.76 rad rms, levers spread by 1 %.
  EXPECT_NEAR(answer["rms_phase"].get<double>() / 41.76, 1, 0.02);
  EXPECT_EQ(answer["rms_phase_route"].get<std::string>(), "sensor·S");
  EXPECT_GT(answer["strain"][1]["asd"].get<double>(), 0);
  EXPECT_EQ(straytrace(project({"--format", "json", "--seed", "3", "--threads", "1"})).out, got.out);
  EXPECT_NE(straytrace(project({"--format", "json", "--seed", "4"})).out, got.out);
}

TEST_F(Projected, SensorsReadTheSameFringes) {
  Words const words = {"sensors", at("run/run.h5"), "--motion", at("shaking.yaml"), "--duration", "8s", "--seed", "3"};
  auto const with = [&](Words more) {
    more.insert(more.begin(), words.begin(), words.end());
    return straytrace(more);
  };
  Finished const got =
      with({"--format", "json", "--at", "20 Hz", "-o", at("sensors.hdf5"), "--asd", at("sensors.txt")});
  ASSERT_EQ(got.code, 0) << got.err;
  auto const power = nlohmann::json::parse(got.out),
             phase = nlohmann::json::parse(with({"--format", "json", "--at", "20 Hz", "--kind", "phase"}).out);
  auto const asd = [](nlohmann::json const& j) { return j["sensors"][2]["asd_20Hz"].get<double>(); };
  EXPECT_NEAR(asd(power) / asd(phase), 2, 1e-9) << "dP/P = 2 Re s against Im s, mean over static phases";
  auto const loudest = std::ranges::find(power["sources"], "bench", [](auto const& row) { return row["sensor"]; });
  ASSERT_NE(loudest, power["sources"].end());
  EXPECT_EQ((*loudest)["source"], "sensor·S");
  EXPECT_GT((*loudest)["share"].template get<double>(), 0.99);
  EXPECT_THAT(text_of(at("sensors.txt")), HasSubstr("relative power dP/P by stray light"));
  EXPECT_FALSE(text_of(at("sensors.hdf5")).empty());
  Finished const wrong = with({"--kind", "quadrants"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'quadrant'?"));
}

// Unresolved routes that h(t) leaves out are a warning, in text and JSON; controls: routes that are named, all
// resolved.
TEST_F(Projected, RoutesLeftOutAreAWarning) {
  Finished const few = straytrace(
      {"run", source_folder + "/examples/virgo_arm.yaml", "-o", at("few"), "--histories", "2048", "--quiet"});
  ASSERT_EQ(few.code, 0) << few.err;
  Words const words{"project", at("few/run.h5"), "--duration", "8s"};
  EXPECT_THAT(straytrace(words).err, HasSubstr("unresolved and left out of h(t), so its level is a lower bound"));
  Words json = words;
  json.insert(json.end(), {"--format", "json"});
  EXPECT_THAT(straytrace(json).err, HasSubstr("left out of h(t)"));
  EXPECT_THAT(straytrace(project({})).err, Not(HasSubstr("left out of h(t)")));
}

// Every command that reads motion states where its files end; check and noise find the same mistakes.
TEST_F(Projected, MotionFilesGiveTheSameErrorsInAllCommands) {
  auto const with = [](std::string const& z) {
    return "straytrace: 1\nbodies:\n  ITM: {motion: still}\n  ETM: {motion: still}\n  bench: {motion: {z: {" + z +
           "}, others: still}}\n";
  };
  write_text(at("bench.txt"), "0.1 1e-9\n100 1e-12\n");
  write_text(at("short.yaml"), with("asd: bench.txt, columns: [Hz, m/sqrt(Hz)]"));
  write_text(at("bad.yaml"), with("asd: bench.txt, columns: [Hz, m], uncertainty: 30") + "noise: {band: 3}\n");
  std::string const run = at("run/run.h5"), warning = "above 100 Hz the body counts as still";
  for (Words const& words : {Words{"check", at("short.yaml")}, Words{"inspect", at("short.yaml")},
                             Words{"noise", run, "--motion", at("short.yaml")},
                             Words{"project", run, "--motion", at("short.yaml"), "--duration", "4s", "--route", "1"}}) {
    Finished const got = straytrace(words);
    EXPECT_EQ(got.code, 0) << words[0] << got.err;
    EXPECT_NE(got.err.find(warning), got.err.npos) << words[0] << got.err;
    EXPECT_EQ(got.err.find(warning), got.err.rfind(warning)) << words[0];
  }
  EXPECT_EQ(straytrace({"noise", run, "--motion", at("short.yaml"), "--quiet"}).err, "");
  EXPECT_EQ(straytrace({"check", at("short.yaml"), "--strict"}).code, 2);
  Finished const checked = straytrace({"check", at("bad.yaml")}),
                 projected = straytrace({"noise", run, "--motion", at("bad.yaml"), "-o", at("none")});
  EXPECT_EQ(checked.code, 2);
  EXPECT_EQ(projected.code, 2);
  EXPECT_EQ(checked.err, projected.err);
  EXPECT_NE(checked.err.find("3 errors"), checked.err.npos) << checked.err;
  EXPECT_FALSE(fs::exists(at("none")));
}

TEST_F(Projected, SavedMotionGivesTheSameStrain) {
  ASSERT_EQ(straytrace(project({"-o", at("h.csv"), "--save-motion", at("x.hdf5"), "--rate", "1024"})).code, 0);
  Finished const again =
      straytrace({"project", at("run/run.h5"), "--motion", at("shaking.yaml"), "--body", "bench", "--axis", "z",
                  "--channel", at("x.hdf5") + "::bench z", "--route", "1", "--rate", "1024", "-o", at("again.csv")});
  ASSERT_EQ(again.code, 0) << again.err;
  std::string const first = text_of(at("h.csv")), second = text_of(at("again.csv"));
  auto const numbers = [](std::string const& text) { return text.substr(text.find("\n0,")); };
  ASSERT_NE(first.find("\n0,"), first.npos) << first.substr(0, 500);
  EXPECT_EQ(numbers(first).substr(0, 3000), numbers(second).substr(0, 3000));
}

// Lines that are narrower than the bins of the noise are compared with a smooth curve through the bins, not with steps.
TEST_F(Projected, MeanBySpectraRunsThroughTheBins) {
  ASSERT_EQ(straytrace({"project", at("run/run.h5"), "--duration", "16s", "--segment", "8 s", "--route", "1", "--seed",
                        "5", "--asd", at("asd.txt"), "--quiet"})
                .code,
            0);
  std::istringstream lines(text_of(at("asd.txt")));
  std::vector<double> hz, mean;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    double f = 0, h = 0, sigma = 0, exact = 0;
    if (line.starts_with('#') || !(words >> f >> h >> sigma >> exact) || f < 100 || f > 200) continue;
    hz.push_back(f);
    mean.push_back(exact);
  }
  ASSERT_GT(hz.size(), 500u);
  std::size_t level = 0;  // the bins are 4 to 8 Hz wide, the lines 1/8 Hz
  for (std::size_t i = 1; i < hz.size(); ++i) level += mean[i] == mean[i - 1];
  EXPECT_LT(level, hz.size() / 50);
}

TEST_F(Projected, ARateThatAliasesIsAnError) {  // R4.10
  Finished const got = straytrace(project({"--rate", "128", "-o", at("none.csv")}));
  EXPECT_EQ(got.code, 2);
  EXPECT_NE(got.err.find("eq. 7.13"), got.err.npos) << got.err;
  EXPECT_NE(got.err.find("must be above"), got.err.npos) << got.err;
  EXPECT_FALSE(fs::exists(at("none.csv")));
}

TEST_F(Projected, ErrorsOfTheCommandLineAreExplained) {
  auto const error = [](Words const& words) {
    Finished const got = straytrace(words);
    EXPECT_EQ(got.code, 2) << got.out;
    return got.err;
  };
  EXPECT_NE(error(project({"--body", "bench"})).find("0 times --channel"), std::string::npos);
  EXPECT_NE(error(project({"--moved-by", "bensh"})).find("did you mean 'bench'?"), std::string::npos);
  std::string const names = error({"project", at("run/run.h5"), "--route", "nowhere", "--route", "99999", "--port",
                                   "no", "--body", "bench", "--axis", "z", "--channel", at("missing.hdf5")});
  EXPECT_NE(names.find("--route: 'nowhere' is part of no route name"), std::string::npos) << names;
  EXPECT_NE(names.find("--route: '99999' is no rank"), std::string::npos) << names;
  EXPECT_NE(names.find("--port: 'no'"), std::string::npos) << names;
  EXPECT_EQ(names.find("missing.hdf5"), std::string::npos) << "names are checked before files are read";
  EXPECT_NE(error(project({"--asd", "h.doc"})).find("--asd"), std::string::npos);
  EXPECT_NE(error({"fringes", "--channel", "x.hdf5"}).find("--wavelength"), std::string::npos);
  EXPECT_NE(error({"fringes", "x.h5", "--stride", "0 s"}).find("--stride: '0 s' is not positive"), std::string::npos);
  std::string const of_coupling = error({"project", "c.csv", "--witness", "x.hdf5::x", "-o", "h.png", "--rate", "64"});
  EXPECT_NE(of_coupling.find("error: -o: "), std::string::npos) << of_coupling;
  EXPECT_NE(of_coupling.find("error: --rate: "), std::string::npos) << of_coupling;
  EXPECT_NE(error(project({"--target", "h.hdf5::h"})).find("--target"), std::string::npos);
}

TEST_F(Projected, FringesOfARunAndOfAChannelAgree) {
  Finished const of_run = straytrace({"fringes", at("run/run.h5"), "--motion", at("shaking.yaml"), "--duration", "8s",
                                      "--route", "1", "--stride", "4s", "--above", "50Hz"});
  ASSERT_EQ(of_run.code, 0) << of_run.err;
  EXPECT_NE(of_run.out.find("67.3"), of_run.out.npos) << of_run.out;
  EXPECT_NE(of_run.out.find("bench 1.00"), of_run.out.npos) << of_run.out;
  EXPECT_NE(of_run.out.find("above 50 Hz from GPS 0 to 8"), of_run.out.npos) << of_run.out;
  ASSERT_EQ(straytrace(project({"--save-motion", at("y.hdf5")})).code, 0);
  Finished const of_channel = straytrace({"fringes", "--wavelength", "1064nm", "--bounces", "2", "--channel",
                                          at("y.hdf5") + "::bench z", "-o", at("fringes.csv")});
  ASSERT_EQ(of_channel.code, 0) << of_channel.err;
  EXPECT_NE(of_channel.out.find("134.6"), of_channel.out.npos) << of_channel.out;  // two bounces
  Finished const negative = straytrace({"fringes", "--wavelength", "-1064nm", "--channel", at("y.hdf5") + "::bench z"});
  EXPECT_EQ(negative.code, 2) << negative.out;
  EXPECT_NE(negative.err.find("--wavelength: '-1064nm' is not positive"), negative.err.npos) << negative.err;
}

// A long projection shows its progress; Ctrl-C ends it at once and leaves no file, not even part of one. Control: a
// short one shows no progress and writes both files.
TEST_F(Projected, ShowsProgressAndLeavesNoFileWhenInterrupted) {
  Folder const results;
  auto const words = [&](Words more) {
    Words all = project({"--asd", results / "asd.txt", "-o", results / "h.txt"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  auto const files = [&] { return std::distance(fs::directory_iterator(results.path()), fs::directory_iterator()); };
  Program running(words({"--realisations", "100000"}), {.paced = true});
  ASSERT_TRUE(running.says(" left\n"));
  running.interrupt();
  Finished const stopped = running.wait();
  EXPECT_THAT(stopped.err, ::testing::ContainsRegex("project  [0-9]+ % of 8 s of h\\(t\\)  about [0-9]+ s left"));
  EXPECT_GE(stopped.code, 128) << stopped.err;  // by the signal
  EXPECT_EQ(stopped.out, "");
  EXPECT_EQ(files(), 0);
  Finished const whole = straytrace(words({}));
  EXPECT_EQ(whole.code, 0) << whole.err;
  EXPECT_EQ(whole.err.find(" left\n"), std::string::npos) << whole.err;
  EXPECT_EQ(files(), 2);
}

}  // namespace
}  // namespace straytrace::testing::app_project
