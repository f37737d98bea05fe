// SPDX-License-Identifier: BSD-3-Clause
// Files of couplings, and what is projected with them (R6.08).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "support/recorded.hpp"

namespace straytrace {
namespace {

using ::testing::HasSubstr;
using enum CouplingFlag;

constexpr char theirs[] =
    "frequency,factor,factor_counts flag\n"
    "10.0,2e-9,4e-15,Real\n"
    "20.0,1e-9,2e-15,Upper Limit\r\n"
    "30.0,0.0,0.0,Thresholds not met\n"
    "40.0,,,No data\n"
    "50.0,3e-9,6e-15, measured\n";

CouplingFunction read(std::string const& text, std::string const& unit = "1/m") {
  return parse_coupling(text, "c.csv", unit, "m");
}

std::string rejected(std::string const& text, std::string const& unit = "1/m") {
  try {
    read(text, unit);
  } catch (InputError const& e) {
    return e.what();
  }
  return "taken";
}

TEST(CouplingFile, ReadsPemcouplingTolerantlyR6_08) {
  CouplingFunction const c = read(theirs);
  ASSERT_EQ(c.points.size(), 5u);
  EXPECT_EQ(c.points[0].factor, 2e-9);
  EXPECT_EQ(c.points[0].factor_counts, 4e-15);
  EXPECT_TRUE(std::isnan(c.points[0].sigma));
  EXPECT_EQ(c.points[1].flag, upper_limit);
  EXPECT_EQ(c.points[2].flag, below_thresholds);
  EXPECT_TRUE(std::isnan(c.points[2].factor)) << "a factor of 0 that is not known is not 0";
  EXPECT_EQ(c.points[3].flag, no_data);
  EXPECT_EQ(c.points[4].flag, measured);
}

TEST(CouplingFile, ReadsFilesSavedBySpreadsheetsAndPandas) {
  for (std::string const text : {"\xef\xbb\xbf"
                                 "frequency,factor,factor_counts,flag\r\n10,2e-9,4e-15,Real\r\n",
                                 ",frequency,factor,factor_counts,flag\n0,10,2e-9,4e-15,Real\n",
                                 "frequency,factor,factor_counts,flag,\n10,2e-9,4e-15,REAL,\n"}) {
    CouplingFunction const c = read(text);
    ASSERT_EQ(c.points.size(), 1u) << text;
    EXPECT_EQ(c.points[0].hz, 10);
    EXPECT_EQ(c.points[0].factor, 2e-9);
    EXPECT_EQ(c.points[0].factor_counts, 4e-15);
  }
}

TEST(CouplingFile, RoundTrip) {
  CouplingFunction c = read(theirs);
  c.witness = "X1:ACC";
  c.target = "X1:H";
  c.points[0].sigma = 1e-10;
  c.points[0].significance = 7.25;
  c.points[2].flag = not_linear;
  c.points[2].factor = 5e-9;
  std::string const text = coupling_csv(c);
  EXPECT_TRUE(text.starts_with("frequency,factor,factor_counts,flag,"));
  EXPECT_THAT(text, HasSubstr("20,1e-09,2e-15,Upper Limit,"));
  CouplingFunction const again = parse_coupling(text, "c.csv");  // units are in it
  EXPECT_EQ(coupling_csv(again), text);
  EXPECT_EQ(again.unit, "1/m");
}

// As pemcoupling writes one injection (with coherence, whose name its header glues to the one before), and its
// composite.
constexpr char injection[] =
    "frequency,factor,factor_counts,flag,sensINJ,sensBG,darmBGcoherence\n"
    "10.00,2.13e-07,3.40e-13,Real,4.10e-05,1.90e-07,6.62e-18,9.71e-01\n"
    "10.50,8.77e-09,1.40e-14,Upper Limit,3.98e-05,1.85e-07,5.90e-18,1.02e-02\n"
    "11.00,0.00e+00,0.00e+00,Thresholds not met,2.10e-07,1.80e-07,5.11e-18,3.00e-03\n"
    "11.50,0.00e+00,0.00e+00,No data,0.00e+00,0.00e+00,0.00e+00,0.00e+00\n";
constexpr char composite[] =
    "frequency,factor,factor_counts,flag,ambient,darm\n"
    "10.00,2.13e-07,3.40e-13,Real,4.05e-14,6.62e-18\n"
    "10.50,8.77e-09,1.40e-14,Upper Limit,1.62e-15,5.90e-18\n"
    "11.00,0.00e+00,0.00e+00,Thresholds not met,0.00e+00,5.11e-18\n"
    "11.50,0.00e+00,0.00e+00,No data,0.00e+00,0.00e+00\n";

TEST(CouplingFile, LayoutsOfPemcouplingRoundTripR6_08) {
  for (std::string const text : {injection, composite}) {
    CouplingFunction const c = parse_coupling(text, "EY_ACC_coupling_data.txt", "m/(m/s^2)", "m/s^2");
    ASSERT_EQ(c.points.size(), 4u);
    EXPECT_EQ(c.points[0].flag, measured);
    EXPECT_EQ(c.points[0].factor, 2.13e-7);
    EXPECT_EQ(c.points[0].factor_counts, 3.4e-13);
    EXPECT_EQ(std::isnan(c.points[0].coherence), text != injection);
    EXPECT_EQ(c.points[1].flag, upper_limit);
    EXPECT_EQ(c.points[1].factor, 8.77e-9);
    EXPECT_EQ(c.points[2].flag, below_thresholds);
    EXPECT_EQ(c.points[3].flag, no_data);
    EXPECT_EQ(c.points[3].hz, 11.5);
    std::string const ours = coupling_csv(c);
    EXPECT_THAT(ours, HasSubstr("\n10,2.13e-07,3.4e-13,Real,,m/(m/s^2),"));
    EXPECT_THAT(ours, HasSubstr("\n10.5,8.77e-09,1.4e-14,Upper Limit,,"));
    EXPECT_THAT(ours, HasSubstr("\n11,,,Thresholds not met,")) << "their 0 is not known, and is not written as 0";
    CouplingFunction const again = parse_coupling(ours, "again.csv");
    ASSERT_EQ(again.points.size(), 4u);
    EXPECT_EQ(coupling_csv(again), ours);
    EXPECT_EQ(again.unit, "m/(m/s^2)");
    // Projected as pemcoupling does: factor times the ambient ASD, here of 1.9e-7 m/s^2.
    QuietWitness const w{"m/s^2", {10, 10.5, 11}, {1.9e-7, 1.85e-7, 1.8e-7}, {0, 0, 0}};
    std::vector<ProjectedPoint> const p = project_coupling(again, w).points;
    EXPECT_NEAR(p[0].asd / 4.05e-14, 1, 2e-3);
    EXPECT_NEAR(p[1].asd / 1.62e-15, 1, 2e-3);
    EXPECT_TRUE(std::isnan(p[2].asd));
  }
}

TEST(CouplingFile, ErrorsStatePlaceAndRemedy) {
  EXPECT_THAT(rejected("frequency,factor\n1,2\n"), HasSubstr("c.csv:1: error: no column 'flag'"));
  EXPECT_THAT(rejected("frequency,factor,flag\n1,2,Measurd\n"),
              AllOf(HasSubstr("c.csv:2:5: error: 'Measurd' is not a flag"), HasSubstr("Measured")));
  EXPECT_NO_THROW(read("frequency,factor,flag\n1,2,Measured\n"));
  for (char const* factor : {"nan", "inf", ""})
    EXPECT_THAT(rejected(fmt::format("frequency,flag,factor\n2,Real,{}\n", factor)),
                HasSubstr("error: the factor is not a finite number"));
  EXPECT_NO_THROW(read("frequency,flag,factor\n2,No data,nan\n"));
  EXPECT_THAT(rejected("frequency,factor,flag\n2,2,Real\n1,2,Real\n"),
              HasSubstr("c.csv:3:1: error: the frequency does not"));
  EXPECT_THAT(rejected("frequency,factor,flag\n2,-2,Real\n"),
              HasSubstr("c.csv:2:3: error: the factor is not positive"));
  EXPECT_THAT(rejected("frequency,factor,flag\n2,x,Real\n"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(rejected("frequency,factor,flag,factor_error\n2,x,Real,y\n"),
              AllOf(HasSubstr("c.csv:2:3: error: 'x' is not a number in column 'factor'"),
                    HasSubstr("c.csv:2:10: error: 'y' is not a number in column 'factor_error'")));
  EXPECT_THAT(rejected("frequency,factor,flag\n2,1e-999,Real\n"), HasSubstr("'1e-999' is outside the range"));
  EXPECT_NO_THROW(
      read("frequency,\xc2\xa0"
           "factor,flag\n2,\xe2\x80\x89"
           "3,Real\n"));
  EXPECT_THAT(rejected("frequency,flag,factor\n2,Real,1,5\n"), HasSubstr("c.csv:2: error: more values than the 3"));
  EXPECT_THAT(rejected(theirs, ""), HasSubstr("c.csv: error: the file does not state the unit of its factors"));
  EXPECT_THAT(rejected(""), HasSubstr("no couplings in it"));
}

TEST(CouplingProjection, ErrorsAreCarriedAndLimitsStayLimitsR6_08) {
  CouplingFunction c = read(theirs);
  c.points[0].sigma = 4e-10;  // 20 %
  QuietWitness const w{"um", {5, 10, 15, 20, 25, 40, 50, 60}, std::vector<double>(8, 2.0), std::vector<double>(8, 0.3)};
  std::vector<ProjectedPoint> const p = project_coupling(c, w).points;
  ASSERT_EQ(p.size(), 8u);
  EXPECT_EQ(p[0].flag, no_data);
  EXPECT_DOUBLE_EQ(p[1].asd, 2e-9 * 2e-6);
  EXPECT_NEAR(p[1].sigma / p[1].asd, 0.25, 1e-12);  // 20 % and 15 %
  EXPECT_EQ(p[2].flag, upper_limit) << "between a measured point and a limit";
  EXPECT_NEAR(p[2].asd, 2e-6 * 2e-9 * std::pow(0.5, std::log(1.5) / std::log(2)), 1e-25);
  EXPECT_EQ(p[3].flag, upper_limit);
  EXPECT_TRUE(std::isnan(p[3].sigma));
  EXPECT_EQ(p[4].flag, below_thresholds);
  EXPECT_TRUE(std::isnan(p[4].asd)) << "never 0 for what is not known";
  EXPECT_EQ(p[5].flag, no_data);
  EXPECT_EQ(p[6].flag, measured);
  EXPECT_TRUE(std::isnan(p[6].sigma)) << "a factor without an error projects without one";
  EXPECT_EQ(p[7].flag, no_data);
}

TEST(CouplingProjection, FringeWrappingAndOtherUnitsAreErrors) {
  CouplingFunction c = read(theirs);
  QuietWitness w{"m", {10, 20}, {1, 1}, {0, 0}};
  c.points[1].flag = not_linear;
  auto const said = [&] {
    try {
      project_coupling(c, w);
    } catch (InputError const& e) {
      return std::string(e.what());
    }
    return std::string("projected");
  };
  EXPECT_THAT(said(), HasSubstr("not linear at 1 frequencies, the first of them 20 Hz"));
  EXPECT_THAT(said(), HasSubstr("project the motion in the time domain"));
  w.hz = {10, 15};
  EXPECT_EQ(said(), "projected") << "outside the requested band it does not matter";
  w.unit = "V";
  EXPECT_THAT(said(), HasSubstr("the coupling is per m, and the witness is in V"));
}

// An acceleration of 1 m/s^2 is 1/(2 pi f)^2 m.
TEST(CouplingProjection, TakesAccelerationsToTheCouplingPerMetre) {
  CouplingFunction const c = read(theirs);
  auto const projected = [&](std::string const& unit) {
    return project_coupling(c, {unit, {20}, {1}, {0}}).points[0].asd;
  };
  EXPECT_NEAR(projected("m/s^2") / projected("m") * std::pow(2 * M_PI * 20, 2), 1, 1e-12);
  EXPECT_NEAR(projected("m/s") / projected("m") * 2 * M_PI * 20, 1, 1e-12);
}

}  // namespace
}  // namespace straytrace
