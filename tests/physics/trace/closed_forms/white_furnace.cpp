// SPDX-License-Identifier: BSD-3-Clause
// White furnace (docs/theory/sampling.md): an enclosure of unit radiance is seen with radiance 1
// wherever one looks, by a lens, by a film, by rough surfaces: what they do not reflect they transmit.
#include "scene/scene.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr char furnace[] =
    "straytrace: 1\n"
    "materials:\n"
    "  black: {}\n"
    "  bare: {specular: fresnel}\n"
    "  film: {specular: {film: {layers: [[2.07, quarter], [1.45, quarter], [2.07, half]]}}}\n"
    "  hazy: {specular: fresnel, scatter: {model: harvey, l: 0.05, s: -2, tis: 60 %}}\n"
    "  ground: {specular: fresnel, scatter: {model: microfacet, roughness: 0.3, reflectance: 0.5, grazing: 1}}\n"
    "  lossy: {scatter: {model: microfacet, roughness: 0.3, reflectance: 1}}\n"
    "media: {glass: {index: 1.5}}\n"
    "bodies: {b: {motion: still}}\n"
    "scene:\n"
    "  - {name: oven, shape: {sphere: {radius: 1 m}}, body: b, material: black}\n"
    "  - {name: lit, shape: {disk: {outer_radius: 1 mm}}, at: [0 m, 0 m, 900 m], body: b, material: hazy}\n"
    "  - {name: lens, use: lens, radius_1: 0.2 m, radius_2: 0.3 m, diameter: 12 cm, thickness: 3 cm, body: b,\n"
    "     material: bare, medium: glass, at: [0 m, 0 m, 0.3 m]}\n"
    "  - {name: film, shape: {disk: {outer_radius: 10 cm}}, body: b, material: film, at: [0.5 m, 0 m, 0 m]}\n";
constexpr char rough[] =
    "  - {name: hazy, shape: {disk: {outer_radius: 10 cm}}, body: b, material: hazy, at: [-0.5 m, 0 m, 0 m]}\n"
    "  - {name: ground, shape: {disk: {outer_radius: 10 cm}}, body: b, material: ground, at: [0 m, 0.5 m, 0 m]}\n";
constexpr char lossy_plate[] =
    "  - {name: lossy, shape: {disk: {outer_radius: 10 cm}}, body: b, material: lossy, at: [0 m, -0.5 m, 0 m]}\n";
constexpr char beams[] = "beams: {s: {on: lit, radius: 1 mm}}\nports: {p: {beam: s, at: lit}}\n";

World furnace_with(std::string const& more) {
  FileTexts const texts{{"a.yaml", furnace + more + beams}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

// Radiance along a line of sight, followed against the light until it ends on the oven, whose radiance is 1. `divide`:
// by the probability of the lobe that was chosen, as it must be.
double radiance(WorldView const& view, std::uint32_t oven, std::uint64_t number, Vec3 from, Vec3 towards, bool divide) {
  Silent sink;
  PathState path;
  path.history = number;
  path.power = 1;
  path.ray = {from, towards};
  for (int i = 0; i < 10000; ++i) {
    Hit const hit = view.closest(path.ray, path.from);
    if (!hit.surface.valid()) return 0;
    Vertex vertex = vertex_at(view, path, hit);
    double const lobe = path.hop.lobe;
    path.power *= finish_hop_weight(view, path, &vertex) * (divide ? 1 : lobe);
    ++path.event;
    evaluate_scattering(view, path, path.ray.dir, vertex);
    if (view.surfaces[hit.surface.value].group.value == oven) return path.power;
    if (!scatter(view, 1, path, vertex, sink)) return 0;
  }
  return 0;
}

// Mean over lines of sight, from all round, to points within `size` of `target`.
SampleMean seen(World& world, Vec3 target, double size, std::uint64_t lines, bool divide = true) {
  WorldView const view = world.view();
  std::uint32_t const oven = world.add_group("oven").value;
  Sampler all;
  for (std::uint64_t i = 0; i < lines; ++i) {
    Rng rng(7, i, 0, Stream::source);
    auto const direction = [&] {
      double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
      SinCos const a = sincos_turn(rng.uniform());
      return Vec3{r * a.cos, r * a.sin, z};
    };
    Vec3 const from = target + 0.2 * direction(), to = target + (size * rng.uniform()) * direction();
    all.add(radiance(view, oven, i, from, unit(to - from), divide));
  }
  return all.mean();
}

TEST(WhiteFurnace, RadianceIsOneEverywhereR3_03) {
  Vec3 const lens{0, 0, 0.285}, film{0.5, 0, 0}, hazy{-0.5, 0, 0}, ground{0, 0.5, 0}, lossy{0, -0.5, 0};
  World clear = furnace_with(""), all = furnace_with(rough), dark = furnace_with(std::string(rough) + lossy_plate);
  // glass and film split light without a spread: every single line of sight has radiance 1
  for (Vec3 const& object : {lens, film}) {
    SampleMean const s = seen(clear, object, 0.04, 20000);
    EXPECT_NEAR(s.mean, 1, 1e-12);
    EXPECT_LT(s.std_error, 1e-12);
    expect_rejected("lobes not divided by their probability", seen(clear, object, 0.04, 20000, false), 1);
  }
  expect_mean("haze", seen(all, hazy, 0.04, 1 << 17), 1, 5e-3);
  expect_mean("ground", seen(all, ground, 0.04, 1 << 17), 1, 5e-3);
  expect_mean("anything", seen(all, {}, 0.8, 1 << 17), 1, 1e-3);
  // control: a surface that absorbs the shadowed light of its small mirrors, viewed directly, and somewhere in the oven
  expect_rejected("a lossy surface", seen(dark, lossy, 0.04, 1 << 16), 1);
  expect_rejected("one of them is lossy", seen(dark, {}, 0.8, 1 << 17), 1);
}

}  // namespace
}  // namespace straytrace::testing
