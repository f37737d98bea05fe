// SPDX-License-Identifier: BSD-3-Clause
// Files of measured scatter: every format by its content, and what is wrong with each at its line and column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string said(std::vector<Problem> const& problems) {
  std::string out;
  for (Problem const& p : problems)
    out += std::to_string(p.place.line) + ":" + std::to_string(p.place.column) + ": " + p.what + " | " + p.suggestion +
           "\n";
  return out;
}

ScatterFile sound(std::string const& text, ScatterDeclared const& given = {}) {
  std::vector<Problem> problems;
  ScatterFile file = read_scatter_file(text, given, problems);
  EXPECT_TRUE(problems.empty()) << said(problems);
  return file;
}
std::string error_text(std::string const& text, ScatterDeclared const& given = {}) {
  std::vector<Problem> problems;
  read_scatter_file(text, given, problems);
  return said(problems);
}
std::string edited(std::string text, std::string const& from, std::string const& to) {
  std::size_t const at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

std::string const lab =
    "# wavelength: 1064 nm\n# angles: from_normal\n# polarisation_in: s\n# polarisation_out: both\n"
    "# noise_floor: 1e-7 /sr\ntheta_i [deg], theta_s [deg], brdf_cos [1/sr]\n"
    "10, 12, 2e-3\r\n10, 20, 1e-4\n10, 60, 4e-8\r\n";

TEST(ScatterFiles, WrongColumnsAreNamedByTheirContent) {
  std::string const rows = "10, 12, 2e-3\r\n";
  EXPECT_THAT(error_text(edited(lab, rows, "10;12,5;2,0e-3\n")), HasSubstr("not semicolons"));
  EXPECT_THAT(error_text(edited(lab, rows, "10, 12,5, 2e-3\n")), HasSubstr("not decimal commas"));
  std::string const radian = error_text(edited(lab, "theta_i [deg]", "theta_i [rad]"));
  EXPECT_THAT(radian, HasSubstr("write 'theta_i [deg]' into the header"));
  EXPECT_THAT(error_text(edited(lab, rows, "95, 12, 2e-3\n")), ::testing::Not(HasSubstr("theta_i [deg]")));
}

TEST(ScatterFiles, HeaderAndRowsAreCheckedTogether) {
  std::string const both = error_text(edited(edited(lab, "brdf_cos", "brfd"), "10, 12, 2e-3", "10, twelve, 2e-3"));
  EXPECT_THAT(both, HasSubstr("6:31: unknown column 'brfd'"));
  EXPECT_THAT(both, HasSubstr("7:5: 'twelve' is not a number"));
  EXPECT_THAT(error_text(edited(edited(lab, "10, 12, 2e-3", "95, 12, 2e-3"), "10, 20, 1e-4", "10, 20, x")),
              ::testing::AllOf(HasSubstr("7:1: incidence of 95 deg"), HasSubstr("8:9: 'x' is not a number")));
  EXPECT_THAT(error_text(edited(lab, "1064 nm", "1064 kg")), HasSubstr("'wavelength' cannot be '1064 kg'"));
}

TEST(ScatterFiles, LaboratoryCsv) {
  ScatterFile const f = sound(lab);
  EXPECT_EQ(f.format, "laboratory CSV");
  EXPECT_DOUBLE_EQ(f.declared.wavelength, 1064e-9);
  EXPECT_EQ(f.declared.polarisation_in, "s");
  ASSERT_EQ(f.points.size(), 3u);
  double const d = pi / 180;
  EXPECT_NEAR(f.points[0].value, 2e-3 / std::cos(12 * d), 1e-15);  // control: as a BRDF, without the cosine
  EXPECT_NEAR(f.points[0].offset, std::sin(12 * d) - std::sin(10 * d), 1e-12);
  EXPECT_FALSE(f.points[1].limit);
  EXPECT_TRUE(f.points[2].limit);  // 4e-8/cos 60 = 8e-8 lies below the floor
  EXPECT_DOUBLE_EQ(f.points[2].value, 1e-7);
  EXPECT_EQ(f.points[1].line, 8u);
  EXPECT_GT(std::fabs(sound(edited(lab, "brdf_cos", "brdf")).points[0].value - f.points[0].value), 1e-5);
  EXPECT_NEAR(sound(edited(lab, "from_normal", "from_specular")).points[0].theta_s, 22 * d, 1e-12);
}

TEST(ScatterFiles, LaboratoryCsvMistakes) {
  std::string const bare = "theta_i [deg], theta_s [deg], brdf [1/sr]\n10, 12, 2e-3\n10, 20, 1e-3\n";
  EXPECT_THAT(error_text(bare), HasSubstr("does not declare wavelength and angles"));
  EXPECT_THAT(error_text(bare), HasSubstr("# angles: from_normal"));  // the template to paste
  EXPECT_EQ(error_text(bare, {.wavelength = 633e-9, .angles = "from_normal"}), "");
  EXPECT_THAT(error_text(edited(lab, "# wavelength", "# wavelenght")), HasSubstr("1:3: unknown declaration"));
  EXPECT_THAT(error_text(edited(lab, "1064 nm", "1064")),
              AllOf(HasSubstr("1:3: 'wavelength' cannot be '1064'"), Not(HasSubstr("declare wavelength"))));
  EXPECT_THAT(error_text(edited(lab, "10, 20, 1e-4", "10, 20, -1e-4")), HasSubstr("8:9: BRDF"));
  EXPECT_THAT(error_text(edited(lab, "10, 20, 1e-4", "10, 20, nan")), HasSubstr("8:9: 'nan' is not a number"));
  EXPECT_THAT(error_text(edited(lab, "10, 20, 1e-4", "10, 20, 1,5e-4")), HasSubstr("decimal commas"));
  EXPECT_THAT(error_text(edited(lab, "10, 20, 1e-4", "10, 20")), HasSubstr("8:1: 2 values, but the header has 3"));
  EXPECT_THAT(error_text(edited(lab, "10, 20, 1e-4", "10, 95, 1e-4")), HasSubstr("8:5: scatter at 95 deg"));
  EXPECT_THAT(error_text(lab, {.wavelength = 633e-9}), HasSubstr("declares wavelength 1064 nm, but 633 nm"));
  std::string const twice = "# wavelength: 633 nm\n" + lab;
  EXPECT_EQ(error_text(twice), "2:3: 'wavelength' is '1064 nm' here and '633 nm' in line 1 | keep one of them\n");
  EXPECT_EQ(error_text("# wavelength: 1064 nm\n" + lab), "");  // the same, so not in doubt
  EXPECT_THAT(error_text(edited(lab, "theta_s [deg]", "theta_s [m]")),
              HasSubstr("6:16: column 'theta_s' is an angle, its unit is a length | write 'theta_s [deg]'"));
  EXPECT_THAT(error_text(edited(lab, "theta_s [deg]", "theta_s")),
              HasSubstr("6:16: column 'theta_s' is an angle and needs its unit | write 'theta_s [deg]'"));
  std::string const no_floor = edited(lab, "# noise_floor: 1e-7 /sr\n", "");
  EXPECT_THAT(error_text(edited(no_floor, "4e-8", "0")), HasSubstr("no noise floor"));
}

TEST(ScatterFiles, MoreIncidencesThanTheModelHolds) {
  std::string text = "# wavelength: 1064 nm\n# angles: from_normal\ntheta_i [deg], theta_s [deg], brdf [1/sr]\n";
  for (int i = 0; i < 40; ++i)
    for (int const away : {1, 5, 20}) text += std::to_string(2 * i) + ", " + std::to_string(2 * i - away) + ", 1e-3\n";
  ScatterFile const f = sound(text);
  auto const groups = by_incidence(f.points);
  ASSERT_EQ(groups.size(), 16u);
  EXPECT_EQ(f.incidences_left_out, 24u);
  EXPECT_NEAR(groups.front()[0].theta_i, 0, 1e-12);
  EXPECT_NEAR(groups.back()[0].theta_i, 78 * pi / 180, 1e-12);
}

// A BSDF of 0.2 /sr everywhere: the total is 0.2 pi at any incidence, whatever the directions are counted from.
std::string zemax(std::string const& stated, double value = 0.2) {
  std::string text =
      "# made up\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n"
      "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  2\n0 40\nScatterAzimuth 5\n"
      "0 45 90 135 180\nScatterRadial 14\n0 10 20 30 40 50 60 70 80 90 100 110 120 130\n\n"
      "Monochrome\nDataBegin\n";
  for (int i = 0; i < 2; ++i) {
    text += "TIS " + stated + "\n";
    for (int a = 0; a < 5; ++a) {
      for (int r = 0; r < 14; ++r) text += std::to_string(value) + " ";
      text += "\n";
    }
  }
  return text + "DataEnd\n";
}
ScatterDeclared const green{.wavelength = 532e-9};

TEST(ScatterFiles, ZemaxTable) {
  ScatterFile const f = sound(zemax("0.628"), green);
  EXPECT_EQ(f.format, "Zemax tabular BSDF");
  ASSERT_EQ(f.stated.size(), 2u);
  for (StatedTis const& t : f.stated) EXPECT_NEAR(t.integral, 0.2 * pi, 0.01 * 0.2 * pi) << t.theta_i;
  // Azimuth 0 points to the normal: radial 40 deg at 40 deg of incidence is the normal itself. Control: the other way.
  auto const at_normal = std::count_if(f.points.begin(), f.points.end(),
                                       [](ScatterPoint const& p) { return p.theta_i > 0.1 && p.theta_s < 1e-6; });
  EXPECT_EQ(at_normal, 1);
  for (ScatterPoint const& p : f.points) EXPECT_LT(p.theta_s, pi / 2);
}

TEST(ScatterFiles, ZemaxMistakes) {
  std::string const good = zemax("0.628");
  EXPECT_THAT(error_text(good), HasSubstr("does not declare wavelength"));
  EXPECT_EQ(error_text("# wavelength: 532 nm\n" + good), "");
  EXPECT_THAT(error_text(edited(good, "AngleOfIncidence  2", "AngleOfIncidence  3"), green),
              HasSubstr("10:1: 'ScatterAzimuth' is not a number"));
  EXPECT_THAT(error_text(edited(good, "ScatterType  BRDF\n", ""), green), HasSubstr("'ScatterType' is missing"));
  EXPECT_THAT(error_text(edited(good, "0.200000 0.200000", "0.200000"), green),
              HasSubstr("is not a number; value 70 of 70"));
  EXPECT_THAT(error_text(edited(good, "DataEnd", "0.2 DataEnd"), green), HasSubstr("'DataEnd' is expected here"));
  EXPECT_THAT(error_text(edited(good, "\nDataEnd", ""), green), HasSubstr("'DataEnd' is expected here"));
  EXPECT_THAT(error_text(edited(good, "0.200000", "0,200000"), green), HasSubstr("decimal commas"));
  EXPECT_THAT(error_text(edited(good, "0.200000", "-0.200000"), green), HasSubstr("18:1: BRDF -0.2"));
  EXPECT_THAT(error_text(edited(good, "0 45 90", "0 90 45"), green), HasSubstr("do not increase"));
  EXPECT_THAT(error_text(edited(good, "Monochrome\nScatter", "XYZ\nScatter"), green), HasSubstr("colours"));
  EXPECT_THAT(error_text(edited(good, "SampleRotation  1\n0\n", "SampleRotation  2\n0 90\n"), green),
              HasSubstr("model 'grooves'"));
}

TEST(ScatterFiles, AbgCatalogue) {
  std::string const text =
      "NAME black\nWAVE 1.064\nDATA 5 2.5e-3 1e-3 1.8\n60 3e-3 1e-3 1.7\nNAME white\nWAVE 0\n0 0.3 1 0\n";
  ScatterFile const f = sound(text, {.entry = "black"});
  EXPECT_DOUBLE_EQ(f.declared.wavelength, 1.064e-6);
  EXPECT_EQ(by_incidence(f.points).size(), 2u);
  for (ScatterPoint const& p : f.points)
    if (p.theta_i < 0.2) {
      EXPECT_NEAR(p.value, 2.5e-3 / (1e-3 + std::pow(p.offset, 1.8)), 1e-12);  // docs/theory/surfaces.md, eq. 3.16
    }
  EXPECT_THAT(error_text(text), HasSubstr("2 entries"));
  EXPECT_THAT(error_text(text, {.entry = "blak"}), HasSubstr("did you mean 'black'"));
  EXPECT_THAT(error_text(text, {.entry = "white"}), HasSubstr("does not declare wavelength"));
  EXPECT_THAT(error_text(edited(text, "60 3e-3 1e-3 1.7", "60 3e-3 1e-3")), HasSubstr("4:1: 3 numbers in a row"));
  EXPECT_THAT(error_text(edited(text, "60 3e-3", "60 -3e-3")), HasSubstr("4:4: A is -0.003"));
}

TEST(ScatterFiles, AstmText) {
  // Specular is opposite to the incident azimuth. 0.5 rad is 28.6 deg.
  std::string const text =
      "TITLE paint\nNUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,633nm,1064nm\n"
      "0.5,0,0.5,3.14159265358979,0.2,0.1\n0.5,0,0.7,3.14159265358979,0.02,0.01\n";
  ScatterFile const f = sound(text, {.wavelength = 1064e-9});
  ASSERT_EQ(f.points.size(), 2u);
  EXPECT_NEAR(f.points[0].offset, 0, 1e-9);
  EXPECT_DOUBLE_EQ(f.points[1].value, 0.01);
  EXPECT_NEAR(f.points[1].offset, std::sin(0.7) - std::sin(0.5), 1e-9);
  EXPECT_THAT(error_text(text), HasSubstr("choose one by 'wavelength': 633nm, 1064nm"));
  ScatterDeclared const ir{.wavelength = 1064e-9};
  EXPECT_THAT(error_text(edited(text, "NUM_POINTS 2", "NUM_POINTS 3"), ir),
              HasSubstr("NUM_POINTS is 3, but the file has 2"));
  EXPECT_THAT(error_text(edited(text, "0.5,0,0.7", "0.5,0,40"), ir), HasSubstr("5:7: a polar angle of 40 rad"));
  EXPECT_THAT(error_text(edited(text, "VARS", "VARIABLES"), ir), HasSubstr("unknown format"));
  ScatterFile const degrees =
      sound(edited(edited(text, "theta_i,phi_i,theta_s,phi_s", "theta_i [deg],phi_i [deg],theta_s [deg],phi_s [deg]"),
                   "0.5,0,0.7,3.14159265358979", "30,0,40,180"),
            ir);
  EXPECT_NEAR(degrees.points[1].offset, std::sin(40 * pi / 180) - 0.5, 1e-9);
}

// Round trip: every measured value at its own direction. Control: a file whose azimuths are swapped.
TEST(ScatterFiles, SsddRoundTrip) {
  std::string text = "# wavelength: 1064 nm\n# angles: from_normal\ntheta_i [deg], theta_s [deg], brdf [1/sr]\n";
  for (int t = -80; t <= 80; t += 7) text += "8, " + std::to_string(t) + ", " + std::to_string(0.1 + 0.001 * t) + "\n";
  for (int t = -75; t <= 75; t += 10)
    text += "45, " + std::to_string(t) + ", " + std::to_string(0.2 + 0.001 * t) + "\n";
  ScatterFile const f = sound(text);
  std::string why;
  std::string const written = ssdd_text(f, "constant", why);
  auto const missed = [&](std::string const& ssdd) {
    std::vector<Problem> problems;
    ScatterFile const back = read_scatter_file(ssdd, {}, problems);
    EXPECT_TRUE(problems.empty()) << said(problems);
    EXPECT_DOUBLE_EQ(back.declared.wavelength, 1064e-9);
    std::size_t count = 0;
    for (ScatterPoint const& p : f.points)
      count += std::none_of(back.points.begin(), back.points.end(), [&](ScatterPoint const& q) {
        double const there = std::cos(q.phi) > 0 ? q.theta_s : -q.theta_s;
        return std::fabs(q.theta_i - p.theta_i) < 1e-7 && std::fabs(there - p.theta_s) < 1e-7 &&
               std::fabs(q.value - p.value) < 1e-6;
      });
    return count;
  };
  EXPECT_EQ(missed(written), 0u) << why;
  EXPECT_GT(missed(edited(written, "PARAM3_LIST 0 180", "PARAM3_LIST 180 360")), f.points.size() / 2);
  std::vector<Problem> problems;
  EXPECT_THAT(error_text(edited(written, "DATA ascii\n", "DATA ascii\nx ")),
              HasSubstr("'x' is not a number; value 1 of"));
  EXPECT_THAT(error_text(written.substr(0, written.size() - 20)), HasSubstr("the file ends where value"));
  EXPECT_THAT(error_text(edited(written, "specular_coordinate_system", "half_difference_coordinate_system")),
              HasSubstr("halfway"));
  // An example of the format's own specification: one Lambertian point.
  std::string const one =
      "VERSION 0.2\n\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n"
      "PARAM0_LIST 0\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n0.3183\n";
  EXPECT_DOUBLE_EQ(sound(one, green).points.at(0).value, 0.3183);
}

TEST(ScatterFiles, OtherFormatsAreErrorsThatNameThem) {
  EXPECT_THAT(error_text(std::string("tensor_file\0\1\0", 14)), HasSubstr("RGL binary BSDF"));
  EXPECT_THAT(error_text(std::string("tensor_file\0\1\0", 14)), HasSubstr("write those as laboratory CSV"));
  EXPECT_THAT(error_text("Symmetry PlaneSymmetrical\nSpectralContent Monochrome\nAOI 10\n"), HasSubstr("LightTools"));
  EXPECT_THAT(error_text(std::string("\x89HDF\r\n\0", 7)), HasSubstr("binary file of no known format"));
  EXPECT_THAT(error_text("hello\n"), HasSubstr("unknown format of measured scatter"));
  for (char const* empty : {"", "\n \n"})
    EXPECT_THAT(error_text(empty), AllOf(HasSubstr("0:0: the file is empty"), Not(HasSubstr("unknown format"))));
}

}  // namespace
}  // namespace straytrace::testing
