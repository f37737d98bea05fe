// SPDX-License-Identifier: BSD-3-Clause
// The range of a route over draws of mirrors and edges (docs/theory/wave.md, Edges that move): percentiles of the noise
// of each draw alone, while the route itself is their mean.
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_draw_band {
namespace {

// Draw n has n + 1 times the field of the first, in two records as those of an edge.
CouplingClass drawn(int draws) {
  CouplingClass c = known_class(1, 0, {});
  c.kind = ClassKind::wave;
  for (int n = 0; n < draws; ++n)
    for (int part : {0, 1}) {
      double const weight = 1e-20 * (part == 0 ? 0.3 : 0.7) / draws;
      c.records.push_back(record(std::uint64_t(n), weight, {phase_sensitivity(0, 2, (n + 1) * two_k)}));
      c.coupling.mean += weight;
    }
  return c;
}

NoiseTrace route(CouplingClass const& c) {
  MotionSet const motion = moving({gaussian_line(30, 3, 1e-11)});
  return project_noise(known_table({c}), motion, UnitDetector(), on({20, 27, 33, 40})).routes.at(0);
}

TEST(DrawBand, PercentilesOfSingleDraws) {
  NoiseTrace const one = route(drawn(1)), forty = route(drawn(40));
  ASSERT_EQ(forty.draws_low.size(), 3u);
  double mean = 0, fourth = 0;
  for (int n = 1; n <= 40; ++n) {
    mean += n * n / 40.0;
    fourth += std::pow(n, 4) / 40.0;
  }
  for (std::size_t bin : {0, 1, 2}) {
    EXPECT_NEAR(forty.draws_low[bin] / one.asd[bin], 2, 1e-3);    // second of 40
    EXPECT_NEAR(forty.draws_high[bin] / one.asd[bin], 38, 0.02);  // 38th
    EXPECT_NEAR(forty.asd[bin] / one.asd[bin], std::sqrt(mean), 0.02);
    EXPECT_NEAR(2 * forty.draws_sigma[bin] / forty.asd[bin], std::sqrt((fourth - mean * mean) / 39) / mean, 1e-3);
  }
  NoiseTrace const three = route(drawn(3));  // smallest and largest
  EXPECT_NEAR(three.draws_low[1] / one.asd[1], 1, 1e-3);
  EXPECT_NEAR(three.draws_high[1] / one.asd[1], 3, 1e-3);
}

TEST(DrawBand, OnlyOfDraws) {
  EXPECT_TRUE(route(drawn(1)).draws_low.empty());
  CouplingClass edge = drawn(4);
  edge.kind = ClassKind::edge;
  EXPECT_TRUE(route(edge).draws_low.empty());  // control: histories of other classes are no draws
}

}  // namespace
}  // namespace straytrace::testing::noise_draw_band
