// SPDX-License-Identifier: BSD-3-Clause
// The world the light sees: surfaces, optics, footprints of the beams, and the fast search for the closest hit.
// `World` owns; `WorldView` is pointers and sizes, passed by value to whatever traces.
#pragma once

#include <string>
#include <vector>

#include "base/pool.hpp"
#include "base/storage.hpp"
#include "base/vec3.hpp"
#include "beams/footprint.hpp"
#include "geometry/shape_types.hpp"
#include "optics/law_types.hpp"
#include "optics/specular_types.hpp"
#include "scene/scene.hpp"
#include "world/axial_tree.hpp"
#include "world/steering.hpp"

namespace straytrace {

using ShapePool = Pool<ShapeTypes>;

struct Surface {
  PoolRef shape;
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t front = 0, back = 0;  // optic on the side the normal points to, and on the other
  BodyId body;
  GroupId group;
  std::uint32_t volume = none;  // filled volume behind it: the normal points out of it
};

// A filled volume: glass of one lens. Volumes of instances of one part are different.
struct Volume {
  std::uint32_t medium = 0;
};

struct Medium {
  double index = 1;
  double absorption = 0;  // of power, 1/m
};

struct Hit {
  SurfaceId surface;
  double distance = infinity;  // m
  std::uint32_t piece = 0;     // of a surface made of pieces
};

// What a ray starts on: there the root at zero is not a hit.
struct Departure {
  SurfaceId surface;
  std::uint32_t piece = 0;
  SurfaceId contact;  // a second surface in contact with the first at this point (cemented, touching lenses)
  STRAY_HD Departure() = default;
  STRAY_HD Departure(SurfaceId s, std::uint32_t p = 0, SurfaceId c = {}) : surface(s), piece(p), contact(c) {}
  STRAY_HD bool on(std::uint32_t id) const { return id == surface.value || id == contact.value; }
};

// How the walk is bounded and whether the search structure is used; part of what decides a result.
struct WalkLimits {
  std::uint32_t max_order = 64;      // surface events after the source; light beyond is booked as `limit`
  double roulette_below = 0.1;       // of the power first scattered: below it paths survive by chance (unbiased)
  std::uint32_t route_vertices = 5;  // routes with more vertices than this are summed in the class `other`
  bool brute_force = false;          // test every surface: must give the same bits
};

struct WorldView {
  ShapePool shapes;
  LawPool laws;
  SpecularPool interfaces;
  View<Volume const> volumes;
  View<Medium const> media;
  View<Surface const> surfaces;
  View<Optic const> optics;
  View<Footprint const> lit;                 // all footprints
  View<std::uint32_t const> lit_of_surface;  // first receiving footprint on this surface, or none
  View<std::uint32_t const> emitters;        // footprints that emit
  AxialTree::View tree;
  Steering steering;  // empty: the scatter law alone
  WalkLimits limits;
  double wavelength = 0;  // m
  static constexpr std::uint32_t none = 0xffffffffu;

  // The smallest positive double distance, ties to the lower SurfaceId; `from` is the surface the ray starts on.
  STRAY_HD Hit closest(Ray const& ray, Departure from) const {
    Hit best{{}, ray.t_max};
    auto const test = [&](std::uint32_t id, double& limit) {
      Ray bounded = ray;
      bounded.t_max = infinity;
      Crossing const c = cross(id, bounded, from);
      double const t = c.distance;
      if (t < best.distance || (t == best.distance && best.surface.valid() && id < best.surface.value))
        best = {{id}, t, c.piece};
      limit = best.distance;
      return false;
    };
    search(ray, best.distance, test);
    return best;
  }
  // Whether anything lies between the origin and ray.t_max. `to_itself`: the ray ends on the surface it starts on,
  // whose only other root is that end: rounding of a grazing root must not hide it.
  STRAY_HD bool occluded(Ray const& ray, Departure from, bool to_itself = false) const {
    bool hidden = false;
    auto const test = [&](std::uint32_t id, double&) {
      if (to_itself && from.on(id)) return false;
      hidden = cross(id, ray, from).distance < infinity;
      return hidden;
    };
    search(ray, ray.t_max, test);
    return hidden;
  }
  STRAY_HD Crossing cross(std::uint32_t id, Ray const& ray, Departure from) const {
    return shapes.visit(surfaces[id].shape,
                        [&](auto const& s) { return crossing_of(s, ray, from.on(id), from.piece); });
  }
  STRAY_HD Vec3 normal(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return normal_of(s, p, piece); });
  }
  STRAY_HD Vec3 project(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return projected_on(s, p, piece); });
  }

 private:
  template <class Test>
  STRAY_HD void search(Ray const& ray, double limit, Test&& test) const {
    if (limits.brute_force) {
      for (std::uint32_t id = 0; id < surfaces.size; ++id)
        if (test(id, limit)) return;
    } else {
      tree.traverse(ray, limit, test);
    }
  }
};

struct Body {
  std::string name;
  Vec3 pivot;               // m, rotations are about it
  bool pivot_given = true;  // NaN given: the place of the body's first surface
};

// Owns all arrays. Built from a scene by build_world, or piece by piece by tests.
class World {
 public:
  std::uint32_t add_optic(Optic const&);
  std::uint32_t add_volume(Medium const&);
  template <class T>
  PoolRef add_interface(T const& coating) {
    auto& list = std::get<std::vector<T>>(interfaces_);
    list.push_back(coating);
    return {kind_of<T, SpecularTypes>(), std::uint32_t(list.size() - 1)};
  }
  template <class Law>
  PoolRef add_law(Law const& law) {
    auto& list = std::get<std::vector<Law>>(laws_);
    list.push_back(law);
    return {kind_of<Law, LawTypes>(), std::uint32_t(list.size() - 1)};
  }
  template <class Shape>
  SurfaceId add_surface(Shape const& shape, std::uint32_t front, std::uint32_t back, BodyId body, GroupId group,
                        std::uint32_t volume = Surface::none) {
    auto& list = std::get<std::vector<Shape>>(shapes_);
    list.push_back(shape);
    surfaces_.push_back(
        {{kind_of<Shape, ShapeTypes>(), std::uint32_t(list.size() - 1)}, front, back, body, group, volume});
    return {std::uint32_t(surfaces_.size() - 1)};
  }
  BodyId add_body(std::string name, Vec3 pivot);
  GroupId add_group(std::string const& name);  // the same id for the same name
  PortId add_port(std::string name);
  void add_footprint(Footprint);  // needs its surface to exist; sets backoff
  // Lets light rejoin at every footprint of a beam on a surface; false when there is none.
  bool open_port(SurfaceId, std::uint32_t beam, std::string const& name);
  void settle_pivots();  // bodies without a given pivot turn about the place of their first surface
  void finish();         // builds the search structure; call last
  void steer(SteeringTables tables) { steering_ = std::move(tables); }
  SteeringTables const& steering() const { return steering_; }

  WorldView view() const;
  std::vector<Surface> const& surfaces() const { return surfaces_; }
  std::vector<Footprint> const& footprints() const { return lit_; }
  std::vector<Body> const& bodies() const { return bodies_; }
  std::vector<std::string> const& groups() const { return groups_; }
  std::vector<std::string> const& ports() const { return ports_; }
  std::vector<std::string> body_names() const;
  // Bytes of everything that can change a trace, and of nothing else (not of motion, not of the search structure).
  std::string fingerprint() const;

  Storage storage;  // tables that shapes, laws and coatings point into
  WalkLimits limits;
  bool reverse_routes = true;  // apply C_rev (physics.md 1.3)
  double wavelength = 1.064e-6;
  double beam_power = 0;  // W, of the first beam that states one; 0: none does. For the interferometer, not the trace
  std::vector<std::string> notes;  // what was assumed or computed on the way, for reports

 private:
  template <class T, class List>
  struct Vectors;
  template <class... T>
  struct Vectors<void, std::tuple<T...>> {
    using type = std::tuple<std::vector<T>...>;
  };
  template <class T, class List, std::uint32_t I = 0>
  static constexpr std::uint32_t kind_of() {
    if constexpr (std::is_same_v<T, std::tuple_element_t<I, List>>)
      return I;
    else
      return kind_of<T, List, I + 1>();
  }

  Vectors<void, ShapeTypes>::type shapes_;
  Vectors<void, LawTypes>::type laws_;
  Vectors<void, SpecularTypes>::type interfaces_;
  std::vector<Surface> surfaces_;
  std::vector<Volume> volumes_;
  std::vector<Medium> media_;
  std::vector<Optic> optics_;
  std::vector<Footprint> lit_;
  std::vector<std::uint32_t> lit_of_surface_, emitters_;
  std::vector<Body> bodies_;
  std::vector<std::string> groups_, ports_;
  AxialTree tree_;
  SteeringTables steering_;
};

// Reads materials, bodies (pivots), parts, beams, ports and trace limits; problems go to the scene's document.
World build_world(Scene const&);

}  // namespace straytrace
