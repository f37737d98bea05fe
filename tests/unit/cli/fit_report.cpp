// SPDX-License-Identifier: BSD-3-Clause
// What a fit says about the clocks of its records.
#include "cli/fit/fit_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/every_module.hpp"

namespace straytrace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string said(ClockCheck const& clock) {
  FringeRecords records;
  records.witnesses.emplace_back();
  FringeFitSettings const settings;
  std::vector<RoutePrediction> const routes;
  FringeFit fit;
  fit.clock = clock;
  return fit_text({records, settings, routes, fit, false});
}

// The search looks 250 ms to either side only, and says so where it finds nothing and where the best delay lies at its
// end. Controls: a delay well inside, and clocks that were not compared.
TEST(FitReport, AClockMayBeWrongByMoreThanTheSearchLooks) {
  auto const beyond = HasSubstr("the clock may be wrong by more");
  EXPECT_THAT(said({0.25, {}, 0, {}, false, false}),
              AllOf(HasSubstr("no delay within 250 ms"), HasSubstr("wrong by more was not searched for")));
  for (double const delay : {0.24, -0.24}) EXPECT_THAT(said({0.25, {delay, 1e-3, false}, 50, {}, true, true}), beyond);
  EXPECT_THAT(said({0.25, {0.2, 1e-3, true}, 50, {}, true, true}), beyond);
  EXPECT_THAT(said({0.25, {0.031, 1e-3, false}, 50, {}, true, true}), Not(beyond));
  EXPECT_THAT(said({}), Not(HasSubstr("clock")));
}

}  // namespace
}  // namespace straytrace
