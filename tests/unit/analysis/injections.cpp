// SPDX-License-Identifier: BSD-3-Clause
// What couplings from injections are made of: stretches that lie apart, a witness in metres, peaks; units of motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coupling/lines.hpp"
#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "spectra/curve.hpp"

namespace straytrace {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Injections, PeaksAreAboveZeroAndNoNeighbourExceedsThem) {
  EXPECT_THAT(peaks_of(std::vector<double>{3, 1, 2, 2, 0, 5}), ElementsAre(0, 3, 5));
  EXPECT_THAT(peaks_of(std::vector<double>{0, 0, 0}), IsEmpty());
  EXPECT_THAT(peaks_of(std::vector<double>{1, 2, 3}), ElementsAre(2));
}

// Controls: stretches that touch, and other files whose time is not GPS.
TEST(Injections, StretchesThatShareTimeAreRejected) {
  FoundStretch const quiet{"--quiet 0..24", "a.csv", 0, 24};
  EXPECT_THROW(refuse_overlaps({quiet, {"--injection 20..30", "a.csv", 20, 30}}), InputError);
  EXPECT_NO_THROW(refuse_overlaps({quiet, {"--injection 24..48", "a.csv", 24, 48}}));
  EXPECT_NO_THROW(refuse_overlaps({quiet, {"--injection 20..30", "b.csv", 20, 30}}));
}

// An acceleration of amplitude a at f moves a/(2 pi f)^2; control: without --displacement nothing changes.
TEST(Injections, AccelerationBecomesMetres) {
  std::vector<LinePoint> line{{0, 10, 0, 4 * pi * pi * 100, 0.5}}, kept = line;
  in_metres(to_metres(true, "m/s^2"), line);
  EXPECT_NEAR(std::abs(line[0].amplitude), 1, 1e-12);
  in_metres(to_metres(false, "m/s^2"), kept);
  EXPECT_EQ(kept[0].amplitude.real(), 4 * pi * pi * 100);
}

TEST(Injections, IntegrationsFollowFromUnits) {
  EXPECT_EQ(integrations_to(dim::length, "um/s^2"), 2);
  EXPECT_EQ(integrations_to(dim::angle, "urad/s"), 1);
  EXPECT_EQ(integrations_to(dim::length, "m"), 0);
  EXPECT_EQ(integrations_to(dim::length, "rad"), std::nullopt);
  EXPECT_EQ(integrations_to(dim::length, "m/s^3"), std::nullopt);
}

// Twice the prediction with 10 % error: ratio 2, ln 2 away at 0.1. A limit below the prediction counts as exceeded.
TEST(Injections, OverlayComparesWithTheBinOfThePrediction) {
  std::vector<double> const edges{10, 20, 40}, factor{1, 3}, sigma{0, 0};
  CouplingFunction measured{"x", "h", "m", "1/m", {}};
  CouplingPoint point, limit;
  point.hz = 15;
  point.factor = 2;
  point.sigma = 0.2;
  point.flag = CouplingFlag::measured;
  limit.hz = 30;
  limit.factor = 1;
  limit.flag = CouplingFlag::upper_limit;
  measured.points = {point, limit};
  Overlay const o = overlay_of(measured, {edges, factor, sigma, "1/m"});
  ASSERT_EQ(o.points.size(), 2);
  EXPECT_NEAR(std::exp(o.mean_ratio), 2, 1e-12);
  EXPECT_NEAR(o.points[0].significance, std::log(2) / 0.1, 1e-9);
  EXPECT_EQ(o.measured, 1);
  EXPECT_EQ(o.points[1].bin, 1u);
  EXPECT_THROW(overlay_of(measured, {edges, factor, sigma, "1/rad"}), InputError);
}

TEST(Injections, OneMeasuredPointRepresentsABin) {
  Overlay o;
  for (double const error : {0.2, 0.1, 0.4}) {
    CouplingPoint p;
    p.factor = 2;
    p.sigma = error;
    p.flag = CouplingFlag::measured;
    o.points.push_back({.measured = p, .bin = 0});
  }
  CouplingPoint limit;
  limit.factor = 9;
  limit.flag = CouplingFlag::upper_limit;
  o.points.push_back({.measured = limit, .bin = 0});
  o.points.push_back({.measured = limit, .bin = 2});
  auto const kept = points_by_bin(o, 3);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0], &o.points[1]) << "control: the last one, or a limit";
  EXPECT_EQ(kept[1], nullptr);
  EXPECT_EQ(kept[2], &o.points[4]);
}

}  // namespace
}  // namespace straytrace
