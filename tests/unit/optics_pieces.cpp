// SPDX-License-Identifier: BSD-3-Clause
// The pieces of the scatter laws: albedo table, quantile and rings of the samplers.
#include <gtest/gtest.h>

#include "optics/law_types.hpp"

namespace straytrace {
namespace {

TEST(albedo_table, meets_its_nodes_and_clamps_its_ends) {
  AlbedoTable table;
  for (int i = 0; i < AlbedoTable::size; ++i) table.value[i] = 3 + 2 * i;
  for (int i = 0; i < AlbedoTable::size; ++i) EXPECT_NEAR(table.at(AlbedoTable::cosine(i)), 3 + 2 * i, 1e-9);
  EXPECT_EQ(table.at(-0.1), 3);
  EXPECT_EQ(table.at(1.1), 3 + 2 * (AlbedoTable::size - 1));
  EXPECT_EQ(AlbedoTable::cosine(AlbedoTable::size - 1), 1);
}

TEST(power_law, quantile_inverts_the_integral) {
  for (double n : {1.2, 2.0, 2.3986, 3.1}) {
    PowerLaw law;
    law.exponent = n;
    law.above = 1e-3;
    double last = 0;
    for (double u : {1e-9, 1e-3, 0.1, 0.5, 0.9, 0.999}) {
      double const theta = law.quantile(u);
      EXPECT_NEAR(law.integral(theta) / law.integral(pi), u, 1e-12) << n;
      EXPECT_GT(std::fabs(law.integral(1.001 * theta) / law.integral(pi) - u), 1e-12) << "a quantile 0.1 % off";
      EXPECT_GT(theta, last);
      last = theta;
    }
    EXPECT_NEAR(law.quantile(0x1p-53), law.above, 1e-15);
    EXPECT_NEAR(law.quantile(1 - 0x1p-53), pi, 1e-9);
  }
}

TEST(power_law, nothing_below_the_hand_over_angle) {
  PowerLaw law;
  law.kappa = 1e-6;
  law.above = 1e-2;
  auto const at = [](double theta) { return Vec3{std::sin(theta), 0, std::cos(theta)}; };
  EXPECT_EQ(law.eval({0, 0, 1}, at(0.00999)), 0);
  EXPECT_EQ(law.pdf({0, 0, 1}, at(0.00999)), 0);
  EXPECT_NEAR(law.eval({0, 0, 1}, at(0.02)), 1e-6 / 4e-4, 1e-15);
  EXPECT_GT(law.pdf({0, 0, 1}, at(0.01001)), 0);
}

TEST(abg, rings_cover_all_offsets) {
  Abg law;
  law.a = 0.01;
  law.b = 1e-3;
  law.prepare();
  EXPECT_EQ(law.edge[0], 0);
  EXPECT_GE(law.edge[Abg::rings], 2);
  EXPECT_EQ(law.cumulative[Abg::rings], 1);
  for (int i = 0; i < Abg::rings; ++i) {
    EXPECT_LT(law.edge[i], law.edge[i + 1]);
    EXPECT_LT(law.cumulative[i], law.cumulative[i + 1]);
    EXPECT_EQ(Abg::ring_of(law.edge[i], law.edge), i);
    EXPECT_EQ(Abg::ring_of(0.5 * (law.edge[i] + law.edge[i + 1]), law.edge), i);
  }
  EXPECT_EQ(Abg::ring_of(2, law.edge), Abg::rings - 1);
  double total = 0;
  for (int i = 0; i < Abg::rings; ++i)
    total += law.ring_density(i) * pi * (law.edge[i + 1] * law.edge[i + 1] - law.edge[i] * law.edge[i]);
  EXPECT_NEAR(total, 1, 1e-12);
}

TEST(bsdf, specular_keeps_the_height) {
  Vec3 const wi{0.3, -0.4, 0.5}, mirrored = specular(wi);
  EXPECT_EQ(mirrored.x, -0.3);
  EXPECT_EQ(mirrored.y, 0.4);
  EXPECT_EQ(mirrored.z, 0.5);
}

}  // namespace
}  // namespace straytrace
