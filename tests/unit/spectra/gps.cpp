// SPDX-License-Identifier: BSD-3-Clause
// GPS time, UTC and spans of the command line.
#include "spectra/files/gps.hpp"

#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace {
namespace {

TEST(Gps, KnownTimes) {  // of published events, and on both sides of a leap second
  EXPECT_EQ(gps_of_utc("1980-01-06"), 0);
  EXPECT_EQ(gps_of_utc("2015-09-14T09:50:45"), 1126259462);
  EXPECT_EQ(gps_of_utc("2017-08-17 12:41:04Z"), 1187008882);
  EXPECT_EQ(gps_of_utc("2016-12-31T23:59:59"), 1167264016);
  EXPECT_EQ(gps_of_utc("2016-12-31T23:59:60"), 1167264017);
  EXPECT_EQ(gps_of_utc("2017-01-01T00:00:00"), 1167264018);
  EXPECT_EQ(gps_of_utc("2019-02-01T12:00:00.25"), 1233057618.25);
  for (char const* wrong : {"2019-02-30T00:00:00", "2019-02-01T23:59:60", "1979-12-31", "2019-2-1", "noon", ""})
    EXPECT_FALSE(gps_of_utc(wrong)) << wrong;
}

TEST(Gps, ThereAndBack) {
  EXPECT_EQ(utc_of_gps(1167264017), "2016-12-31T23:59:60Z");
  EXPECT_EQ(utc_of_gps(1167264018), "2017-01-01T00:00:00Z");
  EXPECT_EQ(utc_of_gps(1126259462.4), "2015-09-14T09:50:45.400000Z");
  for (double gps = 1.0; gps < 1.5e9; gps += 7654321) EXPECT_EQ(gps_of_utc(utc_of_gps(gps)), gps);
}

TEST(Gps, SpansOfTheCommandLine) {
  GpsSpan const both = parse_gps("2019-02-01T12:00:00..1233057700.5");
  EXPECT_EQ(both.from, 1233057618);
  EXPECT_EQ(both.to, 1233057700.5);
  EXPECT_EQ(parse_gps("1233057618").to, GpsSpan{}.to);
  EXPECT_EQ(parse_gps("..1233057618").from, GpsSpan{}.from);
  for (char const* wrong : {"2..1", "1..1", "a..b", "", "1...2x"}) EXPECT_THROW(parse_gps(wrong), InputError) << wrong;
}

TEST(Units, OfFilesAndForGwpy) {
  struct Row {
    char const *theirs, *ours;
  };
  for (Row const& r : {Row{"m / Hz(1/2)", "m/sqrt(Hz)"},
                       {"1 / Hz(1/2)", "1/sqrt(Hz)"},
                       {"m / s2", "m/s^2"},
                       {"ct", "count"},
                       {"", "1"},
                       {"V / (m s2)", "V/(m*s^2)"},
                       {"m2 / Hz", "m^2/Hz"},
                       {"um", "um"},
                       {"Pa", "Pa"},
                       {"nT", "nT"}}) {
    EXPECT_EQ(unit_of_file(r.theirs), r.ours);
    EXPECT_EQ(gwpy_unit(r.ours), r.theirs);
  }
  EXPECT_EQ(unit_of_file("strain"), "1");
  EXPECT_EQ(unit_of_file("m/s**2"), "m/s^2");
  EXPECT_EQ(gwpy_unit("m/s^2/sqrt(Hz)"), "m / (s2 Hz(1/2))");
  EXPECT_FALSE(unit_of_file("furlong"));
  EXPECT_FALSE(unit_of_file("m /"));
  EXPECT_EQ(psd_unit("um/s^2"), "um^2/s^4/Hz");
  EXPECT_EQ(asd_unit("1"), "1/sqrt(Hz)");
  EXPECT_EQ(ratio_unit("V", "m/s^2"), "V/(m/s^2)");
  EXPECT_EQ(ratio_unit("m", "m"), "1");
  for (char const* unit : {"um/s^2", "V", "count", "1"})  // what is made can be read
    for (std::string const& made : {asd_unit(unit), psd_unit(unit), ratio_unit("m", unit)})
      EXPECT_TRUE(unit_of_file(made)) << made;
}

}  // namespace
}  // namespace straytrace
