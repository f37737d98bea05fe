// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: what is read from each format, and the mesh checks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/mesh_shapes.hpp"
#include "unit/world/mesh_texts.hpp"
#include "world/import/geometry_file.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

MeshFile mesh(std::string const& name, std::string const& bytes, std::string* said = nullptr,
              CompanionFile const& companion = {}) {
  MeshFile out;
  out.name = name;
  MeshFault const fault = read_mesh_file(bytes, companion, out);
  if (said)
    *said = fault.what;
  else
    EXPECT_EQ(fault.what, "");
  return out;
}

std::size_t triangles_of(MeshFile const& file) {
  std::size_t n = 0;
  for (MeshPart const& p : file.parts) n += p.triangles.size();
  return n;
}

double area(MeshFile const& file) {
  double sum = 0;
  for (MeshHealth::Part const& p : examine(file).parts) sum += p.area;
  return sum;
}

TEST(mesh_file, obj_cube_has_12_triangles_and_area_6) {
  MeshFile const file = mesh("cad/cube.obj", cube_obj);
  EXPECT_EQ(triangles_of(file), 12u);
  EXPECT_DOUBLE_EQ(area(file), 6);
  ASSERT_EQ(file.parts.size(), 3u);
  EXPECT_EQ(file.parts[0].name, "dump_1");
  EXPECT_EQ(file.parts[0].material, "black");
  EXPECT_EQ(file.parts[1].name, "wall");
  EXPECT_EQ(file.parts[1].material, "alu");
  EXPECT_EQ(file.parts[2].name, "wall");
  EXPECT_EQ(file.parts[2].material, "steel");
  MeshHealth const health = examine(file);
  EXPECT_EQ(health.open_edges, 0u);
  EXPECT_TRUE(health.parts[0].closed);
  EXPECT_DOUBLE_EQ(health.parts[2].volume, 1);
  EXPECT_TRUE(advice(file, health).empty());
  EXPECT_EQ(triangles_of(mesh("cube.obj", cube_obj + "f 1 2 3\n")), 13u) << "a control with one more";
}

std::string binary_stl(testing::Soup const& s) {
  std::string out(80, ' ');
  auto const put = [&](auto x) { out.append(reinterpret_cast<char const*>(&x), sizeof x); };
  put(std::uint32_t(s.triangles.size()));
  for (MeshTriangle const& t : s.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0f);
    for (std::uint32_t c : t.corner) put(s.vertices[c]);
    put(std::uint16_t(0));
  }
  return out;
}

TEST(mesh_file, stl_in_both_forms) {
  MeshFile const cube = mesh("cube.stl", binary_stl(testing::cube()));
  ASSERT_EQ(cube.parts.size(), 1u);
  EXPECT_EQ(cube.parts[0].triangles.size(), 12u);
  EXPECT_EQ(cube.parts[0].vertices.size(), 8u) << "equal corners are one vertex";
  std::string const face =
      "facet normal 9 9 9\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  MeshFile const text = mesh("two.STL", "solid a\n" + face + "endsolid a\nsolid b\n" + face + "endsolid b\n");
  ASSERT_EQ(text.parts.size(), 2u);
  EXPECT_EQ(text.parts[1].name, "b");
}

TEST(mesh_file, ply_polygons_become_triangles) {
  MeshFile const file = mesh("five.ply",
                             "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n1 1 0\n0.5 1.5 0\n0 1 0\n5 0 1 2 3 4\n");
  EXPECT_EQ(triangles_of(file), 3u);
  EXPECT_DOUBLE_EQ(area(file), 1.25);
}

TEST(mesh_file, gltf_is_in_metres_and_places_its_nodes) {
  MeshFile const file = mesh("a/plate.gltf", gltf_with("plate.bin"), nullptr, [](std::string const& name) {
    return name == "plate.bin" ? triangle_buffer() : std::string();
  });
  EXPECT_EQ(file.stated_unit, 1);
  ASSERT_EQ(file.parts.size(), 2u);
  EXPECT_EQ(file.parts[1].name, "moved");
  EXPECT_EQ(file.parts[1].material, "glass");
  EXPECT_EQ(file.parts[1].vertices[0].z, 2);
}

TEST(mesh_file, other_files_are_searched_in_its_folder_only) {
  for (char const* name : {"../plate.bin", "/etc/plate.bin", "file:///etc/plate.bin", "a/../../plate.bin"}) {
    std::string said;
    bool asked = false;
    mesh("plate.gltf", gltf_with(name), &said, [&](std::string const&) {
      asked = true;
      return triangle_buffer();
    });
    EXPECT_FALSE(asked) << name;
    EXPECT_NE(said, "") << name;
  }
}

TEST(mesh_file, errors_are_explained) {
  std::string said;
  for (auto const& [name, bytes] : {std::pair{"a.stl", std::string("hello")},
                                    {"a.obj", "f 1 2 3\n"},
                                    {"a.ply", "ply\nxx"},
                                    {"a.glb", "glTF"},
                                    {"a.stl", binary_stl(testing::cube()).substr(0, 300)},
                                    {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n"}}) {
    mesh(name, bytes, &said);
    EXPECT_NE(said, "") << name;
  }
  mesh("bench.txt", "x", &said);
  EXPECT_THAT(said, HasSubstr(".txt"));
}

// Each defect in our words; no word of the library and no byte of the file.
TEST(mesh_file, defects_are_named_without_words_of_the_library) {
  std::string const corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", facet = "solid a\nfacet normal 0 0 1\nouter loop\n";
  std::string const end = "endloop\nendfacet\nendsolid a\n", noise = "\x01\x02\x03\x04\x05\x06\xff\xfe";
  std::string many = noise;
  for (int i = 0; i < 100; ++i) many += noise;
  for (auto const& [name, bytes, cause] :
       {std::tuple{"a.obj", corners, "it contains no faces"},
        {"a.obj", corners + "f 1 2 ", "fewer than three corners"},
        {"a.obj", corners + "f 1\n", "fewer than three corners"},
        {"a.obj", corners + "f 1 2 9\n", "names a corner that the file does not have"},
        {"a.obj", many, "the file is binary"},
        {"a.stl", many, "neither text nor as long as a binary file"},
        {"a.stl", facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 x\n" + end, "a text that is not a number"},
        {"a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\n"), "its header is cut off"}}) {
    std::string said;
    mesh(name, bytes, &said);
    EXPECT_THAT(said, HasSubstr(cause)) << name;
    for (char const* foreign : {"aiMesh", "mFaces", "mNumMeshes", "endloop", "Validation"})
      EXPECT_THAT(said, ::testing::Not(HasSubstr(foreign))) << name;
  }
  mesh("a.obj", corners + "f 1 2 3\n");
  mesh("a.stl", facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" + end);
}

// Files that would make the library crash or take all memory; more of them in fuzz/corpus/mesh.
TEST(mesh_file, hostile_files_are_errors) {
  std::string const head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  std::string const corners = "end_header\n0 0 0\n1 0 0\n0 1 0\n", list = "\nproperty list uchar int vertex_indices\n";
  std::string said;
  mesh("a.ply", head + "element face 1" + list + corners + "3 0 1 2\n");
  mesh("a.ply", head + "element face 1" + list + corners + "3 0 1 1000000\n", &said);
  EXPECT_THAT(said, HasSubstr("names a corner that the file does not have"));
  mesh("a.ply", head + "element face 4000000000" + list + corners + "3 0 1 2\n", &said);
#ifdef __SANITIZE_ADDRESS__  // which ends the library's process where it asks for too much memory
  EXPECT_THAT(said, HasSubstr("the library that reads it failed"));
#else
  EXPECT_THAT(said, HasSubstr("it states more points or faces than its size allows"));
#endif
}

// R3.08: the size of the author's test, 105,917 vertices, is read, looked through and made ready.
TEST(mesh_file, the_size_of_the_original_test) {
  testing::Soup const ball = testing::bumpy(231, 0.1);
  std::string text;
  for (MeshVertex const& v : ball.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
  for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
    if (i % 5000 == 0) text += fmt::format("g part_{}\n", i / 5000);
    auto const& c = ball.triangles[i].corner;
    text += fmt::format("f {} {} {}\n", c[0] + 1, c[1] + 1, c[2] + 1);
  }
  MeshFile file = mesh("ball.obj", text);
  EXPECT_GT(ball.vertices.size(), 105917u);
  EXPECT_EQ(file.parts.size(), 43u);
  EXPECT_EQ(examine(file).open_edges, 0u) << "parts meet without holes";
  Storage storage;
  std::size_t kept = 0;
  for (MeshPart& p : file.parts)
    kept += prepare_mesh(std::move(p.vertices), std::move(p.triangles), storage).triangles.size;
  EXPECT_EQ(kept, ball.triangles.size());
}

MeshFile one_part(testing::Soup const& s) {
  MeshFile file;
  file.name = "x.stl";
  file.parts = {{"part", "", "", s.vertices, s.triangles, {}}};
  return file;
}
std::string said_of(MeshFile const& file) {
  std::string all;
  for (MeshAdvice const& a : advice(file, examine(file))) all += a.what + "\n";
  return all;
}

TEST(mesh_checks, finds_what_is_odd) {
  testing::Soup const good = testing::cross_shaped();
  EXPECT_EQ(said_of(one_part(good)), "");
  testing::Soup holed = good, flipped = good, doubled = good, flat = good, inverted = good;
  holed.triangles.pop_back();
  EXPECT_THAT(said_of(one_part(holed)), HasSubstr("3 edges in 1 of 1 part belong to one triangle only"));
  std::swap(flipped.triangles[0].corner[0], flipped.triangles[0].corner[1]);
  EXPECT_THAT(said_of(one_part(flipped)), HasSubstr("3 edges join triangles that show different sides"));
  doubled.triangles.push_back(doubled.triangles[3]);
  EXPECT_THAT(said_of(one_part(doubled)), HasSubstr("1 triangle lies on the corners of another one"));
  EXPECT_THAT(said_of(one_part(doubled)), HasSubstr("more than two triangles"));
  flat.triangles.push_back({{0, 1, 1}});
  EXPECT_THAT(said_of(one_part(flat)), HasSubstr("1 triangle has no area"));
  for (MeshTriangle& t : inverted.triangles) std::swap(t.corner[0], t.corner[1]);
  EXPECT_THAT(said_of(one_part(inverted)), HasSubstr("normals of closed parts look inwards: 'part'"));
}

TEST(mesh_checks, a_file_without_area_is_a_fault) {
  testing::Soup collapsed, line;
  collapsed.vertices = line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  collapsed.triangles = {{{0, 1, 1}}};
  line.triangles = {{{0, 1, 2}}};
  EXPECT_THAT(without_area(examine(one_part(collapsed))).what, HasSubstr("no triangle of the file has an area"));
  EXPECT_THAT(without_area(examine(one_part(line))).what, HasSubstr("no triangle of the file has an area"));
  line.triangles.push_back({{0, 1, 3}});
  EXPECT_EQ(without_area(examine(one_part(line))).what, "");
}

TEST(mesh_checks, turns_inverted_bodies_and_leaves_hollow_ones) {
  testing::Soup s = testing::cube();
  for (MeshTriangle& t : s.triangles) std::swap(t.corner[0], t.corner[1]);
  MeshFile file = one_part(s);
  EXPECT_LT(examine(file).parts[0].volume, 0);
  EXPECT_TRUE(repair(file, examine(file)));
  EXPECT_DOUBLE_EQ(examine(file).parts[0].volume, 1);
  testing::Soup hollow = testing::cube();  // a box with a smaller box cut out: normals out of the material
  auto const n = std::uint32_t(hollow.vertices.size());
  for (std::size_t i = 0; i < 8; ++i) {
    MeshVertex const v = hollow.vertices[i];
    hollow.vertices.push_back({v.x / 2, v.y / 2, v.z / 2});
  }
  for (std::size_t i = 0; i < 12; ++i) {
    MeshTriangle const t = hollow.triangles[i];
    hollow.triangles.push_back({{t.corner[1] + n, t.corner[0] + n, t.corner[2] + n}});
  }
  MeshFile box = one_part(hollow);
  EXPECT_DOUBLE_EQ(examine(box).parts[0].volume, 1 - 1.0 / 8);
  EXPECT_FALSE(repair(box, examine(box)));
}

}  // namespace
}  // namespace straytrace::test
