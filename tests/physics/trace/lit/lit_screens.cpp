// SPDX-License-Identifier: BSD-3-Clause
// A screen around the hole that a followed beam passes: light that it scatters back into the beam
// (docs/theory/path_integral.md, eq. 1.4, 5.5).
#include "scene/scene.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_lit_screens {
namespace {

constexpr double lambda = 1.064e-6, w = 5e-3, brdf = 1e-3;

World world_of(std::string const& hole, std::string const& at = "0 m") {
  FileTexts const texts{
      {"a.yaml",
       "straytrace: 1\nmaterials: {white: {scatter: {model: lambertian, brdf: 1e-3 /sr}}, black: {}}\n"
       "bodies: {b: {motion: still}}\nscene:\n"
       "  - {name: screen, shape: {disk: {inner_radius: " +
           hole + ", outer_radius: 10 cm}}, at: [" + at +
           ", 0 m, 1 m], facing: [0, 0, -1], body: b, material: white}\n"
           "  - {name: end, shape: {disk: {outer_radius: 10 cm}}, at: [0 m, 0 m, 2 m], facing: [0, 0, -1],"
           " body: b, material: black}\n"
           "beams: {in: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 5 mm, lit: yes}}\n"
           "ports: {back: {beam: in, at: screen}}\n"}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

// f_r = beta lambda^2 times the integral of |u|^4 outside of the hole, e^(-4 a^2/w^2)/(pi w^2). Controls: the power
// that the screen takes in place of it, and the whole spot.
TEST(LitScreens, scatter_back_into_the_beam) {
  double const there = w * std::sqrt(1 + std::pow(lambda / (pi * w * w), 2)), a = 6e-3;
  double const whole = brdf * lambda * lambda / (pi * there * there), edge = std::exp(-2 * a * a / (there * there));
  SampleMean const s = total_coupling(run_histories(world_of("6 mm"), 1 << 19));
  expect_mean("outside of the hole", s, whole * edge * edge, 2e-2 * whole * edge * edge);
  expect_rejected("the share of the power", s, whole * edge);
  expect_rejected("the whole spot", s, whole);
}
// Off the beam by 4 mm, by a sum over the plane.
TEST(LitScreens, of_a_hole_off_the_beam) {
  double const there = w * std::sqrt(1 + std::pow(lambda / (pi * w * w), 2)), a = 7e-3;
  double sum = 0, centred = 0;
  int const n = 2000;
  double const step = 8 * w / n, u4 = std::pow(2 / (pi * there * there), 2);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      double const x = -4 * w + (i + 0.5) * step, y = -4 * w + (k + 0.5) * step;
      double const value = u4 * std::exp(-4 * (x * x + y * y) / (there * there)) * step * step;
      if (std::hypot(x - 4e-3, y) > a) sum += value;
      if (std::hypot(x, y) > a) centred += value;
    }
  double const expected = brdf * lambda * lambda * sum;
  SampleMean const s = total_coupling(run_histories(world_of("7 mm", "4 mm"), 1 << 20));
  expect_mean("off the beam", s, expected, 2e-2 * expected);
  expect_rejected("centred", s, brdf * lambda * lambda * centred);
}

}  // namespace
}  // namespace straytrace::testing::trace_lit_screens
