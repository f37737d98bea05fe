// SPDX-License-Identifier: BSD-3-Clause
// Fits and audit of measured scatter against the closed forms of docs/theory/surfaces.md, on points made from them.
#include "world/scatter_data/scatter_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::world_scatter_fit {
namespace {

using Bsdf = std::function<double(double offset, double cos_i, double cos_s)>;

// A normal deviate, the same for the same number.
double deviate(std::uint64_t n) {
  double u = 0, v = 0;
  std::uint64_t x = n * 0x9E3779B97F4A7C15u + 1;
  auto const next = [&] {
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    return (double(x >> 11) + 0.5) / 9007199254740992.0;
  };
  for (int i = 0; i < 5; ++i) u = next();
  v = next();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v);
}

// Scans in the plane of incidence at 5, 30 and 55 deg, from 0.02 to 30 deg on both sides of the specular direction.
ScatterFile scans(Bsdf const& bsdf, double relative_error = 0, double floor = 0) {
  ScatterFile file;
  file.format = "laboratory CSV";
  file.declared.wavelength = 1064e-9;
  file.declared.noise_floor = floor;
  double const degree = pi / 180;
  std::uint64_t n = 0;
  for (double const theta_i : {5.0, 30.0, 55.0})
    for (double away = 0.02; away < 31; away *= 1.2)
      for (double const side : {-1.0, 1.0}) {
        ScatterPoint p = scatter_point(theta_i * degree, (theta_i + side * away) * degree, 0, 0);
        p.value = bsdf(p.offset, std::cos(p.theta_i), std::cos(p.theta_s));
        p.value *= std::exp(relative_error * deviate(++n));
        p.error = relative_error * p.value;
        p.limit = p.value <= floor;
        if (p.limit) p.value = floor;
        file.points.push_back(p);
      }
  return file;
}

ScatterFit const& fit_named(std::vector<ScatterFit> const& fits, std::string const& model) {
  for (ScatterFit const& f : fits)
    if (f.model == model) return f;
  throw std::logic_error(model);
}

Bsdf const harvey = [](double x, double, double) { return 0.4 * std::pow(1 + x * x / (0.004 * 0.004), -1.6 / 2); };
Bsdf const abg = [](double x, double, double) { return 2e-4 / (3e-5 + std::pow(x, 1.9)); };
// a = 2e-31 m^4, b = 0.15 mm, c = 1.3: eq. 3.13 through eq. 3.8 at 1064 nm.
Bsdf const knee = [](double x, double cos_i, double cos_s) {
  return 16 * pi * pi / std::pow(1064e-9, 4) * cos_i * cos_s * 2e-31 /
         std::pow(1 + std::pow(0.15e-3 * x / 1064e-9, 2), 1.15);
};

// Without noise the parameters come back to the accuracy of the search; a law of another kind leaves residuals.
TEST(ScatterFit, GivesBackTheLaw) {
  struct Case {
    Bsdf law;
    char const* model;
    double value[3];
  };
  for (Case const& c : {Case{abg, "abg", {2e-4, 3e-5, 1.9}}, Case{harvey, "harvey", {0.4, 0.004, -1.6}},
                        Case{knee, "k-correlation", {2e-31, 0.15e-3, 1.3}}}) {
    auto const fits = fit_scatter(scans(c.law), "made up");
    ScatterFit const& fit = fit_named(fits, c.model);
    ASSERT_EQ(fit.why, "");
    EXPECT_EQ(fit.parameters.size(), 3u) << "no floor is there";
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(fit.parameters[std::size_t(i)].value / c.value[i], 1, 1e-4) << c.model << ' ' << i;
    EXPECT_LT(fit.rms, 1e-5);
    for (ScatterFit const& other : fits)  // controls: the other two laws
      if (other.model != c.model && other.why.empty()) {
        EXPECT_GT(other.rms, 1e-3) << c.model << " as " << other.model;
      }
  }
}

// The errors are those of the parameters: pulls of order one, and a wrong true value is rejected.
TEST(ScatterFit, ErrorsCoverTheTrueValue) {
  ScatterFit const fit = fit_named(fit_scatter(scans(harvey, 0.1), "made up"), "harvey");
  double const truth[] = {0.4, 0.004, -1.6};
  for (std::size_t i = 0; i < 3; ++i) {
    double const pull = (fit.parameters[i].value - truth[i]) / fit.parameters[i].error;
    EXPECT_LT(std::fabs(pull), 5) << fit.parameters[i].name;
  }
  EXPECT_NEAR(fit.chi2 / double(fit.freedom), 1, 5 * std::sqrt(2.0 / double(fit.freedom)));
  EXPECT_GT(std::fabs(fit.parameters[2].value + 1.7) / fit.parameters[2].error, 5);  // control: s = -1.7
}

// A constant floor (eq. 3.18) is found; one glint of a factor 50 does not move the law.
TEST(ScatterFit, FloorAndGlint) {
  ScatterFile file = scans([](double x, double c, double s) { return harvey(x, c, s) + 3e-4; }, 0.05);
  file.points[40].value *= 50;
  file.points[40].error *= 50;
  ScatterFit const fit = fit_named(fit_scatter(file, "made up"), "harvey");
  ASSERT_EQ(fit.parameters.size(), 4u);
  EXPECT_NEAR(fit.parameters[3].value, 3e-4, 5 * fit.parameters[3].error);
  EXPECT_LT(fit.parameters[3].error, 1e-4);
  EXPECT_NEAR(fit.parameters[2].value, -1.6, 5 * fit.parameters[2].error);
  EXPECT_GE(fit.outliers, 1u);
  EXPECT_NE(fit.yaml.find("model: lambertian, brdf: "), std::string::npos);
}

// Points at the noise floor bound the law from above. Control: taken as measurements they bend it up.
TEST(ScatterFit, UpperLimits) {
  ScatterFile file = scans(harvey, 0.05, 1e-2);
  auto const limits = std::count_if(file.points.begin(), file.points.end(), [](auto const& p) { return p.limit; });
  ASSERT_GT(limits, 30);
  ScatterFit const fit = fit_named(fit_scatter(file, "made up"), "harvey");
  EXPECT_EQ(fit.parameters.size(), 3u);
  EXPECT_NEAR(fit.parameters[2].value, -1.6, 5 * fit.parameters[2].error);
  for (ScatterPoint& p : file.points) p.limit = false;
  ScatterFit const bent = fit_named(fit_scatter(file, "made up"), "harvey");
  EXPECT_GT(bent.parameters.size() > 3 ? 1.0 : std::fabs(bent.parameters[2].value + 1.6), 0.1);
}

// Eq. 3.15 and 3.17 at normal incidence.
TEST(ScatterFit, TotalOfTheFit) {
  double const l = 0.004, s = -1.6, square = l * l;
  double const expected =
      2 * pi * 0.4 / (std::pow(l, s) * (s + 2)) * (std::pow(1 + square, (s + 2) / 2) - std::pow(l, s + 2));
  EXPECT_NEAR(fit_named(fit_scatter(scans(harvey), "made up"), "harvey").tis / expected, 1, 1e-3);
}

// Total of an incidence: a Lambertian surface scatters pi b at any of them; the share beyond the points is known too.
TEST(ScatterAudit, Totals) {
  ScatterFile const file = scans([](double, double, double) { return 0.1; });
  for (IncidenceAudit const& i : audit_scatter(file, "constant").incidences) {
    EXPECT_NEAR(i.tis, 0.1 * pi, 1e-3 * pi * 0.1);
    EXPECT_LT(i.sampling, 1e-9);
  }
  auto const dark = audit_scatter(file, "zero").incidences;
  EXPECT_NEAR(dark[0].tis / (pi * 0.1), std::pow(dark[0].farthest, 2), 0.02);  // 5 deg: rings hardly cut by the horizon
  EXPECT_LT(dark[0].outside, 1e-3 * dark[0].tis);
  auto const bright = audit_scatter(file, "constant").incidences[0];
  EXPECT_NEAR(bright.outside + dark[0].tis - bright.inside, bright.tis, 0.01 * bright.tis);
}

// A reciprocal law passes; values times the cosine of scatter, a common mistake, do not.
TEST(ScatterAudit, Reciprocity) {
  auto const full = [](Bsdf const& bsdf) {
    ScatterFile file;
    for (double const theta_i : {10.0, 50.0})
      for (int t = -80; t <= 80; t += 2) {
        ScatterPoint p = scatter_point(theta_i * pi / 180, t * pi / 180, 0, 0);
        p.value = bsdf(p.offset, std::cos(p.theta_i), std::cos(p.theta_s));
        file.points.push_back(p);
      }
    return audit_scatter(file, "constant");
  };
  ScatterAudit const good = full(harvey);
  EXPECT_EQ(good.pairs, 2u);
  EXPECT_LT(good.worst_reciprocity, 1e-6);
  ScatterAudit const bad = full([](double x, double c, double s) { return harvey(x, c, s) * s; });
  EXPECT_NEAR(bad.worst_reciprocity, std::log(std::cos(10 * pi / 180) / std::cos(50 * pi / 180)), 1e-6);
}

TEST(ScatterAudit, OrderAndDuplicates) {
  ScatterFile file = scans(harvey);
  file.points.clear();
  for (double const t : {10.0, 12.0, 11.0, 14.0, 14.0, 20.0})
    file.points.push_back(scatter_point(0.1, t * pi / 180, 0, 1e-3));
  ScatterAudit const a = audit_scatter(file, "constant");
  EXPECT_EQ(a.turns, 2u);
  EXPECT_EQ(a.duplicates, 1u);
}

}  // namespace
}  // namespace straytrace::testing::world_scatter_fit
