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

namespace straytrace {

// What later readers need to find by name.
struct Registry {
  std::map<std::string, std::uint32_t> materials;  // optic index
  std::map<std::string, BodyId> bodies;
  std::map<std::string, SurfaceId> surfaces;  // by instance name, and by entry name when there is only one
  std::set<std::string> refused;              // entries without surfaces, whose problem is reported
  std::map<std::string, Medium> media;        // of the scene; presets are found by find_medium
  std::map<std::uint32_t, Pose> frames;       // own frame of a surface, by its number; those of meshes are not here
  std::uint32_t black = 0;                    // optic that absorbs everything
};

// Wavelength and media: before everything else.
void read_media(Scene const&, World&, Registry&);
// The medium a scalar names: one of the scene, a preset, or vacuum; nothing, and a problem, when there is none.
std::optional<Medium> find_medium(Node const& name, World const&, Registry const&);
bool is_medium(std::string_view name, Registry const&);
// `specular` of a material, before its laws are read; and what the interface says about their total, after.
void read_specular(Node const& material, World&, Registry const&, Optic&);
void prescribe_scatter(Node const& material, World&, Optic&);
void read_materials(Scene const&, World&, Registry&);
void read_bodies(Scene const&, World&, Registry&);
// `shape` of an elastic mode (docs/reference/scene.md). Empty after a problem.
ElasticMode read_elastic_mode(Node const& shape);
void read_surfaces(Scene const&, World&, Registry&);
void read_receivers(Scene const&, World&, Registry const&);  // before the beams: with receivers no port is needed
void read_beams(Scene const&, World&, Registry const&);
void read_edges(Scene const&, World&);  // after the beams
void read_trace_limits(Scene const&, World&);
void check_lays(Scene const&, World const&);  // of a finished world: have all grooves a direction?
// Of a finished world: does light get into its glass, and out again?
void check_glass(Scene const&, World const&, Registry const&);
bool lets_light_in(World const&, std::uint32_t optic);  // at normal incidence, or as scatter
void check_beams(Scene const&, World const&);           // of a finished world: do they light anything?
void check_faces(Scene const&, World const&);           // of a finished world: do surfaces share space?

inline bool only_absorbs(Optic const& o) {
  return o.laws == 0 && o.reflect == 0 && o.transmit == 0 && !o.has_interface;
}

// What keeps the surfaces of a volume from enclosing it with normals pointing out; empty when nothing does.
std::string volume_fault(World const&, std::vector<std::uint32_t> const& faces);
bool encloses(World const&, std::vector<std::uint32_t> const& faces);    // a volume, with normals that point out of it
std::vector<std::vector<std::uint32_t>> faces_of_volumes(World const&);  // by volume

SurfaceId read_shape(Node const& shape, Surface const& as, Pose const&, World&);  // invalid: a problem was recorded
// Finds a surface by name; invalid, and a problem with the nearest name, when there is none.
SurfaceId find_surface(Node const& name, Registry const&);
Pose turned_about_normal(Pose const&, double angle);  // rad, from e1 towards e2
Pose read_pose(Node const& table);                    // keys at, facing or rotate
Vec3 read_vector(Node const& list, Dimension);
bool some_missing(std::vector<double> const&);  // NaN among numbers that were read: reported where it stands
// A unit vector; none, with a problem at the list or at what it names, where it has no direction.
std::optional<Vec3> read_direction(Node const& list);

// The media that scenes know without stating them, each at a wavelength of the detectors that it holds for.

struct KnownMedium {
  std::string name, source;
  double index, wavelength;  // m, vacuum: 1064 nm, or 1550 nm where that is out of range
};
std::vector<KnownMedium> known_media();

}  // namespace straytrace
