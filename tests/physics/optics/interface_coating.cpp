// SPDX-License-Identifier: BSD-3-Clause
// Coatings tabulated against the angle (8.2, C2.6, C8.9): the steel of beam tubes, energy, and
// BSDF models that follow the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "optics/coating/coating.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/angle_weight.hpp"
#include "support/laws.hpp"

namespace straytrace::optics_interface_coating {
namespace {

Coating steel(Storage& storage) { return make_coating(coating_presets()[0].rows, true, storage); }
double reflect(Coating const& c, double degrees) {
  return c.amplitudes(std::cos(degrees * degree), 1, 1, true).reflectance();
}
double scatter(Coating const& c, double degrees) { return c.scattered(std::cos(degrees * degree)); }

// The published triple at its angles, 1e-12: A 0.60 up to 60 deg, 0.57 at 70, 0.45 at 80, 0 at 90; R 0.005, 0.11 at 80.
TEST(optics_interface_coating, steel_keeps_the_published_triple) {
  Storage storage;
  Coating const c = steel(storage);
  double const angles[] = {0, 60, 70, 80, 90}, absorbed[] = {0.60, 0.60, 0.57, 0.45, 0};
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(1 - reflect(c, angles[i]) - scatter(c, angles[i]), absorbed[i], 1e-12) << angles[i];
  EXPECT_NEAR(reflect(c, 30), 0.005, 1e-12);
  EXPECT_NEAR(scatter(c, 30), 0.395, 1e-12);
  EXPECT_NEAR(reflect(c, 80), 0.11, 1e-12);
  EXPECT_NEAR(reflect(c, 90), 1, 1e-12);
  EXPECT_NEAR(scatter(c, 90), 0, 1e-12);
}

// Energy at every angle, 1e-12. Control: the table of the original with its offset of 0.2 on S violates energy
// conservation.
TEST(optics_interface_coating, steel_makes_no_light) {
  Storage storage;
  Coating const c = steel(storage);
  std::vector<CoatingRow> rows = coating_presets()[0].rows;
  for (CoatingRow& r : rows) r.scatter += 0.2;
  Coating const offset = make_coating(rows, true, storage);
  double most = 0, most_with_offset = 0, before = 0;
  for (int i = 0; i <= 90000; ++i) {
    double const a = i * 1e-3, sum = reflect(c, a) + scatter(c, a);
    most = std::max(most, sum);
    most_with_offset = std::max(most_with_offset, reflect(offset, a) + scatter(offset, a));
    ASSERT_GE(scatter(c, a), 0);
    ASSERT_GE(reflect(c, a), before - 1e-12);  // no bumps between the entries
    before = reflect(c, a);
  }
  EXPECT_LE(most, 1 + 1e-12);
  EXPECT_GT(most_with_offset, 1.19);
}

// A path along a tube at 0.4 mrad grazing, 89.977 deg: 1 - R and S are those of 89 deg (0.1 and 0.08) scaled by the
// cosine, 5 %, and halve with the angle, 2 %. Control: rounded to whole degrees the path sees R = 1 and S = 0.
TEST(optics_interface_coating, steel_at_grazing) {
  Storage storage;
  Coating const c = steel(storage);
  double const at = 90 - 0.4e-3 / degree, scale = std::sin(0.4e-3) / std::cos(89 * degree);
  EXPECT_NEAR((1 - reflect(c, at)) / (0.1 * scale), 1, 0.05);
  EXPECT_NEAR(scatter(c, at) / (0.08 * scale), 1, 0.05);
  EXPECT_NEAR((1 - reflect(c, 90 - 0.2e-3 / degree)) / (1 - reflect(c, at)), 0.5, 0.02);
  double const rounded = std::round(at);
  EXPECT_FALSE(std::fabs((1 - reflect(c, rounded)) / (0.1 * scale) - 1) < 0.05);
  EXPECT_FALSE(std::fabs(scatter(c, rounded) / (0.08 * scale) - 1) < 0.05);
}

// Relations between columns at the entries hold everywhere: here R_p = 1 - T_p and R_s = 2 R_p, 1e-14; and values
// stay between entries. Control: linear interpolation in the angle.
TEST(optics_interface_coating, relations_between_columns) {
  std::vector<CoatingRow> rows;
  for (double a : {0.0, 20.0, 45.0, 60.0, 75.0, 90.0}) {
    double const p = 0.5 * std::pow(a / 90, 3);
    rows.push_back({a * degree, 2 * p, p, 1 - 2 * p, 1 - p, 0});
  }
  Storage storage;
  Coating const c = make_coating(rows, false, storage);
  double kink = 0, linear_kink = 0;
  auto const linear = [&](double a) {
    std::size_t k = 1;
    while (rows[k].angle < a) ++k;
    double const x = (a - rows[k - 1].angle) / (rows[k].angle - rows[k - 1].angle);
    return rows[k - 1].reflect_p + x * (rows[k].reflect_p - rows[k - 1].reflect_p);
  };
  auto const at = [&](double a) { return norm(c.amplitudes(std::cos(a), 1, 1, true).rp); };
  for (int i = 1; i < 900; ++i) {
    double const a = i * 0.1 * degree, h = 1e-3 * degree;
    Amplitudes const v = c.amplitudes(std::cos(a), 1, 1, true);
    ASSERT_NEAR(norm(v.rp) + norm(v.tp), 1, 1e-14);
    ASSERT_NEAR(norm(v.rs), 2 * norm(v.rp), 1e-14);
    kink = std::max(kink, std::fabs(at(a + h) - 2 * at(a) + at(a - h)) / h);
    if (i < 899) linear_kink = std::max(linear_kink, std::fabs(linear(a + h) - 2 * linear(a) + linear(a - h)) / h);
  }
  EXPECT_LT(kink, 0.01);
  EXPECT_GT(linear_kink, 0.1);
  EXPECT_EQ(c.scattered(0.5), -1);
  // beyond the critical angle what the table transmits is reflected
  EXPECT_NEAR(c.amplitudes(0.5, 1.45, 1, true).reflectance(), 1, 1e-14);
  EXPECT_EQ(c.amplitudes(0.5, 1.45, 1, true).transmittance(), 0);
}

// A BSDF model weighted by the table scatters the share of the table, and stays reciprocal: total by quadrature, 2e-3
// of the largest share, for a Lambertian and for a lobe. Control: without the weight.
TEST(optics_interface_coating, laws_follow_the_table) {
  Storage storage;
  Coating const c = steel(storage);
  std::vector<Lambertian> flat{Lambertian{1}};
  std::vector<PowerLaw> lobe{testing::power_law(1e-3, 1.2, 0.05)};
  LawPool laws;
  std::get<0>(laws.arrays) = {flat.data(), 1};
  std::get<1>(laws.arrays) = {lobe.data(), 1};
  for (std::uint32_t kind : {0u, 1u}) {
    Optic optic;
    optic.laws = 1;
    optic.law[0] = {kind, 0};
    AngleWeight const weight = weight_for_share(laws, optic.law[0], [&](double cosine) { return c.scattered(cosine); });
    Optic plain = optic;
    optic.weight[0] = {&weight, 1};
    double worst = 0, without = 0;
    for (double a : {0.0, 45.0, 75.0, 85.0, 88.0, 89.5}) {
      double const cosine = std::cos(a * degree), wanted = c.scattered(cosine);
      Vec3 const wi{std::sin(a * degree), 0, cosine};
      double sum = 0;
      constexpr int n = 300, m = 64;
      for (int i = 0; i < n * m; ++i) {
        double const u = (i % n + 0.5) / n, v = (i / n + 0.5) / m;
        BsdfSample const s = laws.visit(optic.law[0], [&](auto const& l) { return l.sample(wi, u, v); });
        if (s.pdf > 0) sum += scatter_eval(laws, optic, wi, s.wo) * s.wo.z / s.pdf / (n * m);
      }
      EXPECT_NEAR(scatter_albedo(laws, optic, cosine), wanted, 2e-3) << kind << " " << a;
      worst = std::max(worst, std::fabs(sum - wanted));
      without = std::max(without, std::fabs(scatter_albedo(laws, plain, cosine) - wanted));
      Vec3 const wo{0.1, -0.5, std::sqrt(1 - 0.26)};
      EXPECT_NEAR(scatter_eval(laws, optic, wi, wo) / scatter_eval(laws, optic, wo, wi), 1, 1e-12);
    }
    EXPECT_LT(worst, 2e-3) << kind;
    EXPECT_GT(without, 0.1) << kind;
  }
}

}  // namespace
}  // namespace straytrace::optics_interface_coating
