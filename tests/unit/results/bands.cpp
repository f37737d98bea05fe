// SPDX-License-Identifier: BSD-3-Clause
// Uncertainties other than the Monte-Carlo error, in words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "results/curves/band.hpp"

namespace straytrace::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Without noise the report makes no statement about inputs and does not call them exact. Control: a resolved curve.
TEST(ReportBands, NoInputBandWithoutResolvedNoise) {
  NoiseBudget b;
  b.grid.edges = {10, 20, 40};
  b.total.asd = {1e-23, 2e-24};
  b.total.sigma = {1e-25, 2e-26};
  b.bands.input_low = b.bands.input_high = b.bands.speckle_05 = b.bands.speckle_50 = b.bands.speckle_95 = b.total.asd;
  b.unresolved = {"A > B: only 3 histories have scored"};
  EXPECT_THAT(band_summary(b, {15}), HasSubstr("taken as exact"));
  for (double const nothing : {0.0, not_a_number}) {
    b.total.asd = {nothing, nothing};
    EXPECT_THAT(band_summary(b, {15}), AllOf(HasSubstr("unknown"), Not(HasSubstr("bracket"))));
  }
}

// A band of zero strain is not printed as a range of numbers: there may be unresolved routes, or no noise.
// Control: a band that is not zero stays.
TEST(ReportBands, ABandOfZeroIsNotANumber) {
  NoiseBudget b;
  b.grid.edges = {10, 20, 40};
  b.total.asd = {0, 2e-24};
  b.total.sigma = {0, 2e-26};
  b.bands.input_low = b.bands.input_high = b.bands.speckle_05 = b.bands.speckle_50 = b.bands.speckle_95 = b.total.asd;
  EXPECT_THAT(band_summary(b, {10, 30}), AllOf(HasSubstr(": none, 2.00e-24 to 2.00e-24"), Not(HasSubstr("0.00e+00"))));
  b.unresolved = {"A > B: only 3 histories have scored"};
  EXPECT_THAT(band_summary(b, {10, 30}), HasSubstr(": not resolved, 2.00e-24 to 2.00e-24"));
  b.bands.coherent = b.total.asd;
  EXPECT_THAT(band_text(b, {10, 30}), AllOf(HasSubstr("not resolved"), HasSubstr("2.00e-24")));
  b.unresolved = {};
  EXPECT_THAT(band_text(b, {10, 30}), AllOf(HasSubstr("none"), HasSubstr("2.00e-24"), Not(HasSubstr("0.00e+00"))));
  b.bands.speckle_05[1] = 0;
  EXPECT_THAT(band_summary(b, {30}), AllOf(HasSubstr(": up to 2.00e-24"), Not(HasSubstr("0.00e+00"))));
}

// A band that is not known is not printed as numbers. Control: the other frequency.
TEST(ReportBands, ABandThatIsNotKnownSaysSo) {
  NoiseBudget b;
  b.grid.edges = {10, 20, 40};
  b.total.asd = {1e-23, 2e-24};
  b.total.sigma = {1e-25, 2e-26};
  b.bands.input_low = b.bands.input_high = b.bands.speckle_05 = b.bands.speckle_50 = b.bands.speckle_95 = b.total.asd;
  b.bands.sources = {{"material steel", "bracket: x 0.25 to 4", not_a_number, not_a_number, not_a_number}};
  EXPECT_THAT(band_summary(b, {14.14, 28.28}), HasSubstr("\ninput uncertainty: 1.00e-23 to 1.00e-23, "));
  b.bands.input_low[0] = b.bands.input_high[0] = not_a_number;
  b.unresolved = {"other > B: only 3 histories have scored"};
  EXPECT_THAT(band_summary(b, {14.14, 28.28}),
              AllOf(HasSubstr("\ninput uncertainty of the light observed so far: not known, "),
                    HasSubstr("it is not known on which materials their light scatters")));
  b.bands.coherent = b.total.asd;
  EXPECT_THAT(band_text(b, {14.14}), AllOf(HasSubstr(" not known "), Not(HasSubstr("nan"))));
}

}  // namespace
}  // namespace straytrace::test
