// SPDX-License-Identifier: BSD-3-Clause
// straytrace wave with photodiodes, and straytrace fit baffle (docs/theory/wave.md, eq. W.40 to W.44).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "physics/wave/kilometre_arm.hpp"
#include "results/results.hpp"
#include "scenes/answers.hpp"
#include "session/light/cavity_waves.hpp"

namespace straytrace::testing::app_fit_baffle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A baffle at the end of a kilometre that may be off the axis, with photodiodes in the tail of the beam.
std::string scene_text() {
  KilometreArm arm;
  arm.baffles =
      "  - {name: baffle, shape: {disk: {inner_radius: 47 mm, outer_radius: 10 cm}}, at: [shift, 0 m, 990 m],"
      " facing: [0, 0, -1], body: pipe, material: black}\n";
  arm.wave =
      "wave: {beam: arm, baffles: baffle, crossover: 60 urad, grid: {points: 128, window: 0.42 m},"
      " maps: {I: {spectrum: none}, E: {spectrum: none}},"
      " photodiodes: {name: d, on: baffle, towards: E, radius: 50 mm, count: 8, size: 4 mm}}\n";
  std::string const scatter = ", scatter: {model: power-law, kappa: 5e-7 /sr, exponent: 2, above: 1 urad}";
  std::string const smooth = edited(arm.text(), scatter, "");
  return edited(smooth, "straytrace: 1\n", "straytrace: 1\nparams: {shift: 0 mm, power: 10 kW}\n") +
         "interferometer: {preset: fabry-perot-michelson, arm_length: 1 km, mirror_mass: 42 kg,"
         " input_transmission: 1.4 %}\n"
         "noise: {band: [10 Hz, 100 Hz], points_per_decade: 5}\n";
}

class FitBaffle : public ::testing::Test {
 protected:
  FitBaffle() { write_text(scene_, edited(scene_text(), "power: 10 kW}}", "power: power}}")); }
  // What the photodiodes measure at a shift, one of them wrong by a share.
  void measure(std::string const& shift, double wrong = 0) {
    std::string const all = folder_ / "all.csv";
    EXPECT_EQ(straytrace({"wave", scene_, "--csv", all, "--quiet", "-p", "shift=" + shift}).code, 0);
    std::istringstream rows(text_of(all));
    std::string text = "photodiode, power [W], error [W]\n", row;
    std::getline(rows, row);
    for (int i = 0; std::getline(rows, row); ++i) {
      std::istringstream cells(row);
      std::string name, x, y, power;
      std::getline(std::getline(std::getline(std::getline(cells, name, ','), x, ','), y, ','), power, ',');
      double const watts = std::stod(power) * (1 + (i == 0 ? wrong : 0));
      text += name + ", " + std::to_string(1e9 * watts) + "e-9, " + std::to_string(1e7 * std::stod(power)) + "e-9\n";
    }
    write_text(csv_, text);  // errors of 1 %
  }
  Words fit(Words const& more = {"--free", "shift=-1..1 mm"}) const {
    Words words{"fit", "baffle", scene_, "--measured", csv_, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Folder const folder_;
  std::string const scene_ = folder_ / "arm.yaml", csv_ = folder_ / "measured.csv";
};

TEST_F(FitBaffle, RecoversTheTruthAndRejectsAnother) {
  measure("0.3 mm");
  auto const found = answer(fit());
  auto const& shift = found["parameters"][0];
  EXPECT_NEAR(shift["value"].get<double>(), 0.3, 0.3 * shift["sigma"].get<double>());  // the data have no noise
  EXPECT_LT(shift["sigma"].get<double>(), 0.1);
  EXPECT_FALSE(found["rejected"].get<bool>());
  EXPECT_EQ(found["photodiodes"].size(), 8u);
  EXPECT_LT(found["photodiodes"][0]["speckle_share_of_variance"].get<double>(), 1e-9);  // perfect mirrors
  measure("0.3 mm", 0.2);  // negative control: a photodiode with a wrong calibration
  auto const wrong = answer(fit());
  EXPECT_TRUE(wrong["rejected"].get<bool>());
  EXPECT_GT(std::abs(wrong["photodiodes"][0]["pull"].get<double>()), 3);
  Finished const text = straytrace(fit());
  EXPECT_THAT(text.out, AllOf(HasSubstr("8 photodiodes, 10000 W in 'arm'"), HasSubstr("the data REJECT the model"),
                              HasSubstr("\nshift")));
}

// The watts of the table --csv are in the run file of `wave`, stay there when histories are added, and are on the page;
// a field that `trace` solves has none.
TEST_F(FitBaffle, RunFilesKeepTheLightOnPhotodiodes) {
  std::string const run = folder_ / "run.h5", all = folder_ / "all.csv";
  auto const solved = [&](std::string const& shift) {
    EXPECT_EQ(straytrace({"wave", scene_, "--csv", all, "-o", run, "--force", "--quiet", "-p", "shift=" + shift}).code,
              0);
    return *read_run(run).about.waves;
  };
  wave::WaveRecord const record = solved("0.3 mm");
  ASSERT_EQ(record.diodes.size(), 8u);
  std::istringstream rows(text_of(all));
  std::string row;
  std::getline(rows, row);
  for (wave::DiodeRecord const& d : record.diodes) {
    std::getline(rows, row);
    std::replace(row.begin(), row.end(), ',', ' ');
    std::istringstream cells(row);
    std::string name;
    double x = 0, y = 0, power = 0, mean = 0;
    cells >> name >> x >> y >> power >> mean;
    EXPECT_EQ(d.name, name);
    EXPECT_EQ(d.rim, 0u);
    EXPECT_FALSE(d.towards_mirror1);
    EXPECT_NEAR(d.centre[0], x, 1e-15);
    EXPECT_NEAR(d.area, 16e-6, 1e-15);
    EXPECT_NEAR(record.power * d.power, power, 1e-12 * power);
    EXPECT_NEAR(record.power * d.mean, mean, 1e-12 * mean);
    EXPECT_NEAR(d.spread, 0, 1e-9 * d.mean);  // perfect mirrors
  }
  Words const trace{"trace", scene_, "--histories", "4096", "--quiet", "-p", "shift=0.3 mm", "-o"};
  auto const traced = [&](std::string const& file) {
    Words words = trace;
    words.push_back(file);
    EXPECT_EQ(straytrace(words).code, 0);
    return read_run(file).about.waves->diodes;
  };
  std::vector<wave::DiodeRecord> const resumed = traced(run);
  ASSERT_EQ(resumed.size(), 8u);
  EXPECT_EQ(resumed[3].power, record.diodes[3].power);
  EXPECT_EQ(straytrace({"report", run, "-o", folder_ / "page.html", "--quiet"}).code, 0);
  EXPECT_THAT(text_of(folder_ / "page.html"), HasSubstr("\"name\":\"d_8\",\"power\":"));
  EXPECT_TRUE(traced(folder_ / "none.h5").empty());
  EXPECT_GT(std::fabs(solved("-0.3 mm").diodes[0].power / record.diodes[0].power - 1), 0.05);  // control
}

TEST_F(FitBaffle, ErrorsSayWhatIsWrong) {
  auto const refused = [&](std::string const& csv, Words const& more = {"--free", "shift=-1..1 mm"}) {
    write_text(csv_, csv);
    Finished const done = straytrace(fit(more));
    EXPECT_EQ(done.code, 2);
    return done.err;
  };
  std::string const head = "photodiode, power [W], error [W]\n";
  EXPECT_THAT(refused(head + "d_9, 1e-6, 1e-8\nd_1, 1e-6, 1e-8\n"),
              AllOf(HasSubstr("measured.csv:2"), HasSubstr("the scene has no photodiode 'd_9'")));
  EXPECT_THAT(refused(head + "d_1, 1e-6, 0\nd_1, 1e-6, 1e-8\n"),
              AllOf(HasSubstr("the error of 'd_1' is not above zero"), HasSubstr("'d_1' is measured twice")));
  EXPECT_THAT(refused("photodiode, power [W]\nd_1, 1e-6\n"), HasSubstr("no column 'error'"));
  EXPECT_THAT(refused("photodiode, power [W], error [m]\nd_1, 1e-6, 1\n"), HasSubstr("column 'error' is a power"));
  std::string const two = head + "d_1, 1e-6, 1e-8\nd_2, 1e-6, 1e-8\n";
  EXPECT_THAT(refused(two, {"--free", "shift=1..-1 mm", "--free", "shift"}),
              AllOf(HasSubstr("does not rise"), HasSubstr("names no parameter")));
  EXPECT_THAT(refused(two, {"--free", "shifd=-1..1 mm"}),
              AllOf(HasSubstr("error: --free \"shifd=-1..1 mm\": parameter 'shifd' is not defined in the model"),
                    HasSubstr("did you mean 'shift'?")));
  EXPECT_THAT(refused(two, {"--free", "shift=-1..1 mm", "-p", "shift=0 mm"}),
              HasSubstr("--free and -p both set 'shift'"));
  EXPECT_THAT(refused(two, {"--free", "shift=-1..1 mm", "--free", "power=9..11 kW"}),
              HasSubstr("2 measured and 2 free: nothing is left to test"));
}

// A range about 0 needs its unit although its middle does not. Before any field: at once.
TEST_F(FitBaffle, AllErrorsAreToldAtOnce) {
  write_text(csv_, "photodiode, power [uW], error [nW]\nd_1, 1, 0\n  d_9, 1, 1\nd_1, 1, 1\n");
  std::string const all = error_text(fit(
      {"--free", "shift=-1..1", "--free", "shift=-2..2 mm", "--free", "powr=9..11 kW", "--free", "power=9..11 kW"}));
  for (char const* const part :
       {"--free \"shift=-1..1\": 'shift' is a length, got \"-1\" without a unit", "--free: 'shift' is free twice",
        "--free \"powr=9..11 kW\": parameter 'powr' is not defined", "measured.csv:2:9: error: the error of 'd_1'",
        "measured.csv:3:3: error: the scene has no photodiode 'd_9'",
        "measured.csv:4:1: error: photodiode 'd_1' is measured twice", "3 measured and 3 free"})
    EXPECT_THAT(all, HasSubstr(part));
  EXPECT_THAT(all, AllOf(Not(HasSubstr("-p ")), Not(HasSubstr("command line"))));
}

// The power of the beam is a parameter like any other: twice the light is twice the power.
TEST_F(FitBaffle, FindsThePowerInMicrowatts) {
  measure("0.3 mm");
  std::istringstream rows(text_of(csv_));
  std::string text = "photodiode, power [uW], error [nW]\n", row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    std::string name, power, error;
    std::getline(std::getline(std::getline(cells, name, ','), power, ','), error, ',');
    text += fmt::format("{}, {:.12g}, {:.12g}\n", name, 2e6 * std::stod(power), 2e9 * std::stod(error));
  }
  write_text(csv_, text);
  auto const found = answer(fit({"-p", "shift=0.3 mm", "--free", "power=5..30 kW"}));
  EXPECT_NEAR(found["parameters"][0]["value"].get<double>(), 20, 0.01);
  EXPECT_NEAR(found["arm_power_w"].get<double>(), 20e3, 10);
}

// Only `straytrace wave` and `fit baffle` give the light on photodiodes; a trace does not compute it.
TEST_F(FitBaffle, TracesLeavePhotodiodesOut) {
  SceneOptions quiet;
  quiet.quiet = true;
  Model model = read_model(scene_, {});
  ArmWaves const of_trace = solved_or_known(model, 1, quiet), whole = solve_waves(model, 1, quiet, {});
  EXPECT_TRUE(of_trace.diodes.empty());
  EXPECT_EQ(whole.diodes.size(), 8u);
  EXPECT_EQ(of_trace.mode.eigenvalue, whole.mode.eigenvalue);
}

TEST_F(FitBaffle, CsvHasUnitsAndAllDigits) {
  std::string const csv = folder_ / "all.csv";
  auto const all = answer({"wave", scene_, "--csv", csv, "--quiet"});
  std::istringstream rows(text_of(csv));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "photodiode,x [m],y [m],power [W],mean [W],spread [W]");
  std::getline(rows, row);
  double const share = all["photodiodes"][0]["power_share_mean"];
  EXPECT_THAT(row, HasSubstr(fmt::format(",{},", 10e3 * share)));
}

TEST_F(FitBaffle, WaveListsPhotodiodes) {
  Finished const text = straytrace({"wave", scene_, "--quiet", "--show", "2", "--order", "0"});
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("photodiode  radius/mm  azimuth/deg"), HasSubstr("d_2 "), Not(HasSubstr("d_3 "))));
  auto const json = answer({"wave", scene_, "--quiet", "--order", "0"});
  ASSERT_EQ(json["photodiodes"].size(), 8u);
  auto const& one = json["photodiodes"][0];
  // Perfect mirrors: the draw is the mean.
  EXPECT_NEAR(one["power_shares"][0].get<double>() / one["power_share_mean"].get<double>(), 1, 1e-2);
}

}  // namespace
}  // namespace straytrace::testing::app_fit_baffle
