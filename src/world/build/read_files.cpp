// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/read_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/document.hpp"
#include "base/text/words.hpp"
#include "geometry/mesh/triangle_mesh.hpp"
#include "world/import/geometry_file.hpp"

namespace straytrace::world {

// A part as its file names it. Rules match the complete name, "tower/dump", or its last piece, "dump".
struct PartLabel {
  std::string name, material, colour;  // colour "#rrggbb"; empty: not in the file
};

namespace {

// Rows of the table `surfaces` or `medium` of an entry, in the order of the scene, then its default, then for
// `surfaces` the `material` of the entry: the first match counts.
class PartRules {
 public:
  PartRules(Scene::Instance const&, std::string_view table, bool first_time);
  // The value for a part; empty: no rule matches.
  Node of(PartLabel const&);
  // The optic of a part; if no rule matches, the black one, and report() says so.
  std::uint32_t optic(PartLabel const&, Registry const&);
  // One problem for rules that match nothing, one for parts without material. `parts`: all parts of the file `name`.
  void report(Scene::Instance const&, std::string const& name, std::vector<PartLabel> const& parts) const;

 private:
  struct Rule {
    std::string pattern, colour;  // of a rule by colour only the colour
    Node says;
    bool used = false;
    bool fits(PartLabel const&) const;
  };
  void add(std::string const& pattern, Node const& says, bool complain);

  std::vector<Rule> rules_;
  std::vector<std::string> bare_;
};

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
    if (!word.empty() && std::ranges::find(words, word) == words.end()) words.push_back(word);
  };
  for (PartLabel const& p : parts) add(last_piece(p.name));
  for (PartLabel const& p : parts) add(p.name);
  for (PartLabel const& p : parts) add(p.material);
  for (PartLabel const& p : parts) add(p.colour.empty() ? "" : std::string(by_colour) + p.colour);
  return words;
}

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
    if (std::ranges::find(bare_, shown) == bare_.end()) bare_.push_back(shown);
    return names.black;
  }
  std::string const name = material.as_word();
  if (auto const hit = names.materials.find(name); hit != names.materials.end()) return hit->second;
  std::vector<std::string> known;
  for (auto const& entry : names.materials) known.push_back(entry.first);
  if (!name.empty())
    material.problem(fmt::format("material '{}' is not defined", name),
                     did_you_mean(name, known, fmt::format("defined: {}", fmt::join(known, ", "))));
  return names.black;
}

void PartRules::report(Scene::Instance const& instance, std::string const& name,
                       std::vector<PartLabel> const& parts) const {
  std::vector<std::string> const words = words_of(parts);
  std::string const all = words.empty() ? "the file names no parts and no materials; write only 'default'"
                                        : fmt::format("it has: {}", some_of(words));
  for (Rule const& r : rules_) {
    if (r.used) continue;
    r.says.problem(fmt::format("no part, material or colour of '{}' matches '{}'", name, r.pattern),
                   did_you_mean(r.pattern, words, all));
  }
  if (bare_.empty()) return;
  instance.placement.problem(fmt::format("parts of '{}' have no material: {}", name, some_of(bare_)),
                             fmt::format("write surfaces: {{{}default: NAME}}",
                                         bare_.front().empty() ? "" : fmt::format("\"{}\": NAME, ", bare_.front())));
}

Node units_of(Scene::Instance const& instance) {
  return instance.node.has("units") ? instance.node["units"] : instance.placement["units"];
}

// m per unit of the file; 0 after a problem. `box`: in units of the file. `stated`: m, the unit that the file states,
// or 0. `source` for messages: "its format says m".
double read_file_unit(Scene::Instance const& instance, Box const& box, double stated, std::string const& source,
                      bool first_time) {
  Node const units = units_of(instance);
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

}  // namespace

struct LoadedMesh {
  MeshFile file;
  std::vector<MeshContent> content;  // of each part
  bool sound = false;
};

// The faces of one name and colour, for which rules choose the material.
struct CadPart {
  PartLabel label;
  std::vector<PlacedCadShape> faces;
  MeshContent triangles;  // m of the file; none when empty
};
struct LoadedCad {
  CadFile file;
  std::map<double, std::vector<CadPart>> scaled;  // by m per metre of the file
};

namespace {

std::shared_ptr<LoadedMesh const> load(Node const& file, World& world, FileLibrary& library) {
  std::string const name = file.as_word(), folder = name.substr(0, name.rfind('/') + 1);
  auto& slot = library.meshes[fmt::format("{}:{}", file.place().file, name)];
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
  if (MeshFault const flat = without_area(health); !flat.what.empty()) {
    file.file_problem(name, 0, 0, flat.what, flat.suggestion);
    return slot;
  }
  for (MeshAdvice const& a : advice(mesh->file, health)) warn_of_file(file, a.what, a.suggestion);
  repair(mesh->file, health);
  for (MeshPart& part : mesh->file.parts)
    mesh->content.push_back(prepare_mesh(std::move(part.vertices), std::move(part.triangles), world.storage));
  mesh->sound = !mesh->file.parts.empty();
  return slot;
}

std::string part_name(LoadedMesh const& mesh, std::size_t i) {
  MeshPart const& part = mesh.file.parts[i];
  if (!part.name.empty()) return part.name;
  if (!part.material.empty()) return part.material;
  return mesh.file.parts.size() == 1 ? "" : fmt::format("part_{}", i + 1);
}

// The converted text of a STEP file, or the file itself if it is converted; stored with the other texts of the model.
// Empty after a problem.
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

std::shared_ptr<LoadedCad> load(Node const& file, FileLibrary& library) {
  std::string const name = file.as_word();
  auto& slot = library.cads[fmt::format("{}:{}", file.place().file, name)];
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
  Node const units = units_of(instance);
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

// The parts of a file on their way into the world.
class PartAdder {
 public:
  PartAdder(PlacedFile const& from, World& world, Registry& names)
      : from_(from),
        world_(world),
        names_(names),
        rules_(from.instance, "surfaces", from.first_time),
        media_(from.instance, "medium", from.first_time),
        as_(from.as) {}
  // Warns of an implausible size; 1 where the unit is not known.
  double checked(double unit, Box const& box) const {
    if (unit > 0 && from_.first_time)
      if (MeshAdvice const odd = scale_advice(box, unit); !odd.what.empty())
        warn_of_file(from_.file, odd.what, odd.suggestion);
    return unit > 0 ? unit : 1;
  }
  // Part of the surfaces that follow.
  void turn_to(PartLabel const& part) {
    labels_.push_back(part);
    set_sides(as_, from_.side, rules_.optic(part, names_), names_.black);
    Node const medium = media_.of(part);
    as_.volume = medium ? from_.fill(medium, part.name) : from_.as.volume;
    tail_ = part.name.empty() ? "" : "/" + part.name;
    as_.group = world_.add_group(from_.instance.group + tail_);
  }
  template <class Shape>
  void add(Shape shape, Pose const& pose, std::string const& face = "") {
    shape.place(pose);
    SurfaceId const id = world_.add_surface(shape, as_);
    names_.surfaces.try_emplace(from_.instance.name + tail_ + face, id);
    names_.surfaces.try_emplace(from_.instance.group + tail_ + face, id);
    names_.surfaces.try_emplace(from_.instance.name, id);
  }
  void add_mesh(MeshContent const& content, double unit, std::string const& face = "") {
    TriangleMesh mesh;
    mesh.unit = unit;
    mesh.content = content;
    add(mesh, from_.pose, face);
  }
  std::string next_face() {
    std::size_t const number = ++faces_[tail_];
    return number == 1 ? "" : fmt::format("/face_{}", number);
  }
  void report() const {
    if (!from_.first_time) return;
    rules_.report(from_.instance, from_.file.as_word(), labels_);
    media_.report(from_.instance, from_.file.as_word(), labels_);
  }

 private:
  PlacedFile const& from_;
  World& world_;
  Registry& names_;
  PartRules rules_, media_;
  Surface as_;
  std::string tail_;
  std::map<std::string, std::size_t> faces_;  // so far, by part
  std::vector<PartLabel> labels_;
};

// The key `smooth` of an entry: normals of the file, or those of triangles that meet at no more than an angle.
class Smoothing {
 public:
  Smoothing(PlacedFile const& from, FileLibrary& library, Storage& storage)
      : from_(from), library_(library), storage_(storage) {
    node_ = from.instance.placement["smooth"];
    if (!node_) return;
    by_file_ = node_.kind() == Node::Kind::scalar && node_.text() == "from_file";
    if (!by_file_) angle_ = node_.as_number(dim::angle, 0, pi / 2);
  }
  MeshContent of(LoadedMesh const& mesh, std::size_t part) {
    MeshContent const& flat = mesh.content[part];
    std::vector<MeshVertex> const& stated = mesh.file.parts[part].normals;
    if (!node_ || (!by_file_ && !std::isfinite(angle_))) return flat;
    bool const any = std::ranges::any_of(mesh.file.parts, [](MeshPart const& p) { return !p.normals.empty(); });
    if (by_file_ && stated.empty()) {
      if (from_.first_time && !any)
        node_.problem(fmt::format("'{}' states no normals at the corners of its triangles", mesh.file.name),
                      "write smooth: 30 deg, the largest angle between triangles of one smooth surface");
      return flat;
    }
    std::string const key = fmt::format("{}:{}:{}:{}", from_.file.place().file, mesh.file.name, part,
                                        by_file_ ? std::string("file") : fmt::format("{}", angle_));
    auto const [slot, fresh] = library_.smooth.try_emplace(key);
    if (fresh) slot->second = by_file_ ? smoothed(flat, stated, storage_) : smoothed(flat, angle_, storage_);
    return slot->second;
  }

 private:
  PlacedFile const& from_;
  FileLibrary& library_;
  Storage& storage_;
  Node node_;
  bool by_file_ = false;
  double angle_ = 0;
};

void add_mesh(PlacedFile const& from, LoadedMesh const& mesh, Smoothing& smoothing, PartAdder& adder) {
  double const stated = mesh.file.stated_unit;
  Box box;
  for (MeshContent const& c : mesh.content) box.add(c.box);
  std::string const source = stated > 0 ? "its format says m" : "files of this format state no unit";
  double const unit = adder.checked(read_file_unit(from.instance, box, stated, source, from.first_time), box);
  for (std::size_t i = 0; i < mesh.file.parts.size(); ++i) {
    adder.turn_to({part_name(mesh, i), mesh.file.parts[i].material, mesh.file.parts[i].colour});
    adder.add_mesh(smoothing.of(mesh, i), unit);
  }
}

void add_cad(PlacedFile const& from, LoadedCad& cad, World& world, PartAdder& adder) {
  double const scale = adder.checked(read_scale(from.instance, cad.file, from.first_time), cad.file.box);
  world.anchor(from.as.body, from.pose.origin);
  for (CadPart const& part : parts_of(cad, scale, world.storage)) {
    adder.turn_to(part.label);
    for (auto const& [any, frame] : part.faces)
      std::visit(
          [&, &frame = frame](auto const& shape) { adder.add(shape, nested(from.pose, frame), adder.next_face()); },
          any);
    if (part.triangles.triangles.size > 0) adder.add_mesh(part.triangles, scale, adder.next_face());
  }
}

}  // namespace

void add_file(PlacedFile const& from, World& world, Registry& names, FileLibrary& library) {
  std::string const name = from.file.as_word();
  bool const is_cad = is_step(name) || is_converted(name);
  auto const cad = is_cad ? load(from.file, library) : nullptr;
  auto const mesh = is_cad ? nullptr : load(from.file, world, library);
  PartAdder adder(from, world, names);
  Smoothing smoothing(from, library, world.storage);
  if (is_cad ? cad->file.parts.empty() : !mesh->sound) {
    from.instance.placement.has("units");
    from.instance.node.has("units");
    return;
  }
  if (is_cad)
    add_cad(from, *cad, world, adder);
  else
    add_mesh(from, *mesh, smoothing, adder);
  adder.report();
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
