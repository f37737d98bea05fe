// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/read_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/document.hpp"
#include "base/text/words.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace::world {

namespace {

constexpr std::string_view by_colour = "color ";

bool is_colour(std::string_view text) {
  return text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdef", 1) == text.npos;
}

std::string some_of(std::vector<std::string> const& names) {
  constexpr std::size_t shown = 8;
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < shown; ++i) out += fmt::format("{}'{}'", i ? ", " : "", names[i]);
  return names.size() > shown ? out + fmt::format(" and {} more", names.size() - shown) : out;
}

std::string last_piece(std::string const& name) { return name.substr(name.rfind('/') + 1); }

// Names that rules of a file can use.
std::vector<std::string> words_of(std::vector<PartLabel> const& parts) {
  std::vector<std::string> words;
  auto const add = [&](std::string const& word) {
    if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  };
  for (PartLabel const& p : parts) add(last_piece(p.name));
  for (PartLabel const& p : parts) add(p.name);
  for (PartLabel const& p : parts) add(p.material);
  for (PartLabel const& p : parts) add(p.colour.empty() ? "" : std::string(by_colour) + p.colour);
  return words;
}

}  // namespace

bool PartRules::Rule::fits(PartLabel const& part) const {
  if (!colour.empty()) return colour == part.colour;
  return matches(pattern, part.name) || matches(pattern, last_piece(part.name)) ||
         (!part.material.empty() && matches(pattern, part.material));
}

void PartRules::add(std::string const& pattern, Node const& says, bool complain) {
  Rule rule{pattern, "", says};
  std::string const low = lower_case(pattern);
  if (low.starts_with(by_colour) || low.starts_with("colour ")) {
    rule.colour = low.substr(low.find(' ') + 1);
    if (!is_colour(rule.colour)) {
      if (complain)
        says.problem(fmt::format("'{}' is not a colour", shortened(pattern)),
                     "write \"color #rrggbb\", as inspect prints it");
      rule.used = true;
    }
  }
  rules_.push_back(std::move(rule));
}

PartRules::PartRules(Scene::Instance const& instance, std::string_view key, bool first_time) {
  bool const materials = key == "surfaces";
  Node const table = instance.node.has(key) ? instance.node[key] : instance.placement[key];
  bool const rows = table && table.kind() == Node::Kind::table;
  if (table && !rows && materials)
    table.problem("'surfaces' names a material for each part", "write {\"dump*\": NAME, default: NAME}");
  if (rows)
    for (auto const& [pattern, node] : table.items())
      if (pattern != "default") add(pattern, node, first_time);
  if (rows && table.has("default")) rules_.push_back({"*", "", table["default"], true});
  if (!materials) return;
  Node const material = instance.node.has("material") ? instance.node["material"] : instance.placement["material"];
  if (material) rules_.push_back({"*", "", material, true});  // of everything not named
}

Node PartRules::of(PartLabel const& part) {
  Rule* chosen = nullptr;
  for (Rule& rule : rules_) {
    if (!rule.fits(part)) continue;
    rule.used = true;
    if (!chosen) chosen = &rule;
  }
  return chosen ? chosen->says : Node();
}

std::uint32_t PartRules::optic(PartLabel const& part, Registry const& names) {
  Node const material = of(part);
  if (!material) {
    std::string const shown = part.name.empty() ? part.material : part.name;
    if (std::find(bare_.begin(), bare_.end(), shown) == bare_.end()) bare_.push_back(shown);
    return names.black;
  }
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

void PartRules::report(Scene::Instance const& instance, std::string const& name,
                       std::vector<PartLabel> const& parts) const {
  std::vector<std::string> const words = words_of(parts);
  std::string const all = words.empty() ? "the file names no parts and no materials; write only 'default'"
                                        : fmt::format("it has: {}", some_of(words));
  for (Rule const& r : rules_) {
    if (r.used) continue;
    std::string const near = nearest_word(r.pattern, words);
    r.says.problem(fmt::format("no part, material or colour of '{}' matches '{}'", name, r.pattern),
                   near.empty() ? all : fmt::format("did you mean '{}'?", near));
  }
  if (bare_.empty()) return;
  instance.placement.problem(fmt::format("parts of '{}' have no material: {}", name, some_of(bare_)),
                             fmt::format("write surfaces: {{{}default: NAME}}",
                                         bare_.front().empty() ? "" : fmt::format("\"{}\": NAME, ", bare_.front())));
}

double read_file_unit(Scene::Instance const& instance, Box const& box, double stated, std::string const& source,
                      bool first_time) {
  Node const units = instance.node.has("units") ? instance.node["units"] : instance.placement["units"];
  Node const& owner = units ? units : instance.placement;
  std::string const text = units ? units.as_word() : "";
  std::string const sizes =
      fmt::format("its bounding box would be {} as mm and {} as m", size_text(box, 1e-3), size_text(box, 1));
  auto const refuse = [&](std::string const& why, std::string const& remedy) {
    if (first_time) owner.problem(why, remedy);
    return 0.0;
  };
  std::string const missing = fmt::format("'{}' has no 'units'", instance.group);
  if (!units && stated > 0) return refuse(missing, fmt::format("write units: from_file ({})", source));
  if (!units) return refuse(fmt::format("{}: {}", missing, sizes), "write units: mm");
  if (text == "from_file") return stated > 0 ? stated : refuse(fmt::format("{}: {}", source, sizes), "write units: mm");
  auto const unit = parse_unit(text);
  if (!unit || !(unit->dimension == dim::length))
    return refuse(fmt::format("'{}' is not a unit of length: {}", text, sizes), "write units: mm");
  return unit->si;
}

void warn_of_file(Node const& file, std::string const& what, std::string const& suggestion) {
  if (Document* const document = file.document())
    document->add({document->place_in_file(file, file.text(), 0, 0), what, suggestion, Severity::warning});
}

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

std::string cad_text(Node const& file) {
  std::string const name = file.as_word(), bytes = file.data_file(name);
  if (bytes.empty()) {
    if (file.healthy()) file.problem(fmt::format("file '{}' is empty", name), "export it again");
    return "";
  }
  if (is_converted(name)) return bytes;
  auto const text = file.document()->derived_file(file, name + ".cad.json", [&]() -> std::optional<std::string> {
    StepConversion made = convert_step(name, bytes);
    if (!made.text.empty()) return std::move(made.text);
    file.file_problem(name, 0, 0, made.fault.what, made.fault.suggestion);
    return {};
  });
  return text.value_or("");
}

namespace {

std::shared_ptr<LoadedCad> load(Node const& file, CadLibrary& library) {
  std::string const name = file.as_word();
  auto& slot = library[fmt::format("{}:{}", file.place().file, name)];
  if (slot) return slot;
  slot = std::make_shared<LoadedCad>();
  std::string const text = cad_text(file);
  if (text.empty()) return slot;
  MeshFault const fault = read_cad_file(text, slot->file);
  if (!fault.what.empty()) {
    slot->file.parts.clear();
    file.file_problem(name, 0, 0, fault.what, fault.suggestion);
  }
  for (MeshFault const& note : slot->file.notes) warn_of_file(file, note.what, note.suggestion);
  return slot;
}

std::vector<CadPart> const& parts_of(LoadedCad& cad, double scale, Storage& storage) {
  auto const [slot, fresh] = cad.scaled.try_emplace(scale);
  if (!fresh) return slot->second;
  for (CadFilePart const& p : cad.file.parts) {
    CadPart& part = slot->second.emplace_back();
    part.label = {p.name, "", p.colour};
    for (CadFileFace const& f : p.faces) part.faces.push_back(cad_shape(f, scale, storage));
    if (!p.triangles.empty()) part.triangles = prepare_mesh(p.vertices, p.triangles, storage);
  }
  return slot->second;
}

// m per metre of the file; 0, and a problem, when it is not known.
double read_scale(Scene::Instance const& instance, CadFile const& cad, bool first_time) {
  Node const units = instance.node.has("units") ? instance.node["units"] : instance.placement["units"];
  if (cad.unit == 0) {
    if (units && units.text() == "from_file") return 1;
    if (first_time)
      (units ? units : instance.placement).problem("the file uses several units of length", "write units: from_file");
    return 0;
  }
  double const stated = cad.unit_stated ? cad.unit : 0;
  std::string const source =
      cad.unit_stated ? fmt::format("the file says {:g} m", cad.unit) : "this file states no unit";
  return read_file_unit(instance, cad.box_in_unit(), stated, source, first_time) / cad.unit;
}

// Adds surfaces under the names of one part.
class PartSurfaces {
 public:
  PartSurfaces(Scene::Instance const& instance, std::string const& part, Surface const& as, World& world,
               Registry& names)
      : tail_(part.empty() ? "" : "/" + part), instance_(instance), as_(as), world_(world), names_(names) {
    as_.group = world.add_group(instance.group + tail_);
  }
  void turn_to(Surface const& materials) {  // and volume, of the faces that follow
    as_.front = materials.front;
    as_.back = materials.back;
    as_.volume = materials.volume;
  }
  template <class Shape>
  void add(Shape const& shape) {
    SurfaceId const id = world_.add_surface(shape, as_.front, as_.back, as_.body, as_.group, as_.volume);
    std::string const face = ++count_ == 1 ? "" : fmt::format("/face_{}", count_);
    names_.surfaces.try_emplace(instance_.name + tail_ + face, id);
    names_.surfaces.try_emplace(instance_.group + tail_ + face, id);
    names_.surfaces.try_emplace(instance_.name, id);
  }

 private:
  std::string tail_;
  Scene::Instance const& instance_;
  Surface as_;
  World& world_;
  Registry& names_;
  std::size_t count_ = 0;
};

void add_part(CadPart const& part, Pose const& pose, double scale, PartSurfaces& to) {
  for (PlacedCadShape const& face : part.faces)
    std::visit(
        [&](auto shape) {
          shape.place(nested(pose, face.frame));
          to.add(shape);
        },
        face.shape);
  if (part.triangles.triangles.size == 0) return;
  TriangleMesh mesh;
  mesh.unit = scale;
  mesh.content = part.triangles;
  mesh.place(pose);
  to.add(mesh);
}

}  // namespace

void add_cad(Scene::Instance const& instance, Node const& file, Pose const& pose, Surface as, std::string const& side,
             FillPart const& fill, bool first_time, World& world, Registry& names, CadLibrary& library) {
  auto const cad = load(file, library);
  PartRules rules(instance, "surfaces", first_time), media(instance, "medium", first_time);
  if (cad->file.parts.empty()) {
    instance.placement.has("units");
    instance.node.has("units");
    return;
  }
  double const known = read_scale(instance, cad->file, first_time), scale = known > 0 ? known : 1;
  if (known > 0 && first_time)
    if (MeshAdvice const odd = scale_advice(cad->file.box, scale); !odd.what.empty())
      warn_of_file(file, odd.what, odd.suggestion);
  world.anchor(as.body, pose.origin);
  std::uint32_t const whole = as.volume;
  std::map<std::string, PartSurfaces> by_name;
  std::vector<PartLabel> labels;
  for (CadPart const& part : parts_of(*cad, scale, world.storage)) {
    labels.push_back(part.label);
    std::uint32_t const optic = rules.optic(part.label, names);
    as.front = side == "back" || side == "inner" ? names.black : optic;
    as.back = side == "front" || side == "outer" ? names.black : optic;
    Node const medium = media.of(part.label);
    as.volume = medium ? fill(medium, part.label.name) : whole;
    auto const [to, fresh] = by_name.try_emplace(part.label.name, instance, part.label.name, as, world, names);
    to->second.turn_to(as);
    add_part(part, pose, scale, to->second);
  }
  if (!first_time) return;
  rules.report(instance, file.as_word(), labels);
  media.report(instance, file.as_word(), labels);
}

namespace {

Pose about(Pose const& p, Vec3 origin, bool turned) {  // turned: by half a turn about e1
  return turned ? Pose{origin, p.e1, -p.e2, -p.e3} : Pose{origin, p.e1, p.e2, p.e3};
}

// Factors of the coordinates of the chart when lengths grow by `s`.
ChartCorner chart_scale(Carrier carrier, double s) {
  switch (carrier) {
    case Carrier::plane:
      return {s, s};
    case Carrier::cone:
      return {1, s * s};
    case Carrier::torus:
      return {1, 1};
    default:
      return {1, s};
  }
}

PlacedCadShape trimmed(CadFileFace const& f, std::vector<ChartLoop> loops, double scale, Storage& storage) {
  ChartCorner const by = chart_scale(f.carrier, scale);
  for (ChartLoop& loop : loops)
    for (ChartCorner& c : loop) c = {c.x * by.x, c.y * by.y, c.bulge};
  CadFace face;
  face.carrier = f.carrier;
  face.radius = f.radius * scale;
  face.second = f.carrier == Carrier::torus ? f.second * scale : f.second;
  face.sense = f.flipped ? -1 : 1;
  face.outline = prepare_outline(loops, storage);
  return {face, about(f.frame, scale * f.frame.origin, false)};
}

// Natural bounds of a face with an inward normal, as a window of its chart.
std::vector<ChartLoop> window(CadFileFace const& f) {
  double low = f.from, high = f.to;
  if (f.carrier == Carrier::cone) {
    low *= f.from;
    high *= f.to;
  } else if (f.carrier == Carrier::torus) {
    low = 0;
    high = 1;
  }
  return {{{0, low}, {1, low}, {1, high}, {0, high}}};
}

PlacedCadShape natural_sphere(CadFileFace const& f, double s, Storage& storage) {
  double const r = f.radius;
  bool const upper = f.to >= r, lower = f.from <= -r;
  double const rim = upper ? f.from : -f.to;  // height of the rim towards the pole
  if (upper != lower && rim > 1e-3 * r) {
    Cap cap;
    cap.curvature = (f.flipped ? 1 : -1) / (s * r);
    cap.outer_radius = s * std::sqrt((r - rim) * (r + rim));
    Vec3 const vertex = s * (f.frame.origin + (upper ? r : -r) * f.frame.e3);
    return {cap, about(f.frame, vertex, upper == f.flipped)};
  }
  if (f.flipped) return trimmed(f, window(f), s, storage);
  Pose const here = about(f.frame, s * f.frame.origin, false);
  if (upper && lower) {
    Sphere sphere;
    sphere.radius = s * r;
    return {sphere, here};
  }
  Zone zone;
  zone.radius = s * r;
  zone.from = s * f.from;
  zone.to = s * f.to;
  return {zone, here};
}

}  // namespace

PlacedCadShape cad_shape(CadFileFace const& f, double s, Storage& storage) {
  if (!f.natural) return trimmed(f, f.loops, s, storage);
  if (f.carrier == Carrier::plane) {
    Disk disk;
    disk.inner_radius = s * f.from;
    disk.outer_radius = s * f.to;
    return {disk, about(f.frame, s * f.frame.origin, f.flipped)};
  }
  if (f.carrier == Carrier::sphere) return natural_sphere(f, s, storage);
  if (f.flipped) return trimmed(f, window(f), s, storage);
  Pose const here = about(f.frame, s * f.frame.origin, false);
  if (f.carrier == Carrier::cylinder) {
    Cylinder c;
    c.radius = s * f.radius;
    c.from = s * f.from;
    c.to = s * f.to;
    return {c, here};
  }
  if (f.carrier == Carrier::torus) {
    Torus t;
    t.major_radius = s * f.radius;
    t.minor_radius = s * f.second;
    return {t, here};
  }
  Cone c;
  c.inner_radius = s * f.from;
  c.outer_radius = s * f.to;
  c.half_angle = f.second;
  return {c, about(f.frame, s * f.frame.origin + (s * f.from / std::tan(f.second)) * f.frame.e3, false)};
}

}  // namespace straytrace::world
