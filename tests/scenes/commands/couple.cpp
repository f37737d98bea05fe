// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple on the example records, whose truth is known (docs/reference/couple.md).

#include <cmath>
#include <complex>
#include <cstdio>
#include <sstream>

#include "scenes/answers.hpp"

namespace straytrace::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

Words noise_words() {
  return {"couple",      "noise",
          "--witness",   data("shaken.csv") + "::ACC",
          "--target",    data("shaken.csv") + "::H",
          "--injection", "24..48",
          "--quiet",     "0..24",
          "--segment",   "2 s"};
}

// |H| of the mode at 12 Hz, tau 0.15 s, 4e-22 per um/s^2.
double mode(double hz) {
  double const r = std::exp(-1 / (0.15 * 50)), turn = 2 * M_PI * 12 / 50;
  std::complex<double> const z = std::polar(1.0, -2 * M_PI * hz / 50);
  return 4e-22 / 1e-6 / std::abs(1.0 - 2 * r * std::cos(turn) * z + r * r * z * z);
}

TEST(Couple, NoiseTellsAllMissingFilesAtOnce) {
  Finished const f = straytrace({"couple", "noise", "--witness", "a.csv::ACC", "--target", "b.csv::H", "--injection",
                                 "c.csv", "--quiet", "d.csv@0..24", "--segments", "e.txt", "--band", "4 Hz..2 Hz"});
  EXPECT_EQ(f.code, 2);
  for (char const* says :
       {"'a.csv'", "'b.csv'", "'c.csv'", "'d.csv@0..24'", "'e.txt'", "'4 Hz..2 Hz' is not a rising range"})
    EXPECT_THAT(f.err, HasSubstr(says));
}

TEST(Couple, NoiseFindsTheTrueCouplingAndIsReadBackR6_01) {
  Folder const folder;
  std::string const csv = folder / "acc.csv";
  Words words = noise_words();
  words.insert(words.end(), {"--save", csv, "--silent"});
  Finished const f = straytrace(words);
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("coupling [1/(um/s^2)]"));
  std::string const saved = text_of(csv);
  EXPECT_TRUE(saved.starts_with("frequency,factor,factor_counts,flag,"));
  EXPECT_THAT(saved, HasSubstr("Upper Limit"));
  int inside = 0, measured = 0;
  std::istringstream lines(saved);
  for (std::string line; std::getline(lines, line);) {
    double hz = 0, factor = 0, sigma = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,,Real,%lf", &hz, &factor, &sigma) != 3 || hz < 3) continue;
    ++measured;
    inside += std::fabs(factor * 1e6 - mode(hz)) < 2 * sigma * 1e6;
  }
  EXPECT_GT(measured, 3);
  EXPECT_GE(inside, 0.8 * measured);
}

TEST(Couple, StretchesMayBeFilesAndTheWitnessMetres) {
  Finished const f = straytrace({"couple", "noise", "--injection", data("shaken.csv") + "::ACC@24..48", "--quiet",
                                 data("shaken.csv") + "@0..24", "--target", "H", "--displacement", "--segment", "1 s"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("coupling [1/m]"));
}

TEST(Couple, TapsNameTheRightPlaceR6_02) {
  json const j =
      answer({"couple", "taps", "--force", data("taps.csv") + "::HAMMER", "--target", data("taps.csv") + "::H",
              "--list", data("tap_list.csv"), "--quiet", "0..8", "--band", "29 Hz..33 Hz"});
  ASSERT_FALSE(j["result"].empty());
  for (json const& peak : j["result"]) EXPECT_EQ(peak["places"][0]["place"], "link");
  EXPECT_FALSE(j["result"][0]["places"][0]["not_linear"]);
}

// The hard taps of "link" from 26 to 32 are inactive: their repeat, and with it the slope, is gone. Data that are never
// used may be damaged. Negative control: a flag that is always active changes no number.
TEST(Couple, TapsWhereAFlagIsActiveR6_02) {
  Folder const folder;
  write_text(folder / "good.txt", "0 14\n14 20\n21 25.5\n");
  write_text(folder / "always.txt", "-100 100\n");
  Words const words{"couple",   "taps",
                    "--force",  data("taps.csv") + "::HAMMER",
                    "--target", data("taps.csv") + "::H",
                    "--list",   data("tap_list.csv"),
                    "--quiet",  "0..8",
                    "--band",   "29 Hz..33 Hz"};
  auto const with = [&](std::string const& file) {
    Words all = words;
    all.insert(all.end(), {"--segments", folder / file, "--format", "json"});
    return straytrace(all);
  };
  EXPECT_EQ(json::parse(with("always.txt").out)["result"], answer(words)["result"]);
  Finished const some = with("good.txt");
  ASSERT_EQ(some.code, 0) << some.err;
  EXPECT_THAT(some.err, HasSubstr("'link' at 26 is left out"));
  EXPECT_THAT(some.err, ::testing::Not(HasSubstr("'bench'"))) << "4.5 s hold eight segments of 1 s";
  json const link = json::parse(some.out)["result"][0]["places"][0];
  EXPECT_EQ(link["place"], "link");
  EXPECT_EQ(link["repeats"], 1);
  EXPECT_TRUE(link["slope"].is_null());
  EXPECT_EQ(answer(words)["result"][0]["places"][0]["repeats"], 2);
  write_text(folder / "never.txt", "0 8\n");
  EXPECT_THAT(with("never.txt").err, HasSubstr("leaves out all places"));
}

// All places at once, each where the list names it. The negative control is the list as it is, above.
TEST(Couple, TapsOutsideTheDataNameTheirLineR6_02) {
  Folder const folder;
  write_text(folder / "list.csv", "place,start,duration\ntower,8,6\nlink,5000,6\ndoor,14,6\nroof,-50,6\n");
  std::string const said = error_text({"couple", "taps", "--force", data("taps.csv") + "::HAMMER", "--target",
                                       data("taps.csv") + "::H", "--list", folder / "list.csv", "--quiet", "0..8"});
  EXPECT_THAT(said, HasSubstr("list.csv:3:6: error: 'link' from 5000 to 5006 is outside the data, which run from "));
  EXPECT_THAT(said, HasSubstr("list.csv:5:6: error: 'roof' from -50 to -44 is outside the data"));
  EXPECT_THAT(said, HasSubstr("\n  correct its start and duration"));
  EXPECT_THAT(said, ::testing::Not(HasSubstr("'tower'")));
}

TEST(Couple, LinesAndRampFindThePhaseR6_03) {
  Words const common{"--witness", data("shaker.csv") + "::DRIVE",
                     "--target",  data("shaker.csv") + "::H",
                     "--band",    "9 Hz..11 Hz",
                     "--window",  "1 s"};
  auto const with = [&](Words words, Words const& more) {
    words.insert(words.end(), common.begin(), common.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  json const lines = answer(with({"couple", "lines"}, {"--gps", "20..28"}))["result"];
  EXPECT_THAT(error_text(with({"couple", "lines"}, {"--wavelength", "-1064nm"})),
              HasSubstr("--wavelength: '-1064nm' is not positive"));
  double const z = 4 * M_PI * 100e-9 / 1064e-9;
  EXPECT_EQ(lines["verdict"], "fringe");
  EXPECT_NEAR(lines["z"], z, 4 * (double(lines["z_high"]) - double(lines["z_low"])) / 2);
  EXPECT_NEAR(lines["motion"], 100e-9, 20e-9);
  Folder const folder;
  json const ramp = answer(with({"couple", "ramp"}, {"--gps", "0..20", "--save", folder / "line.csv"}))["result"];
  EXPECT_EQ(ramp["verdict"], "fringe");
  EXPECT_NEAR(ramp["z"], 2 * z, 4 * (double(ramp["z_high"]) - double(ramp["z_low"])) / 2);
  EXPECT_THAT(text_of(folder / "line.csv"), HasSubstr("Fringe wrapped"));
}

TEST(Couple, FactorsWithoutUnitsAreProjectedInTheGivenUnitR6_08) {
  Folder const folder;
  std::string const csv = folder / "c.csv", out = folder / "p.csv", bench = data("bench.csv") + "::bench";
  write_text(csv, "frequency,factor,factor_counts,flag\n5,2,7,Real\n40,2,7,Real\n");
  auto const project = [&](std::string const& unit, Words more = {}) {
    Words words = {"project", csv, "--witness", bench, "--coupling-unit", unit, "--segment", "4 s"};
    words.insert(words.end(), more.begin(), more.end());
    return straytrace(words);
  };
  auto const at_10_hz = [&](std::string const& unit, Words const& more = {}) {
    Words words = {"--asd", out, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(project(unit, words).code, 0);
    double asd = 0;
    std::istringstream lines(text_of(out));
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("10,")) asd = std::stod(line.substr(3));
    return asd;
  };
  double const per_um = at_10_hz("1/um");  // bench.csv is in um
  EXPECT_GT(per_um, 0);
  EXPECT_NEAR(at_10_hz("1/m") / per_um, 1e-6, 1e-12) << "2 per metre, of a witness in um";
  EXPECT_NEAR(at_10_hz("nm/um", {"--target", bench}) / per_um, 1e-3, 1e-9) << "nm, shown in the um of the target";
  EXPECT_THAT(project("1/um").out, HasSubstr("error unknown")) << "pemcoupling has no errors, but values";
  EXPECT_THAT(project("1/um").out, ::testing::Not(HasSubstr("unresolved")));
  EXPECT_THAT(project("1/(m/s^2)").err, HasSubstr("is not per um"));
  EXPECT_THAT(project("m").err, HasSubstr("is not per um"));
  EXPECT_THAT(project("1/m", {"--target", bench}).err, HasSubstr("but the coupling gives 1"));
}

TEST(Couple, SweepImpulseAndEvents) {
  Finished const sweep =
      straytrace({"couple", "sweep", "--witness", data("sweep.csv") + "::MIC", "--target", data("sweep.csv") + "::H",
                  "--band", "8 Hz..45 Hz", "--window", "1 s", "--show", "1"});
  EXPECT_EQ(sweep.code, 0) << sweep.err;
  EXPECT_THAT(sweep.out, HasSubstr("coupling [1/Pa]"));
  json const impulse = answer({"couple", "impulse", "--force", data("taps.csv") + "::HAMMER", "--target",
                               data("taps.csv") + "::H", "--gps", "26..32", "--length", "1.5 s"})["result"];
  ASSERT_EQ(impulse["modes"].size(), 1u) << "humps of noise are not modes";
  EXPECT_NEAR(impulse["modes"][0]["frequency"], 31, 0.05);
  EXPECT_NEAR(impulse["modes"][0]["quality"], M_PI * 31 * 0.3, 4);
  json const events = answer({"couple", "events", data("shaken.csv") + "::H", "--quiet", "0..24", "--segment", "1 s",
                              "--averages", "12"})["result"];
  ASSERT_FALSE(events.empty());
  EXPECT_NEAR(events[0]["frequency"], 12, 2);
  EXPECT_GE(events[0]["to"], 30.0);
}

TEST(Couple, ErrorsNameTheRemedy) {
  auto const said = [](Words const& words) {
    Finished const f = straytrace(words);
    EXPECT_EQ(f.code, 2);
    EXPECT_EQ(f.out, "");
    return f.err;
  };
  Words two = noise_words();
  two.insert(two.end(), {"--witness", data("shaken.csv") + "::H", "--save", "x.csv"});
  EXPECT_THAT(said(two), HasSubstr("--save writes one coupling"));
  Words ending = noise_words();
  ending.insert(ending.end(), {"-o", "x.doc"});
  EXPECT_THAT(said(ending), HasSubstr("x.doc"));
  EXPECT_THAT(
      said({"couple", "ramp", "--witness", data("shaker.csv") + "::DRIVE", "--target", data("shaker.csv") + "::H"}),
      HasSubstr("write --band"));
  EXPECT_THAT(said({"couple", "nois"}), HasSubstr("did you mean 'noise'?"));
  EXPECT_THAT(said({"couple", "noise", "--targ", "x"}), HasSubstr("straytrace couple noise --help"));
  EXPECT_THAT(said({"couple", "taps", "--force", data("taps.csv") + "::HAMER", "--target", data("taps.csv") + "::H",
                    "--list", data("tap_list.csv"), "--quiet", "0..8"}),
              HasSubstr("did you mean 'HAMMER'?"));
}

}  // namespace
}  // namespace straytrace::testing
