// SPDX-License-Identifier: BSD-3-Clause
// Scatter from the interfaces of a coating (docs/theory/surfaces.md, eq. 3.29 to 3.31) against one interface (eq. 3.9),
// two interfaces in closed form, and the rigid displacement of a whole stack.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/every_module.hpp"
#include "optics/coating/film.hpp"
#include "optics/scatter/roughness.hpp"

namespace straytrace::stack_factor {
namespace {

constexpr double line = 1.064e-6;  // m

RoughStack stack_of(std::vector<FilmLayer> layers, Complex behind, double correlated) {
  return {std::move(layers), behind, line, correlated};
}
std::vector<FilmLayer> mirror(int pairs) {  // (HL)^N H, quarter waves
  std::vector<FilmLayer> layers;
  for (int i = 0; i <= 2 * pairs; ++i) {
    double const n = i % 2 ? 1.45 : 2.07;
    layers.push_back({{n, 0}, line / (4 * n)});
  }
  return layers;
}
Vec3 direction(double cosine, double turn) {
  double const sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}
// phi = 0 is forward: both directions point away from the surface.
double cos_phi(Vec3 wi, Vec3 wo) {
  return -(wi.x * wo.x + wi.y * wo.y) / std::sqrt((1 - wi.z * wi.z) * (1 - wo.z * wo.z));
}

// Without layers: eq. 3.9 of glass and of metal, all azimuths. Layers of the index of the body change nothing.
TEST(StackFactor, one_interface_is_eq_3_9) {
  for (Complex const n : {Complex{1.45, 0}, Complex{3.5, 0.01}, Complex{0.25, 7}}) {
    PolarisationFactor const bare{n.re * n.re - n.im * n.im, 2 * n.re * n.im, 1};
    RoughStack const none = stack_of({}, n, 1), alike = stack_of({{n, 90e-9}}, n, 0);
    for (double const ci : {0.2, 0.7, 0.99})
      for (double const cs : {0.1, 0.5, 0.95})
        for (double const turn : {0.0, 1.0, 2.5, pi}) {
          Vec3 const wi = direction(ci, 0), wo = direction(cs, turn);
          double const expected = bare.mean(wi, wo);
          EXPECT_NEAR(none.factor(ci, cs, cos_phi(wi, wo)) / expected, 1, 1e-11);
          EXPECT_NEAR(alike.factor(ci, cs, cos_phi(wi, wo)) / expected, 1, 1e-10);
          if (turn == 1) {  // control
            EXPECT_GT(std::fabs(none.factor(ci, cs, -cos_phi(wi, wo)) / expected - 1), 1e-3);
          }
        }
  }
}

// Two interfaces near normal incidence: fields 1 + r in front and t exp(i delta)/(1 + r1 r2 exp(2 i delta)) behind
// (Airy); heights in common add in amplitude, independent ones in power.
TEST(StackFactor, two_interfaces_in_closed_form) {
  using C = std::complex<double>;
  double const n = 2.07, ns = 1.45, thickness = 170e-9;
  double const r1 = (1 - n) / (1 + n), r2 = (n - ns) / (n + ns), delta = 2 * pi * n * thickness / line;
  C const round = std::polar(1.0, 2 * delta), below = 1.0 + r1 * r2 * round;
  C const e0 = 1.0 + (r1 + r2 * round) / below, e1 = (1 + r1) * (1 + r2) * std::polar(1.0, delta) / below;
  C const g0 = (n * n - 1) * e0 * e0 / 4.0, g1 = (ns * ns - n * n) * e1 * e1 / 4.0;
  double const together = std::norm(g0 + g1), apart = std::norm(g0) + std::norm(g1);
  std::vector<FilmLayer> const layer{{{n, 0}, thickness}};
  for (double const c : {0.0, 0.4, 1.0})
    EXPECT_NEAR(stack_of(layer, {ns, 0}, c).factor(1, 1, 1) / (c * together + (1 - c) * apart), 1, 1e-12);
  EXPECT_GT(std::fabs(together / apart - 1), 0.1);  // the closed form tells them apart
}

// Heights in common displace the whole stack: in the specular direction r becomes r exp(-2 i k cos h), so Q is its
// reflectance, of any stack, absorbing ones too. Control: independent heights.
TEST(StackFactor, common_heights_scatter_like_the_displaced_stack) {
  auto layers = mirror(4);
  layers.insert(layers.begin() + 3, FilmLayer{{1.8, 0.02}, 63e-9});
  Film film;
  film.layers = {layers.data(), layers.size()};
  film.wavelength = line;
  film.opaque = {1.45, 0};
  RoughStack const whole = stack_of(layers, {1.45, 0}, 1), apart = stack_of(layers, {1.45, 0}, 0);
  for (double const c : {0.05, 0.3, 0.6, 0.9, 1.0}) {
    double const reflectance = film.computed(c, 1, 1, true).reflectance();
    EXPECT_NEAR(whole.factor(c, c, 1), reflectance, 1e-11);
    EXPECT_GT(std::fabs(apart.factor(c, c, 1) / reflectance - 1), 0.05);
  }
}

// Back-scatter of the mirror of 37 layers against an independent program with characteristic matrices in numpy: it
// grows with the incidence. Control: the forward direction.
TEST(StackFactor, back_scatter_of_a_mirror) {
  struct Row {
    double degrees, common, independent;
  };
  RoughStack const whole = stack_of(mirror(18), {1.45, 0}, 1), apart = stack_of(mirror(18), {1.45, 0}, 0);
  for (Row const& row : {Row{20, 1.305, 0.397}, Row{45, 4.528, 2.761}, Row{60, 6.710, 9.356}}) {
    double const c = std::cos(row.degrees * pi / 180);
    EXPECT_NEAR(whole.factor(c, c, -1), row.common, 6e-4);
    EXPECT_NEAR(apart.factor(c, c, -1), row.independent, 6e-4);
    EXPECT_GT(std::fabs(whole.factor(c, c, 1) - row.common), 0.1);
  }
}

// The table of a mirror of 37 layers: outside the stop band its layers resonate, within 0.01 of the cosine. Error of Q
// below 5e-3 of its largest value. Control: the table of 33 layers.
TEST(StackFactor, table) {
  Storage storage;
  RoughStack const direct = stack_of(mirror(18), {1.45, 0}, 0);
  StackFactor const table = direct.tabulated(storage), other = stack_of(mirror(16), {1.45, 0}, 0).tabulated(storage);
  double worst = 0, control = 0, most = 0;
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 40; ++k)
      for (double const turn : {0.3, 1.9}) {
        Vec3 const wi = direction((i + 0.37) / 40, 0), wo = direction((k + 0.61) / 40, turn);
        double const expected = direct.factor(wi.z, wo.z, cos_phi(wi, wo));
        most = std::fmax(most, expected);
        worst = std::fmax(worst, std::fabs(table.mean(wi, wo) - expected));
        control = std::fmax(control, std::fabs(other.mean(wi, wo) - expected));
      }
  EXPECT_LT(worst, 5e-3 * most) << table.nodes;
  EXPECT_GT(control, 5e-2 * most);
}

}  // namespace
}  // namespace straytrace::stack_factor
