// SPDX-License-Identifier: BSD-3-Clause
// The model of a scene. It owns the arrays of WorldView (view.hpp), and data for reports and later steps: names,
// bodies, materials, and how beams reached their footprints.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "base/memory/storage.hpp"
#include "world/model/material.hpp"
#include "world/model/receiver.hpp"
#include "world/model/view.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::world {

// Bodies and their elastic modes, and the contribution of one hit on a body to the phase of a path
// (docs/theory/motion.md, eq. 2.1, 2.3).

class World;

// psi(r), without unit: displacement of a point per displacement of the mode's coordinate q.
class ModeShape {
 public:
  virtual ~ModeShape() = default;
  virtual Vec3 at(Vec3 point) const = 0;  // relative to the origin of the shape, m, along the world axes
};

struct ElasticMode {
  BodyId id;  // the coordinate counts as a body of its own, with d[0] of its phase sensitivities
  Vec3 origin;
  bool origin_given = false;  // otherwise the pivot of the body
  std::shared_ptr<ModeShape const> shape;
  std::string description;  // all parameters of the shape
};

struct Body {
  std::string name;
  Vec3 pivot;               // m, rotations are about it
  bool pivot_given = true;  // NaN given: the place of the body's first surface
  std::vector<ElasticMode> modes = {};
};

// The entry of a body; adds one where there is none.
PhaseSensitivity& phase_sensitivity_of(std::vector<PhaseSensitivity>&, BodyId);

// Adds kappa [rad/m], its moment about the pivot of the body, and kappa . psi for each elastic mode of it. A surface
// without a body (a measuring plane) adds nothing. `delay` [s]: weighs the part of PhaseSensitivity::moment.
void add_hit(std::vector<PhaseSensitivity>&, World const&, SurfaceId, Vec3 point, Vec3 kappa, double delay = 0);

}  // namespace straytrace::world

namespace straytrace::scene {
class Scene;
}  // namespace straytrace::scene

namespace straytrace::world {

// How a beam reached a footprint: its chief ray from the launch. Light that rejoins travels the same way back, by
// eq. 2.2 with the same phase sensitivities.
struct Feed {
  static constexpr std::uint32_t none = 0xffffffffu;
  bool propagated = false;  // found by propagation; false: stated in the scene
  double path_length = 0;   // optical, m
  // Of the surfaces passed, over the wave number: 1 and m, by body; moments with the time since the beam started.
  std::vector<PhaseSensitivity> phase_sensitivities;
  std::uint32_t mirror = none;  // footprint of the cavity mirror that the beam leaked through: the reference of eq. 2.5
  std::uint32_t order = 0;      // of the ghost; 0: the beam itself
  double clipped = 0;           // share of the light that passes beside the surface
};

// The table `edges` of a scene: which rims diffract light from one mirror of a cavity to the other.
struct EdgeSettings {
  enum class Sum { independent, geometric, in_phase };  // of the rims of one group: powers, or fields
  std::vector<std::string> groups;
  Vec3 offset;              // m, added to the place of every rim
  double tooth_height = 0;  // m, random heights, besides teeth that the shape has
  double tooth_width = 0;   // m, of one such tooth
  Sum sum = Sum::independent;
};

// A beam: of the scene, or the light of the interferometer behind an input mirror.
struct LightBeam {
  std::string name;
  std::uint32_t entry = 0;  // in `beams` of the scene: the beam itself, or the cavity that it leaves
  std::string network;      // the beam of the network of the interferometer that it is; empty: none
  double share = 1;         // of its power, over that of the first beam with a stated one (q of eq. 1.1)
};

// Where a beam of the network begins and ends: behind them the network continues.
struct NetworkSpan {
  struct End {
    SurfaceId surface;   // invalid: a plane in space
    Vec3 point, travel;  // m, unit: of light that ends there
    double radius = 0;   // m
  };
  std::uint32_t footprint = 0;    // of the launch
  std::uint32_t mirror = 0;       // footprint of the mirror of the cavity behind which it runs, or Feed::none
  std::vector<SurfaceId> cavity;  // mirrors
  std::vector<End> ends;
  double longest = 0;  // m, optical: the beam itself goes no further
  Departure leaves{};  // the surface on which it starts, which does not clip it; invalid: in space
};

// Owns all arrays. Built from a scene by build_world, or piece by piece by tests.
class World {
 public:
  std::uint32_t most_shapes = SurfaceRef::most_shapes;  // of one kind; more throw InputError
  std::uint32_t add_optic(Optic const&);
  // Gives one side of a surface an optic of its own that leaves light within an angle of the specular direction to the
  // field of a cavity (docs/theory/wave.md); `below`: its share at normal incidence.
  void begin_scatter_at(SurfaceId, bool front, double crossover, double below);
  std::uint32_t material_optic(std::uint32_t optic) const { return material_optic_[optic]; }  // that it was made from
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
  template <class Law>
  std::vector<Law> const& laws() const {
    return std::get<std::vector<Law>>(laws_);
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
                         has_normals(shape),
                         scale_of(shape)});
    return {std::uint32_t(surfaces_.size() - 1)};
  }
  template <class Shape>
  SurfaceId add_surface(Shape const& shape, Surface const& as) {  // all but its shape
    return add_surface(shape, as.front, as.back, as.body, as.group, as.volume);
  }
  void make_clear(SurfaceId id) { surfaces_[id.value].clear = true; }  // light passes, and it hides nothing
  BodyId add_body(std::string name, Vec3 pivot);
  // Its coordinate is a body of its own, of this name; returns that.
  BodyId add_mode(BodyId of, std::string name, ElasticMode);
  GroupId add_group(std::string const& name);  // the same id for the same name
  PortId add_port(std::string name);
  void add_footprint(Footprint, Feed = {});  // its surface must exist; limits backoff to the value given
  void add_receiver(std::string name, Receiver);
  // Whether it sees through glass, and the surfaces that sub-paths aim at (at most `most_aims`), all equally.
  void cover_receiver(std::uint32_t receiver, bool behind_glass, std::vector<Receiver::Aim> const& aims = {}) {
    Receiver& r = receivers_[receiver];
    r.behind_glass = behind_glass;
    r.sub_paths = behind_glass ? 1 : 0;
    r.aim_at(aims);
  }
  void set_aim_shares(std::uint32_t receiver, std::span<double const> shares) {
    receivers_[receiver].set_aim_shares(shares);
  }
  void set_sub_paths(std::uint32_t receiver, double mean) { receivers_[receiver].sub_paths = mean; }
  void set_sub_paths_of_mode(std::uint32_t footprint, double mean) { lit_[footprint].sub_paths = mean; }
  // For a receiver whose map has no stated pixels.
  void set_map_cells(std::uint32_t receiver, CellTree const& tree) {
    receivers_[receiver].nodes = storage.keep(tree.nodes());
    receivers_[receiver].cells = storage.keep(tree.cells());
  }
  // Lets light rejoin at every footprint of a beam on a surface; false: there is none.
  bool open_port(SurfaceId, std::uint32_t beam, std::string const& name);
  void open_port(std::string const& name, std::vector<std::uint32_t> const& footprints);
  // A port for light of each beam of the network that joins another one, or the cavity at one of its mirrors, and back;
  // and for light that runs on along its own beam: that of the beam of the opposite direction (`reverse`, by beam), or
  // where there is none one of its own. After all ports are open.
  static constexpr std::uint32_t no_beam = 0xffffffffu;
  void pair_ports(std::vector<std::uint32_t> const& reverse);
  // A port for faces that return the light of both beams, each against itself.
  void open_face_port(PortId first, PortId second);
  // Where light of one footprint that joins the mode of another counts. Invalid: it does not, since only one of them is
  // light of the network.
  PortId port_between(Footprint const& source, Footprint const& goal) const;
  void anchor(BodyId, Vec3 place);  // its pivot, m, when none is given and no surface is on it yet
  void settle_pivots();  // bodies without a stated pivot rotate about the reference point of their first surface
  void build_search();   // over all surfaces added so far
  void finish();         // search structure, if not up to date, and lists of footprints; call last
  void steer(SteeringTables tables) { steering_ = std::move(tables); }
  SteeringTables const& steering() const { return steering_; }
  void light_halo(HaloTables tables) { halo_ = std::move(tables); }
  void set_halo_level(double level) { halo_.level = level; }
  HaloTables const& halo() const { return halo_; }

  WorldView view() const;
  std::vector<Surface> const& surfaces() const { return surfaces_; }
  std::vector<Footprint> const& footprints() const { return lit_; }
  std::vector<Feed> const& feeds() const { return feeds_; }  // by footprint
  std::vector<Body> const& bodies() const { return bodies_; }
  std::vector<std::string> const& groups() const { return groups_; }
  std::string const& name_of(SurfaceId id) const { return groups_[surfaces_[id.value].group.value]; }
  std::vector<std::string> const& ports() const { return ports_; }
  struct PortPair {
    PortId port;
    std::uint32_t beam = 0;             // that is scattered
    PortId to;                          // port of the beam that lights the way back, or of the beam itself
    bool forward = false;               // joins the beam that is scattered
    std::uint32_t mirror = Feed::none;  // footprint of the mirror of a cavity at one end
    std::string lit{}, light{};         // of the network: the light that is scattered, and that of the way back
    double reference = 1;               // geometric mean of their powers, over the power that couplings refer to
  };
  std::vector<PortPair> const& port_pairs() const { return pairs_; }
  // Of faces that two beams of opposite directions meet: the light of both sides returns as one field.
  struct FacePort {
    PortId port, first, second;  // of both, and of each beam
  };
  std::vector<FacePort> const& face_ports() const { return face_ports_; }
  std::vector<Receiver> const& receivers() const { return receivers_; }
  std::vector<std::string> const& receiver_names() const { return receiver_names_; }
  std::vector<std::string> body_names() const;
  // Bytes of everything that can change a trace, and of nothing else: neither motion nor the search structure.
  std::string fingerprint() const;

  Storage storage;  // tables that shapes, laws and coatings point into
  WalkLimits limits;
  EdgeSettings edges;  // independent of the trace, not part of the fingerprint
  WaveSettings wave;   // the same
  bool polarised = false;
  bool reverse_routes = true;  // apply C_rev (docs/theory/path_integral.md)
  double wavelength = 1.064e-6;
  // Histories per block. It belongs to the run, not to the scene: not part of the fingerprint.
  std::uint64_t block_size = largest_block;
  double beam_power = 0;            // W, of the first beam with a stated power; 0: none. For reports, not for the trace
  std::vector<double> beam_powers;  // W, by beam; 0: not stated. For the interferometer
  std::vector<LightBeam> beams;
  std::vector<NetworkSpan> spans;
  // Light of the network that arrives at a mirror of a cavity, "ITMx.back.in"; `footprint`: there.
  struct MirrorLight {
    std::uint32_t footprint = 0;
    std::string name;
  };
  std::vector<MirrorLight> mirror_lights;
  std::vector<MaterialInfo> materials;  // in the order of the scene
  std::vector<std::string> notes;       // assumptions and intermediate results, for reports

 private:
  void pair_with_mirror(MirrorLight const&, std::vector<std::uint32_t> const& beam_of);
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
  std::vector<std::uint32_t> material_optic_;  // by optic
  std::vector<Footprint> lit_;
  std::vector<Feed> feeds_;
  std::vector<std::uint32_t> lit_of_surface_, emitters_, receiver_of_surface_;
  std::vector<Receiver> receivers_;
  std::vector<std::string> receiver_names_;
  std::vector<Body> bodies_;
  std::vector<std::string> groups_, ports_;
  std::vector<PortPair> pairs_;
  std::vector<FacePort> face_ports_;
  SearchTree tree_;
  std::size_t searched_ = 0;  // surfaces in it
  SteeringTables steering_;
  HaloTables halo_;  // follows from scene and field: not part of the fingerprint
};

// Reads materials, bodies (pivots), parts, beams, ports and trace limits; problems go to the scene's document.
World build_world(Scene const&);

// Areas of surfaces, and of the cells of maps within the rim of their surface.

// As filled_share(), of a map that stands in `frame`.
double filled_share(WorldView const&, SurfaceId, Chart, MapCell const&, Pose const& frame);

// Of each pixel or cell of a receiver's map on this surface, m^2: what lies beyond the rim does not count. A cell that
// the rim leaves nothing of has its whole area.
std::vector<double> map_areas(WorldView const&, SurfaceId, Receiver const&);

// Of all surfaces of each group, m^2; a surface has one side.
std::vector<double> group_areas(WorldView const&, std::size_t groups);

}  // namespace straytrace::world
