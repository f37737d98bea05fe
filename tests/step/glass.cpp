// SPDX-License-Identifier: BSD-3-Clause
// One part of a STEP file filled with glass: a lens refracts, its holder does not.
#include <complex>
#include <unistd.h>

#include "scene/scene.hpp"
#include "step/support.hpp"
#include "world/model/world.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

constexpr double lambda = 1064e-9, w0 = 3e-3, start = 0.1, screen = 0.25;  // m; start: before the middle of the lens

// Behind two surfaces of curvature 1/R in glass of index n, t thick, a Gaussian beam has at the screen the radius that
// follows from its complex parameter: q grows by the distance, and n'/q' = n/q - (n' - n)/R at a surface.
double radius_exact(double n) {
  constexpr double R = 0.25, t = 9e-3;
  std::complex<double> q(start - t / 2, pi * w0 * w0 / lambda);
  q = n / (1.0 / q - (n - 1) / R);
  q += t;
  q = 1.0 / (n / q - (1 - n) / -R);
  q += screen - t / 2;
  return std::sqrt(-lambda / (pi * std::imag(1.0 / q)));
}

Built lens(std::string const& medium, FileTexts files = {{"l.step", sample(step::add_lens)}}) {
  folder();
  files["lens.yaml"] =
      "straytrace: 1\nmaterials:\n  bare: {specular: fresnel}\n  grey: {scatter: {model: lambertian, tis: 20 %}}\n"
      "bodies: {bench: {motion: still}}\nscene:\n"
      "  - {name: bench, body: bench, file: l.step, units: from_file, surfaces: {L1: bare, default: grey}" +
      medium +
      "}\n"
      "  - {name: screen, shape: {disk: {outer_radius: 5 cm}}, at: [25 cm, 0 m, 0 m], facing: [-1, 0, 0], body: "
      "bench,\n"
      "     material: grey}\n"
      "beams: {in: {from: [-10 cm, 0 m, 0 m], facing: [1, 0, 0], radius: 3 mm, lit: on}}\n"
      "receivers: {screen: {on: screen, side: front}}\n";
  Built out;
  Scene const scene = read_scene("lens.yaml", {}, &files);
  out.world = build_world(scene);
  out.warnings = scene.warnings();
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    out.errors = e.what();
  }
  return out;
}

double radius_on_screen(World const& world) {
  for (Footprint const& f : world.footprints())
    if (f.surface.valid() && world.groups()[world.surfaces()[f.surface.value].group.value] == "screen")
      return f.profile == Profile::astigmatic ? std::sqrt(f.astigmatism.w1 * f.astigmatism.w2) : f.radius;
  return 0;
}

TEST(step_glass, a_lens_in_its_holder_focuses_like_the_closed_form) {
  Built const b = lens(", medium: {L1: fused_silica}");
  ASSERT_EQ(b.errors, "");
  EXPECT_EQ(b.warnings, "");
  double const exact = radius_exact(1.44963);
  EXPECT_NEAR(radius_on_screen(b.world), exact, 2e-5 * exact);  // five digits of the index
  EXPECT_GT(std::fabs(radius_exact(1.45003) / exact - 1), 1e-4) << "another glass would be seen";
  for (Surface const& s : b.world.surfaces())
    EXPECT_EQ(s.volume != Surface::none, b.world.groups()[s.group.value] == "bench/L1");
}

TEST(step_glass, a_bare_boundary_without_glass_is_reported) {
  Built const b = lens("");
  ASSERT_EQ(b.errors, "");
  EXPECT_THAT(b.warnings, HasSubstr("'bench/L1' is a bare boundary (specular: fresnel), but nothing is filled"));
  EXPECT_THAT(b.warnings, HasSubstr("medium: {L1: fused_silica}"));
  EXPECT_NEAR(radius_on_screen(b.world), w0, 1e-3 * w0) << "nothing refracts";
}

TEST(step_glass, rows_of_medium_are_rules) {
  EXPECT_THAT(lens(", medium: {L2: fused_silica}").errors, HasSubstr("matches 'L2'"));
  EXPECT_THAT(lens(", medium: {L2: fused_silica}").errors, HasSubstr("did you mean 'L1'?"));
  EXPECT_THAT(lens(", medium: {L1: fused_silca}").errors, HasSubstr("fused_sil"));
  Built const all = lens(", medium: {\"color #a0d0ff\": fused_silica, default: none}");
  EXPECT_EQ(all.errors, "");
  EXPECT_NEAR(radius_on_screen(all.world), radius_exact(1.44963), 1e-6);
}

// A thread is joined by nothing: OpenCASCADE would look for joints in it without an end.
TEST(step_glass, threads_end_in_the_holder) {
  ::alarm(120);  // s: of a second or two
  CadFile const f = converted(sample(step::add_thread));
  ::alarm(0);
  ASSERT_EQ(f.parts.size(), 1u);
  EXPECT_GT(f.parts[0].triangles.size(), 100u);
  EXPECT_GE(f.parts[0].faces.size(), 5u);
}

}  // namespace
}  // namespace straytrace::test
