// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/read_mesh.hpp"

#include <fmt/format.h>

#include "base/input/document.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace {
namespace {

// Material libraries that an OBJ file names: only the colours are read, the file itself names the materials.
void read_libraries(Node const& file, std::string const& bytes, std::string const& folder, MeshFile& mesh) {
  if (!file.document() || !file.as_word().ends_with(".obj")) return;
  std::size_t number = 0;
  for (std::size_t at = 0; at < bytes.size(); ++number) {
    std::size_t const end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view line(bytes.data() + at, end - at);
    at = end + 1;
    constexpr std::string_view keyword = "mtllib ";
    if (!line.starts_with(keyword)) continue;
    line.remove_prefix(keyword.size());
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    if (line.empty()) continue;
    std::string const name = shortened(line);
    bool const below = line.find("..") == line.npos && line.find_first_of("\\:") == line.npos && line[0] != '/';
    auto const library =
        below ? file.document()->optional_file(file, folder + std::string(line)) : std::optional<std::string>();
    if (library) {
      set_library_colours(*library, mesh);
      continue;
    }
    Place place = file.document()->place_in_file(file, file.text(), std::uint32_t(number + 1), 8);
    file.document()->add({place, fmt::format("the material library '{}' that this file names is not beside it", name),
                          "only colours are read from it, materials keep the names behind 'usemtl': copy it here if "
                          "rules should choose by colour",
                          Severity::warning});
  }
}

std::shared_ptr<LoadedMesh const> load(Node const& file, World& world, MeshLibrary& library) {
  std::string const name = file.as_word(), folder = name.substr(0, name.rfind('/') + 1);
  auto& slot = library[fmt::format("{}:{}", file.place().file, name)];
  if (slot) return slot;
  auto const mesh = std::make_shared<LoadedMesh>();
  slot = mesh;
  mesh->file.name = name;
  std::string const bytes = file.data_file(name);
  if (bytes.empty()) {
    if (file.healthy()) file.problem(fmt::format("file '{}' is empty", name), "export the mesh again");
    return slot;
  }
  MeshFault const fault = read_mesh_file(
      bytes, [&](std::string const& other) { return file.data_file(folder + other); }, mesh->file);
  if (!fault.what.empty()) {
    file.file_problem(name, 0, 0, fault.what, fault.suggestion);
    return slot;
  }
  read_libraries(file, bytes, folder, mesh->file);
  MeshHealth const health = examine(mesh->file);
  for (MeshAdvice const& a : advice(mesh->file, health)) warn_of_file(file, a.what, a.suggestion);
  repair(mesh->file, health);
  for (MeshPart& part : mesh->file.parts)
    mesh->content.push_back(prepare_mesh(std::move(part.vertices), std::move(part.triangles), world.storage));
  mesh->sound = !mesh->file.parts.empty();
  return slot;
}

Box box_of(LoadedMesh const& mesh) {
  Box box;
  for (MeshContent const& c : mesh.content) box.add(c.box);
  return box;
}

std::string part_name(LoadedMesh const& mesh, std::size_t i) {
  MeshPart const& part = mesh.file.parts[i];
  if (!part.name.empty()) return part.name;
  if (!part.material.empty()) return part.material;
  return mesh.file.parts.size() == 1 ? "" : fmt::format("part_{}", i + 1);
}

std::vector<PartLabel> labels_of(LoadedMesh const& mesh) {
  std::vector<PartLabel> labels;
  for (std::size_t i = 0; i < mesh.file.parts.size(); ++i)
    labels.push_back({part_name(mesh, i), mesh.file.parts[i].material, mesh.file.parts[i].colour});
  return labels;
}

}  // namespace

void add_mesh(Scene::Instance const& instance, Node const& file, Pose const& pose, Surface as, std::string const& side,
              FillPart const& fill, bool first_time, World& world, Registry& names, MeshLibrary& library) {
  auto const mesh = load(file, world, library);
  PartRules rules(instance, "surfaces", first_time), media(instance, "medium", first_time);
  if (!mesh->sound) {
    instance.placement.has("units");
    instance.node.has("units");
    return;
  }
  double const stated = mesh->file.stated_unit;
  double const unit =
      read_file_unit(instance, box_of(*mesh), stated,
                     stated > 0 ? "its format says m" : "files of this format state no unit", first_time);
  if (unit > 0 && first_time)
    if (MeshAdvice const odd = scale_advice(box_of(*mesh), unit); !odd.what.empty())
      warn_of_file(file, odd.what, odd.suggestion);
  std::vector<PartLabel> const labels = labels_of(*mesh);
  for (std::size_t i = 0; i < mesh->file.parts.size(); ++i) {
    std::uint32_t const optic = rules.optic(labels[i], names);
    std::string const& part = labels[i].name;
    Node const medium = media.of(labels[i]);
    std::string const tail = part.empty() ? "" : "/" + part;
    TriangleMesh shape;
    shape.unit = unit > 0 ? unit : 1;
    shape.content = mesh->content[i];
    shape.place(pose);
    std::uint32_t const front = side == "back" || side == "inner" ? names.black : optic;
    std::uint32_t const back = side == "front" || side == "outer" ? names.black : optic;
    SurfaceId const id = world.add_surface(shape, front, back, as.body, world.add_group(instance.group + tail),
                                           medium ? fill(medium, part) : as.volume);
    names.surfaces.try_emplace(instance.name + tail, id);
    names.surfaces.try_emplace(instance.group + tail, id);
    names.surfaces.try_emplace(instance.name, id);
  }
  if (!first_time) return;
  rules.report(instance, mesh->file.name, labels);
  media.report(instance, mesh->file.name, labels);
}

}  // namespace straytrace
