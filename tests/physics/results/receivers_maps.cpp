// SPDX-License-Identifier: BSD-3-Clause
// Maps of receivers: flatness, quadrants, interference (R3.29, R3.30, R4.02).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "physics/results/receiver_support.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing {
namespace {

std::string disc(std::string const& profile, std::string const& receiver) {
  return "scene:\n  - {name: det, shape: {disk: {outer_radius: 20 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: "
         "b, "
         "material: black}\nbeams: {b: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], power: 3 W, radius: 10 cm, "
         "profile: " +
         profile + "}}\nreceivers: {PD: {on: det, " + receiver + "}}\n";
}

// R3.29: a uniform disc is flat, and the error of each pixel holds: the mean square of (value - expectation)/error over
// 1024 pixels is 1, in the mean over 110 seeds. Pixels of one run are correlated, as strata deal its light. With B
// blocks the square of such a ratio has the mean (B - 1)/(B - 3).
TEST(ReceiverMaps, AUniformDiscIsFlatWithinItsErrors) {
  std::string const map = "map: {pixels: [32, 32], width: 10 cm}";
  auto const statistic = [](Traced const& t, double scale) {
    BlockSums const& total = t.result.total;
    CellEstimates const cells = cell_estimates(total.receivers[0].image, total.histories, total.blocks);
    double const expected = 0.01 / 1024 / (pi * 0.01), b = double(total.blocks);
    double sum = 0;
    for (std::size_t i = 0; i < cells.mean.size(); ++i)
      sum += std::pow((cells.mean[i] - expected) / (scale * cells.error[i]), 2);
    return sum * (b - 3) / (b - 1) / 1024;
  };
  Sampler right, large, small;
  for (std::uint64_t seed = 1; seed <= 110; ++seed) {
    Traced const flat = traced(disc("even", map), 32, 2, {}, seed);
    ASSERT_EQ(flat.result.total.receivers[0].image.sum.size(), 1024u);
    right.add(statistic(flat, 1)), large.add(statistic(flat, 1.25)), small.add(statistic(flat, 0.8));
  }
  expect_mean("mean square", right.mean(), 1, 0.36);
  expect_rejected("errors too large", large.mean(), 1);
  expect_rejected("errors too small", small.mean(), 1);
  EXPECT_GT(statistic(traced(disc("gaussian", map), 64), 1), 2);  // control: another profile
}

// Without stated pixels: an even spot of 0.1 mm on a diode of 10 mm. Within r of its centre is (r/w)^2 of the light, by
// cells small against the spot. Control: squares of 9 x 9.
TEST(ReceiverMaps, ASpotOfATenthOfAMillimetreIsResolved) {
  double const w = 5e-5, x = 1.2e-3, y = -0.7e-3;
  auto const scene = [](std::string const& map) {
    return "scene:\n  - {name: det, shape: {disk: {outer_radius: 5 mm}}, at: [0 m, 0 m, 1 m], body: b, material: "
           "black}\nbeams: {b: {from: [1.2 mm, -0.7 mm, 0 m], facing: [0, 0, 1], radius: 0.05 mm, wavelength: 1 um, "
           "profile: even}}\nreceivers: {PD: {on: det, map: " +
           map + "}}\n";
  };
  Traced const t = traced(scene("{}"), 64);
  Receiver const& r = t.world.receivers()[0];
  MapSums const& image = t.result.total.receivers[0].image;
  ASSERT_TRUE(r.by_light && r.chart == Chart::polar);
  ASSERT_EQ(image.sum.size(), r.cells.size);
  double sum = 0, widest = 0, area = 0;
  for (std::size_t i = 0; i < r.cells.size; ++i) {
    MapCell const& c = r.cells[i];
    sum += image.sum[i] / double(t.result.total.histories);
    area += r.area(i);
    double const u = 0.5 * (c.u_low + c.u_high), v = 0.5 * (c.v_low + c.v_high);
    if (std::hypot(u * std::cos(v) - x, u * std::sin(v) - y) < 0.8 * w)
      widest = std::fmax(widest, std::fmax(c.u_high - c.u_low, u * (c.v_high - c.v_low)));
  }
  EXPECT_NEAR(sum, t.power(0).mean, 1e-12 * sum);
  EXPECT_NEAR(area, pi * 25e-6, 1e-12 * area);
  EXPECT_GT(widest, 0);
  EXPECT_LT(widest, 0.2 * w);
  auto const within = [&](double radius) {
    double inside = 0;
    for (std::size_t i = 0; i < r.cells.size; ++i) {
      MapCell const& c = r.cells[i];
      double const u = 0.5 * (c.u_low + c.u_high), v = 0.5 * (c.v_low + c.v_high);
      if (std::hypot(u * std::cos(v) - x, u * std::sin(v) - y) < radius) inside += image.sum[i];
    }
    return inside / double(t.result.total.histories) / sum;
  };
  EXPECT_NEAR(within(0.5 * w), 0.25, 0.03);
  Traced const squares = traced(scene("{pixels: [9, 9], width: 10 mm}"), 1);  // control: one of them has all light
  auto const& nine = squares.result.total.receivers[0].image.sum;
  EXPECT_EQ(std::count_if(nine.begin(), nine.end(), [](double p) { return p > 0; }), 1);
}

// A uniform annulus is flat within the errors of its cells, whose number the program chose: chi-square as above.
// Controls: a tilt of 5 % across the radius, and a Gaussian beam.
TEST(ReceiverMaps, AUniformAnnulusIsFlatInItsOwnCells) {
  auto const scene = [](std::string const& profile) {
    return "scene:\n  - {name: det, shape: {disk: {inner_radius: 4 cm, outer_radius: 10 cm}}, at: [0 m, 0 m, 1 m], "
           "facing: [0, 0, -1], body: b, material: black}\nbeams: {b: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], "
           "radius: 12 cm, profile: " +
           profile + "}}\nreceivers: {PD: {on: det, map: {}}}\n";
  };
  auto const statistic = [](Traced const& t, double tilt) {
    BlockSums const& total = t.result.total;
    Receiver const& r = t.world.receivers()[0];
    CellEstimates const all = cell_estimates(total.receivers[0].image, total.histories, total.blocks);
    double const b = double(total.blocks);
    double sum = 0;
    for (std::size_t i = 0; i < r.cells.size; ++i) {
      MapCell const& c = r.cells[i];
      double const x = 0.5 * (c.u_low + c.u_high) * std::cos(0.5 * (c.v_low + c.v_high));
      double const expected = r.area(i) / (pi * 0.12 * 0.12) * (1 + tilt * x / 0.1);
      sum += std::pow((all.mean[i] - expected) / all.error[i], 2);
    }
    EXPECT_GT(r.cells.size, 100u);
    return sum * (b - 3) / (b - 1) / double(r.cells.size);
  };
  Sampler flat, tilted;
  for (std::uint64_t seed = 1; seed <= 90; ++seed) {
    Traced const t = traced(scene("even"), 32, 2, {}, seed);
    flat.add(statistic(t, 0)), tilted.add(statistic(t, 0.05));
  }
  expect_mean("mean square", flat.mean(), 1, 0.75);
  expect_rejected("tilted", tilted.mean(), 1);
  EXPECT_GT(statistic(traced(scene("gaussian"), 64), 0), 2);
}

// Cells and what is in them are functions of scene, seed and histories: not of threads, nor of where a run stopped.
// Another seed fills the same cells.
TEST(ReceiverMaps, CellsDoNotDependOnThreadsOrStops) {
  std::string const scene = disc("gaussian", "map: {width: 8 cm, centre: [1 cm, 0 cm]}");
  Traced const one = traced(scene, 40, 1), two = traced(scene, 40, 3), half = traced(scene, 16, 2);
  Traced const resumed = traced(scene, 40, 2, half.result.tree);
  auto const& image = one.result.total.receivers[0].image;
  EXPECT_EQ(one.world.receivers()[0].chart, Chart::plane);
  ASSERT_GT(image.sum.size(), 100u);
  for (Traced const* t : {&two, &resumed}) {
    EXPECT_EQ(t->result.total.receivers[0].image.sum, image.sum);
    EXPECT_EQ(t->result.total.receivers[0].image.sum2, image.sum2);
  }
  EXPECT_NE(half.result.total.receivers[0].image.sum, image.sum);
  for (std::size_t i = 0; i < image.sum.size(); ++i) {
    EXPECT_EQ(half.world.receivers()[0].cells[i].u_low, one.world.receivers()[0].cells[i].u_low);
    EXPECT_EQ(half.world.receivers()[0].cells[i].v_high, one.world.receivers()[0].cells[i].v_high);
  }
}

// R3.30: a centred beam gives four equal quarters; a frame out of centre by d along x has F on one side of its axis,
// F = 1/2 + (a sqrt(1 - a^2) + asin a)/pi with a = d/R; quadrants and gap together are the whole to rounding.
TEST(ReceiverMaps, Quadrants) {
  auto const cells = [](Traced const& t) {
    BlockSums const& total = t.result.total;
    return cell_estimates(total.receivers[0].quadrants, total.histories, total.blocks);
  };
  auto const of = [](CellEstimates const& c, std::size_t i) { return SampleMean{c.mean[i], c.error[i], 1 << 19}; };
  // Dealt alike to all blocks: the error is the light of one of them.
  CellEstimates const centred = cells(traced(disc("even", "quadrants: {}"), 384));
  for (std::size_t i = 0; i < 4; ++i) expect_mean("quarter", of(centred, i), 0.25, 0.006);
  EXPECT_TRUE(std::isnan(centred.mean[4]));  // no gap: no light seen there

  Traced const shifted = traced(disc("even", "quadrants: {gap: 2 mm, centre: [2.5 cm, 0 m], turn: 90 deg}"), 128);
  CellEstimates const c = cells(shifted);
  double sum = 0;
  for (double const x : c.mean) sum += x;
  EXPECT_NEAR(sum / shifted.power(0).mean, 1, 1e-12);
  expect_rejected("centred frame", of(c, 0), 0.25);
  // Turned by 90 deg, "lower" (y < 0) is x > 2.5 cm on the disc, less half of the gap: x > 2.6 cm.
  double const a = 0.26, share = 0.5 - (a * std::sqrt(1 - a * a) + std::asin(a)) / pi;
  double const along =
      4 * 0.1 * 1e-3 / (pi * 0.01) / 4;  // strip of half the gap's width along the other axis, a quarter
  double const lower = c.mean[0] + c.mean[1];
  EXPECT_NEAR(lower, share - 2 * along * (1 - a), 5 * std::hypot(c.error[0], c.error[1]) + 1e-3);
  EXPECT_GT(std::fabs(c.mean[2] + c.mean[3] - share), 0.2);  // control: the axis turned the other way
}

// R4.02: two plane waves cross at 2 theta: fringes lambda/(2 sin theta) apart, of contrast 2 sqrt(P1 P2)/(P1 + P2).
struct Fringes {
  double contrast, wave_number;  // rad/m
};
Fringes fringes_of(std::vector<double> const& irradiance, std::vector<double> const& x, double near) {
  double mean = 0, width = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean += irradiance[i] / double(x.size());
    width = std::max(width, x[i]);
  }
  auto const amplitude = [&](double k, bool windowed) {
    std::complex<double> sum;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += (irradiance[i] - mean) * std::polar(1.0, -k * x[i]) *
             (windowed ? std::pow(std::sin(pi * x[i] / width), 2) : 1);
    return 2 * std::abs(sum) / (mean * double(x.size()));
  };
  double best = near;
  for (double k = 0.7 * near; k < 1.3 * near; k += 1e-3 * near)
    if (amplitude(k, true) > amplitude(best, true)) best = k;
  return {amplitude(near, false), best};
}

TEST(ReceiverMaps, CrossedPlaneWavesInterfere) {
  // 4 fringes of 1 mm: a pixel is 1/16 of a fringe, whose averages over whole fringes are exact.
  double const theta = std::asin(0.5 * 1.064e-6 / 1e-3);
  auto const wave = [&](char const* name, double side, char const* power) {
    return fmt::format(
        "  {}: {{from: [{} m, 0 m, 0 m], facing: [{}, 0, {}], profile: even, radius: 8 mm, power: {}}}\n", name,
        -side * std::tan(theta), side * std::sin(theta), std::cos(theta), power);
  };
  std::string const scene =
      "scene:\n  - {name: det, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: b, "
      "material: black}\nbeams:\n" +
      wave("one", 1, "1 W") + wave("two", -1, "250 mW") +
      "receivers: {PD: {on: det, map: {pixels: [64, 2], width: 4 mm, height: 4 mm}}}\n";
  Traced const t = traced(scene, 256);
  FieldMap const map = field_map(t.world.receivers()[0], t.result.total.receivers[0], t.result.total.histories,
                                 t.content().map_areas.at(0));
  ASSERT_EQ(map.field.size(), 128u);
  std::vector<double> x, right, wrong;
  for (std::size_t i = 0; i < map.field.size(); ++i) {
    x.push_back((double(i % 64) + 0.5) * 4e-3 / 64);
    right.push_back(std::norm(map.field[i]));
    EXPECT_GT(map.coherence[i], 0.98);
    std::complex<double> control;  // the power of a pixel taken as its amplitude
    for (auto const& [route, f] : t.result.total.receivers[0].fields)
      control += std::complex<double>(f.real[i], f.imaginary[i]);
    wrong.push_back(std::norm(control));
  }
  double const k = 2 * pi / 1e-3;
  Fringes const seen = fringes_of(right, x, k);
  EXPECT_NEAR(seen.contrast, 0.8, 0.02);
  EXPECT_NEAR(seen.wave_number, k, 0.02 * k);
  EXPECT_GT(std::fabs(fringes_of(wrong, x, k).contrast - 0.8), 0.2);
  EXPECT_GT(std::fabs(fringes_of(right, x, 0.5 * k).contrast - 0.8), 0.5);  // fringes lambda/sin(theta) apart
  // Absolute: the mean irradiance is that of 1 W and 0.25 W over the discs.
  double mean = 0;
  for (double const i : right) mean += i / double(right.size());
  EXPECT_NEAR(mean, 1.25 / (pi * 64e-6), 0.03 * 1.25 / (pi * 64e-6));
}

}  // namespace
}  // namespace straytrace::testing
