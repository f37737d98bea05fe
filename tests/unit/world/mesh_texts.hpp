// SPDX-License-Identifier: BSD-3-Clause
// Mesh files as texts.
#pragma once

#include <string>

namespace straytrace::test {

// v//vn, v/vt/vn, negative numbers, a hexagon's worth of polygons, groups and materials; the library does not exist.
inline std::string const cube_obj = R"(mtllib ../../../etc/missing.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vn 0 0 1
vt 0 0
g dump_1
usemtl black
f 4//1 3//1 2//1 1//1
f 5//1 6//1 7//1 8//1
g wall
usemtl alu
f 1 2 6 5
f 2/1/1 3/1/1 7/1/1 6/1/1
usemtl steel
f 3 4 8 7
f -8 -4 -1 -5
)";

inline std::string const gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"name":"plate"},{"mesh":0,"name":"moved","translation":[0,0,2]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"materials":[{"name":"glass"}],
"buffers":[{"byteLength":36,"uri":"FILE"}],"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";
inline std::string gltf_with(std::string const& buffer) {
  std::string out = gltf;
  return out.replace(out.find("FILE"), 4, buffer);
}
inline std::string triangle_buffer() {
  float const xyz[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  return {reinterpret_cast<char const*>(xyz), sizeof xyz};
}

}  // namespace straytrace::test
