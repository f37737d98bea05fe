// SPDX-License-Identifier: BSD-3-Clause
// The state of one path, its interaction at a vertex, and the rolling name of its route.
#pragma once

#include "base/math/strata.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/coating/specular.hpp"
#include "optics/polarisation.hpp"
#include "trace/result.hpp"
#include "world/model/diffraction.hpp"

namespace straytrace::trace {

// How the present direction was chosen. The density of the mixture depends on the surface hit, so the weight of the hop
// is completed on arrival (finish_hop_weight()).
struct Hop {
  double kept = 1;                       // mean share of the power at the vertex left that continues
  double cosine = 1;                     // of a scattered direction with the normal of the surface left
  double value = 1;                      // f |cos| [1/sr]; specular: 1
  double lobe = 1;                       // probability with which the lobe was chosen
  double law_pdf = 0;                    // 1/sr, of the BSDF model; 0 marks a specular hop, which has no density
  double pdf = 0;                        // 1/sr, of the whole mixture with its lobe; set on arrival
  Event left_by = Event::emit;           // what happened at the vertex left
  std::uint32_t side = WorldView::none;  // whose targets take part in the mixture
  bool below_facet = false;              // out of a mesh of smooth normals into the facet: absorbed on arrival
  bool aimed = false;                    // the side left has targets
  bool off_list = false;                 // drawn from the BSDF model, and met no listed target
  SurfaceId aim;                         // surface of the target drawn; invalid: the BSDF model chose the direction
  double aim_distance = 0;               // m to the point drawn on it: anything hit earlier hides it
};

// A scattering vertex as the power heuristic sees it (docs/theory/sampling.md, eq. 1.15 to 1.17). Densities of
// directions are per etendue, 1/(m^2 sr), and include the probabilities of the specular ways up to the next scattering
// vertex.
struct Link {
  double forward = 0;   // with which the walk leaves it towards the receiver
  double backward = 0;  // with which a sub-path from the receiver leaves it towards the source
  double geometry = 0;  // n^2 cos cos'/d^2 of the leg from the vertex before; 0: light came by a specular surface
  double chance = 1;    // of being connected, for a sub-path that meets it
};
constexpr std::uint32_t most_ends = 5;  // vertices of a sub-path, the one on the receiver included

// What the weights need of the vertices passed.
struct Trail {
  Link link[most_ends];     // of scattering vertices, the last one first
  std::uint32_t count = 0;  // of all
  std::uint32_t hops = 0;   // specular ones since the last of them
  double start = 0;         // 1/m^2, density of the first one; 0: no sub-path ends there
  double back = 1;          // probability with which a sub-path passes those hops the other way
  STRAY_HD void add(Link const& next) {
    for (std::uint32_t i = most_ends - 1; i > 0; --i) link[i] = link[i - 1];
    link[0] = next;
    ++count;
    hops = 0;
    back = 1;
  }
};

struct PathState {
  std::uint64_t history = 0;
  std::uint32_t event = 0;  // number of this vertex in its history, siblings counted; the source is 0
  std::uint32_t order = 0;  // surface events since the source
  Ray ray;
  Departure from;      // surface that the ray starts on
  double power = 0;    // carried, relative to the main mode
  double emitted = 0;  // first scattered out of the mode by this history, relative to the main mode
  Hop hop;
  Trail trail;
  bool from_halo = false;  // its mirror scattered it below the crossover angle
  bool coherent = false;   // a free beam that has met specular surfaces only
  double path_length = 0;  // optical, sum of n d since the source, m
  double turned = 0;       // by interfaces, of the phase of coherent light (s polarised), in turns
  MediaStack media;        // filled volumes the ray runs in
  Polarisation polarisation;
  std::uint64_t route = 0;   // rolling hash of (group, event) of all vertices left so far
  std::uint32_t source = 0;  // footprint it started from
  double level = 0;          // power x adjoint that the weight window keeps; 0 before the first vertex with an adjoint
  Strata strata;             // of the dealt numbers of its history
  double stratum = -1;       // decides lobe and target of the first hop; negative: a random number does
};

// Light from a mirror to one surface and straight back to the same mirror belongs to the classes `halo` where one of
// both ways is below the crossover angle (docs/theory/wave.md, eq. W.21).
//
// Whether a path of light below the angle comes straight back from the first surface that it met.
STRAY_HD bool returns_to_halo(PathState const& path, std::uint32_t footprint) {
  return path.from_halo && path.order == 2 && path.hop.left_by == Event::scatter && footprint == path.source;
}
// Whether a vertex is the first that light of this mirror meets.
STRAY_HD bool first_of_mirror(PathState const& path, std::uint32_t order, std::uint32_t footprint) {
  return order == 1 && footprint == path.source;
}

// Sets the shares of light scattered, reflected and transmitted at a vertex whose media are known.
STRAY_HD void set_shares(WorldView const& world, Polarisation const& polarisation, Vec3 travel, Vertex& v) {
  v.albedos = albedos_of(world.laws, *v.optic, v.wi, v.n_in, v.n_out);
  v.albedo = scattered_share(*v.optic, v.albedos.total, v.wi.z);
  if (v.optic->diffracts) {
    v.reflect = diffracted_share(world, v, travel, false);
    v.transmit = diffracted_share(world, v, travel, true);
    return;
  }
  if (world.polarised && v.optic->has_interface) {
    Amplitudes const a = specular_amplitudes(world.interfaces, *v.optic, v.wi.z, v.n_in, v.n_out, v.front);
    double const r = reflected(polarisation, travel, v.frame.e3, a).power;
    double const t = transmitted(polarisation, travel, v.frame.e3, a).power;
    double const left = specular_remainder(world.interfaces, *v.optic, r + t, v.albedo);
    v.reflect = left * r;
    v.transmit = left * t;
    return;
  }
  SpecularShares const s = specular_shares(world.interfaces, *v.optic, v.wi.z, v.n_in, v.n_out, v.front, v.albedo);
  v.reflect = s.reflect;
  v.transmit = s.transmit;
}
// Sets the media on both sides of the vertex and those shares.
STRAY_HD void evaluate_scattering(WorldView const& world, MediaStack const& media, Polarisation const& polarisation,
                                  Vec3 travel, Vertex& v) {
  if (!(v.wi.z > 0)) return;
  find_media(world, media, travel, v);
  set_shares(world, polarisation, travel, v);
}
STRAY_HD void evaluate_scattering(WorldView const& world, PathState const& path, Vec3 travel, Vertex& v) {
  evaluate_scattering(world, path.media, path.polarisation, travel, v);
}
// The point of a vertex for unpolarised light that arrives along `travel` in these media.
STRAY_HD Vertex seen_along(WorldView const& world, Vertex const& v, Vec3 travel, MediaStack const& media) {
  Vec3 const wi = v.frame.to_local(-travel);
  if (wi.z > 0 && !v.smooth) {
    Vertex same = v;
    same.wi = wi;
    set_shares(world, {}, travel, same);
    return same;
  }
  Vertex other = make_vertex(world, v.surface, v.point, travel, v.piece);
  evaluate_scattering(world, media, {}, travel, other);
  return other;
}

STRAY_HD Vertex vertex_at(WorldView const& world, PathState const& path, Hit const& hit) {
  Vertex v = make_vertex(world, hit.surface, path.ray.origin + hit.distance * path.ray.dir, path.ray.dir, hit.piece);
  v.leg = hit.distance;
  return v;
}

// Absorption on a leg (Beer-Lambert) and its optical length; returns the power lost.
STRAY_HD double lost_in_medium(WorldView const& world, PathState& path, double leg) {
  path.path_length += index_of(world, path.media.current()) * leg;
  double const left = path.power * kept_along(world, path.media, leg);
  double const lost = path.power - left;
  path.power = left;
  return lost;
}

// The hash of a route depends only on its own vertices, not on other routes or the order of arrival.
STRAY_HD std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
STRAY_HD std::uint64_t extended(std::uint64_t route, GroupId group, Event event) {
  return mixed(route * 0x9e3779b97f4a7c15ull + (std::uint64_t(group.value) << 8 | std::uint64_t(event)) + 1);
}

}  // namespace straytrace::trace
