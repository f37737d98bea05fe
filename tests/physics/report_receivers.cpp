// SPDX-License-Identifier: BSD-3-Clause
// Light in watts from scene to map: enclosures, flatness, quadrants, interference, census, files
// (requirements.md R2.24, R3.28 to R3.32, R4.02).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstring>

#include "chi_square.hpp"
#include "report/receivers.hpp"
#include "statistics.hpp"
#include "trace/trace.hpp"
#include "unit/report_synthetic.hpp"
#include "world/world.hpp"

namespace straytrace::testing {
namespace {

constexpr char head[] =
    "straytrace: 1\nmaterials:\n  black: {}\n  white: {scatter: {model: lambertian, tis: 100 %}}\n"
    "  mirror: {specular: {reflect: 99 %}}\n  rough: {specular: {reflect: 50 %}, scatter: {model: lambertian, tis: 40 "
    "%}}\n"
    "bodies: {b: {motion: still}}\n";

World world_of(std::string const& text) {
  FileTexts const texts{{"a.yaml", head + text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

struct Traced {
  World world;
  TraceResult result;
  RunContent content() const {
    RunContent c;
    c.receivers = world.receivers();
    c.beam_power = world.beam_power;
    c.main_file = "a.yaml";
    c.provenance.created = "2024-05-01T12:00:00Z";
    c.trace = &result;
    return c;
  }
  Estimate const& power(std::size_t i) const { return result.coupling.received_power.at(i); }
  double emitted() const { return result.total.emitted.sum / double(result.total.histories); }
  double all_received() const {
    double sum = 0;
    for (Estimate const& e : result.coupling.received_power) sum += e.mean;
    return sum;
  }
};
Traced traced(std::string const& text, std::uint64_t blocks, unsigned threads = 2, SumTree resume = {}) {
  Traced t{world_of(text), {}};
  TraceSettings settings;
  settings.histories = blocks * block_size;
  settings.threads = threads;
  settings.resume = std::move(resume);
  t.result = trace(t.world, settings, *make_backend("cpu"));
  return t;
}

std::string can(bool wall = true) {
  return std::string(
             "scene:\n"
             "  - {name: lamp, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 30 cm], body: b, side: front, "
             "material: white}\n"
             "  - {name: wall, shape: {cylinder: {radius: 30 cm, from: 0 m, to: 1 m}}, body: b, material: black}\n"
             "  - {name: low, shape: {disk: {outer_radius: 30 cm}}, body: b, material: black}\n"
             "  - {name: high, shape: {disk: {outer_radius: 30 cm}}, at: [0 m, 0 m, 1 m], body: b, material: "
             "black}\n"
             "beams: {light: {on: lamp, profile: even, radius: 3 cm}}\n"
             "receivers: {low: {on: low}, high: {on: high}") +
         (wall ? ", wall: {on: wall}}\n" : "}\n");
}

// R3.28: the count on a full enclosure is the light launched; by itself to rounding, with connections within errors.
TEST(Receivers, AFullEnclosureCountsAllLight) {
  std::string const ball =
      "scene:\n  - {name: ball, shape: {sphere: {radius: 1 m}}, body: b, material: black}\n"
      "beams: {b: {from: [10 cm, 0 m, 0 m], facing: [1, 1, 1], profile: even, radius: 1 cm, wavefront_curvature: 50 "
      "/m}}\n"
      "receivers: {all: {on: ball, side: ";
  Traced const walk = traced(ball + "back}}\n", 4);
  EXPECT_NEAR(walk.power(0).mean / walk.emitted(), 1, 1e-12);
  EXPECT_EQ(traced(ball + "front}}\n", 4).power(0).scored, 0u);  // twin: the other side sees nothing

  Traced const lamp = traced(can(), 64);
  double variance = 0;
  for (Estimate const& e : lamp.result.coupling.received_power)
    if (e.scored > 0) variance += e.std_error * e.std_error;
  // Sums of errors: those of the parts of one whole partly cancel, so the bound is generous.
  SampleMean const sum{lamp.all_received() / lamp.emitted(), std::sqrt(variance) / lamp.emitted(),
                       (long long)lamp.result.total.histories};
  expect_mean("can", sum, 1, 0.02);
  Traced const open = traced(can(false), 64);  // twin: a receiver is missing
  expect_rejected("open can", {open.all_received() / open.emitted(), sum.std_error, sum.n}, 1);
}

// R2.24: the fates of all light sum to what was emitted, to 1e-12.
TEST(Receivers, BooksClose) {
  Traced const t = traced(can(), 32);
  double fates = 0;
  for (Moments const& m : t.result.total.ledger) fates += m.sum;
  EXPECT_NEAR(fates / t.result.total.emitted.sum, 1, 1e-12);
  double const without = fates - t.result.total.ledger[int(Fate::absorbed)].sum;
  EXPECT_GT(std::fabs(without / t.result.total.emitted.sum - 1), 0.1);  // twin
}

std::string disc(std::string const& profile, std::string const& receiver) {
  return "scene:\n  - {name: det, shape: {disk: {outer_radius: 20 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: "
         "b, "
         "material: black}\nbeams: {b: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], power: 3 W, radius: 10 cm, "
         "profile: " +
         profile + "}}\nreceivers: {PD: {on: det, " + receiver + "}}\n";
}

double two_sided(double statistic, double dof) {
  double const p = chi_square_tail(statistic, dof);
  return 2 * std::fmin(p, 1 - p);
}

// R3.29: a uniform disc is flat to sqrt(N), and the error of each pixel holds: chi-square of (value -
// expectation)/error over 1024 pixels. With B blocks the square of such a ratio has the mean (B - 1)/(B - 3).
TEST(Receivers, AUniformDiscIsFlatWithinItsErrors) {
  std::string const map = "map: {pixels: [32, 32], width: 10 cm}";
  auto const statistic = [](Traced const& t, double scale) {
    BlockSums const& total = t.result.total;
    CellEstimates const cells = cell_estimates(total.receivers[0].image, total.histories, total.blocks);
    double const expected = 0.01 / 1024 / (pi * 0.01), b = double(total.blocks);
    double sum = 0;
    for (std::size_t i = 0; i < cells.mean.size(); ++i)
      sum += std::pow((cells.mean[i] - expected) / (scale * cells.error[i]), 2);
    return sum * (b - 3) / (b - 1);
  };
  Traced const flat = traced(disc("even", map), 256);
  ASSERT_EQ(flat.result.total.receivers[0].image.sum.size(), 1024u);
  EXPECT_GT(two_sided(statistic(flat, 1), 1024), 1e-6) << statistic(flat, 1);
  EXPECT_LT(two_sided(statistic(flat, 1.25), 1024), 1e-6);  // twins: errors too large, too small, another profile
  EXPECT_LT(two_sided(statistic(flat, 0.8), 1024), 1e-6);
  EXPECT_LT(two_sided(statistic(traced(disc("gaussian", map), 64), 1), 1024), 1e-6);
}

// R3.30: a centred beam gives four equal quarters; a frame out of centre by d along x has F on one side of its axis,
// F = 1/2 + (a sqrt(1 - a^2) + asin a)/pi with a = d/R; quadrants and gap together are the whole to rounding.
TEST(Receivers, Quadrants) {
  auto const cells = [](Traced const& t) {
    BlockSums const& total = t.result.total;
    return cell_estimates(total.receivers[0].quadrants, total.histories, total.blocks);
  };
  auto const of = [](CellEstimates const& c, std::size_t i) { return SampleMean{c.mean[i], c.error[i], 1 << 19}; };
  CellEstimates const centred = cells(traced(disc("even", "quadrants: {}"), 128));
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
  EXPECT_GT(std::fabs(c.mean[2] + c.mean[3] - share), 0.2);  // twin: the axis turned the other way
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

TEST(Receivers, CrossedPlaneWavesInterfere) {
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
  FieldMap const map = field_map(t.world.receivers()[0], t.result.total.receivers[0], t.result.total.histories);
  ASSERT_EQ(map.field.size(), 128u);
  std::vector<double> x, right, wrong;
  for (std::size_t i = 0; i < map.field.size(); ++i) {
    x.push_back((double(i % 64) + 0.5) * 4e-3 / 64);
    right.push_back(std::norm(map.field[i]));
    EXPECT_GT(map.coherence[i], 0.98);
    std::complex<double> twin;  // the power of a pixel taken as its amplitude
    for (auto const& [route, f] : t.result.total.receivers[0].fields)
      twin += std::complex<double>(f.real[i], f.imaginary[i]);
    wrong.push_back(std::norm(twin));
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

std::string two_mirrors(std::string const& material) {
  return "scene:\n"
         "  - {name: M1, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 1, -1], body: b, "
         "material: " +
         material +
         "}\n  - {name: M2, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 1 m, 1 m], facing: [0, -1, 1], body: b, "
         "material: " +
         material +
         "}\n  - {name: det, shape: {disk: {outer_radius: 4 cm}}, at: [0 m, 1 m, 2 m], facing: [0, 0, -1], body: b, "
         "material: black}\n"
         "beams: {probe: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 5 mm, power: 2 W}}\n"
         "receivers:\n  PD: {on: det, map: {pixels: [8, 8], width: 4 cm}, angles: {bins: 4, half_angle: 10 deg}, "
         "quadrants: {}}\n"
         "  plane: {shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 50 cm, 1 m], facing: [0, -1, 0], map: {pixels: [4, "
         "4], "
         "width: 5 cm}}\n";
}

// R3.31: light over two mirrors is exactly one group of paths, and the census names what it has met.
TEST(Receivers, CensusOfATwoMirrorPath) {
  Traced const t = traced(two_mirrors("mirror"), 32);
  ReceiverTable const table = receiver_table(t.content());
  ReceiverEntry const& pd = table.receivers.at(0);
  ASSERT_EQ(pd.routes.size(), 1u);
  EXPECT_EQ(pd.routes[0].sequence, "probe·B > M1·R > M2·R > det·D");
  EXPECT_NEAR(pd.power.mean, 0.99 * 0.99, 1e-12);
  EXPECT_TRUE(pd.power.trusted) << pd.power.why_not;
  ASSERT_EQ(pd.census.size(), 3u);
  for (CensusRow const& row : pd.census) {
    EXPECT_NEAR(row.power.value, 0.99 * 0.99, 1e-12);
    EXPECT_EQ(row.routes, std::vector<std::size_t>{1});
  }
  // The plane between the mirrors hides nothing and is met once.
  EXPECT_NEAR(table.receivers.at(1).power.mean, 0.99, 1e-12);
  EXPECT_EQ(table.receivers[1].routes.at(0).sequence, "probe·B > M1·R > plane·D");
  // Twin: mirrors that scatter too have more than one.
  EXPECT_GT(receiver_table(traced(two_mirrors("rough"), 32).content()).receivers.at(0).routes.size(), 1u);
  std::string const text = receiver_text(table, 10);
  EXPECT_THAT(text, ::testing::HasSubstr("1.96"));  // W
  EXPECT_THAT(text, ::testing::HasSubstr("lower left"));
  EXPECT_THAT(census_text(table, 10), ::testing::HasSubstr("M2"));
}

// R3.32 and architecture.md 7: bits do not depend on threads, nor on stopping, writing, reading and going on.
TEST(Receivers, TheSameBitsHoweverTheyCame) {
  test::Folder const folder;
  auto const hash_of = [&](Traced const& t) {
    write_run(folder / "run.h5", t.content());
    return data_hash(folder / "run.h5");
  };
  std::string const scene = two_mirrors("rough");
  std::string const one = hash_of(traced(scene, 13, 1));
  EXPECT_EQ(hash_of(traced(scene, 13, 2)), one);
  EXPECT_EQ(hash_of(traced(scene, 13, 3)), one);
  hash_of(traced(scene, 6));
  RunFile const half = read_run(folder / "run.h5");
  EXPECT_EQ(hash_of(traced(scene, 13, 2, half.trace.tree)), one);
  RunFile const whole = read_run(folder / "run.h5");
  write_run(folder / "again.h5", whole.content());
  EXPECT_EQ(data_hash(folder / "again.h5"), one);
  EXPECT_EQ(whole.about.receivers.size(), 2u);
  EXPECT_EQ(whole.trace.coupling.received_power[0].mean, traced(scene, 13).power(0).mean);
  EXPECT_FALSE(whole.trace.total.receivers[0].fields.empty());
  EXPECT_NE(hash_of(traced(scene, 14)), one);  // twin
}

// What an export says is what the sums say: rows from the lower left, watts per area, the error beside it.
TEST(Receivers, ExportedMaps) {
  test::Folder const folder;
  Traced const t = traced(two_mirrors("rough"), 32);
  std::vector<std::string> const files = write_maps(folder / ".", t.content());
  EXPECT_THAT(files, ::testing::IsSupersetOf({"PD_image.csv", "PD_image.npy", "PD_image_sigma.npy", "PD_field.csv",
                                              "PD_field.npy", "PD_angles.csv", "PD_quadrants.csv", "plane_image.csv"}));
  std::string const csv = read_file(folder / "PD_image.csv");
  EXPECT_THAT(csv, ::testing::HasSubstr("from the lower left row by row"));
  EXPECT_THAT(csv, ::testing::HasSubstr("W/m^2"));
  EXPECT_THAT(csv, ::testing::HasSubstr("\n0,0,-0.0175,-0.0175,"));
  std::string const npy = read_file(folder / "PD_image.npy");
  EXPECT_EQ(npy.substr(1, 5), "NUMPY");
  EXPECT_EQ(npy.size(), 128u + 64 * 8);
  double pixel = 0;
  std::memcpy(&pixel, npy.data() + 128 + 27 * 8, 8);  // row 3, column 3: inside the beam
  double const area = 0.04 * 0.04 / 64;
  EXPECT_DOUBLE_EQ(pixel, t.result.total.receivers[0].image.sum[27] / double(t.result.total.histories) * 2 / area);
}

}  // namespace
}  // namespace straytrace::testing
