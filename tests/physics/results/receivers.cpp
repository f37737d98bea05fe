// SPDX-License-Identifier: BSD-3-Clause
// Light in watts: enclosures, energy balance, census, files (R2.24).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "physics/results/receiver_support.hpp"
#include "support/statistics.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::testing {
namespace {

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

// R3.28: the count on a full enclosure is the light launched; analog to rounding, with connections within errors.
TEST(Receivers, AFullEnclosureCountsAllLight) {
  std::string const ball =
      "scene:\n  - {name: ball, shape: {sphere: {radius: 1 m}}, body: b, material: black}\n"
      "beams: {b: {from: [10 cm, 0 m, 0 m], facing: [1, 1, 1], profile: even, radius: 1 cm, wavefront_curvature: 50 "
      "/m}}\n"
      "receivers: {all: {on: ball, side: ";
  Traced const walk = traced(ball + "back}}\n", 4);
  EXPECT_NEAR(walk.power(0).mean / walk.emitted(), 1, 1e-12);
  EXPECT_EQ(traced(ball + "front}}\n", 4).power(0).scored, 0u);  // control: the other side sees nothing

  Traced const lamp = traced(can(), 64);
  double variance = 0;
  for (Estimate const& e : lamp.result.coupling.received_power)
    if (e.scored > 0) variance += e.std_error * e.std_error;
  // Sums of errors: those of the parts of one whole partly cancel, so the bound is generous.
  SampleMean const sum{lamp.all_received() / lamp.emitted(), std::sqrt(variance) / lamp.emitted(),
                       (long long)lamp.result.total.histories};
  expect_mean("can", sum, 1, 0.02);
  Traced const open = traced(can(false), 64);  // control: a receiver is missing
  expect_rejected("open can", {open.all_received() / open.emitted(), sum.std_error, sum.n}, 1);
}

// R2.24: the terms of the energy balance of all light sum to what was emitted, to 1e-12.
TEST(Receivers, EnergyBalanceCloses) {
  Traced const t = traced(can(), 32);
  double balance_terms = 0;
  for (Moments const& m : t.result.total.energy_balance) balance_terms += m.sum;
  EXPECT_NEAR(balance_terms / t.result.total.emitted.sum, 1, 1e-12);
  double const without = balance_terms - t.result.total.energy_balance[int(BalanceTerm::absorbed)].sum;
  EXPECT_GT(std::fabs(without / t.result.total.emitted.sum - 1), 0.1);  // negative control
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
  // Control: mirrors that scatter too have more than one.
  EXPECT_GT(receiver_table(traced(two_mirrors("rough"), 32).content()).receivers.at(0).routes.size(), 1u);
  std::string const text = receiver_text(table, 10);
  EXPECT_THAT(text, ::testing::HasSubstr("1.96"));  // W
  EXPECT_THAT(text, ::testing::HasSubstr("lower left"));
  EXPECT_THAT(census_text(table, 10), ::testing::HasSubstr("M2"));
}

// R3.32 and docs/develop/architecture.md: bits do not depend on threads, nor on stopping, writing, reading and
// resuming.
TEST(Receivers, TheSameBitsInAnyOrder) {
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
  EXPECT_EQ(whole.about.map_areas, traced(scene, 13).content().map_areas);
  EXPECT_EQ(whole.trace.coupling.received_power[0].mean, traced(scene, 13).power(0).mean);
  EXPECT_FALSE(whole.trace.total.receivers[0].fields.empty());
  EXPECT_NE(hash_of(traced(scene, 14)), one);  // negative control
}

// Uniform light on a disc, 1/(pi R^2) per watt, whichever part of a pixel or cell the rim leaves. Control: over the
// whole area.
TEST(Receivers, CellsCutByTheRimHaveTheIrradianceOfTheOthers) {
  Traced const t = traced(
      "scene:\n  - {name: det, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: b, "
      "material: black}\n"
      "beams: {light: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], profile: even, radius: 6 cm}}\n"
      "receivers: {pixels: {on: det, map: {pixels: [9, 9], width: 10.2 cm}}, cells: {on: det, map: {width: 10.2 "
      "cm}}}\n",
      64);
  double const uniform = 1 / (pi * 0.06 * 0.06), rim = 0.01;  // filled_share is good to 0.5 %
  std::vector<std::vector<double>> const areas = t.content().map_areas;
  for (std::size_t i = 0; i < 2; ++i) {
    Receiver const r = t.content().receivers[i];
    CellEstimates const light =
        cell_estimates(t.result.total.receivers[i].image, t.result.total.histories, t.result.total.blocks);
    double power = 0, within = 0;
    int cut = 0, rejected = 0;
    for (std::size_t k = 0; k < r.map_size(); ++k) {
      if (!std::isfinite(light.mean[k]) || !std::isfinite(light.error[k])) continue;
      power += light.mean[k];
      within += areas[i][k];
      double const share = areas[i][k] / r.area(k), allowed = 5 * light.error[k] + rim * r.area(k) * uniform;
      if (share < 0.1 || share > 0.8) continue;
      ++cut;
      EXPECT_NEAR(light.mean[k], uniform * areas[i][k], allowed);
      rejected += std::fabs(light.mean[k] - uniform * r.area(k)) > allowed;
    }
    EXPECT_GT(cut, 10);
    EXPECT_GT(rejected, cut / 2);
    EXPECT_NEAR(power / t.power(i).mean, 1, 1e-9);
    EXPECT_NEAR(within / (pi * 0.05 * 0.05), 1, 0.01);
  }
}

// Exports agree with the sums: rows from the lower left, watts per area, followed by the error.
TEST(Receivers, ExportedMaps) {
  test::Folder const folder;
  Traced const t = traced(two_mirrors("rough"), 32);
  std::vector<std::string> const files = write_maps(folder / ".", t.content(), t.content().map_areas);
  EXPECT_THAT(files, ::testing::IsSupersetOf({"PD_image.csv", "PD_image.npy", "PD_image_sigma.npy", "PD_field.csv",
                                              "PD_field.npy", "PD_angles.csv", "PD_quadrants.csv", "plane_image.csv"}));
  std::string const csv = read_file(folder / "PD_image.csv");
  EXPECT_THAT(csv, ::testing::HasSubstr("from the lower left row by row"));
  EXPECT_THAT(csv, ::testing::HasSubstr("W/m^2 of the area within the rim"));
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
