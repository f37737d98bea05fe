// SPDX-License-Identifier: BSD-3-Clause
// straytrace fit as users call it.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing::app_fit {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

std::string const example = source_folder + "/examples/data/swinging_baffle.hdf5";

Words words(Words more, char const* band = "20 Hz..85 Hz") {
  Words all{"fit", "--target", example + "::h", "--witness", example + "::x", "--band", band};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

// The formula of tools/data/make_fringe_example.py: G 2e-21, W 1.3 of a witness of 4.3 um peak.
TEST(Fit, ExampleGivesItsFormulaR6_07) {
  Folder const folder;
  Finished const done = straytrace(words({"--gain-per-field", "1.1e-16", "--format", "json", "--subtract",
                                          folder / "rest.hdf5", "-o", folder / "fit.json", "-o", folder / "fit.txt"}));
  ASSERT_EQ(done.code, 0) << done.err;
  Json const fit = Json::parse(done.out);
  EXPECT_EQ(fit["verdict"], "found");
  Json const& path = fit["paths"][0];
  auto const expect = [&](Json const& f, double truth, double relative) {
    EXPECT_NEAR(f["value"].get<double>() / truth, 1, relative);
    EXPECT_NEAR(f["value"].get<double>(), truth, 4 * f["sigma"].get<double>());
  };
  expect(path["multiplicity"], 1.3, 0.02);
  expect(path["recoupled_fraction"], std::pow(2e-21 / 1.1e-16, 2), 0.04);
  EXPECT_NEAR(path["effective_motion_peak_m"].get<double>(), 1.3 * 4.3e-6, 0.02 * 1.3 * 4.3e-6);
  EXPECT_NEAR(fit["out_of_sample"]["scale"]["value"].get<double>(), 1, 0.05);
  EXPECT_THAT(done.err, HasSubstr("before noise subtraction"));
  EXPECT_TRUE(Json::parse(text_of(folder / "fit.json"))["asd"].contains("residual"));
  EXPECT_THAT(text_of(folder / "fit.txt"), HasSubstr("fitted_noise"));
  // The residual, fitted again, holds nothing.
  Finished const again = straytrace({"fit", "--target", folder / "rest.hdf5", "--witness", example + "::x", "--band",
                                     "25 Hz..80 Hz", "--multiplicity", "1.2..1.4", "--format", "json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_LT(Json::parse(again.out)["paths"][0]["amplitude"]["value"].get<double>(), 0.05 * 2e-21);
}

// A witness of another motion, from `gps` for 40 s.
void write_witness(std::string const& file, double gps) {
  std::string text = "# time [s]  x [um]\n";
  for (int i = 0; i < 800; ++i) text += fmt::format("{:.2f} {:.6f}\n", gps + 0.05 * i, 2 * std::sin(0.21 * i + 1));
  write_text(file, text);
}

TEST(Fit, NothingIsSubtractedWithoutAFringe) {
  Folder const folder;
  write_witness(folder / "x.txt", 1187000000);
  Finished const done = straytrace({"fit", "--target", example + "::h", "--witness", folder / "x.txt", "--band",
                                    "20 Hz..85 Hz", "--subtract", folder / "rest.hdf5"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.out, HasSubstr("no significant fringe noise"));
  EXPECT_THAT(done.err, HasSubstr("nothing was subtracted"));
  EXPECT_FALSE(fs::exists(folder / "rest.hdf5"));
}

// Freeing one parameter does not fix another.
TEST(Fit, FreeAddsToWhatIsSearched) {
  Finished const done = straytrace(words({"--free", "delay", "--gps", "1187000000..1187000020", "--format", "json"}));
  ASSERT_EQ(done.code, 0) << done.err;
  Json const path = Json::parse(done.out)["paths"][0];
  EXPECT_TRUE(path["delay_s"]["free"]);
  EXPECT_TRUE(path["multiplicity"]["free"]);
  EXPECT_NEAR(path["multiplicity"]["value"].get<double>(), 1.3, 0.03);
}

TEST(Fit, ImpossibleFitsAreErrors) {
  auto const rejected = [](Words const& more, char const* what, char const* band = "20 Hz..85 Hz") {
    Finished const done = straytrace(words(more, band));
    EXPECT_EQ(done.code, 2) << done.out;
    EXPECT_THAT(done.err, HasSubstr(what));
    EXPECT_EQ(done.out, "");
  };
  rejected({"--multiplicity", "1..6"}, "eq. 7.13");
  rejected({}, "half the sample rate", "20 Hz..300 Hz");
  rejected({"--gps", "1187000000..1187000001.1"}, "too few");
  rejected({"--free", "colour"}, "colour");
  rejected({"--delay", "20..30"}, "--delay");
  rejected({"--ratio", "1"}, "--witness2");
  rejected({"--wavelength", "5"}, "--wavelength");
  rejected({"--wavelength", "-1064nm"}, "--wavelength: '-1064nm' is not positive");
  rejected({"--gain-per-field", "-1"}, "--gain-per-field: '-1' is not positive");
  rejected({"--target-unit", "m", "--gain-per-field", "1e-16"}, "--target-unit");
}

TEST(Fit, TellsAllWrongOptionsAtOnce) {
  Finished const done =
      straytrace({"fit", "--target", "none.hdf5::h", "--witness", "no_more.csv", "--band", "80 Hz..20 Hz", "--delay",
                  "20..30", "--train", "2", "--gps", "5..4", "--multiplicity", "1 s"});
  EXPECT_EQ(done.code, 2);
  for (char const* says : {"--target: file 'none.hdf5'", "--witness: file 'no_more.csv'", "--band: '80 Hz..20 Hz'",
                           "--delay:", "--train: '2'", "'5..4' ends before", "--multiplicity: '1 s'"})
    EXPECT_THAT(done.err, HasSubstr(says));
  Finished const right = straytrace(words({"--delay", "-1 ms..1 ms", "--train", "60 %", "--multiplicity", "1.3"}));
  EXPECT_EQ(right.code, 0) << right.err;  // control: the same options, as they should be
}

TEST(Fit, RecordsOfOtherTimesDoNotOverlap) {
  Folder const folder;
  write_witness(folder / "x.txt", 1187001000);
  Finished const done =
      straytrace({"fit", "--target", example + "::h", "--witness", folder / "x.txt", "--band", "20 Hz..80 Hz"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("do not overlap"));
}

TEST(Fit, EdgeGivesTheEffectiveMotionR2_40) {
  Finished const done = straytrace({"fit", "edge", "--target", example + "::h", "--witness", example + "::x", "--band",
                                    "12 Hz..90 Hz", "--format", "json"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NEAR(Json::parse(done.out)["effective_motion"]["value"].get<double>(), 1.3, 0.02 * 1.3);
}

// The phase sensitivity of the route, the response of its port and the wavelength come from the run: an arm, T =
// lambda/(4 pi L).
TEST(Fit, RouteOfARunAgainstItsPrediction) {
  Folder const folder;
  ASSERT_EQ(straytrace({"trace", virgo_arm, "--histories", "65536", "--seed", "3", "-o", folder / "run.h5"}).code, 0);
  Finished const done =
      straytrace({"fit", folder / "run.h5", "--target", example + "::h", "--witness", example + "::x", "--band",
                  "20 Hz..85 Hz", "--multiplicity", "1..2", "--format", "json", "--path", "1"});
  ASSERT_EQ(done.code, 0) << done.err;
  Json const path = Json::parse(done.out)["paths"][0];
  EXPECT_NEAR(path["multiplicity"]["value"].get<double>(), 1.3, 0.02);
  Json const& prediction = path["prediction"];
  EXPECT_EQ(prediction["rank"], 1);
  EXPECT_GT(std::fabs(prediction["multiplicity"].get<double>()), 0);
  double const transfer = 1064e-9 / (4 * 3.14159265358979 * 2999.8);
  double const f = path["recoupled_fraction"]["value"].get<double>();
  EXPECT_LT(f, 1.1 * std::pow(2e-21 / transfer, 2)) << "both quadratures make h: less field is enough";
  EXPECT_GT(f, 0);
  if (prediction["resolved"].get<bool>()) {
    EXPECT_NEAR(prediction["measured_over_predicted"]["value"].get<double>(),
                f / prediction["recoupled_fraction"]["value"].get<double>(), 1e-9);
  }
  Finished const other = straytrace({"fit", folder / "run.h5", "--path", "999", "--target", example + "::h",
                                     "--witness", example + "::x", "--band", "20 Hz..85 Hz"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("--path"));
  // --paths belongs to a fit without a run. Control: there it is accepted.
  Finished const counted = straytrace({"fit", folder / "run.h5", "--paths", "2", "--target", example + "::h",
                                       "--witness", example + "::x", "--band", "20 Hz..85 Hz"});
  EXPECT_EQ(counted.code, 2);
  EXPECT_EQ(counted.out, "");
  EXPECT_THAT(counted.err, HasSubstr("--paths is the number of paths of a fit without a run"));
  EXPECT_EQ(straytrace(words({"--paths", "1"})).code, 0);
}

}  // namespace
}  // namespace straytrace::testing::app_fit
