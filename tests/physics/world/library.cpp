// SPDX-License-Identifier: BSD-3-Clause
// The library as geometry and optics: every part and material is sound, and baffles by the shadow rule hide the wall of
// every arm from both of its mirrors (docs/theory/arm.md, eq. 8.16, E.1).
#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/files/read_write.hpp"
#include "base/math/rng.hpp"
#include "scene/model_tree.hpp"
#include "world/build/read_materials.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_library {
namespace {

FileTexts with_library(std::string const& scene) {
  FileTexts texts{{"scene.yaml", "straytrace: 1\n" + scene}};
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name)) texts[std::string(file.name)] = file.text;
  return texts;
}

std::string said_of(FileTexts const& texts) {
  try {
    Scene const scene = read_scene("scene.yaml", {}, &texts);
    World const world = build_world(scene);
    scene.throw_if_problems();
  } catch (InputError const& e) {
    return e.what();
  }
  return "";
}

std::string const lamp =
    "  - {name: lamp, shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, 50 m], body: b, material: bare_steel}\n"
    "beams: {s: {on: lamp, radius: 1 mm, wavelength: 1064 nm}}\nreceivers: {r: {on: lamp}}\n";

std::vector<std::string> names_of(char const* section, std::string const& include) {
  FileTexts const texts = with_library("include: [" + include + "]\nscene: [{name: all, file: all}]\n");
  std::vector<std::string> names;
  for (auto const& [name, node] : read_scene("scene.yaml", {}, &texts).table(section).items()) names.push_back(name);
  return names;
}

// Entries of all files that are numbers, by their text.
std::size_t presets_written() {
  constexpr std::string_view key = "\n    preset:";
  std::size_t count = 0;
  for (EmbeddedFile const& file : embedded_files())
    if (file.name.starts_with("library/materials/"))
      for (auto at = file.text.find(key); at != file.text.npos; at = file.text.find(key, at + 1)) ++count;
  EXPECT_GE(count, 21u);
  return count;
}

TEST(LibraryWorld, EveryMaterialIsSound) {
  std::vector<std::string> const names = names_of("materials", "library/materials.yaml");
  EXPECT_GT(names.size(), 40u);
  for (std::string const& name : names) {
    std::string const use =
        "include: [library/materials.yaml]\nbodies: {b: {motion: still}}\nscene:\n  - {name: m, shape: {disk: "
        "{outer_radius: 1 cm}}, side: "
        "front, body: b, material: " +
        name + "}\n";
    EXPECT_EQ(said_of(with_library(use + lamp)), "") << name;
  }
  EXPECT_EQ(material_presets().size(), presets_written());
}

TEST(LibraryWorld, EveryPartIsSound) {
  std::vector<std::string> const names = names_of("parts", "library/parts.yaml");
  EXPECT_GT(names.size(), 30u);
  for (std::string const& name : names) {
    std::string const medium =
        name == "mounted_lens" || name == "test_mass" || name == "viewport" ? ", medium: fused_silica" : "";
    std::string const use =
        "include: [library/parts.yaml]\nbodies: {b: {motion: still}}\nscene:\n  - {name: p, use: " + name +
        ", body: b, material: bare_steel" + medium + "}\n";
    EXPECT_EQ(said_of(with_library(use + lamp)), "") << name;
  }
}

std::vector<std::string> detectors() {
  std::vector<std::string> names;
  for (EmbeddedFile const& file : embedded_files())
    if (file.name.starts_with("library/detectors/")) names.emplace_back(file.name);
  return names;
}

struct Arm {
  World world;
  double length, tube, mirror, first;
};

Arm arm_of(std::string const& detector, std::vector<std::string> const& overrides = {}) {
  FileTexts const texts = with_library("include: [" + detector + ", library/arm.yaml]\n");
  Scene const scene = read_scene("scene.yaml", overrides, &texts);
  Arm arm{build_world(scene), 0, 0, 0, 0};
  scene.throw_if_problems();
  FileTexts asked = texts;
  asked["scene.yaml"] += "report: {a: L, b: tube_radius, c: mirror_radius, d: first_baffle}\n";
  Scene const report = read_scene("scene.yaml", overrides, &asked);
  Node const numbers = report.table("report");
  arm.length = numbers.number("a", dim::length);
  arm.tube = numbers.number("b", dim::length);
  arm.mirror = numbers.number("c", dim::length);
  arm.first = numbers.number("d", dim::length);
  return arm;
}

// Straight lines between points of a mirror, half of them on its edge, and of the wall that nothing stands in the way
// of. Where none is, no light goes from mirror to mirror by way of the bare wall, in any specular order m >= 1.
int lines_to_the_wall(Arm const& arm, int lines) {
  int open = 0;
  for (int i = 0; i < lines; ++i) {
    Rng rng(816, std::uint64_t(i), 0, Stream::source);
    bool const end = i % 2, edge = i % 4 < 2;
    double const r = arm.mirror * (edge ? 1 - 1e-9 : std::sqrt(rng.uniform())), a = rng.uniform();
    // The middle third as often as all: there the two rows meet.
    double const part = i % 8 < 4 ? rng.uniform() : (1 + rng.uniform()) / 3;
    double const z = arm.first + part * (arm.length - 2 * arm.first);
    SinCos const from = sincos_turn(a), to = sincos_turn(edge ? a + 0.5 : rng.uniform());
    Vec3 const start{r * from.cos, r * from.sin, end ? arm.length : 0}, wall{arm.tube * to.cos, arm.tube * to.sin, z};
    Hit const hit = arm.world.view().closest({start, unit(wall - start)}, SurfaceId{end ? 1u : 0u});
    open += hit.surface.valid() && arm.world.groups()[arm.world.surfaces()[hit.surface.value].group.value] == "tube";
  }
  return open;
}

TEST(LibraryWorld, BafflesHideTheWallFromBothMirrorsE1) {
  EXPECT_EQ(detectors().size(), 6u);
  for (std::string const& name : detectors()) EXPECT_EQ(lines_to_the_wall(arm_of(name), 40000), 0) << name;
}

// Negative controls: the same rule with every step 1.2 times too long; and rows that only reach the middle of the arm,
// which shows the wall of LIGO there.
TEST(LibraryWorld, BafflesTooFarApartLeakE1) {
  for (std::string const& name : detectors())
    EXPECT_GT(
        lines_to_the_wall(arm_of(name, {"shadow=1.2*(tube_radius + mirror_radius)/(rim + mirror_radius)"}), 40000),
        1000)
        << name;
  FileTexts texts = with_library("");
  std::string half(texts.at("library/arm/baffles.yaml"));
  for (std::string const& reach : {std::string("L*shadow/(1 + shadow)"), std::string("L/(1 + shadow)")})
    half.replace(half.find("to: " + reach), 4 + reach.size(), "to: L/2");
  texts["library/arm/baffles.yaml"] = half;
  texts["scene.yaml"] = "straytrace: 1\ninclude: [library/detectors/aligo.yaml, library/arm.yaml]\n";
  Scene const scene = read_scene("scene.yaml", {}, &texts);
  Arm arm = arm_of("library/detectors/aligo.yaml");
  arm.world = build_world(scene);
  EXPECT_GT(lines_to_the_wall(arm, 40000), 0);
}

// The numbers of R5.08 and docs/theory/arm.md.
TEST(LibraryWorld, NumberOfBaffles) {
  auto const per_half = [](std::string const& name) {
    int count = 0;
    Arm const arm = arm_of("library/detectors/" + name + ".yaml");
    for (Surface const& s : arm.world.surfaces()) count += arm.world.groups()[s.group.value] == "baffles_in";
    return count;
  };
  EXPECT_EQ(per_half("adv"), 35);
  EXPECT_EQ(per_half("et-hf"), 49);
}

}  // namespace
}  // namespace straytrace::world_library
