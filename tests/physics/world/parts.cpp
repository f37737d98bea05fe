// SPDX-License-Identifier: BSD-3-Clause
// The built-in composites (R3.06 and 7.2): sizes, closed bodies of glass, normals that point out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_parts {
namespace {

using ::testing::HasSubstr;

std::string text_of(std::string const& entry, std::string const& parts = "") {
  return "straytrace: 1\nmaterials: {m: {}, ground: {scatter: {model: lambertian, tis: 10 %}}}\n"
         "bodies: {b: {motion: still}}\n" +
         parts + "media: {glass: {index: 1.45}}\nscene:\n  - {name: x, body: b, material: m, " + entry + "}\n" +
         "  - {name: lit, shape: {disk: {outer_radius: 1 mm}}, at: [0 m, 0 m, 900 m], body: b, material: ground}\n" +
         "beams: {s: {on: lit, radius: 1 mm}}\nports: {p: {beam: s, at: lit}}\n";
}
World world_of(std::string const& entry, std::string const& parts = "") {
  FileTexts const texts{{"a.yaml", text_of(entry, parts)}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}
std::string error_text_of(std::string const& entry, std::string const& parts = "") {
  try {
    world_of(entry, parts);
  } catch (InputError const& e) {
    return e.what();
  }
  return {};
}

// The barrel among the first three surfaces.
struct Barrel {
  double from = 0, to = 0;
};
Barrel barrel_of(World const& world) {
  Barrel b;
  WorldView const v = world.view();
  for (std::uint32_t id = 0; id < 3; ++id)
    v.shapes.visit(v.surfaces[id].shape, [&](auto const& s) {
      if constexpr (std::is_same_v<std::decay_t<decltype(s)>, Cylinder>) b = {s.from, s.to};
    });
  return b;
}
double sag(double r, double diameter) { return r - std::sqrt(r * r - diameter * diameter / 4); }

// R3.06: RoC 0.1 m, diameter 0.09 m: sag 10.69714 mm, and the lens of E.2b. Barrels of 7.2: t - s1 - s2, t + s1 + s2, t
// - s1 + s2.
TEST(WorldParts, LensSagsAndBarrels) {
  Barrel const convex =
      barrel_of(world_of("use: lens, radius_1: 0.1 m, radius_2: 0.1 m, diameter: 9 cm, thickness: 3 cm"));
  EXPECT_NEAR(-convex.to, 10.69714e-3, 5e-9);
  EXPECT_GT(std::fabs(0.045 * 0.045 / 0.2 - 10.69714e-3), 1e-4);  // control: the parabola
  EXPECT_NEAR(convex.to - convex.from, 0.03 - 2 * sag(0.1, 0.09), 1e-15);
  // the lens of E.2b: edge 2.25697 mm; control: one face convex, the other flat
  Barrel const bench =
      barrel_of(world_of("use: lens, radius_1: 102.93 mm, radius_2: 102.93 mm, diameter: 10 mm, thickness: 2.5 mm"));
  EXPECT_NEAR(bench.to - bench.from, 2.25697e-3, 5e-9);
  EXPECT_GT(std::fabs(2.5e-3 - sag(0.10293, 0.01) - 2.25697e-3), 5e-9);
  Barrel const hollow =
      barrel_of(world_of("use: lens, radius_1: -0.1 m, radius_2: -0.2 m, diameter: 9 cm, thickness: 1 cm"));
  EXPECT_NEAR(hollow.to - hollow.from, 0.01 + sag(0.1, 0.09) + sag(0.2, 0.09), 1e-15);
  Barrel const meniscus =
      barrel_of(world_of("use: lens, radius_1: 0.1 m, radius_2: -0.2 m, diameter: 9 cm, thickness: 1 cm"));
  EXPECT_NEAR(meniscus.to - meniscus.from, 0.01 - sag(0.1, 0.09) + sag(0.2, 0.09), 1e-15);
  EXPECT_GT(std::fabs(meniscus.to - meniscus.from - (0.01 + sag(0.1, 0.09) - sag(0.2, 0.09))),
            1e-3);  // negative control
}

// Focal length of two faces with vacuum around them, from the ray matrix of the faces and the glass between them.
double focal_length(World const& world, double thickness, double index) {
  double power[2] = {};
  WorldView const v = world.view();
  for (std::uint32_t id : {0, 2})
    v.shapes.visit(v.surfaces[id].shape, [&](auto const& s) {
      if constexpr (requires { s.curvature; }) power[id / 2] = -s.curvature * (index - 1);
    });
  return 1 / (power[0] + power[1] - thickness / index * power[0] * power[1]);
}

// docs/reference/parts.md, lens by focal length; indices of docs/reference/interfaces/media.md.
TEST(WorldParts, FocalLensHasItsFocalLength) {
  auto const off = [](std::string const& entry, double f, double d, double n) {
    return std::fabs(focal_length(world_of("use: focal_lens, " + entry), d, n) / f - 1);
  };
  std::string const bk7 = "focal_length: 200 mm, thickness: 8 mm, medium: bk7, bending: ";
  for (char const* bending : {"1", "0", "-1", "0.3", "2"})
    EXPECT_LT(off(bk7 + bending, 0.2, 8e-3, 1.50663), 1e-5) << bending;
  EXPECT_GT(off(bk7 + "0", 0.2, 8e-3, 1.44963), 0.05);  // control: another glass
  EXPECT_GT(off(bk7 + "0", 0.2, 0, 1.50663), 1e-3);     // control: a thin lens of the same faces
  EXPECT_LT(off("focal_length: -0.1 m, thickness: 3 mm", -0.1, 3e-3, 1.44963), 1e-5);
  EXPECT_LT(off("focal_length: 0.1 m, thickness: 3 mm, medium: glass", 0.1, 3e-3, 1.45), 1e-12);
  EXPECT_THAT(error_text_of("use: focal_lens, focal_length: 0 m"), HasSubstr("no radii give this focal length"));
  EXPECT_THAT(error_text_of("use: focal_lens, focal_length: 10 mm, diameter: 50 mm"),
              HasSubstr("must be at most 8.992 mm"));
}

// Lines through the body: every one goes in and out in turn. False for the first that does not.
bool left_as_often_as_entered(World const& world, int lines, double size, Vec3 middle) {
  WorldView const v = world.view();
  Rng rng(3, 0, 0, Stream::source);
  auto const direction = [&] {
    double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
    SinCos const a = sincos_turn(rng.uniform());
    return Vec3{r * a.cos, r * a.sin, z};
  };
  for (int i = 0; i < lines; ++i) {
    Vec3 const d = direction(), aim = middle + (size * rng.uniform()) * direction();
    Ray ray{aim - (3 * size) * d, d};
    Departure from;
    bool inside = false;
    for (int n = 0; n < 20; ++n) {
      Hit const h = v.closest(ray, from);
      if (!h.surface.valid() || h.distance > 10 * size) break;
      Vec3 const p = ray.origin + h.distance * d;
      bool const entering = dot(v.normal(h.surface, p, h.piece), d) < 0;
      if (entering == inside) return false;
      inside = entering;
      ray.origin = v.project(h.surface, p, h.piece);
      from = Departure(h.surface, h.piece);
    }
    if (inside) return false;
  }
  return true;
}

TEST(WorldParts, GlassIsLeftAsOftenAsEntered) {  // 1e5 lines each
  struct Case {
    char const* entry;
    double size, middle;  // m: of a ball about the body, and where along z it is
  };
  Case const cases[] = {
      {"use: lens, radius_1: 0.1 m, radius_2: 0.1 m, diameter: 9 cm, thickness: 3 cm", 0.05, -0.015},
      {"use: lens, radius_1: -0.1 m, radius_2: -0.2 m, diameter: 9 cm, thickness: 1 cm", 0.05, -0.005},
      {"use: lens, radius_1: 0.1 m, radius_2: -0.2 m, diameter: 9 cm, thickness: 1 cm", 0.05, -0.005},
      {"use: lens, radius_1: 50 mm", 0.014, -0.0025},
      {"use: thick_mirror, radius_of_curvature: 1683 m", 0.21, -0.1},
      {"use: thick_mirror, radius_of_curvature: -2 m, wedge: 1.5 deg", 0.21, -0.1},
      {"use: flat_mirror", 0.015, -0.003},
      {"use: plate, wedge: 10 deg", 0.016, -0.0025},
      {"use: plate, wedge: -0.3 deg", 0.016, -0.0025},
      {"shape: {box: {width: 1 cm, height: 2 cm, depth: 3 cm}}", 0.02, 0},
  };
  for (Case const& c : cases)
    for (bool const moved : {false, true}) {
      std::string const entry =
          std::string(c.entry) + ", medium: glass" + (moved ? ", at: [1 m, 2 m, 3 m], facing: [0.3, -0.5, 0.7]" : "");
      Vec3 const along = moved ? unit({0.3, -0.5, 0.7}) : Vec3{0, 0, 1}, at = moved ? Vec3{1, 2, 3} : Vec3{};
      EXPECT_TRUE(left_as_often_as_entered(world_of(entry), 50000, c.size, at + c.middle * along)) << entry;
    }
}

// Control: the barrel ends 1 um before the rim of the first face.
TEST(WorldParts, AGapOfOneMicrometreIsFound) {
  auto const with = [](std::string const& gap) {
    return "parts:\n  slab:\n    faces:\n      front: {shape: {disk: {outer_radius: 1 cm}}}\n"
           "      barrel: {shape: {cylinder: {radius: 1 cm, from: -2 mm, to: 0 m - " +
           gap + "}}}\n      back: {shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, -2 mm], facing: [0, 0, -1]}\n";
  };
  EXPECT_TRUE(
      left_as_often_as_entered(world_of("use: slab, medium: glass", with("0 m")), 100000, 0.01, {0, 0, -0.001}));
  EXPECT_FALSE(
      left_as_often_as_entered(world_of("use: slab, medium: glass", with("1 um")), 100000, 0.01, {0, 0, -0.001}));
}

TEST(WorldParts, OneVolumeForEachPlacedPart) {
  World const world = world_of("use: lens, radius_1: 0.1 m, medium: glass, repeat: {count: 3, along: z, pitch: 1 m}");
  for (std::uint32_t id = 0; id < 9; ++id) EXPECT_EQ(world.surfaces()[id].volume, id / 3);
  EXPECT_EQ(world.surfaces()[9].volume, Surface::none);
  EXPECT_EQ(world.view().volumes.size, 3u);
  EXPECT_EQ(world.view().media[world.view().volumes[2].medium].index, 1.45);
  World const diode = world_of("use: photodiode, medium: glass");
  for (std::uint32_t id = 0; id < 7; ++id) EXPECT_EQ(diode.surfaces()[id].volume, id < 3 ? 0 : Surface::none);
}

TEST(WorldParts, MaterialsByFace) {
  World const world = world_of("use: lens, radius_1: 0.1 m, surfaces: {barrel: ground}");
  WorldView const v = world.view();
  auto const scatters = [&](std::uint32_t id) { return v.optics[v.surfaces[id].front].laws > 0; };
  EXPECT_TRUE(!scatters(0) && scatters(1) && !scatters(2));
  EXPECT_THAT(error_text_of("use: lens, surfaces: {barel: ground}"), HasSubstr("unknown key 'barel'"));
  EXPECT_THAT(error_text_of("use: lens, surfaces: {barrel: grond}"), HasSubstr("did you mean 'ground'?"));
  EXPECT_THAT(error_text_of("use: lens, surfaces: ground"), HasSubstr("names a material for each face"));
}

TEST(WorldParts, VolumesMustCloseWithNormalsOutwards) {
  auto const slab = [](std::string const& front, std::string const& barrel, std::string const& back) {
    return "parts:\n  slab:\n    faces:\n      front: {shape: {disk: {outer_radius: 1 cm}}" + front + "}\n" + barrel +
           "      back: {shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, -2 mm]" + back + "}\n";
  };
  std::string const barrel = "      barrel: {shape: {cylinder: {radius: 1 cm, from: -2 mm, to: 0 m}}}\n";
  std::string const down = ", facing: [0, 0, -1]", open = "do not close";
  std::string const entry = "use: slab, medium: glass";
  EXPECT_EQ(error_text_of(entry, slab("", barrel, down)), "");
  EXPECT_THAT(error_text_of(entry, slab("", barrel, "")), HasSubstr(open));    // the back looks into the glass
  EXPECT_THAT(error_text_of(entry, slab(down, barrel, "")), HasSubstr(open));  // both do
  EXPECT_THAT(error_text_of(entry, slab("", "", down)), HasSubstr(open));      // no barrel
  EXPECT_THAT(
      error_text_of(entry, slab("",
                                "      cone: {shape: {cone: {inner_radius: 5 mm, outer_radius: 1 cm, half_angle: "
                                "35 deg}}}\n",
                                down)),
      HasSubstr(open));
  auto const plugged = [&](std::string const& radius) {  // a gap of 1 % of the area is reported, one of 0.1 % is not
    std::string const place = "}}, at: [0 m, 0 m, -2 mm], facing: [0, 0, -1]}\n";
    return "parts:\n  slab:\n    faces:\n      front: {shape: {disk: {outer_radius: 1 cm}}}\n" + barrel +
           "      ring: {shape: {disk: {inner_radius: 9 mm, outer_radius: 1 cm" + place +
           "      plug: {shape: {disk: {outer_radius: " + radius + place;
  };
  EXPECT_EQ(error_text_of(entry, plugged("9 mm")), "");
  EXPECT_EQ(error_text_of(entry, plugged("8.98 mm")), "");
  EXPECT_THAT(error_text_of(entry, plugged("8.8 mm")), HasSubstr(open));
  EXPECT_THAT(error_text_of("shape: {disk: {outer_radius: 1 cm}}, medium: glass"), HasSubstr(open));
  EXPECT_EQ(error_text_of("shape: {sphere: {radius: 1 cm}}, medium: glass"), "");
  EXPECT_THAT(error_text_of("use: lens, medium: glas"), HasSubstr("did you mean 'glass'?"));
  EXPECT_EQ(error_text_of("use: lens, medium: none"), "");
}

TEST(WorldParts, AllAreAccepted) {
  for (char const* part : {"mirror", "lens", "focal_lens", "thick_mirror", "flat_mirror", "plate", "conical_baffle",
                           "serrated_baffle", "chamber", "tube_section", "dump", "photodiode", "mount", "motor_mount"})
    EXPECT_EQ(error_text_of(std::string("use: ") + part), "") << part;
}

// A chamber has walls: from the middle its inside is met, from outside its outside, `wall` apart.
TEST(WorldParts, ChamberHasWalls) {
  auto const hit_at = [](World const& world, double from, double towards) {
    Hit const h = world.view().closest({{from, 0, 0}, {towards, 0, 0}}, {});
    return from + towards * h.distance;
  };
  World const world = world_of("use: chamber, width: 2 m, wall: 2 cm");
  EXPECT_DOUBLE_EQ(hit_at(world, 0, 1), 1);
  EXPECT_DOUBLE_EQ(hit_at(world, 5, -1), 1.02);
  EXPECT_GT(std::fabs(hit_at(world_of("use: chamber, width: 2 m, wall: 1 cm"), 5, -1) - 1.02),
            5e-3);  // negative control
}

// Requirements 7.2: left and right mounts are mirror images of each other.
TEST(WorldParts, MotorMountsHaveHands) {
  auto const behind = [](std::string const& hand, double x, double y) {  // what a ray from behind meets first
    World const world = world_of("use: motor_mount" + hand);
    Hit const h = world.view().closest({{x, y, -1}, {0, 0, 1}}, {});
    return world.groups()[world.surfaces()[h.surface.value].group.value];
  };
  EXPECT_EQ(behind("", 0.0275, -0.0275), "x/lower_motor");
  EXPECT_EQ(behind(", hand: right", 0.0275, -0.0275), "x/lower_motor");
  EXPECT_EQ(behind(", hand: right", -0.0275, 0.0275), "x/upper_motor");
  EXPECT_EQ(behind(", hand: left", -0.0275, -0.0275), "x/lower_motor");
  EXPECT_EQ(behind(", hand: left", 0.0275, 0.0275), "x/upper_motor");
  EXPECT_EQ(behind(", hand: left", 0.0275, -0.0275),
            "x/frame/back");  // control: a mount without hands has a motor there
  EXPECT_THAT(error_text_of("use: motor_mount, hand: up"), HasSubstr("'hand' is right or left, got \"up\""));
  EXPECT_THAT(error_text_of("use: motor_mount, motor_width: 3 cm"), HasSubstr("must be at most 20.52 mm"));
}

}  // namespace
}  // namespace straytrace::world_parts
