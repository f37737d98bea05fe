// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/read_cad.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/input/document.hpp"
#include "world/import/cad_file.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace {

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

// Natural bounds of a face that looks inwards, as a window of its chart.
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

}  // namespace straytrace
