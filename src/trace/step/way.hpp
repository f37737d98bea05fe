// SPDX-License-Identifier: BSD-3-Clause
// The straight line from a vertex of the walk to a point that it is connected to.
#pragma once

#include "base/math/rng.hpp"
#include "trace/step/scatter.hpp"

namespace straytrace::trace {

// The straight line from a vertex to a point: direction, length, and the BSDF models of the vertex in this direction.
struct Way {
  Vec3 out;            // unit vector from the vertex
  Vec3 wo;             // the same, local
  double length = 0;   // m
  double bsdf = 0;     // 1/sr; 0: no light
  double law_pdf = 0;  // 1/sr, with which the models sample it
  double kept = 1;     // share not absorbed on the line
  STRAY_HD double geometry(double cosine) const { return std::fabs(wo.z) * cosine / (length * length); }  // 1/m^2
};
STRAY_HD Way way_to(WorldView const& world, Vertex const& vertex, Vec3 y) {
  Way way;
  Vec3 const span = y - vertex.point;
  way.length = length(span);
  if (!(way.length > 0)) return way;
  way.out = (1 / way.length) * span;
  way.wo = vertex.frame.to_local(way.out);
  if (vertex.beyond_facet(way.wo, way.out)) return way;
  optics::ValueAndPdf const law =
      scatter_both(world.laws, *vertex.optic, vertex.albedos, vertex.wi, way.wo, vertex.n_in, vertex.n_out);
  way.bsdf = law.value;
  way.law_pdf = law.pdf;
  way.kept = kept_along(world, way.wo.z < 0 ? vertex.after : vertex.before, way.length);
  return way;
}
// Density per area with which the walk would have sampled this line, including the choice of the lobe.
STRAY_HD double walk_density(WorldView const& world, PathState const& path, Vertex const& vertex, Way const& way,
                             std::uint32_t patch, double cosine) {
  double const lobe = path.order == 0 ? 1 : vertex.albedo / vertex.kept();
  return lobe * per_area(mixture_pdf(world, vertex.side(), way.law_pdf, patch, way.length, cosine), way.length, cosine);
}
// Whether anything hides y, the far end of the line.
STRAY_HD bool blocked(WorldView const& world, Vertex const& vertex, Way const& way, Vertex const& y) {
  return world.occluded({vertex.point, way.out, way.length - world.slack(y.surface, way.length, y.cosine())},
                        {vertex.surface, vertex.piece, vertex.contact}, vertex.surface == y.surface);
}

// n^2 cos cos'/d^2 of a line from a vertex to a point that it meets under `cosine` (eq. 1.16).
STRAY_HD double line_geometry(Vertex const& from, Way const& way, double cosine) {
  double const n = way.wo.z < 0 ? from.n_out : from.n_in;
  double const leaving = from.smooth ? std::fabs(dot(way.out, from.facet)) : std::fabs(way.wo.z);
  return n * n * leaving * cosine / (way.length * way.length);
}

// Whether the sink hears scores of this vertex of the walk.
template <class Sink>
STRAY_HD bool hears(Sink const& sink, PathState const& path) {
  if constexpr (requires { sink.hears(path.event); }) return sink.hears(path.event);
  return true;
}

}  // namespace straytrace::trace
