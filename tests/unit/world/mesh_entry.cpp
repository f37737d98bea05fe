// SPDX-License-Identifier: BSD-3-Clause
// Scene entries with `file` (docs/reference/scene.md) and material lists.
#include "base/text/words.hpp"
#include "unit/scene/support.hpp"
#include "unit/world/mesh_texts.hpp"
#include "world/build/read_files.hpp"
#include "world/import/newmtl.hpp"

namespace straytrace::test::world_mesh_entry {
namespace {

using ::testing::HasSubstr;

std::string const head = R"(straytrace: 1
materials:
  black_glass: {scatter: {model: lambertian, tis: 1 ppm}}
  aluminium: {scatter: {model: lambertian, tis: 30 %}}
  steel: {scatter: {model: lambertian, tis: 20 %}}
bodies: {bench: {motion: still}}
beams: {spot: {on: mirror, radius: 1 cm}}
ports: {mirror: {beam: spot, at: mirror}}
scene:
  - {name: mirror, shape: {disk: {outer_radius: 2 cm}}, at: [1 m, 0 m, -1 cm], body: bench, material: steel}
)";
struct Built {
  World world;
  std::string errors, warnings;
  FileTexts files;
};
Built built(std::string const& entry, FileTexts files = {}) {
  files["arm.yaml"] = head + "  - {name: bench, body: bench, " + entry + "}\n";
  files.try_emplace("cad/cube.obj", cube_obj);
  Built out;
  Scene const scene = scene_of(files);
  out.world = build_world(scene);
  out.warnings = scene.warnings();
  out.files = scene.files();
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    out.errors = e.what();
  }
  return out;
}
constexpr char const* placed =
    "file: cad/cube.obj, units: mm, at: [0 m, 0 m, 5 m], facing: [0, 0, -1], "
    "surfaces: {\"dump*\": black_glass, steel: steel, default: aluminium}";

TEST(mesh_entry, parts_become_surfaces_with_the_materials_chosen) {
  Built const b = built(placed);
  EXPECT_EQ(b.errors, "");
  EXPECT_THAT(b.warnings, HasSubstr("cad/cube.obj:1:8: warning: the material library '../../../etc/missing.mtl' that "
                                    "this file names is not beside it"));
  ASSERT_EQ(b.world.surfaces().size(), 4u);
  EXPECT_THAT(b.world.groups(), ::testing::ElementsAre("mirror", "bench/dump_1", "bench/wall"));
  auto const& s = b.world.surfaces();
  EXPECT_NE(s[1].front, s[2].front);
  EXPECT_NE(s[2].front, s[3].front);
  EXPECT_EQ(s[3].front, s[0].front);
  EXPECT_EQ(s[2].front, s[2].back);
  EXPECT_TRUE(b.files.contains("cad/cube.obj")) << "the run file holds it";
  WorldView const v = b.world.view();
  Hit const hit = v.closest({{0.0005, -0.0005, 0}, {0, 0, 1}}, {});
  ASSERT_TRUE(hit.surface.valid());
  EXPECT_EQ(hit.surface.value, 1u);
  EXPECT_NEAR(hit.distance, 4.999, 1e-12);
}

TEST(mesh_entry, smooth_normals) {
  std::string const cube = "file: cad/cube.obj, units: mm, material: steel";
  Built const flat = built(cube), round = built(cube + ", smooth: 90 deg"),
              stated = built(cube + ", smooth: from_file");
  for (Built const* b : {&flat, &round, &stated}) EXPECT_EQ(b->errors, "");
  EXPECT_FALSE(flat.world.surfaces()[1].smooth);
  EXPECT_TRUE(round.world.surfaces()[1].smooth);
  EXPECT_NE(flat.world.fingerprint(), round.world.fingerprint());
  EXPECT_NE(stated.world.fingerprint(), round.world.fingerprint());
  EXPECT_EQ(flat.world.fingerprint(), built(cube).world.fingerprint());
  EXPECT_THAT(built(cube + ", smooth: 100 deg").errors, HasSubstr("100"));
  FileTexts const bare{{"cad/cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}};
  EXPECT_THAT(built(cube + ", smooth: from_file", bare).errors,
              HasSubstr("'cad/cube.obj' states no normals at the corners of its triangles"));
}

TEST(mesh_entry, instances_share_their_arrays_and_differ_in_the_fingerprint) {
  std::string const two =
      "file: cad/cube.obj, units: mm, material: steel, repeat: {count: 2, along: z, from: 1 m, to: 2 m}";
  Built const b = built(two);
  EXPECT_EQ(b.errors, "");
  WorldView const v = b.world.view();
  View<TriangleMesh const> const meshes = std::get<View<TriangleMesh const>>(v.shapes.arrays);
  ASSERT_EQ(meshes.size, 6u);
  EXPECT_EQ(meshes[0].content.packs.data, meshes[3].content.packs.data);
  EXPECT_NE(meshes[0].pose.origin.z, meshes[3].pose.origin.z);
  std::string other = cube_obj;
  other.replace(other.find("v 1 1 1"), 7, "v 1 1 2");
  EXPECT_EQ(built(two).world.fingerprint(), b.world.fingerprint());
  EXPECT_NE(built(two, {{"cad/cube.obj", other}}).world.fingerprint(), b.world.fingerprint());
}

TEST(mesh_entry, an_entry_without_area_is_an_error) {
  std::string const corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\n", entry = "file: a.obj, units: mm, material: steel";
  EXPECT_THAT(built(entry, {{"a.obj", corners}}).errors,
              HasSubstr("a.obj: error: no triangle of the file has an area"));
  Built const one_more = built(entry, {{"a.obj", corners + "f 1 2 3\n"}});
  EXPECT_EQ(one_more.errors, "");
  EXPECT_THAT(one_more.warnings, HasSubstr("1 triangle has no area"));
}

TEST(mesh_entry, a_missing_unit_is_an_error_that_shows_the_size) {
  EXPECT_THAT(built("file: cad/cube.obj, material: steel").errors,
              HasSubstr("'bench' has no 'units': its bounding box would be 1 mm x 1 mm x 1 mm as mm and "
                        "1 m x 1 m x 1 m as m"));
  EXPECT_THAT(built("file: cad/cube.obj, material: steel").errors, HasSubstr("write units: mm"));
  EXPECT_THAT(built("file: cad/cube.obj, units: kg, material: steel").errors,
              HasSubstr("'kg' is not a unit of length"));
  EXPECT_THAT(built("file: cad/cube.obj, units: from_file, material: steel").errors, HasSubstr("state no unit"));
  FileTexts const files{{"a.gltf", gltf_with("a.bin")}, {"a.bin", triangle_buffer()}};
  EXPECT_EQ(built("file: a.gltf, units: from_file, material: steel", files).errors, "");
  EXPECT_THAT(built("file: a.gltf, material: steel", files).errors, HasSubstr("units: from_file"));
  EXPECT_THAT(
      built("file: cad/cube.obj, units: km, material: steel").warnings,
      HasSubstr("cad/cube.obj: warning: bounding box 1 km x 1 km x 1 km; was it exported in mm and read as m?"));
}

TEST(mesh_entry, rules_that_do_not_fit_are_errors) {
  EXPECT_THAT(built("file: cad/cube.obj, units: mm, surfaces: {\"dump*\": black_glass}").errors,
              HasSubstr("parts of 'cad/cube.obj' have no material: 'wall'"));
  EXPECT_THAT(built("file: cad/cube.obj, units: mm, surfaces: {dumb_1: steel, default: steel}").errors,
              HasSubstr("did you mean 'dump_1'?"));
  EXPECT_THAT(built("file: cad/cube.obj, units: mm, surfaces: {default: stel}").errors,
              HasSubstr("did you mean 'steel'?"));
  EXPECT_THAT(built("file: cad/sphere.obj, units: mm, material: steel").errors, HasSubstr("cannot read file"));
  EXPECT_THAT(built("file: cad/cube.obj, units: mm, material: steel, unit: mm").errors,
              HasSubstr("unknown key 'unit'"));
  EXPECT_THAT(built("file: a.obj, units: mm, material: steel", {{"a.obj", "garbage\n"}}).errors,
              HasSubstr("a.obj: error:"));
  EXPECT_THAT(built("shape: {mesh: {}}, material: steel").errors, HasSubstr("shape mesh comes from a file"));
}

TEST(mesh_entry, rules_see_colours) {
  std::string cube = cube_obj.substr(cube_obj.find('\n') + 1);
  FileTexts const obj{{"a.obj", "mtllib a.mtl\n" + cube}, {"a.mtl", "newmtl black\nKd 0 0.2 1\nnewmtl alu\n"}};
  std::string const entry = "file: a.obj, units: mm, surfaces: {\"color #0033ff\": black_glass, default: steel}";
  Built const b = built(entry, obj);
  EXPECT_EQ(b.errors, "");
  EXPECT_NE(b.world.surfaces()[1].front, b.world.surfaces()[2].front);
  EXPECT_THAT(built(entry).errors, HasSubstr("cannot read file"));  // control: another file
  std::string const ply =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n0 0 1 0 0 255\n1 0 1 0 0 255\n0 1 1 0 0 255\n"
      "3 0 1 2\n3 3 4 5\n";
  Built const p =
      built("file: a.ply, units: mm, surfaces: {\"color #0000ff\": steel, default: aluminium}", {{"a.ply", ply}});
  EXPECT_EQ(p.errors, "");
  ASSERT_EQ(p.world.surfaces().size(), 3u);
  EXPECT_NE(p.world.surfaces()[1].front, p.world.surfaces()[2].front);
  std::string coloured = gltf_with("a.bin");
  coloured.replace(coloured.find("{\"name\":\"glass\"}"), 16,
                   "{\"name\":\"glass\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0.2158605,1]}}");
  EXPECT_EQ(built("file: a.gltf, units: from_file, surfaces: {\"color #ff0080\": steel}",
                  {{"a.gltf", coloured}, {"a.bin", triangle_buffer()}})
                .errors,
            "");
}

// Of a material library only colours are read, but a file that names one in vain may not be whole.
TEST(mesh_entry, missing_material_libraries_are_reported) {
  std::string const cube = cube_obj.substr(cube_obj.find('\n') + 1);
  auto const warnings = [&](std::string const& line, FileTexts files = {}) {
    files["cad/named.obj"] = "# made by hand\n" + line + cube;
    return built("file: cad/named.obj, units: mm, material: steel", files).warnings;
  };
  EXPECT_EQ(warnings(""), "");
  EXPECT_EQ(warnings("mtllib bench.mtl\n", {{"cad/bench.mtl", "newmtl steel\n"}}), "");
  EXPECT_THAT(warnings("mtllib bench.mtl \r\n"), HasSubstr("cad/named.obj:2:8: warning: the material library "
                                                           "'bench.mtl' that this file names is not beside it"));
  EXPECT_THAT(warnings("mtllib bench.mtl\n", {{"bench.mtl", "newmtl steel\n"}}), HasSubstr("'bench.mtl'"));
}

TEST(mesh_entry, an_unknown_key_is_reported_once) {
  std::string const said = built("file: cad/cube.obj, units: mm, surfaces: {default: steel}, materials: {a: b}").errors;
  EXPECT_THAT(said, HasSubstr("unknown key 'materials'"));
  EXPECT_THAT(said, HasSubstr("1 error."));
  EXPECT_THAT(built("file: cad/cube.obj, units: mm, surfaces: {default: steel}, materials: {a: b}, colour: red").errors,
              HasSubstr("2 errors."));  // negative control
}

TEST(mesh_entry, patterns) {
  EXPECT_TRUE(matches("dump*", "dump_3"));
  EXPECT_TRUE(matches("*_3", "dump_3"));
  EXPECT_TRUE(matches("d*p*3", "dump_3"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_FALSE(matches("dump", "dump_3"));
  EXPECT_FALSE(matches("*_4", "dump_3"));
}

// R3.35: the materials of the iris scene.
std::string const iris = R"(# four materials
newmtl glass_a
TR 0.5 0.3
IOR 1.45 1064
PPM 100 1
newmtl glass_b
TR 0.3 0.3
IOR 1.5 1.064
PPM 1 100
newmtl splitter
TR 0.5 0.3
newmtl absorber
TR 0 0
)";

TEST(newmtl, iris_file_has_four_materials) {
  std::vector<Problem> problems;
  auto const m = read_newmtl("newmtl broken\nTR 0.7 0.7\nnewmtl twice\nTR 0.1\nNs 3\n", problems);
  EXPECT_EQ(problems.size(), 3u) << "a sum above 1, a missing number, an unknown word";
  problems.clear();
  auto const list = read_newmtl(iris, problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[0].transmit, 0.5);
  EXPECT_EQ(list[0].reflect, 0.3);
  EXPECT_EQ(list[1].transmit, 0.3);
  EXPECT_EQ(list[0].index, 1.45);
  EXPECT_EQ(list[1].index, 1.5);
  EXPECT_NEAR(list[0].wavelength, 1.064e-6, 1e-18);
  EXPECT_NEAR(list[1].wavelength, 1.064e-6, 1e-18);
  EXPECT_NEAR(list[0].scatter_transmit, 1e-4, 1e-18);
  EXPECT_NEAR(list[0].scatter_reflect, 1e-6, 1e-18);
  EXPECT_EQ(m.size(), 2u);
}

TEST(newmtl, sums_above_one_are_errors_and_tables_are_read) {
  std::vector<Problem> problems;
  read_newmtl("newmtl glass\nTR 0.5 0.5\nPPM 100 1\n", problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].what, HasSubstr("violates energy conservation"));
  problems.clear();
  std::string const table = materials_table(read_newmtl("newmtl a\nTR 0.5 0.3\nIOR 1.45 1064\nPPM 100 1\n", problems));
  Scene const scene = scene_of(FileTexts{
      {"arm.yaml", "straytrace: 1\n" + table +
                       "bodies: {b: {motion: still}}\nbeams: {s: {on: m, radius: 1 cm}}\nports: {m: {beam: s, at: m}}\n"
                       "scene:\n  - {name: m, shape: {disk: {outer_radius: 2 cm}}, "
                       "body: b, material: a}\n"}});
  build_world(scene);
  EXPECT_NO_THROW(scene.throw_if_problems());
}

}  // namespace
}  // namespace straytrace::test::world_mesh_entry
