// SPDX-License-Identifier: BSD-3-Clause
// A point on a surface that light has reached: its frame, and the media on both sides. The trace and the beam tree
// share this type.
#pragma once

#include "geometry/shape_types.hpp"
#include "optics/media_stack.hpp"
#include "world/model/view.hpp"

namespace straytrace::world {

struct Vertex {
  SurfaceId surface;
  std::uint32_t piece = 0;
  bool front = true;           // lit on the side its normal points to
  Vec3 point;                  // projected onto its surface
  Frame frame;                 // e3 = normal on the lit side
  Vec3 wi;                     // towards the previous vertex, local
  double leg = 0;              // m from the previous vertex
  double n_in = 1, n_out = 1;  // indices on the lit side and behind it
  MediaStack before, after;    // volumes there
  SurfaceId contact;           // a second surface that touches this one here
  Optic const* optic = nullptr;
  double albedo = 0, reflect = 0, transmit = 0;  // shares scattered, reflected and transmitted at this incidence
  optics::Albedos albedos;                       // of the BSDF models
  std::uint32_t patch = WorldView::none;         // of the steering tables
  bool smooth = false;                           // e3 is a normal between those of the corners of a mesh
  Vec3 facet;                                    // then: normal of the facet on the lit side
  double facet_cosine = 1;                       // and the cosine of incidence on it
  // Normal and cosine of incidence of the surface itself: they belong to areas, e3 and wi to the optics.
  STRAY_HD Vec3 normal() const { return smooth ? facet : frame.e3; }
  STRAY_HD double cosine() const { return smooth ? facet_cosine : wi.z; }
  // Whether light that leaves along `out`, local `wo`, would run into the facet that it leaves.
  STRAY_HD bool beyond_facet(Vec3 wo, Vec3 out) const { return smooth && (dot(out, facet) > 0) != (wo.z > 0); }
  STRAY_HD double kept() const { return albedo + reflect + transmit; }
  STRAY_HD std::uint32_t side() const {
    return patch == WorldView::none ? WorldView::none : 2 * patch + (front ? 0 : 1);
  }
};

STRAY_HD std::uint32_t patch_of(WorldView const& world, SurfaceId id, Vec3 point, std::uint32_t piece) {
  if (!world.steering.on()) return WorldView::none;
  std::uint32_t const only = world.steering.only_strip(id);
  if (only != WorldView::none) return world.steering.strips[only].patch;
  double const u = world.shapes.visit(world.surfaces[id.value].shape,
                                      [&](auto const& s) { return strip_coordinate(s, point, piece); });
  return world.steering.strips[world.steering.strip_at(id, u)].patch;
}

// Turns the frame about its normal so that e2 runs along the grooves; keeps it where they have no direction.
STRAY_HD void lay_frame(WorldView const& world, Surface const& surface, Vec3 point, Optic const& optic, Frame& frame) {
  Vec3 run = optic.lay_direction;
  if (optic.lay != Lay::given)
    run = world.shapes.visit(surface.shape, [&](auto const& s) {
      return optic.lay == Lay::along ? s.axis : cross(s.axis, point - s.reference());
    });
  Vec3 const flat = run - dot(run, frame.e3) * frame.e3;
  double const size = length(flat);
  if (!(size > 1e-9 * length(run))) return;
  frame.e2 = (1 / size) * flat;
  frame.e1 = cross(frame.e2, frame.e3);
}

constexpr double grazing_facet = 1e-3;  // cosine to the normal of a facet with which bent light leaves it

// A direction turned to the back of the facet, which it leaves at a grazing angle.
STRAY_HD Vec3 below(Vec3 out, Vec3 facet) { return unit(out - (dot(out, facet) + grazing_facet) * facet); }

// The normal of a mesh of smooth normals, both on the lit side, turned where necessary so that light reflected there
// stays on the lit side of the facet (docs/reference/shapes/mesh.md).
STRAY_HD Vec3 shading_normal(Vec3 smooth, Vec3 facet, Vec3 travel) {
  Vec3 const out = travel - (2 * dot(travel, smooth)) * smooth;
  double const up = dot(out, facet);
  if (up >= grazing_facet && dot(travel, smooth) < 0) return smooth;
  return unit(unit(out + (grazing_facet - up) * facet) - travel);
}

// A point of a surface before light arrives there.
struct SurfaceSpot {
  SurfaceId surface;
  std::uint32_t piece = 0, patch = WorldView::none;
  Landing at;
};
STRAY_HD SurfaceSpot spot_on(WorldView const& world, SurfaceId id, Vec3 point, std::uint32_t piece) {
  Landing const at = world.landing(id, point, piece);
  return {id, piece, patch_of(world, id, at.point, piece), at};
}
// Light that travels along `travel` has reached it.
STRAY_HD Vertex vertex_on(WorldView const& world, SurfaceSpot const& spot, Vec3 travel) {
  Vertex v;
  v.surface = spot.surface;
  v.piece = spot.piece;
  v.patch = spot.patch;
  v.point = spot.at.point;
  Vec3 const normal = spot.at.normal;
  v.front = dot(travel, normal) < 0;
  Surface const& surface = world.surfaces[v.surface.value];
  v.optic = &world.optics[v.front ? surface.front : surface.back];
  Vec3 lit = v.front ? normal : -normal;
  if (world.smooth(v.surface)) {
    v.smooth = true;
    v.facet = lit;
    v.facet_cosine = -dot(travel, lit);
    Vec3 const smooth = world.smooth_normal(v.surface, v.point, v.piece);
    lit = shading_normal(v.front ? smooth : -smooth, lit, travel);
  }
  v.frame = Frame::around(lit);
  if (v.optic->lay != Lay::free) lay_frame(world, surface, v.point, *v.optic, v.frame);
  v.wi = v.frame.to_local(-travel);
  return v;
}
STRAY_HD Vertex make_vertex(WorldView const& world, SurfaceId id, Vec3 point, Vec3 travel, std::uint32_t piece = 0) {
  return vertex_on(world, spot_on(world, id, point, piece), travel);
}

STRAY_HD double index_of(WorldView const& world, std::uint32_t volume) {
  return volume == Passage::none ? 1 : world.media[world.volumes[volume].medium].index;
}

// Media on both sides of the vertex; a surface within a nanometre counts as in contact.
STRAY_HD void find_media(WorldView const& world, MediaStack const& media, Vec3 travel, Vertex& v) {
  if (world.volumes.size == 0) return;
  Passage const here{world.surfaces[v.surface.value].volume, v.front};
  MediumSides found = sides(media, here);
  if (here.volume != Passage::none && world.volumes.size > 1) {
    Ray const probe{v.point - contact_distance * travel, travel, 2 * contact_distance};
    Hit const other = world.closest(probe, {v.surface, v.piece});
    if (other.surface.valid() && world.surfaces[other.surface.value].volume != Passage::none) {
      Vec3 const normal = world.normal(other.surface, v.point, other.piece);
      found = sides(media, here, {world.surfaces[other.surface.value].volume, dot(travel, normal) < 0});
      v.contact = other.surface;
    }
  }
  v.before = found.before;
  v.after = found.after;
  v.n_in = index_of(world, found.in);
  v.n_out = index_of(world, found.out);
}

// Share of the power that remains after a leg in the medium of these volumes.
STRAY_HD double kept_along(WorldView const& world, MediaStack const& media, double leg) {
  if (media.depth == 0) return 1;
  return kept_on_the_way(world.media[world.volumes[media.current()].medium].absorption, leg);
}

}  // namespace straytrace::world
