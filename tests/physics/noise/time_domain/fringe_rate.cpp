// SPDX-License-Identifier: BSD-3-Clause
// Predicted fringe frequencies against published arches (docs/theory/spectra.md, eq. 7.1, cases B1 to B3; R2.39, R2.41,
// R6.10).
#include "motion/motion_files.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

// Sine motion along z of body 0.
MotionSeries swinging(double peak, double hz, double duration = 20) {
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(hz, peak)};
  return draw_motion(motion, {1000, 512, std::size_t(512 * duration)}, 1);
}
double largest(std::vector<double> const& x) { return *std::max_element(x.begin(), x.end()); }
double fringe_of(double peak, double hz, double bounces = 1) {
  return largest(fringe_frequency(swinging(peak, hz).coordinates[0].velocity, wavelength, bounces));
}

// Minima of the fringe frequency lie between arches.
double time_between_arches(std::vector<double> const& hz, double rate) {
  std::vector<std::size_t> minima;
  for (std::size_t i = 1; i + 1 < hz.size(); ++i)
    if (hz[i] < hz[i - 1] && hz[i] <= hz[i + 1]) minima.push_back(i);
  return double(minima.back() - minima.front()) / double(minima.size() - 1) / rate;
}

TEST(PublishedArches, KagraSine) {  // B1: 14 um at 0.42 Hz
  MotionSeries const m = swinging(14e-6, 0.42);
  EXPECT_LT(deviation(largest(m.coordinates[0].velocity), 36.945e-6), 1e-4);  // A2
  EXPECT_LT(deviation(fringe_of(14e-6, 0.42), 69.4), 1e-3);
  EXPECT_GT(fringe_of(14e-6, 0.42), 50);  // published: arches of 50 to 100 Hz
  EXPECT_LT(fringe_of(14e-6, 0.42), 100);
  std::vector<double> const hz = fringe_frequency(m.coordinates[0].velocity, wavelength, 1);
  EXPECT_LT(deviation(2 * time_between_arches(hz, 512), 2.4), 0.02);  // two arches in a period of the motion
}

TEST(PublishedArches, HanfordReactionMass) {  // B2: 5 um/s
  std::vector<double> const velocity = {5e-6, -5e-6};
  double const one = fringe_frequency(velocity, wavelength, 1)[1];
  EXPECT_LT(deviation(one, 9.40), 1e-3);
  EXPECT_LT(deviation(one, 10), 0.1);           // published: about 10 Hz between arches
  EXPECT_LT(deviation(100 / one, 10.6), 0.01);  // bounces for 100 Hz
  EXPECT_LT(deviation(fringe_frequency(velocity, wavelength, 10.6)[0], 100), 0.01);
}

TEST(PublishedArches, VirgoSwingingBaffle) {                // B3: bump near 70 Hz
  EXPECT_LT(deviation(fringe_of(5e-6, 1.14), 67.3), 1e-3);  // 10 um peak to peak
  EXPECT_LT(deviation(fringe_of(5e-6, 1.14), 70), 0.05);
  EXPECT_LT(deviation(fringe_of(10e-6, 1.14), 134.6), 1e-3);  // as amplitude: excluded
  EXPECT_GT(deviation(fringe_of(10e-6, 1.14), 70), 0.5);
  EXPECT_LT(deviation(pendulum_modes({1}, {0.191}).at(0), 1.14), 2e-3);  // the pendulum that swings so: 19.1 cm
}

TEST(PublishedArches, CutOffAndMicroseism) {  // R2.39, R2.41
  EXPECT_LT(deviation(fringe_of(600e-6, 0.06), 425.2), 1e-4);
  EXPECT_LT(deviation(fringe_of(600e-6, 0.12), 850.4), 1e-4);
  EXPECT_LT(deviation(fringe_of(900e-6, 0.12), 1275.5), 1e-4);
  EXPECT_LT(deviation(fringe_of(3e-6, 0.35), 12.40), 1e-3);
  EXPECT_GT(deviation(fringe_of(300e-6, 0.06), 425.2), 0.4);  // control: peak to peak read as peak
}

// Multiplicity from the phase sensitivities: a route that sees the body twice has arches twice as high (eq. 7.1).
TEST(FringeCurve, CountsBouncesByThePhaseSensitivities) {
  CouplingTable table = known_table({known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})}),
                                     known_class(2, 1,
                                                 {record(0, 0.5, {phase_sensitivity(0, 2, 1.9 * two_k)}),
                                                  record(1, 0.5, {phase_sensitivity(0, 2, 2.1 * two_k)})}),
                                     known_class(3, 1, {record(0, 1, {phase_sensitivity(1, 2, two_k)})})});
  MotionSeries const m = swinging(14e-6, 0.42);
  FringeCurve const once = fringe_curve(table, 0, m), twice = fringe_curve(table, 1, m),
                    still = fringe_curve(table, 2, m);
  ASSERT_EQ(once.bodies.size(), 1u);
  EXPECT_NEAR(once.bodies[0].bounces, 1, 1e-12);
  EXPECT_NEAR(twice.bodies[0].bounces, 2, 1e-12);
  EXPECT_NEAR(twice.bodies[0].spread, 0.1, 1e-12);
  EXPECT_LT(deviation(largest(twice.hz), 2 * 69.446), 1e-4);
  EXPECT_TRUE(still.bodies.empty());
  EXPECT_EQ(largest(still.hz), 0);

  table.classes[1].reverse = 4;
  std::vector<std::uint32_t> const routes = {0, 1, 2};
  FringeCurves const all = fringe_curves(table, routes, m, 3), first = fringe_curves(table, routes, m, 1);
  ASSERT_EQ(all.curves.size(), 2u) << "the third does not move";
  EXPECT_EQ(all.curves[0].route, 1u) << "the largest coupling first";
  EXPECT_EQ(all.left_out, 0u);
  EXPECT_EQ(all.largest, twice.hz);
  ASSERT_EQ(first.curves.size(), 1u);
  EXPECT_EQ(first.left_out, 2u);
  EXPECT_NE(fringe_curves(table, std::span(routes).first(1), m, 3).largest, all.largest) << "control: one route";
}

TEST(FringeStrides, PercentilesAndCrossings) {  // R6.10
  // 10 s below, 20 s of a storm, 10 s below; arches |cos|: median 1/sqrt 2, 95 % 0.9969 of the top.
  SampleTimes const times{1000, 100, 4000};
  std::vector<double> hz;
  for (std::size_t i = 0; i < 4000; ++i)
    hz.push_back((i >= 1000 && i < 3000 ? 40 : 4) * std::fabs(std::cos(2 * pi * 0.3 * double(i) / 100)));
  std::vector<FringeStride> const strides = by_stride(hz, times, 10, 10);
  ASSERT_EQ(strides.size(), 4u);
  EXPECT_NEAR(strides[1].median, 40 / std::sqrt(2), 0.3);
  EXPECT_NEAR(strides[1].p95, 40 * std::sin(0.95 * pi / 2), 0.1);
  EXPECT_NEAR(strides[1].largest, 40, 0.02);
  EXPECT_NEAR(strides[1].share_above, 1 - 2 / pi * std::asin(0.25), 0.01);
  EXPECT_EQ(strides[0].share_above, 0);
  std::vector<StretchAbove> const stretches = stretches_above(strides, 10);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].from, 1010);
  EXPECT_EQ(stretches[0].to, 1030);
  EXPECT_NEAR(stretches[0].largest, 40, 0.02);
}

}  // namespace
}  // namespace straytrace::testing
