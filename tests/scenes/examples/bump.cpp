// SPDX-License-Identifier: BSD-3-Clause
// A bump at 70 Hz, its witnesses in counts and an injection, on records whose truth is known (docs/guide/bump.md,
// tools/data/make_bump_example.py): h = G sin(0.7 + 4 pi x/lambda), G = 4.5e-21.
#include <cmath>
#include <sstream>

#include "scenes/answers.hpp"

namespace straytrace::testing::app_bump {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string const quiet = data("bump_quiet.hdf5"), shaken = data("bump_shaken.hdf5");
double const gain = 4.5e-21, per_metre = gain * 4 * M_PI / 1064e-9;

Words injection(std::string const& witness, std::string const& unit, std::string const& band, Words more = {}) {
  Words words{"couple",   "noise", "--injection",    shaken, "--quiet",        quiet,    "--witness", witness,
              "--target", "H",     "--witness-unit", unit,   "--displacement", "--band", band};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// The number behind "together: ".
double together(Words const& words) {
  Finished const f = straytrace(words);
  EXPECT_EQ(f.code, 0) << f.err;
  std::string const mark = "together: ";
  auto const at = f.out.find(mark);
  return at == f.out.npos ? 0 : std::stod(f.out.substr(at + mark.size()));
}

TEST(Bump, SlowMotionOfTheLinkGivesGainAndOneBounce) {
  json const fit = answer({"fit", "--target", quiet + "::H", "--witness", quiet + "::SEIS", "--witness-unit",
                           "2e-9 m/s", "--corner", "0.05 Hz", "--band", "8 Hz..30 Hz"});
  json const& path = fit["paths"][0];
  EXPECT_NEAR(path["multiplicity"]["value"].get<double>(), 1, 0.01);
  EXPECT_NEAR(path["amplitude"]["value"].get<double>(), gain, 0.05 * gain);
}

// C.13: 2kG/sqrt(2). The unit of a count is in it; the bench, which feels a twentieth, seems to couple far more.
TEST(Bump, WholeBandHasTheCouplingOfSmallMotion) {
  double const link = together(injection("ACC_LINK", "2e-6 m/s^2", "50 Hz..90 Hz"));
  EXPECT_NEAR(link, per_metre / std::sqrt(2), 0.12 * per_metre);
  EXPECT_NEAR(together(injection("ACC_LINK", "4e-6 m/s^2", "50 Hz..90 Hz")) / link, 0.5, 0.01);
  EXPECT_GT(together(injection("ACC_BENCH", "2e-6 m/s^2", "60 Hz..78 Hz")), 10 * link);
  EXPECT_THAT(straytrace(injection("ACC_LINK", "2e-6 m/s^2", "67 Hz..73 Hz")).out, HasSubstr("choose a wider band"));
}

TEST(Bump, CountsNeedACalibrationAndMetresDoNot) {
  EXPECT_THAT(straytrace(injection("ACC_LINK", "count", "50 Hz..90 Hz")).err, HasSubstr("2e-6 m/s^2"));
  EXPECT_THAT(straytrace(injection("ACC_LINK", "0 m/s^2", "50 Hz..90 Hz")).err, HasSubstr("calibrates with 0"));
  EXPECT_THAT(straytrace({"fit", "--target", quiet + "::H", "--witness", data("bench.csv") + "::acc", "--witness-unit",
                          "2e-6 m/s^2", "--band", "8 Hz..30 Hz"})
                  .err,
              HasSubstr("needs no calibration"));
  Finished const second =
      straytrace({"fit", "--target", quiet + "::H", "--witness", quiet + "::SEIS", "--witness-unit", "2e-9 m/s",
                  "--witness2", quiet + "::ACC_LINK", "--corner", "0.05 Hz", "--band", "8 Hz..30 Hz"});
  EXPECT_EQ(second.code, 2);
  EXPECT_THAT(second.err, HasSubstr("--witness2-unit")) << "the unit of the first is not that of the second";
}

// 3.2e-9 m/sqrt(Hz) of the ring at 70 Hz times some 4e-14 1/m; an accelerometer taken as metres is off by 2e5.
TEST(Bump, AccelerometerIsProjectedByACouplingPerMetre) {
  Folder const folder;
  std::string const csv = folder / "c.csv", out = folder / "p.csv";
  ASSERT_EQ(
      straytrace(injection("ACC_LINK", "2e-6 m/s^2", "68 Hz..72 Hz", {"--accept-incoherent", "--save", csv})).code, 0);
  auto const at_70_hz = [&](std::string const& unit) {
    Finished const f = straytrace({"project", csv, "--witness", quiet + "::ACC_LINK", "--unit", unit, "--segment",
                                   "8 s", "--asd", out, "--quiet"});
    EXPECT_EQ(f.code, 0) << f.err;
    std::istringstream lines(text_of(out));
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("70,")) return std::stod(line.substr(3));
    return 0.0;
  };
  double const h = at_70_hz("2e-6 m/s^2");
  EXPECT_GT(h, 0.4e-22);
  EXPECT_LT(h, 4e-22);
  EXPECT_NEAR(at_70_hz("4e-6 m/s^2") / h, 2, 1e-6);
}

TEST(Bump, ARecordIsNotARunFile) {
  Finished const f = straytrace({"inspect", quiet});
  EXPECT_THAT(f.err, HasSubstr("but not a run file"));
  EXPECT_THAT(f.err, HasSubstr("signal psd"));
}

}  // namespace
}  // namespace straytrace::testing::app_bump
