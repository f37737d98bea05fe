// SPDX-License-Identifier: BSD-3-Clause
// Mesh files, distinguished by their first bytes, up to their search tree; and faces converted from STEP.
#include "base/every_module.hpp"
#include "base/memory/storage.hpp"
#include "fuzz.hpp"
#include "geometry/mesh/triangle_mesh.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/geometry_file.hpp"

namespace {

std::string name_for(std::string_view text) {
  if (text.starts_with("glTF")) return "mesh.glb";
  if (text.starts_with("{")) return "mesh.gltf";
  if (text.starts_with("ply")) return "mesh.ply";
  for (std::string_view begin : {"v ", "o ", "g ", "#", "mtllib", "usemtl"})
    if (text.starts_with(begin)) return "mesh.obj";
  return "mesh.stl";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  std::string const bytes(fuzz::text_of(data, size));
  CadFile cad;
  if (bytes.starts_with("{")) (void)read_cad_file(bytes, cad);
  MeshFile mesh;
  mesh.name = name_for(bytes);
  auto const companion = [&](std::string const&) { return bytes; };
  if (!read_mesh_file(bytes, companion, mesh).what.empty()) return 0;
  set_library_colours(bytes, mesh);
  MeshHealth const health = examine(mesh);
  (void)advice(mesh, health);
  repair(mesh, health);
  Storage storage;
  for (MeshPart& part : mesh.parts) (void)prepare_mesh(std::move(part.vertices), std::move(part.triangles), storage);
  return 0;
}
