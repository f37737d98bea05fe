// SPDX-License-Identifier: BSD-3-Clause
#include "world/read_mesh.hpp"

#include <fmt/format.h>

#include "base/document.hpp"
#include "world/mesh_doctor.hpp"

namespace straytrace {

bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, mark = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      mark = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

namespace {

void warn(Node const& file, MeshAdvice const& a) {
  Document* const document = file.document();
  if (document)
    document->add({document->place_in_file(file, file.text(), 0, 0), a.what, a.suggestion, Severity::warning});
}

// Material libraries that an OBJ file names; its own lines name the materials, so none is read.
void look_for_libraries(Node const& file, std::string const& bytes, std::string const& folder) {
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
    if (below && file.document()->optional_file(file, folder + std::string(line))) continue;
    Place place = file.document()->place_in_file(file, file.text(), std::uint32_t(number + 1), 8);
    file.document()->add({place, fmt::format("the material library '{}' that this file names is not beside it", name),
                          "nothing is read from it, materials keep the names behind 'usemtl': copy it here if the "
                          "export should be complete",
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
  look_for_libraries(file, bytes, folder);
  MeshHealth const health = examine(mesh->file);
  for (MeshAdvice const& a : advice(mesh->file, health)) warn(file, a);
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

// m per unit of the file; 0, and a problem, when it is not known.
double read_unit(Scene::Instance const& instance, LoadedMesh const& mesh, bool first_time) {
  Node const units = instance.node.has("units") ? instance.node["units"] : instance.placement["units"];
  Node const& owner = units ? units : instance.placement;
  std::string const sizes = fmt::format("its bounding box would be {} as mm and {} as m", size_text(box_of(mesh), 1e-3),
                                        size_text(box_of(mesh), 1));
  std::string const text = units ? units.as_word() : "";
  auto const refuse = [&](std::string const& why) {
    if (first_time) owner.problem(why + ": " + sizes, "write units: mm");
    return 0.0;
  };
  if (!units) {
    if (mesh.file.stated_unit > 0) {
      if (first_time)
        owner.problem(fmt::format("'{}' has no 'units'", instance.group), "write units: from_file (its format says m)");
      return 0;
    }
    return refuse(fmt::format("'{}' has no 'units'", instance.group));
  }
  if (text == "from_file")
    return mesh.file.stated_unit > 0 ? mesh.file.stated_unit : refuse("files of this format state no unit");
  auto const unit = parse_unit(text);
  if (!unit || !(unit->dimension == dim::length)) return refuse(fmt::format("'{}' is not a unit of length", text));
  return unit->si;
}

// One row of `surfaces`.
struct Choice {
  std::string pattern;
  Node material;
  bool used = false;
};

std::vector<Choice> read_choices(Scene::Instance const& instance) {
  std::vector<Choice> out;
  Node const table = instance.node.has("surfaces") ? instance.node["surfaces"] : instance.placement["surfaces"];
  if (table && table.kind() != Node::Kind::table)
    table.problem("'surfaces' names a material for each part", "write {\"dump*\": NAME, default: NAME}");
  else if (table)
    for (auto const& [pattern, node] : table.items())
      if (pattern != "default") out.push_back({pattern, node});
  if (table.kind() == Node::Kind::table && table.has("default")) out.push_back({"*", table["default"], true});
  Node const material = instance.node.has("material") ? instance.node["material"] : instance.placement["material"];
  if (material) out.push_back({"*", material, true});  // of everything not named
  return out;
}

std::string part_name(LoadedMesh const& mesh, std::size_t i) {
  MeshPart const& part = mesh.file.parts[i];
  if (!part.name.empty()) return part.name;
  if (!part.material.empty()) return part.material;
  return mesh.file.parts.size() == 1 ? "" : fmt::format("part_{}", i + 1);
}

std::uint32_t optic_of(Node const& material, Registry const& names) {
  std::string const name = material.as_word();
  if (auto const hit = names.materials.find(name); hit != names.materials.end()) return hit->second;
  std::vector<std::string> known;
  for (auto const& entry : names.materials) known.push_back(entry.first);
  std::string const near = nearest_word(name, known);
  if (!name.empty())
    material.problem(
        fmt::format("material '{}' is not defined", name),
        near.empty() ? fmt::format("defined: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", near));
  return names.black;
}

void report_choices(Scene::Instance const& instance, LoadedMesh const& mesh, std::vector<Choice> const& choices,
                    std::vector<std::string> const& bare) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < mesh.file.parts.size(); ++i)
    for (std::string const& word : {mesh.file.parts[i].name, mesh.file.parts[i].material})
      if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  std::string const all = words.empty() ? "it names no parts and no materials; write 'default' only"
                                        : shortened(fmt::format("it has: {}", fmt::join(words, ", ")));
  for (Choice const& c : choices) {
    if (c.used) continue;
    std::string const near = nearest_word(c.pattern, words);
    c.material.warning(fmt::format("no part or material of '{}' matches '{}'", mesh.file.name, c.pattern),
                       near.empty() ? all : fmt::format("did you mean '{}'?", near));
  }
  if (!bare.empty())
    instance.placement.problem(fmt::format("{} of {} parts of '{}' have no material, the first is '{}'", bare.size(),
                                           mesh.file.parts.size(), mesh.file.name, bare.front()),
                               fmt::format("write surfaces: {{{}default: NAME}}",
                                           bare.front().empty() ? "" : fmt::format("\"{}\": NAME, ", bare.front())));
}

}  // namespace

void add_mesh(Scene::Instance const& instance, Node const& file, Pose const& pose, Surface as, std::string const& side,
              bool first_time, World& world, Registry& names, MeshLibrary& library) {
  auto const mesh = load(file, world, library);
  std::vector<Choice> choices = read_choices(instance);
  if (!mesh->sound) {
    instance.placement.has("units");
    instance.node.has("units");
    return;
  }
  double const unit = read_unit(instance, *mesh, first_time);
  if (unit > 0 && first_time)
    if (MeshAdvice const odd = scale_advice(box_of(*mesh), unit); !odd.what.empty()) warn(file, odd);
  std::vector<std::string> bare;
  for (std::size_t i = 0; i < mesh->file.parts.size(); ++i) {
    std::uint32_t optic = names.black;
    bool chosen = false;
    for (Choice& c : choices) {
      MeshPart const& part = mesh->file.parts[i];
      bool const fits = matches(c.pattern, part.name) || (!part.material.empty() && matches(c.pattern, part.material));
      if (!fits) continue;
      if (!chosen) optic = optic_of(c.material, names);
      chosen = c.used = true;
    }
    std::string const part = part_name(*mesh, i), tail = part.empty() ? "" : "/" + part;
    if (!chosen) bare.push_back(part);
    TriangleMesh shape;
    shape.unit = unit > 0 ? unit : 1;
    shape.content = mesh->content[i];
    shape.place(pose);
    std::uint32_t const front = side == "back" || side == "inner" ? names.black : optic;
    std::uint32_t const back = side == "front" || side == "outer" ? names.black : optic;
    SurfaceId const id =
        world.add_surface(shape, front, back, as.body, world.add_group(instance.group + tail), as.volume);
    names.surfaces.try_emplace(instance.name + tail, id);
    names.surfaces.try_emplace(instance.group + tail, id);
    names.surfaces.try_emplace(instance.name, id);
  }
  if (first_time) report_choices(instance, *mesh, choices, bare);
}

}  // namespace straytrace
