// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple: several witnesses, stretches that share time, units that contradict, sweeps, and a measured
// coupling against a predicted one (R6.01 to R6.08).
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scenes/answers.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

using nlohmann::json;
using std::numbers::pi;
using ::testing::HasSubstr;

Words noise_words(std::string const& injection, std::string const& quiet, Words more = {}) {
  Words all{"couple", "noise",     "--target", data("shaken.csv") + "::H", "--injection", injection, "--quiet",
            quiet,    "--segment", "1 s"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

Words const acc{"--witness", data("shaken.csv") + "::ACC"};

TEST(CoupleRecords, OverlappingStretchesAreErrors) {
  EXPECT_THAT(error_text(noise_words("20..48", "0..24", acc)),
              HasSubstr("--quiet 0..24 and --injection 20..48 share the time from 20 to 24"));
  EXPECT_THAT(
      error_text(noise_words("24..40", "0..24", {"--injection", "36..48", "--witness", data("shaken.csv") + "::ACC"})),
      HasSubstr("share the time from 36 to 40"));
  EXPECT_EQ(straytrace(noise_words("24..48", "0..24", acc)).code, 0) << "one ends where the other begins";
  Folder const folder;  // files that count their own seconds are other data
  write_text(folder / "quiet.csv", text_of(data("shaken.csv")));
  EXPECT_EQ(straytrace({"couple", "noise", "--witness", "ACC", "--target", "H", "--injection",
                        data("shaken.csv") + "@24..48", "--quiet", folder / "quiet.csv@20..30", "--segment", "1 s"})
                .code,
            0);
  EXPECT_THAT(error_text({"couple", "taps", "--force", data("taps.csv") + "::HAMMER", "--target",
                          data("taps.csv") + "::H", "--list", data("tap_list.csv"), "--quiet", "0..9"}),
              HasSubstr("'tower'"));
}

// Where the channels name their file, a stretch that is no stretch and no file, or another file, does not pass for the
// whole record.
TEST(CoupleRecords, StretchesThatNoChannelUsesAreErrors) {
  for (char const* wrong : {"nope.csv", "24-48", "24:48", "nope.csv@24..48"}) {
    EXPECT_THAT(error_text(noise_words(wrong, "0..24", acc)),
                HasSubstr(fmt::format("--injection: '{}' is neither a stretch A..B nor a readable file", wrong)));
    EXPECT_THAT(error_text(noise_words("24..48", wrong, acc)),
                HasSubstr(fmt::format("--quiet: '{}' is neither a stretch A..B nor a readable file", wrong)));
  }
  EXPECT_THAT(error_text(noise_words(data("sweep.csv") + "@24..48", "0..24", acc)), HasSubstr("are in other files"));
  EXPECT_EQ(straytrace(noise_words(data("shaken.csv") + "@24..48", "0..24", acc)).code, 0) << "the same file, twice";
  EXPECT_EQ(
      straytrace(noise_words(data("shaken.csv") + "@24..48", data("shaken.csv") + "@0..24", {"--witness", "ACC"})).code,
      0)
      << "the witness in the file of the stretch, the target in its own";
}

TEST(CoupleRecords, UnitsThatContradictTheFileAreErrors) {
  Words words = noise_words("24..48", "0..24", acc);
  words.insert(words.end(), {"--witness-unit", "m/s^2"});
  EXPECT_THAT(error_text(words), HasSubstr("is in um/s^2, not in m/s^2"));
  words.back() = "um/s^2";
  EXPECT_EQ(straytrace(words).code, 0);
}

// A second witness, which does not see the injection, does not rank before the first.
TEST(CoupleRecords, SeveralWitnessesAreRankedTogetherR6_01) {
  Folder const folder;
  std::string text = "time [s],MIC [Pa]\n";
  std::uint64_t state = 5;
  for (int i = 0; i < 48 * 50; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    text += fmt::format("{:.2f},{:.6f}\n", i / 50.0, double(state >> 11) / 9007199254740992.0 - 0.5);
  }
  write_text(folder / "mic.csv", text);
  Words words = noise_words("24..48", "0..24", acc);
  words.insert(words.end(), {"--witness", folder / "mic.csv::MIC"});
  Finished const f = straytrace(words);
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_THAT(f.out, HasSubstr("MIC: of 25 frequencies 0 measured, 0 upper limits, 25 below the thresholds"));
  EXPECT_THAT(f.out, HasSubstr("12 Hz  ACC"));
  json const all = answer(words);
  bool mine = false, other = false;
  for (json const& c : all["y"]) {
    mine = mine || c["name"] == "ACC_coupling";
    other = other || c["name"] == "MIC_coupling";
  }
  EXPECT_TRUE(mine && other) << all["y"].dump();
}

// --displacement divides every frequency by its (2 pi f)^-2, limits as well as what was measured.
TEST(CoupleRecords, LimitsOfASweepFollowTheDisplacementR6_04) {
  std::string text = "t [s],ACC [m/s^2],H [1]\n";
  std::uint64_t draw = 1;
  for (int i = 0; i < 16 * 256; ++i) {
    double const t = i / 256.0;
    draw = draw * 6364136223846793005u + 1442695040888963407u;
    double const noise = double(draw >> 11) / 9007199254740992.0 - 0.5;
    text += fmt::format("{:.17g},{:.17g},{:.17g}\n", t, std::sin(2 * pi * (20 * t + t * t)), 1e-20 * noise);
  }
  Folder const folder;
  write_text(folder / "sweep.csv", text);
  Words const words{
      "couple",       "sweep",    "--witness", folder / "sweep.csv::ACC", "--target", folder / "sweep.csv::H", "--band",
      "18 Hz..55 Hz", "--window", "1 s"};
  Words metres = words;
  metres.push_back("--displacement");
  auto const limits = [](json const& a) {
    for (json const& y : a.at("y"))
      if (y.at("name") == "upper_limit") return y.at("values");
    return json();
  };
  json const plain = answer(words), moved = answer(metres);
  json const a = limits(plain), b = limits(moved), hz = plain.at("x").at("values");
  int compared = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].is_null()) continue;
    double const f = hz[i].get<double>(), squared = 4 * pi * pi * f * f;
    EXPECT_NEAR(b[i].get<double>() / a[i].get<double>() / squared, 1, 0.1) << f << " Hz; control: 1/squared";
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

// exp(-t/0.3 s) cos(2 pi 31 t), driven by sweeps of 1 s that are followed by 3 s of silence.
TEST(CoupleRecords, FinishedSweepsGiveTheModeR6_03) {
  Folder const folder;
  double const rate = 200, decay = std::exp(-1 / (0.3 * rate)), turn = 2 * M_PI * 31 / rate;
  std::string text = "time [s],F [N],H [strain]\n", list = "place,start,duration\n";
  double one = 0, two = 0;
  for (int i = 0; i < int(24 * rate); ++i) {
    double const t = i / rate, in = std::fmod(t, 4) - 1;
    double const force = in >= 0 && in < 1 ? std::sin(2 * M_PI * (20 * in + 12 * in * in) + std::floor(t / 4)) : 0;
    double const y = force + 2 * decay * std::cos(turn) * one - decay * decay * two;
    two = one;
    one = y;
    text += fmt::format("{:.4f},{:.9g},{:.9g}\n", t, force, 1e-20 * (y + 1e-3 * std::sin(777.7 * i * i)));
  }
  for (int i = 0; i < 5; ++i) list += fmt::format("shaker,{},1\n", 4 * i + 1);
  write_text(folder / "sweeps.csv", text);
  write_text(folder / "list.csv", list);
  Words const words{"couple",      "impulse",
                    "--force",     folder / "sweeps.csv::F",
                    "--target",    folder / "sweeps.csv::H",
                    "--list",      folder / "list.csv",
                    "--length",    "3.9 s",
                    "--modes",     "1",
                    "--sweeps",    "--band",
                    "25 Hz..37 Hz"};
  json const r = answer(words)["result"];
  EXPECT_EQ(r["stretches"], 5);
  ASSERT_EQ(r["modes"].size(), 1u);
  EXPECT_NEAR(r["modes"][0]["frequency"], 31, 0.02);
  EXPECT_NEAR(r["modes"][0]["quality"], M_PI * 31 * 0.3, 0.02 * M_PI * 31 * 0.3);
}

// With few histories the resolved routes are bounds on rims, and rows `other` hold the light that moves by 2k.
TEST(CoupleRecords, APredictionKeepsItsBoundsAndTheLimitOfItsNoise) {
  Folder const folder;
  std::string const run = folder / "run.h5";
  ASSERT_EQ(straytrace({"trace", source_folder + "/examples/et_hf_edges.yaml", "--histories", "300", "-o", run}).code,
            0);
  Words const words{"couple", "predict", run, "--body", "tube", "--amplitude", "1 um peak", "--frequency", "0.5 Hz"};
  json const r = answer(words)["result"];
  EXPECT_LT(r["linear_to"].get<double>(), 1e-7) << "control: 0.4 m, of the rims";
  EXPECT_EQ(r["bound"], "neither");
  EXPECT_EQ(r["routes"][0]["upper_bound"], true);
  EXPECT_GT(r["routes"][0]["linear_to"].get<double>(), 0.1);
  std::string const text = straytrace(words).out;
  EXPECT_THAT(text, HasSubstr("small motion (contains upper bounds; 2 routes unresolved)"));
  EXPECT_THAT(text, HasSubstr(" about 1.3e-17"));
  EXPECT_THAT(text, HasSubstr("at most 2"));  // per cent
  EXPECT_THAT(text, HasSubstr("fringe wrapped"));
}

// A ratio to an upper bound has a lower bound; with routes missing as well it has none. Control: of a lower bound the
// ratio is at most, see MeasuredAgainstPredictedR6_08.
TEST(CoupleRecords, RatiosToABoundAreBounds) {
  Folder const folder;
  std::string const csv = folder / "measured.csv";
  write_text(csv,
             "frequency,factor,factor_counts,flag,factor_error,unit,witness_unit\n"
             "30,1e-16,,Real,1e-17,1/m,m\n100,1e-17,,Upper Limit,,1/m,m\n300,1e-19,,Upper Limit,,1/m,m\n");
  auto const compared = [&](char const* histories) {
    std::string const run = folder / (std::string(histories) + ".h5");
    EXPECT_EQ(
        straytrace({"trace", source_folder + "/examples/et_hf_edges.yaml", "--histories", histories, "-o", run}).code,
        0);
    return Words{"couple", "predict", run, "--body", "tube", "--measured", csv};
  };
  Words const complete = compared("65536"), incomplete = compared("300");
  json const r = answer(complete)["result"];
  ASSERT_EQ(r["bound"], "upper");
  json const& m = r["measured"];
  EXPECT_EQ(m["bound"], "lower");
  EXPECT_EQ(m["points"][0]["bound"], "lower");
  EXPECT_EQ(m["points"][1]["bound"], "neither") << "a limit over a bound";
  EXPECT_EQ(m["above_limit"], 0) << "an upper bound exceeds no limit";
  EXPECT_THAT(straytrace(complete).out, ::testing::ContainsRegex("measured over predicted: at least [0-9]"));
  EXPECT_EQ(answer(incomplete)["result"]["measured"]["points"][0]["bound"], "neither");
  EXPECT_THAT(straytrace(incomplete).out, ::testing::ContainsRegex("measured over predicted: about [0-9]"));
}

// Measured twice what is predicted, with 10 % of error each, and one limit far below the prediction.
TEST(CoupleRecords, MeasuredAgainstPredictedR6_08) {
  Folder const folder;
  std::string const run = folder / "run.h5", csv = folder / "measured.csv";
  ASSERT_EQ(straytrace({"trace", virgo_arm, "--histories", "131072", "--seed", "3", "-o", run}).code, 0);
  Words words{"couple", "predict", run, "--body", "tube", "--axis", "z", "--band", "10 Hz..1 kHz"};
  json const alone = answer(words);
  auto const column = [&](json const& sheet, std::string const& name) {
    for (json const& c : sheet["y"])
      if (c["name"] == name) return c["values"];
    return json();
  };
  json const hz = alone["x"]["values"], predicted = column(alone, "predicted");
  ASSERT_EQ(hz.size(), predicted.size()) << alone.dump().substr(0, 2000);
  std::string text = "frequency,factor,factor_counts,flag,factor_error,unit,witness_unit\n";
  for (std::size_t i = 10; i < 60; i += 10) {
    double const p = predicted[i], off = i % 20 ? 1.05 : 0.95;
    text += fmt::format("{:.6g},{:.6g},,Real,{:.6g},1/m,m\n", hz[i].get<double>(), 2 * off * p, 0.2 * p);
  }
  text += fmt::format("{:.6g},{:.6g},,Upper Limit,,1/m,m\n", hz[70].get<double>(), 0.1 * predicted[70].get<double>());
  write_text(csv, text);
  words.insert(words.end(), {"--measured", csv});
  json const result = answer(words)["result"], m = result["measured"];
  EXPECT_EQ(m["bound"], result["bound"] == "lower" ? "upper" : "");
  EXPECT_EQ(m["measured"], 5);
  EXPECT_NEAR(m["mean_ratio"], 2, 0.1);
  EXPECT_NEAR(m["mean_ratio_sigma"].get<double>() / m["mean_ratio"].get<double>(), 0.1 / std::sqrt(5), 0.02);
  EXPECT_LT(m["chi_square"].get<double>(), 5);
  EXPECT_EQ(m["points"].size(), 6u);
  EXPECT_EQ(m["above_limit"], 1);
  EXPECT_THAT(straytrace(words).out, HasSubstr("measured over predicted: "));
  words.insert(words.end(), {"-o", folder / "both.csv", "--silent"});
  Finished const page = straytrace(words);
  ASSERT_EQ(page.code, 0) << page.err;
  EXPECT_THAT(text_of(folder / "both.csv"), HasSubstr("measured_limit"));
}

}  // namespace
}  // namespace straytrace::testing
