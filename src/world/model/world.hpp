// SPDX-License-Identifier: BSD-3-Clause
// The world the light sees: surfaces, optics, footprints of the beams, and the fast search for the closest hit.
// `World` owns; `WorldView` is pointers and sizes, passed by value to whatever traces.
#pragma once

#include <string>
#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "base/memory/storage.hpp"
#include "beams/footprint.hpp"
#include "geometry/shape_types.hpp"
#include "optics/coating/specular_types.hpp"
#include "optics/scatter/mixture.hpp"
#include "scene/scene.hpp"
#include "world/model/inner_rim.hpp"
#include "world/model/mode_shapes.hpp"
#include "world/model/receiver.hpp"
#include "world/model/scatter_spread.hpp"
#include "world/model/search_kernels.hpp"
#include "world/model/steering.hpp"
#include "world/search/hit.hpp"
#include "world/search/search.hpp"

namespace straytrace {

using ShapePool = Pool<ShapeTypes>;

struct Surface {
  PoolRef shape;
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t front = 0, back = 0;  // optic on the side the normal points to, and on the other
  BodyId body;
  GroupId group;
  std::uint32_t volume = none;  // filled volume behind it: the normal points out of it
  bool clear = false;           // a measuring plane: neither hit nor hiding anything
  double scale = 0;             // m, the largest length from which hits on it are computed
};

// A filled volume: glass of one lens. Volumes of instances of one part are different.
struct Volume {
  std::uint32_t medium = 0;
};

struct Medium {
  double index = 1;
  double absorption = 0;  // of power, 1/m
};

// How the walk is bounded and whether the search structure is used; part of what decides a result.
struct WalkLimits {
  std::uint32_t max_order = 64;      // surface events after the source; light beyond is booked as `limit`
  double roulette_below = 0.1;       // of the power first scattered: below it paths survive by chance (unbiased)
  std::uint32_t route_vertices = 5;  // routes with more vertices than this are summed in the class `other`
  bool targets = true;               // aim at what the adjoint tables call important (docs/theory/sampling.md)
  double law_share = 0.25;           // of directions, that the scatter law keeps at least beside the targets (alpha)
  bool window = true;                // split and weed paths by power x adjoint (docs/theory/sampling.md)
  std::uint32_t children = 1;        // paths that go on from the first vertex
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
  View<Receiver const> receivers;
  View<std::uint32_t const> receiver_of_surface;  // the first, or none; measuring planes are not listed
  bool polarised = false;                         // the walk carries the state of polarisation
  SearchView tree;
  Steering steering;  // empty: the scatter law alone
  WalkLimits limits;
  double wavelength = 0;  // m
  std::uint64_t block_size = largest_block;
  static constexpr std::uint32_t none = 0xffffffffu;

  // The smallest positive double distance, ties to the lower SurfaceId; `from` is the surface the ray starts on.
  STRAY_HD Hit closest(Ray const& ray, Departure from) const {
#if defined(__CUDA_ARCH__)
    auto const cross_one = [this](SurfaceRef r, Ray const& bounded, Departure const& f) {
      return cross(r.surface, bounded, f);
    };
    NearestQuery<decltype(cross_one)> query(ray, from, cross_one, {{}, ray.t_max});
    search(ray, query);
    return query.best();
#else
    return search_kernels->closest(*this, ray, from);
#endif
  }
  // The same for several rays at once: in meshes they take turns, so that none waits for memory alone.
  void closest_together(RayQuery const* queries, Hit* hits, std::uint32_t count) const {
    search_kernels->closest_together(*this, queries, hits, count);
  }
  // Whether anything lies between the origin and ray.t_max. `to_itself`: the ray ends on the surface it starts on; a
  // quadric has nothing in between.
  STRAY_HD bool occluded(Ray const& ray, Departure from, bool to_itself = false) const {
#if defined(__CUDA_ARCH__)
    auto const cross_one = [this](SurfaceRef r, Ray const& bounded, Departure const& f) {
      return cross(r.surface, bounded, f);
    };
    return search(ray, AnyQuery<decltype(cross_one)>{cross_one, from, ray, to_itself});
#else
    return search_kernels->occluded(*this, ray, from, to_itself);
#endif
  }
  STRAY_HD Crossing cross(std::uint32_t id, Ray const& ray, Departure from) const {
    return shapes.visit(surfaces[id].shape,
                        [&](auto const& s) { return crossing_of(s, ray, from.on(id), from.piece); });
  }
  // How much earlier than a point drawn on a surface, `way` m away, a line may meet that surface, m (eq. 1.14).
  STRAY_HD double slack(SurfaceId id, double way, double cosine) const {
    return hit_slack(surfaces[id.value].scale, way, cosine);
  }
  STRAY_HD Vec3 normal(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return normal_of(s, p, piece); });
  }
  STRAY_HD Vec3 project(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return projected_on(s, p, piece); });
  }

  // Asks about all that the ray may hit, until the answer is true; says whether it was.
  template <class Query>
  STRAY_INLINE bool search(Ray const& ray, Query&& query) const {
    return limits.brute_force ? search_all(ray, query) : tree.traverse(ray, ray.t_max, query);
  }
  template <class Query>
  STRAY_INLINE bool search_all(Ray const& ray, Query&& query) const {
    double limit = ray.t_max;
    for (std::uint32_t id = 0; id < surfaces.size; ++id)
      if (!surfaces[id].clear && query.cross(SurfaceRef::of(id, surfaces[id].shape), limit)) return true;
    return false;
  }
};

struct Body {
  std::string name;
  Vec3 pivot;               // m, rotations are about it
  bool pivot_given = true;  // NaN given: the place of the body's first surface
  std::vector<ElasticMode> modes = {};
};

// How the beam came to a footprint: its chief ray from where it was launched. Light that rejoins goes the same way
// back, and by eq. 2.2 with the same phase sensitivities.
struct Feed {
  static constexpr std::uint32_t none = 0xffffffffu;
  bool propagated = false;  // the footprint was found by propagation; false: stated, at its place from the start
  double path_length = 0;   // optical, m
  std::vector<PhaseSensitivity> phase_sensitivities;  // of the surfaces passed, over the wave number: 1 and m, by body
  std::uint32_t mirror = none;  // footprint of the cavity mirror it leaked through: the reference of eq. 2.5
  std::uint32_t order = 0;      // of the ghost; 0: the beam itself
  double clipped = 0;           // share of the light that passes beside the surface
};

// Where the numbers of a material come from.
struct LawInfo {
  std::string model, source, wavelength;
};
struct MaterialInfo {
  std::string name, source;
  std::vector<LawInfo> laws;
  std::uint32_t optic = 0;
  ScatterSpread spread;
};

// Owns all arrays. Built from a scene by build_world, or piece by piece by tests.
class World {
 public:
  std::uint32_t most_shapes = SurfaceRef::most_shapes;  // of one kind; more throw InputError
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
    if (list.size() >= most_shapes) too_many_shapes(Shape::key);
    list.push_back(shape);
    surfaces_.push_back({{kind_of<Shape, ShapeTypes>(), std::uint32_t(list.size() - 1)},
                         front,
                         back,
                         body,
                         group,
                         volume,
                         false,
                         scale_of(shape)});
    return {std::uint32_t(surfaces_.size() - 1)};
  }
  BodyId add_body(std::string name, Vec3 pivot);
  // Its coordinate is a body of its own, of this name; returns that.
  BodyId add_mode(BodyId of, std::string name, ElasticMode);
  GroupId add_group(std::string const& name);  // the same id for the same name
  PortId add_port(std::string name);
  void add_footprint(Footprint, Feed = {});  // needs its surface to exist; sets backoff, to what is given at most
  void add_receiver(std::string name, Receiver);
  // Whether sub-paths serve it, and what they start towards (`most_aims` surfaces at most).
  void cover_receiver(std::uint32_t receiver, bool behind_glass, std::vector<SurfaceId> const& aims = {}) {
    Receiver& r = receivers_[receiver];
    r.behind_glass = behind_glass;
    r.aims = 0;
    for (SurfaceId const id : aims) r.aim[r.aims++] = id;
  }
  // Of a receiver whose map has no stated pixels.
  void set_map_cells(std::uint32_t receiver, CellTree const& tree) {
    receivers_[receiver].nodes = storage.keep(tree.nodes());
    receivers_[receiver].cells = storage.keep(tree.cells());
  }
  // Lets light rejoin at every footprint of a beam on a surface; false when there is none.
  bool open_port(SurfaceId, std::uint32_t beam, std::string const& name);
  void open_port(std::string const& name, std::vector<std::uint32_t> const& footprints);
  void anchor(BodyId, Vec3 place);  // its pivot, m, when none is given and no surface is on it yet
  void settle_pivots();             // bodies without a given pivot turn about the place of their first surface
  void build_search();              // of all surfaces there are
  void finish();                    // the same, unless it was done, and the lists of footprints; call last
  void steer(SteeringTables tables) { steering_ = std::move(tables); }
  SteeringTables const& steering() const { return steering_; }

  WorldView view() const;
  std::vector<Surface> const& surfaces() const { return surfaces_; }
  std::vector<Footprint> const& footprints() const { return lit_; }
  std::vector<Feed> const& feeds() const { return feeds_; }  // by footprint
  std::vector<Body> const& bodies() const { return bodies_; }
  std::vector<std::string> const& groups() const { return groups_; }
  std::vector<std::string> const& ports() const { return ports_; }
  std::vector<Receiver> const& receivers() const { return receivers_; }
  std::vector<std::string> const& receiver_names() const { return receiver_names_; }
  std::vector<std::string> body_names() const;
  // Bytes of everything that can change a trace, and of nothing else (not of motion, not of the search structure).
  std::string fingerprint() const;

  Storage storage;  // tables that shapes, laws and coatings point into
  WalkLimits limits;
  EdgeSettings edges;  // independent of the trace, not part of the fingerprint
  bool polarised = false;
  bool reverse_routes = true;  // apply C_rev (docs/theory/path_integral.md)
  double wavelength = 1.064e-6;
  // Histories: how they are dealt to sources. Of the run, not of the scene: no part of the fingerprint.
  std::uint64_t block_size = largest_block;
  double beam_power = 0;            // W, of the first beam that states one; 0: none does. For reports, not the trace
  std::vector<double> beam_powers;  // W, by beam; 0: not stated. For the interferometer
  std::vector<MaterialInfo> materials;  // in the order of the scene
  std::vector<std::string> notes;       // what was assumed or computed on the way, for reports

 private:
  [[noreturn]] void too_many_shapes(std::string_view kind) const;
  template <class T, class List>
  struct Vectors;
  template <class... T>
  struct Vectors<void, std::tuple<T...>> {
    using type = std::tuple<std::vector<T>...>;
  };
  Vectors<void, ShapeTypes>::type shapes_;
  Vectors<void, LawTypes>::type laws_;
  Vectors<void, SpecularTypes>::type interfaces_;
  std::vector<Surface> surfaces_;
  std::vector<Volume> volumes_;
  std::vector<Medium> media_;
  std::vector<Optic> optics_;
  std::vector<Footprint> lit_;
  std::vector<Feed> feeds_;
  std::vector<std::uint32_t> lit_of_surface_, emitters_, receiver_of_surface_;
  std::vector<Receiver> receivers_;
  std::vector<std::string> receiver_names_;
  std::vector<Body> bodies_;
  std::vector<std::string> groups_, ports_;
  SearchTree tree_;
  std::size_t searched_ = 0;  // surfaces in it
  SteeringTables steering_;
};

// Reads materials, bodies (pivots), parts, beams, ports and trace limits; problems go to the scene's document.
World build_world(Scene const&);

}  // namespace straytrace
