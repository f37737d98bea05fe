// SPDX-License-Identifier: BSD-3-Clause
// Warnings about glass without effect, closed volumes and beams.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "optics/coating/specular.hpp"
#include "world/build/read_parts.hpp"
#include "world/checks/faces.hpp"
#include "world/ghosts/apertures.hpp"
#include "world/ghosts/beam_tree.hpp"
#include "world/model/diffraction.hpp"

namespace straytrace::world {
namespace {

bool is_bare_boundary(World const& world, std::uint32_t optic) {
  Optic const& o = world.view().optics[optic];
  if (!o.has_interface) return false;
  return world.view().interfaces.visit(o.interface, [](auto const& interface) {
    if constexpr (std::is_same_v<std::decay_t<decltype(interface)>, Fresnel>)
      return interface.opaque.re == 0 && interface.opaque.im == 0;
    else
      return false;
  });
}

// Shares at normal incidence on the outer side (front) or the inner side of a face of glass.
SpecularShares shares(World const& world, std::uint32_t optic, bool front) {
  constexpr double glass = 1.45;  // for film and bare boundary; coatings do not depend on it
  WorldView const view = world.view();
  return specular_shares(view.interfaces, view.optics[optic], 1, front ? 1 : glass, front ? glass : 1, front);
}

std::string const& name_of(World const& world, std::uint32_t surface) { return world.name_of({surface}); }

void warn_of_bare_boundaries(Scene const& scene, World const& world) {
  std::set<std::uint32_t> told;
  for (Surface const& s : world.surfaces()) {
    if (s.volume != Surface::none || !(is_bare_boundary(world, s.front) || is_bare_boundary(world, s.back))) continue;
    if (!told.insert(s.group.value).second) continue;
    std::string const name = world.groups()[s.group.value], part = name.substr(name.rfind('/') + 1);
    scene.root()["scene"].warning(
        fmt::format("'{}' is a bare boundary (specular: fresnel), but nothing is filled with glass there: it neither "
                    "reflects nor refracts",
                    name),
        fmt::format("give it a medium, 'medium: fused_silica'; one part of a file: 'medium: {{{}: fused_silica}}'",
                    part));
  }
}

// The entry that places a surface; of faces of a file the scene as a whole.
Node entry_of(Scene const& scene, Registry const& names, std::uint32_t surface) {
  for (Scene::Instance const& instance : scene.instances()) {
    auto const found = names.surfaces.find(instance.name);
    if (found != names.surfaces.end() && found->second.value == surface) return instance.placement;
  }
  return scene.root()["scene"];
}

// Glass whose faces all reflect most of the light: light inside circulates between them, and hardly any leaves.
void warn_of_traps(Scene const& scene, World const& world, Registry const& names) {
  std::set<std::string> told;
  for (std::vector<std::uint32_t> const& faces : faces_of_volumes(world)) {
    std::string text;
    std::size_t clear = 0;
    bool trap = true;
    for (std::uint32_t const id : faces) {
      Surface const& s = world.surfaces()[id];
      if (!lets_light_in(world, s.front)) continue;
      double const reflected = shares(world, s.back, false).reflect;
      trap = trap && reflected > 0.5;
      if (++clear <= 3) text += fmt::format("{}'{}' {:.6g}", clear > 1 ? ", " : "", name_of(world, id), reflected);
    }
    if (!trap || clear < 2 || !told.insert(text).second) continue;
    entry_of(scene, names, faces.front())
        .warning(
            fmt::format(
                "light that enters glass is trapped in it, since all its clear faces reflect most of it ({}{}): next "
                "to nothing passes",
                text, clear > 3 ? ", ..." : ""),
            "'material' of an entry covers all its faces: give the others their own, 'surfaces: {back: ar_window, "
            "barrel: "
            "black}'");
  }
}

// A part, or a single shape, of the scene.
struct Solid {
  std::string entry;
  Node where;
  Node medium;  // as stated
  std::vector<std::uint32_t> faces;
  std::size_t clear = 0;  // faces that let light in
  bool filled = false;
  bool optic = false;  // a part that is filled with glass as soon as a face lets light in
};

std::map<std::string, Solid> solids(Scene const& scene, World const& world, Registry const& names) {
  std::map<std::string, Solid> all;
  for (Scene::Instance const& instance : scene.instances()) {
    auto const found = names.surfaces.find(instance.name);
    if (found == names.surfaces.end() || instance.node["file"]) continue;
    std::size_t const slash = instance.name.rfind('/');
    Solid& solid = all[instance.name.substr(0, slash)];
    solid.entry = instance.group.substr(0, instance.group.find_first_of("["));
    if (slash != instance.name.npos) solid.entry = instance.group.substr(0, instance.group.rfind('/'));
    solid.where = instance.placement;
    Surface const& s = world.surfaces()[found->second.value];
    if (Node const at_face = instance.node["medium"], medium = at_face ? at_face : instance.placement["medium"]; medium)
      solid.medium = medium;
    solid.faces.push_back(found->second.value);
    solid.filled = solid.filled || s.volume != Surface::none;
    solid.optic = solid.optic || instance.usual_medium;
    solid.clear += lets_light_in(world, s.front);
  }
  return all;
}

void warn_of_solids(Scene const& scene, World const& world, Registry const& names) {
  std::set<std::string> told;
  for (auto const& [name, solid] : solids(scene, world, names)) {
    if (solid.filled && solid.medium && solid.clear == 0) {
      if (told.insert(solid.entry).second)
        solid.where.warning(fmt::format("'{}' is filled with '{}', but none of its faces lets light in", solid.entry,
                                        solid.medium.text()),
                            "give a face 'specular: {reflect: ..., transmit: ...}', or leave out 'medium'");
      continue;
    }
    bool const alone = solid.faces.size() == 1;
    if (solid.filled || solid.medium || solid.clear < (alone ? 1 : 2)) continue;
    if (!encloses(world, solid.faces) || !told.insert(solid.entry).second) continue;
    solid.where.warning(
        fmt::format("'{}' lets light through its faces, but nothing is between them: it does not refract", solid.entry),
        "give it a medium, 'medium: fused_silica', or say that there is none, 'medium: none'");
  }
}

// Surfaces on which the main beam of a launch ends, neither reflected nor transmitted.
class LastSurfaces final : public BeamSink {
 public:
  explicit LastSurfaces(BeamLaunch const& launch) : launch_(launch) {}
  void ended(BeamEnd how, BeamSpot const* spot, LeavingBeam const&, std::span<BeamStep const> way) override {
    bool const mirror_of_cavity = way.empty() && launch_.arrives_at.valid();
    if (how == BeamEnd::landed && spot && spot->order == 0 && !mirror_of_cavity) all.insert(spot->surface.value);
  }
  std::set<std::uint32_t> all;

 private:
  BeamLaunch const& launch_;
};

// A lens or mirror substrate without a face that lets light in has no medium: a beam that meets it ends there.
void warn_of_opaque_optics(Scene const& scene, World const& world, Registry const& names) {
  std::map<std::uint32_t, Solid const*> opaque;  // by surface
  auto const parts = solids(scene, world, names);
  for (auto const& [name, solid] : parts)
    if (solid.optic && !solid.filled && !solid.medium && solid.clear == 0)
      for (std::uint32_t const face : solid.faces) opaque[face] = &solid;
  if (opaque.empty()) return;
  constexpr double floor = 1e-6;  // of the launched power
  std::set<std::string> told;
  for (BeamLaunch const& launch : launches(world)) {
    LastSurfaces last(launch);
    grow_tree(world, launch, {floor, 0}, last);
    for (std::uint32_t const surface : last.all) {
      auto const found = opaque.find(surface);
      if (found == opaque.end() || !told.insert(found->second->entry).second) continue;
      found->second->where.warning(
          fmt::format("'{}' is opaque: beam '{}' ends on it and is not refracted, as none of its faces lets light in",
                      found->second->entry, world.beams.at(launch.beam).name),
          "give its faces a material with 'specular: {reflect: ..., transmit: ...}', or write 'medium: none' where the "
          "beam should end");
    }
  }
}

}  // namespace

bool lets_light_in(World const& world, std::uint32_t optic) {
  Optic const& o = world.view().optics[optic];
  if (std::any_of(o.through, o.through + o.laws, [](bool through) { return through; })) return true;
  return shares(world, optic, true).transmit > 0;
}

void check_glass(Scene const& scene, World const& world, Registry const& names) {
  warn_of_bare_boundaries(scene, world);
  warn_of_traps(scene, world, names);
  warn_of_solids(scene, world, names);
  warn_of_opaque_optics(scene, world, names);
}

// Grooves without a direction: their lay is the normal of a flat surface.

namespace {

// Whether the direction of the grooves is the normal of a flat surface: then their direction is undefined.
bool lay_vanishes(WorldView const& view, Surface const& s, Optic const& o) {
  if (o.lay != Lay::along && o.lay != Lay::given) return false;
  return view.shapes.visit(s.shape, [&](auto const& shape) {
    using Shape = std::decay_t<decltype(shape)>;
    if constexpr (std::is_same_v<Shape, Disk> || std::is_base_of_v<PlaneFrame, Shape>)
      return o.lay == Lay::along || length(cross(o.lay_direction, shape.axis)) < 1e-9;
    else
      return false;
  });
}

// Whether the lines of a grating, counted across the grooves and the axis of the shape, have no spacing on it.
bool lines_vanish(World const& world, SurfaceId id, std::uint32_t optic) {
  WorldView const view = world.view();
  if (!view.optics[optic].diffracts) return false;
  SurfacePoint const at =
      view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return sample_of(s, 0.3, 0.3); });
  Vertex v;
  v.surface = id;
  v.point = at.point;
  v.optic = &view.optics[optic];
  v.frame = Frame::around(view.normal(id, at.point, at.piece));
  double place = 0;
  return length(across_grooves(view, v, place)) < 0.5;
}

}  // namespace

void check_lays(Scene const& scene, World const& world) {
  WorldView const view = world.view();
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    Surface const& s = world.surfaces()[id];
    if (lines_vanish(world, {id}, s.front) || lines_vanish(world, {id}, s.back))
      scene.root()["scene"].problem(
          fmt::format("the lines of the grating '{}' have no spacing along its surface", world.groups()[s.group.value]),
          "put gratings on faces across the axis of their shape (disk, rectangle, cap), with grooves along the face");
  }
  for (Surface const& s : world.surfaces())
    if (lay_vanishes(view, s, view.optics[s.front]) || lay_vanishes(view, s, view.optics[s.back]))
      scene.root()["scene"].warning(
          fmt::format("the grooves of '{}' run along its normal: on the surface they have no direction",
                      world.groups()[s.group.value]),
          "write lay: around, or a direction that lies in the surface");
}

// Whether the surfaces of a filled volume are closed, with outward normals, from samples of each surface. A few samples
// decide for most bodies; the others need many.

namespace {

constexpr int few = 1 << 10, many = 1 << 14;  // samples per surface
constexpr double tolerance = 0.01;            // of the integrals of the magnitudes; `many` give them to about 1e-3
constexpr double clearly = 0.25;              // of the tolerance: `few` samples decide as `many` would

using Faces = std::vector<std::uint32_t>;

template <class Add>
void each_sample(WorldView const& view, Faces const& faces, int samples, Add const& add) {
  for (std::uint32_t const id : faces) {
    double const share =
        view.shapes.visit(view.surfaces[id].shape, [&](auto const& shape) { return shape.area() / samples; });
    for (FaceSample const& p : face_samples(view, id, samples)) add(p, share);
  }
}

BodyIntegrals body_integrals(WorldView const& view, Faces const& faces, int samples) {
  Vec3 middle;
  double area = 0;
  each_sample(view, faces, few / 8, [&](FaceSample const& p, double share) {
    middle = middle + share * p.point;
    area += share;
  });
  BodyIntegrals sums;
  each_sample(view, faces, samples,
              [&](FaceSample const& p, double share) { sums.add(p.point - (1 / area) * middle, p.normal, share); });
  return sums;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> faces_of_volumes(World const& world) {
  std::vector<Faces> faces;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    std::uint32_t const volume = world.surfaces()[id].volume;
    if (volume == Surface::none) continue;
    if (volume >= faces.size()) faces.resize(volume + 1);
    faces[volume].push_back(id);
  }
  return faces;
}

std::string volume_fault(World const& world, std::vector<std::uint32_t> const& faces) {
  WorldView const view = world.view();
  BodyIntegrals const guess = body_integrals(view, faces, few);
  if (!(guess.area > 0) || (guess.closed(clearly * tolerance) && guess.enclosed() > 0)) return {};
  BodyIntegrals const found = body_integrals(view, faces, many);
  if (!found.closed(tolerance))
    return "the faces with this medium do not close, or some of their normals point into it";
  if (!(found.enclosed() > 0)) return "the normals of the faces with this medium all point into it";
  return {};
}

bool encloses(World const& world, std::vector<std::uint32_t> const& faces) {
  return body_integrals(world.view(), faces, few).enclosed() > 0 && volume_fault(world, faces).empty();
}

// Beams without effect: they meet only absorbing sides, or no surface at all.

namespace {

constexpr int across = 64;  // lines tried in radius, and in azimuth

// Whether `found` holds for the chief line or any other of the beam.
template <class Found>
bool any_line(Footprint const& f, Found const& found) {
  if (found(Ray{f.centre - f.backoff * f.travel, f.travel})) return true;
  for (int i = 0; i < across; ++i)
    for (int k = 0; k < across; ++k)
      if (found(f.sample((i + 0.5) / across, (k + 0.5) / across))) return true;
  return false;
}

bool meets_plane(World const& world, Ray const& ray) {  // a measuring plane
  WorldView const view = world.view();
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id)
    if (view.surfaces[id].clear && view.cross(id, ray, {}).distance < infinity) return true;
  return false;
}

void check_free(Node const& beam, std::string const& name, Footprint const& f, World const& world) {
  WorldView const view = world.view();
  bool const met = any_line(f, [&](Ray line) {
    line.dir = f.direction(line.origin);
    return view.closest(line, {}).surface.valid() || meets_plane(world, line);
  });
  if (!met) beam.warning(fmt::format("beam '{}' meets no surface", name), "turn 'facing', or move 'from'");
}

std::string opposite(Vec3 v) { return fmt::format("[{:g}, {:g}, {:g}]", 0 - v.x, 0 - v.y, 0 - v.z); }

void check_spot(Node const& beam, std::string const& name, Footprint const& f, World const& world) {
  WorldView const view = world.view();
  Surface const& surface = world.surfaces()[f.surface.value];
  std::string const& lit = world.groups()[surface.group.value];
  bool met = false, front = false;
  bool const alive = any_line(f, [&](Ray const& line) {
    Crossing const c = view.cross(f.surface.value, line, {});
    if (!(c.distance < infinity)) return false;
    met = true;
    front = dot(view.normal(f.surface, line.origin + c.distance * line.dir, c.piece), line.dir) < 0;
    return !only_absorbs(view.optics[front ? surface.front : surface.back]);
  });
  if (alive) return;
  if (!met)
    return beam.warning(fmt::format("beam '{}' does not meet '{}'", name, lit),
                        "change 'travel', 'centre' or 'radius'");
  bool const other = !only_absorbs(view.optics[front ? surface.back : surface.front]);
  beam.problem(fmt::format("beam '{}' lights the side of '{}' that only absorbs: no light starts there", name, lit),
               other
                   ? fmt::format("its light travels along {}: write 'travel: {}', or change 'side' or 'facing' of '{}'",
                                 opposite(-f.travel), opposite(f.travel), lit)
                   : fmt::format("give the material of '{}' a 'scatter', or 'specular'", lit));
}

// Light of one beam by propagation and of another by statement is probably the same light. A ghost is that of another
// beam only where the scene states it, with about its power.
bool same_light(World const& world, std::uint32_t followed, std::uint32_t other) {
  Footprint const &f = world.footprints()[followed], &g = world.footprints()[other];
  if (g.free || f.beam == g.beam || f.surface != g.surface || !f.emits || !g.emits) return false;
  if (world.feeds()[followed].order > 0 || world.feeds()[other].order > 0) {
    bool const alike = f.share < 3 * g.share && g.share < 3 * f.share;
    if (world.feeds()[other].propagated || !alike) return false;
  }
  return dot(f.travel, g.travel) > 0.99 && f.intensity(g.centre) > 0.1 * f.intensity(f.centre);
}
void warn_of_light_counted_twice(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  auto const count = std::uint32_t(world.footprints().size());
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = 0; world.feeds()[i].propagated && j < count; ++j)
      if (same_light(world, i, j))
        return beams[world.beams[world.footprints()[i].beam].entry].second.warning(
            fmt::format("'{}' is lit by beam '{}' too, along the same way",
                        world.groups()[world.surfaces()[world.footprints()[i].surface.value].group.value],
                        world.beams[world.footprints()[j].beam].name),
            "if it is the same light, keep one of them: it is counted twice");
}

// A beam that loses much power at a rim is no longer Gaussian behind it. read_lit.cpp reports the losses beside
// surfaces for beams with `lit`.
void warn_of_clipping(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  std::set<std::pair<std::uint32_t, std::uint32_t>> said;
  for (MainLoss const& loss : main_losses(world)) {
    GroupId const group = world.surfaces()[loss.surface.value].group;
    auto const& [name, entry, network, share] = world.beams.at(loss.beam);
    Node const node = beams.at(entry).second;
    bool const lit = node.has("lit");
    if ((loss.beside && lit) || !said.insert({loss.beam, group.value}).second) continue;
    node.warning(fmt::format("beam '{}' loses {:.2g} % {} '{}'", name, 100 * loss.share, loss.beside ? "beside" : "on",
                             world.groups()[group.value]),
                 "behind it the beam is still taken as Gaussian: widen the aperture or centre it on the beam");
  }
}

// Sub-paths behind glass do not follow polarisation.
void warn_of_glass_in_polarised_light(Scene const& scene, World const& world) {
  if (!world.polarised) return;
  for (auto const& [name, node] : scene.table("receivers").items())
    if (node.flag("behind_glass", false))
      node["behind_glass"].warning("'behind_glass' does nothing where a beam states its polarisation",
                                   "light by way of glass is then found by the walk alone, slowly");
}

}  // namespace

void check_beams(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.emits || f.standing || world.feeds()[i].propagated || f.beam >= beams.size()) continue;
    auto const& [name, node] = beams[f.beam];
    if (f.free)
      check_free(node, name, f, world);
    else
      check_spot(node, name, f, world);
  }
  warn_of_light_counted_twice(scene, world);
  if (scene.root().healthy()) warn_of_clipping(scene, world);
  warn_of_glass_in_polarised_light(scene, world);
}

}  // namespace straytrace::world
