// SPDX-License-Identifier: BSD-3-Clause
// The pieces of build_world: each reads one table of the scene and records its problems there.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// Light of an interferometer, for beams of a scene that are light of it.

struct NetworkPowers {
  bool faulty = false;                  // the interferometer has problems that its reader reports
  std::map<std::string, double> watts;  // by beam of the network, "ITMx.front.out"; empty: there is no network
  // By port of the network: the light that comes to it, named where it leaves ("BS.3.out"), and the length of the
  // space.
  struct Space {
    std::string source;
    double length = 0;  // m
  };
  std::map<std::string, Space> spaces;
  std::string behind_input;      // port behind the input mirror of an arm of a preset; empty: not known
  std::set<std::string> stated;  // lights of the network that beams of the scene name

  // The same light has two names, one at each end of its space.
  std::string named_where_it_leaves(std::string const& light) const {
    auto const port = light.substr(0, light.rfind('.'));
    auto const space = spaces.find(port);
    return light.ends_with(".in") && space != spaces.end() ? space->second.source : light;
  }
  // The light that runs the other way.
  std::string reverse_of(std::string const& light) const {
    auto const dot = light.rfind('.');
    return named_where_it_leaves(light.substr(0, dot) + (light.ends_with(".in") ? ".out" : ".in"));
  }
};

// As build_world, with the powers of beams that state `network`.
World build_world(Scene const&, NetworkPowers const&);

// Names of a scene, for later readers.
struct Registry {
  std::map<std::string, std::uint32_t> materials;  // optic index
  std::map<std::string, BodyId> bodies;
  std::map<std::string, SurfaceId> surfaces;  // by instance name, and by entry name when there is only one
  std::set<std::string> refused;              // entries with an error of their own, which is reported
  std::map<std::string, Medium> media;        // of the scene; find_medium also knows the presets
  std::map<std::uint32_t, Pose> frames;       // frame of a surface, by its number; not of meshes
  std::uint32_t black = 0;                    // optic that absorbs everything
};

// Wavelength and media: before everything else.
void read_media(Scene const&, World&, Registry&);
// The medium that a scalar names: of the scene, a preset, or vacuum. Empty after a problem.
std::optional<Medium> find_medium(Node const& name, World const&, Registry const&);
bool is_medium(std::string_view name, Registry const&);
// `specular` of a material, before its BSDF models; and the total that the interface prescribes for them, after.
void read_specular(Node const& material, World&, Registry const&, Optic&);
void prescribe_scatter(Node const& material, World&, Optic&);
void read_materials(Scene const&, World&, Registry&);
void read_bodies(Scene const&, World&, Registry&);
// `shape` of an elastic mode (docs/reference/scene.md). Empty after a problem.
ElasticMode read_elastic_mode(Node const& shape);
void read_surfaces(Scene const&, World&, Registry&);
void read_receivers(Scene const&, World&, Registry const&);  // before the beams: a scene with receivers needs no port
void read_beams(Scene const&, World&, Registry const&, NetworkPowers const&);
void read_edges(Scene const&, World&, Registry const&);  // after the beams
void read_wave(Scene const&, World&, Registry const&);   // after the edges
// Single digs, scratches, glints and chamfers, after all beams and ports.
void read_imperfections(Scene const&, World&, Registry const&);
void read_photodiodes(Node const& wave, World&, Registry const&);  // after mirrors and baffles of `wave`
// Entries of the scene whose surfaces have inner rims. Adds those of them that a name or pattern fits to `chosen`.
std::vector<std::string> groups_with_rims(World const&);
void choose_rims(Node const& pattern, World const&, Registry const&, std::vector<std::string> const& with_rims,
                 std::vector<std::string>& chosen);
void read_trace_limits(Scene const&, World&);
// Checks of a finished world: direction of grooves; light that cannot enter or leave glass; beams that illuminate no
// surface; surfaces that share space.
void check_lays(Scene const&, World const&);
void check_glass(Scene const&, World const&, Registry const&);
bool lets_light_in(World const&, std::uint32_t optic);  // at normal incidence, or as scatter
void check_beams(Scene const&, World const&);
void check_faces(Scene const&, World const&);

inline bool only_absorbs(Optic const& o) {
  return o.laws == 0 && o.reflect == 0 && o.transmit == 0 && !o.has_interface;
}

// `side`: which one scatters; the other absorbs.
inline void set_sides(Surface& s, std::string_view side, std::uint32_t optic, std::uint32_t black) {
  s.front = side == "back" || side == "inner" ? black : optic;
  s.back = side == "front" || side == "outer" ? black : optic;
}

// Why the surfaces of a volume do not enclose it with normals that point out; empty: they do.
std::string volume_fault(World const&, std::vector<std::uint32_t> const& faces);
bool encloses(World const&, std::vector<std::uint32_t> const& faces);    // a volume, with normals that point out of it
std::vector<std::vector<std::uint32_t>> faces_of_volumes(World const&);  // by volume

SurfaceId read_shape(Node const& shape, Surface const& as, Pose const&, World&);  // invalid after a problem
// Finds a surface by name. Invalid after a problem, which names the nearest name, and for refused entries.
SurfaceId find_surface(Node const& name, Registry const&);
// Whether a name or pattern belongs to a refused entry.
bool is_refused(std::string const& pattern, Registry const&);
Pose turned_about_normal(Pose const&, double angle);  // rad, from e1 towards e2
Pose read_pose(Node const& table);                    // keys at, facing or rotate
Vec3 read_vector(Node const& list, Dimension);
bool some_missing(std::vector<double> const&);  // NaN among numbers read: already reported
// A unit vector; empty after a problem.
std::optional<Vec3> read_direction(Node const& list);

// A preset medium, at a wavelength of the detectors within its range.
struct KnownMedium {
  std::string name, source;
  double index, wavelength;  // m, vacuum: 1064 nm, or 1550 nm where that is out of range
};
std::vector<KnownMedium> known_media();

// The pieces of read_beams: each reads one kind of beam, or the ports.

// The key `lit` of a beam: whether it propagates through the scene, and which of its spots count.
struct LitWish {
  bool wanted = false;
  double floor = 1e-9;                    // weakest beam followed, over the one launched
  std::uint32_t order = 0;                // largest order of ghosts
  std::vector<std::string> only, except;  // surfaces, by name or pattern
  std::string behind;                     // port of the network behind the input mirror; empty: that of the preset
};

// A cavity mirror behind which the light is that of two beams of the network.
struct BehindMirror {
  Node beam;  // the cavity
  std::uint32_t number = 0;
  LitWish wish;
  std::uint32_t mirror = 0;  // its footprint
  std::string port;          // of the network, behind it
};

// Common properties of all footprints of a beam.
struct Lighting {
  std::string name;
  std::uint32_t number = 0;
  double power = 1;  // over that of the first beam that states one (q of eq. 1.1)
  NetworkPowers const* network = nullptr;
  std::vector<BehindMirror>* behind = nullptr;  // receives the input mirrors whose network is known
};

// A cap or disk as a mirror of a cavity.
struct CavityMirror {
  SurfaceId id;
  Vec3 vertex, axis;                 // m; unit normal on the front
  double curvature = 0, radius = 0;  // 1/RoC [1/m], positive when concave; of the clear aperture, m
};
// False after a problem.
bool read_mirror(Node const&, Registry const&, World const&, CavityMirror&);
// A surface in the way of the light between two mirrors.
std::optional<SurfaceId> obstacle(World const&, CavityMirror const&, Vec3 from, CavityMirror const&, Vec3 to);

void read_cavity(Node const& beam, Node const& cavity, Registry const&, World&, Lighting const&);
// Three mirrors or more, in the order of a round trip.
void read_ring_cavity(Node const& beam, Node const& cavity, Registry const&, World&, Lighting const&);
// Whether the light of a cavity of three mirrors or more turns back, so that it goes through each leg both ways.
bool turns_back(std::vector<Node> const& mirrors);
void read_free(Node const& beam, Registry const&, World&, Lighting const&);  // key `from`
void read_spot(Node const& beam, Registry const&, World&, Lighting const&);  // key `on`

// The beams read so far; for `broken` ones a problem is already reported.
struct Beams {
  std::vector<std::string> names;
  std::vector<bool> broken;
};
void read_ports(Scene const&, World&, Registry const&, Beams const&);

LitWish read_lit(Node const& beam, Registry const&);
// Adds footprints on every surface that the beam meets, starting from its footprints so far. Does nothing while the
// document has problems.
void light_up(Node const& beam, LitWish const&, Registry const&, World&, Lighting const&);
// The last footprint is the launch of this light of the network: ends it where the network continues.
void end_in_network(Node const& beam, World&, NetworkPowers const&, std::string const& light);
// Two beams between the mirror and the next component: the light that leaves the mirror, and the light that comes to
// it (docs/theory/recoupling.md). They become beams of the world, with the names of their light and ports of the same
// names.
void light_behind(BehindMirror const&, Registry const&, World&, NetworkPowers const&);

// Places a stated spot on a surface that its light crosses more than once: tubes, spheres, boxes. Sets `backoff` of the
// footprint so that its lines start after the crossing before the illuminated one, and moves its centre along the chief
// ray to that one. The illuminated crossing is the one within the radius of the spot about its centre; otherwise the
// first, in the direction of travel, on a side that does not only absorb. Changes nothing if the chief ray crosses at
// most once.
void place_spot(World const&, Footprint&);

}  // namespace straytrace::world
