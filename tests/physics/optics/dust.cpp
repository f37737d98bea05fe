// SPDX-License-Identifier: BSD-3-Clause
// Dust (docs/theory/surfaces.md, eq. 3.21 to 3.24): the law and its totals against Mie sums at single angles, for all
// angles and size parameters from 0.1 to 200. Control of the tables: 512 linear steps at chords 2 (i/512)^4, which have
// no node within 14 deg of exact backscatter.
#include <gtest/gtest.h>

#include <functional>

#include "contract/optics/quadrature.hpp"
#include "optics/scatter/mie.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

constexpr double wavelength = 1.064e-6, wavenumber = 2 * pi / wavelength;
constexpr double sizes[] = {0.1, 1, 3, 10, 50, 120, 200};

Dust of_grains(std::vector<Grain> const& all, double reflectance, double index, double extinction) {
  Dust law;
  law.reflectance = reflectance;
  set_grains(law, all, wavelength, index, extinction, law_arrays());
  law.prepare();
  return law;
}
Dust one_size(double diameter, double coverage, double reflectance) {
  return of_grains({{diameter, coverage / (pi * diameter * diameter / 4)}}, reflectance, 1.5, 0.05);
}
// One grain per square metre, transparent: the sharpest interference.
Dust one_sphere(double x, double reflectance) { return of_grains({{x * wavelength / pi, 1}}, reflectance, 1.5, 0); }
std::vector<double> exact_at(double x, std::vector<double> const& cosines) {  // m^2/sr
  std::vector<double> all = mie(x, 1.5, cosines).intensity;
  for (double& v : all) v /= wavenumber * wavenumber;
  return all;
}

// Angles from 0 to 180 deg, even and crowding at both ends.
std::vector<double> angles() {
  std::vector<double> all{0, pi};
  for (int i = 0; i < 20000; ++i) all.push_back(pi * (i + 0.37) / 20000);
  for (int i = 0; i < 2000; ++i) {
    double const near = 1e-6 * std::pow(1e6, i / 2000.0);
    all.push_back(near);
    all.push_back(pi - near);
  }
  return all;
}
double half_sine_squared(double angle) {
  return angle < pi / 2 ? std::pow(std::sin(angle / 2), 2) : 1 - std::pow(std::cos(angle / 2), 2);
}

class OldNodes {
 public:
  explicit OldNodes(std::function<std::vector<double>(std::vector<double> const&)> const& exact) {
    std::vector<double> cosines;
    for (int i = 0; i <= 512; ++i) cosines.push_back(1 - 2 * std::pow(i / 512.0, 8));
    value_ = exact(cosines);
  }
  double at(double s) const {
    double const x = 512 * std::pow(s, 0.125);
    int const i = std::min(static_cast<int>(x), 511);
    return value_[std::size_t(i)] + (x - i) * (value_[std::size_t(i) + 1] - value_[std::size_t(i)]);
  }

 private:
  std::vector<double> value_;
};

// Largest relative error of a table of |S|^2/k^2 over all angles.
template <class Table>
double worst_miss(Table const& table, std::vector<double> const& at, std::vector<double> const& exact) {
  double worst = 0;
  for (std::size_t i = 0; i < at.size(); ++i)
    worst = std::fmax(worst, deviation(table.at(half_sine_squared(at[i])), exact[i]));
  return worst;
}

TEST(dust, table_is_the_mie_intensity_at_all_angles) {
  std::vector<double> const at = angles();
  std::vector<double> cosines;
  for (double angle : at) cosines.push_back(std::cos(angle));
  for (double x : sizes) {
    std::vector<double> const exact = exact_at(x, cosines);
    EXPECT_LT(worst_miss(one_sphere(x, 0).scatter, at, exact), 1e-4) << x;
    if (x < 10) continue;
    OldNodes const control([&](auto const& c) { return exact_at(x, c); });
    EXPECT_GT(worst_miss(control, at, exact), 0.5) << x;
  }
}

// eq. 3.23 for any two directions, through eval(). Control: the scattering angle of the direct path is that of the
// reflected one.
TEST(dust, law_has_the_four_paths_eq_3_23) {
  double const r = 0.4;
  for (double x : sizes) {
    Dust const law = one_sphere(x, r);
    Rng rng(6, 0, 0, Stream::source);
    double worst = 0, worst_control = 0;
    for (int i = 0; i < 3000; ++i) {
      Vec3 const wi = incoming(89 * rng.uniform(), rng.uniform()), at = i % 3 ? wi : specular(wi);
      double const size = std::pow(10, -4 * rng.uniform());
      Vec3 const off = size * incoming(90 * rng.uniform(), rng.uniform());
      Vec3 const wo = i % 3 == 2 ? incoming(89 * rng.uniform(), rng.uniform()) : unit(at + off);
      std::vector<double> const exact = exact_at(x, {-dot(wi, wo), dot(specular(wi), wo)});
      double const lit = law.lit(wi.z, wo.z);
      worst = std::fmax(worst, deviation(law.eval(wi, wo), lit * ((1 + r * r) * exact[0] + 2 * r * exact[1])));
      worst_control = std::fmax(worst_control, deviation(law.eval(wi, wo), lit * (1 + r) * (1 + r) * exact[1]));
    }
    EXPECT_LT(worst, 1e-4) << x;
    EXPECT_GT(worst_control, 0.1) << x;
  }
}

// Integral over the solid angle between two scattering angles of f at the cosines of even angles.
double over_angles(std::function<std::vector<double>(std::vector<double> const&)> const& f, double low, double high) {
  constexpr int steps = 20000;
  std::vector<double> cosines;
  for (int i = 0; i < steps; ++i) cosines.push_back(std::cos(low + (high - low) * (i + 0.5) / steps));
  std::vector<double> const values = f(cosines);
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] * std::sqrt(1 - cosines[i] * cosines[i]);
  return 2 * pi * (high - low) * sum / steps;
}
template <class Table>
auto each_of(Table const& table) {
  return [&](std::vector<double> const& cosines) {
    std::vector<double> all;
    for (double c : cosines) all.push_back(table.at((1 - c) / 2));
    return all;
  };
}

// The table keeps the power of each hemisphere, and of the sphere: Q_sca pi r^2.
TEST(dust, hemispheres_hold_what_the_spheres_scatter) {
  for (double x : sizes) {
    Dust const law = one_sphere(x, 0);
    auto const exact = [&](auto const& cosines) { return exact_at(x, cosines); };
    double const forward = over_angles(each_of(law.scatter), 0, pi / 2),
                 back = over_angles(each_of(law.scatter), pi / 2, pi), whole = over_angles(exact, pi / 2, pi);
    EXPECT_LT(deviation((forward + back) * wavenumber * wavenumber, pi * x * x * mie(x, 1.5, {}).q_sca), 1e-4) << x;
    EXPECT_LT(deviation(back, whole), 1e-4) << x;
    if (x < 10) continue;
    EXPECT_GT(deviation(over_angles(each_of(OldNodes(exact)), pi / 2, pi), whole), 0.02) << x;
  }
}

// Cleanliness levels: the sum over all sizes, within 3 deg of exact backscatter and far from it.
TEST(dust, levels_meet_their_sum_near_backscatter) {
  std::vector<double> at, cosines;
  for (int i = 0; i <= 60; ++i) at.push_back(pi - pi / 180 * 0.05 * i);
  for (double degrees : {0.0, 0.3, 3.0, 20.0, 60.0, 90.0, 135.0, 170.0}) at.push_back(degrees * pi / 180);
  for (double angle : at) cosines.push_back(std::cos(angle));
  for (double level : {100.0, 200.0, 300.0, 500.0}) {
    Cleanliness size;
    size.level = level;
    std::vector<Grain> const all = grains(size);
    auto const sum = [&](std::vector<double> const& c) {
      std::vector<double> total(c.size(), 0.0);
      for (Grain const& g : all) {
        std::vector<double> const one = exact_at(pi * g.diameter / wavelength, c);
        for (std::size_t i = 0; i < c.size(); ++i) total[i] += g.per_area * one[i];
      }
      return total;
    };
    Dust law;
    set_grains(law, all, wavelength, 1.5, 0, law_arrays());
    std::vector<double> const exact = sum(cosines);
    EXPECT_LT(worst_miss(law.scatter, at, exact), 1e-4) << level;
    EXPECT_GT(worst_miss(OldNodes(sum), at, exact), 0.3) << level;
  }
}

// eval cos over the hemisphere by brute force, in steps of cos_s that are dense at the horizon and at the normal.
double brute_albedo(Dust const& law, double degrees, int rings, int around) {
  Vec3 const wi = incoming(degrees, 0);
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    double const y = (i + 0.5) / rings, cos_s = y * y * (3 - 2 * y), sin_s = std::sqrt(1 - cos_s * cos_s);
    double ring = 0;
    for (int j = 0; j < around; ++j) {
      SinCos const a = sincos_turn(0.5 * (j + 0.5) / around);
      ring += law.eval(wi, {sin_s * a.cos, sin_s * a.sin, cos_s});
    }
    sum += ring / around * cos_s * 6 * y * (1 - y) / rings;
  }
  return 2 * pi * sum;
}
// Control: a surface that reflects 0.1 % more.
TEST(dust, albedo_is_the_integral_over_the_hemisphere) {
  for (double x : {1.0, 10.0, 50.0})
    for (double degrees : {0.0, 40.0, 85.0}) {
      Dust law = of_grains({{x * wavelength / pi, 1e-2 / (pi / 4 * std::pow(x * wavelength / pi, 2))}}, 0.7, 1.5, 0);
      double const exact = brute_albedo(law, degrees, degrees > 0 ? 1500 : 8000, degrees > 0 ? 600 : 1),
                   cosine = incoming(degrees).z;
      EXPECT_LT(deviation(law.albedo(cosine), exact), 1e-4) << x << " " << degrees;
      law.reflectance = 0.701;
      law.prepare();
      EXPECT_GT(deviation(law.albedo(cosine), exact), 1e-4) << "control: another surface";
    }
}

// eq. 3.24 through eq. 3.23: a thin layer on a perfect mirror scatters 2 n Q_sca pi r^2 at normal incidence, since the
// light meets each particle twice and all of it ends above the surface. The control has R = 0, where only the backward
// half comes back.
TEST(dust, total_scatter_of_a_thin_layer_eq_3_24) {
  double const diameter = 2e-6, coverage = 1e-7;
  MieSphere const sphere = mie(pi * diameter / wavelength, {1.5, 0.05}, {});
  EXPECT_LT(deviation(one_size(diameter, coverage, 1).albedo(1), 2 * coverage * sphere.q_sca), 1e-4);
  EXPECT_LT(one_size(diameter, coverage, 0).albedo(1), 0.2 * coverage * sphere.q_sca);
}

// Grains that absorb nothing on a perfect mirror send all light back out, which is met at grazing. Control: a mirror
// that absorbs.
TEST(dust, all_light_leaves_a_perfect_mirror_at_grazing) {
  for (double x : {3.0, 50.0}) {
    auto const worst = [&](double reflectance) {
      double const diameter = x * wavelength / pi;
      Dust const law = of_grains({{diameter, 0.01 / (pi / 4 * diameter * diameter)}}, reflectance, 1.5, 0);
      double most = 0;
      for (int i = 0; i <= 2000; ++i) most = std::fmax(most, law.albedo(std::pow(i / 2000.0, 4)));
      return most;
    };
    EXPECT_NEAR(worst(1), 1, 1e-4) << x;
    EXPECT_LT(worst(0.99), 0.9999) << x;
  }
}

// R2.32: 10 ppm of covered area take 20 ppm out of the beam. Large absorbing grains, by extinction (Q_ext -> 2).
TEST(dust, large_grains_take_twice_their_area_r2_32) {
  EXPECT_LT(deviation(one_size(400e-6, 10e-6, 0).optical_depth, 20e-6), 0.02);
  EXPECT_GT(deviation(one_size(1e-6, 10e-6, 0).optical_depth, 20e-6), 0.1);
}

}  // namespace
}  // namespace straytrace::testing
