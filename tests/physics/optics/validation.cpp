// SPDX-License-Identifier: BSD-3-Clause
// Reference numbers for roughness and spheres: A15, A17, A17b. Next to each a variant that must fail it.
#include <gtest/gtest.h>

#include "contract/optics/quadrature.hpp"
#include "optics/scatter/diffuse.hpp"
#include "optics/scatter/mie.hpp"
#include "optics/scatter/roughness.hpp"
#include "support/laws.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

// A15, eq. 3.10.
TEST(validation, total_scatter_a15) {
  EXPECT_LT(deviation(tis_smooth(5e-9, 1, 0.5e-6), 0.0157914), 1e-5);
  EXPECT_LT(deviation(tis_smooth(0.5e-9, 1, 1.064e-6), 3.4872e-5), 1e-5);
  EXPECT_LT(deviation(tis_smooth(0.05e-9, 1, 1.064e-6), 3.4872e-7), 1e-5);
  EXPECT_GT(deviation(tis_moderate(5e-9, 1, 0.5e-6), 0.0157914), 5e-3) << "control: the exponential form";
}

// B10, the BRDF round robin of 1989: an aluminium mirror of 0.7 nm at 632.8 nm, and a white diffuser of 0.27 /sr, on
// which laboratories differed by a factor of 2; the Lambertian of albedo 1 has 0.318 /sr.
TEST(validation, round_robin_b10) {
  EXPECT_LT(deviation(tis_smooth(0.7e-9, 1, 632.8e-9), 1.93e-4), 2e-3);
  EXPECT_GT(deviation(tis_smooth(0.7e-9, 1, 1.064e-6), 1.93e-4), 0.5) << "control: 1064 nm";
  EXPECT_NEAR(std::log2(Lambertian{1}.eval({0, 0, 1}, {0.6, 0, 0.8}) / 0.27), 0, 1);
}

// A15, eq. 3.9: index 1.45 in the specular direction at 30 deg.
TEST(validation, polarisation_factors_a15) {
  PolarisationFactor const glass{1.45 * 1.45, 0, 1};
  Vec3 const in = incoming(30);
  auto const q = glass.each(in, specular(in));
  EXPECT_LT(deviation(q.ss, 0.0494089), 1e-5);
  EXPECT_LT(deviation(q.pp, 0.0208776), 1e-5);
  auto const control = glass.each(in, incoming(30, 0.1 + 0.25));
  EXPECT_GT(deviation(control.ss, 0.0494089), 0.5) << "control: a quarter of a turn out of the plane";
}

// A15, eq. 3.7: S2 = f^-3.4 has the one-sided profile 0.678679 at f = 2, and the two-sided one is half of that.
TEST(validation, profile_of_a_surface_a15) {
  auto const surface_at_two = [](double one_sided) {
    HeightSpectrum profile;
    for (double f : {0.02, 0.2, 2.0, 20.0, 200.0}) profile.push_back({f, one_sided / 2 * std::pow(f / 2, 1 - 3.4)});
    return spectrum_at(surface_of_profile(profile), 2);
  };
  EXPECT_LT(deviation(surface_at_two(0.678679), std::pow(2, -3.4)), 1e-5);
  EXPECT_GT(deviation(surface_at_two(2 * 0.678679), std::pow(2, -3.4)), 0.5) << "control: two-sided for one-sided";
}

// A17: spheres of the classic tables. Q_back = 4 |S(180 deg)|^2/x^2.
TEST(validation, mie_a17) {
  double const x = 2 * pi * 0.525 / 0.6328;
  MieSphere const small = mie(x, 1.55, {-1}), large = mie(100, 1.5, {}), black = mie(100, {1.5, 1}, {});
  EXPECT_LT(deviation(small.q_ext, 3.10543), 1e-5);
  EXPECT_LT(deviation(4 * small.intensity[0] / (x * x), 2.92534), 1e-5);
  EXPECT_LT(deviation(large.q_ext, 2.09439), 1e-5);
  EXPECT_LT(deviation(large.asymmetry, 0.818245), 1e-5);
  EXPECT_LT(deviation(black.q_ext, 2.09750), 1e-5);
  EXPECT_LT(deviation(black.q_sca, 1.28370), 1e-5);
  EXPECT_LT(deviation(black.asymmetry, 0.850252), 1e-5);
  EXPECT_GT(deviation(mie(2 * pi * 0.525 / 0.633, 1.55, {}).q_ext, 3.10543), 1e-4) << "control: 633 nm";
}

// A17b, eq. 3.24: a million spheres of 1 um per square metre at 1064 nm; they absorb nothing.
TEST(validation, dust_layer_a17b) {
  EXPECT_LT(deviation(mie(pi * 1e-6 / 1.064e-6, 1.5, {}).q_sca, 3.39752), 1e-5);
  Dust layer;
  set_grains(layer, {{1e-6, 1e6}}, 1.064e-6, 1.5, 0, law_arrays());
  EXPECT_LT(deviation(layer.optical_depth, 2.66840e-6), 1e-5);
  Dust control;
  set_grains(control, {{1e-6, 1e6}}, 1.064e-6, 1.5, 0.01, law_arrays());
  EXPECT_GT(deviation(control.optical_depth, 2.66840e-6), 1e-3) << "control: spheres that absorb";
}

}  // namespace
}  // namespace straytrace::testing
