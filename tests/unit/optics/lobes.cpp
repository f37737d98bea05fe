// SPDX-License-Identifier: BSD-3-Clause
// The pieces of the BSDF models: albedo table, rings about the specular direction, spectra and curves they hold.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"

namespace straytrace::testing {
namespace {

TEST(albedo_table, meets_its_nodes_and_clamps_its_ends) {
  AlbedoTable table;
  for (int i = 0; i < AlbedoTable::size; ++i) table.value[i] = 3 + 2 * i;
  for (int i = 0; i < AlbedoTable::size; ++i) EXPECT_NEAR(table.at(AlbedoTable::cosine(i)), 3 + 2 * i, 1e-9);
  EXPECT_EQ(table.at(-0.1), 3);
  EXPECT_EQ(table.at(1.1), 3 + 2 * (AlbedoTable::size - 1));
  EXPECT_EQ(AlbedoTable::cosine(AlbedoTable::size - 1), 1);
}

// Narrow steep lobes fall off in proportion to the cosine down to grazing: linear between the nodes is exact there.
TEST(albedo_table, is_exact_for_what_falls_as_the_cosine) {
  AlbedoTable table;
  for (int i = 0; i < AlbedoTable::size; ++i) table.value[i] = AlbedoTable::cosine(i);
  for (double c : {1e-7, 3e-5, 1e-3, 0.0078, 0.3}) EXPECT_NEAR(table.at(c) / c, 1, 1e-12);
  PowerLaw const steep = power_law(1e-9, 3.5, 5e-4);
  for (double c : {2e-3, 5e-3, 1.0 / 128})
    EXPECT_NEAR(steep.albedo(c) / albedo_by_cones(steep, {std::sqrt(1 - c * c), 0, c}), 1, 5e-3) << c;
}

// Sound rows, and each square of a radius in its ring: at the edges and one step to either side of them, since value,
// density and sample find the ring from the bits of the square alone.
template <class Rings>
void expect_sound(LobeTable<Rings> const& lobe) {
  using Table = LobeTable<Rings>;
  ASSERT_GE(lobe.rings, 30);
  ASSERT_LE(lobe.rings, Table::most_rings);
  EXPECT_GE(lobe.edge2[lobe.rings], 4);
  for (int i = 0; i < lobe.rings; ++i) {
    EXPECT_EQ(lobe.ring_of(lobe.edge2[i]), i);
    EXPECT_EQ(lobe.ring_of(std::nextafter(lobe.edge2[i], 5)), i);
    EXPECT_EQ(lobe.ring_of(std::nextafter(lobe.edge2[i + 1], 0)), i);
  }
  for (int row = 0; row < Table::rows; ++row) {
    EXPECT_EQ(lobe.cumulative[row][0], 0);
    EXPECT_EQ(lobe.cumulative[row][lobe.rings], 1);
    EXPECT_EQ(Table::row_of(Table::row_cosine(row)), row);
    for (int i = 0; i < lobe.rings; ++i) {
      EXPECT_LT(lobe.edge2[i], lobe.edge2[i + 1]);
      EXPECT_LE(lobe.cumulative[row][i], lobe.cumulative[row][i + 1]);
      double const least = lobe.cumulative[row][i], next = lobe.cumulative[row][i + 1];
      if (least < next) {
        EXPECT_EQ(lobe.drawn_ring(0.5 * (least + next), lobe.cumulative[row]), i);
      }
    }
  }
  EXPECT_EQ(Table::row_of(1), 0);
  EXPECT_EQ(Table::row_of(0), Table::rows - 1);
}

TEST(lobe_table, rings_and_rows) {
  expect_sound(abg(0.01, 1e-3, 2).lobe);
  expect_sound(power_law(1e-6, 2, 1e-2).lobe);
  expect_sound(power_law(1e-6, 2, 1e-5).lobe);
  expect_sound(abg(0.01, 1e-18, 2).lobe);
  expect_sound(instances<Dust>().front().lobe);
}

// A point of a ring has the ring's radius, and its arc ends where it meets the horizon. Control: an arc 1 % wider dips
// below.
template <class Rings>
void expect_arcs() {
  for (double degrees : {10.0, 45.0, 80.0}) {
    Vec3 const wi = incoming(degrees);
    for (double r : {0.3, 0.9, 1.2}) {
      double const half = Rings::arc(wi, r * r).half;
      if (!(half > 0 && half < 3.1)) continue;
      Vec3 const edge = Rings::direction(wi, r, sincos_turn(0.5 + half * (1 - 1e-9) / (2 * pi)));
      EXPECT_NEAR(Rings::square(wi, edge), r * r, 1e-12);
      EXPECT_NEAR(length(edge), 1, 1e-12);
      EXPECT_NEAR(edge.z, 0, 1e-3);
      EXPECT_GT(Rings::direction(wi, r, sincos_turn(0.5 + half * 0.9 / (2 * pi))).z, 0.01);
      EXPECT_LE(Rings::direction(wi, r, sincos_turn(0.5 + half * 1.01 / (2 * pi))).z, 0);
    }
  }
}
TEST(lobe_table, arcs_end_at_the_horizon) {
  expect_arcs<OffsetRings>();
  expect_arcs<ChordRings>();
}

TEST(half_power, products_and_roots_are_the_power) {
  for (double n : {-4.0, -3.0, -2.5, -2.0, -1.0, 0.7, 1.0, 2.0, 3.0, 4.0})
    for (double square : {1e-12, 0.3, 7.0})
      EXPECT_NEAR(half_power(square, n) / std::pow(square, n / 2), 1, 1e-14) << n << ' ' << square;
}

TEST(power_law, zero_below_the_minimum_scatter_angle) {
  PowerLaw const law = power_law(1e-6, 2, 1e-2);
  auto const at = [](double theta) { return Vec3{std::sin(theta), 0, std::cos(theta)}; };
  EXPECT_EQ(law.eval({0, 0, 1}, at(0.00999)), 0);
  EXPECT_EQ(law.pdf({0, 0, 1}, at(0.00999)), 0);
  EXPECT_NEAR(law.eval({0, 0, 1}, at(0.02)), 1e-6 / 4e-4, 1e-15);
  EXPECT_GT(law.pdf({0, 0, 1}, at(0.01001)), 0);
}

TEST(roughness, table_meets_its_points_and_its_ends) {
  Roughness const power = tabulated(Theory::rayleigh_rice, 1e-6, 2.1, 1e-3, 0.9, false),
                  cut = tabulated(Theory::rayleigh_rice, 1e-6, 2.1, 1e-3, 0.9, true);
  for (double rho : {1e-3, 0.02, 0.5, 0.9, 1.7})
    EXPECT_NEAR(power.spectrum(rho) / (1e-6 * std::pow(rho, -2.1)), 1, 1e-9) << rho;
  EXPECT_EQ(power.spectrum(1e-5), power.spectrum(1e-3));
  EXPECT_EQ(cut.spectrum(0.91), 0);
  EXPECT_GT(cut.spectrum(0.89), 0);
}

// A rougher surface sends part of the light out in higher orders: they add up to 1 - exp(-g) - g exp(-g).
TEST(roughness, higher_orders_complete_the_exponential) {
  Roughness const law = k_correlation(Theory::harvey_shack, 0.08, 200, 3.5);
  double const g = 4 * law.phase_variance;
  double sum = 0;
  for (int i = 0; i < 4000; ++i) {
    double const rho = 1e-5 * std::pow(2e5, (i + 0.5) / 4000);
    sum += 2 * pi * rho * rho * law.higher_orders(rho, g) * std::log(2e5) / 4000;
  }
  EXPECT_NEAR(sum / (std::expm1(g) - g), 1, 0.02);
  EXPECT_GT(std::fabs(sum / (std::expm1(g) - g - g * g / 2) - 1), 0.1);
}

std::vector<MeasuredPoint> line(double sine, double value, double slope) {
  std::vector<MeasuredPoint> points;
  for (double offset : {0.01, 0.02, 0.05, 0.1, 0.2}) points.push_back({sine, offset, value * std::pow(offset, slope)});
  return points;
}

TEST(measured, extrapolates_as_requested) {
  for (auto [rule, expected] :
       {std::pair{Beyond::constant, std::pow(0.2, -1.5)}, {Beyond::power, std::pow(0.8, -1.5)}, {Beyond::zero, 0.0}}) {
    Measured law;
    fit_measured(law, line(0, 1e-3, -1.5), rule);
    EXPECT_NEAR(law.one_way(0, 0.8), 1e-3 * expected, 1e-3 * expected * 1e-6 + 1e-30);
    EXPECT_NEAR(law.one_way(0, 0.05) / (1e-3 * std::pow(0.05, -1.5)), 1, 1e-3);
    EXPECT_NEAR(law.one_way(0, 0.001), rule == Beyond::zero ? 0 : 1e-3 * std::pow(0.01, -1.5), 1e-9);
  }
}

TEST(measured, reports_joined_and_corrected_points) {
  auto points = line(0, 1e-3, -1.5), other = line(0.1, 2e-3, -1.5);
  points.insert(points.end(), other.begin(), other.end());
  points.push_back({0, 0.05, 4e-3 * std::pow(0.05, -1.5)});
  Measured law;
  MeasuredSummary const s = fit_measured(law, points, Beyond::constant);
  EXPECT_EQ(law.incidences, 2);
  EXPECT_NEAR(s.spread, 4, 1e-9);
  EXPECT_NEAR(s.asymmetry, 2, 0.1);
  EXPECT_NEAR(law.one_way(0, 0.05) / (2e-3 * std::pow(0.05, -1.5)), 1, 0.01);  // geometric mean
  EXPECT_NEAR(law.one_way(0.05, 0.02) / std::sqrt(law.one_way(0, 0.02) * law.one_way(0.1, 0.02)), 1, 1e-9);
}

TEST(bsdf, specular_keeps_the_height) {
  Vec3 const wi{0.3, -0.4, 0.5}, mirrored = specular(wi);
  EXPECT_EQ(mirrored.x, -0.3);
  EXPECT_EQ(mirrored.y, 0.4);
  EXPECT_EQ(mirrored.z, 0.5);
}

}  // namespace
}  // namespace straytrace::testing
