// SPDX-License-Identifier: BSD-3-Clause
// The mixture from which directions are drawn, in solid angle at the vertex left (docs/theory/sampling.md):
//   p(w) = alpha p_law(w) + (1 - alpha) q_k d^2/(A_k cos_y)      k: the patch that is hit first along w
// One sample, one division, whichever component drew it. The scatter law always takes part (alpha >= 0.1), so no light
// is missed because no target was listed for it.
#pragma once

#include "trace/step/path.hpp"

namespace straytrace {

// Density per area becomes density per solid angle and back: the only places where d^2 stands.
STRAY_HD double per_solid_angle(double per_area, double distance, double cosine) {
  return cosine > 0 ? per_area * distance * distance / cosine : 0;
}
STRAY_HD double per_area(double per_solid_angle, double distance, double cosine) {
  return per_solid_angle * cosine / (distance * distance);
}

// The part of the targets in that: density 1/sr of aiming from `side` at what lies on `patch`, at `distance` under
// `cosine`.
STRAY_HD double aimed_pdf(WorldView const& world, std::uint32_t side, std::uint32_t patch, double distance,
                          double cosine) {
  if (side == WorldView::none || patch == WorldView::none) return 0;
  return per_solid_angle(world.steering.density(world.steering.sides[side], patch), distance, cosine);
}
STRAY_HD double law_share(WorldView const& world, std::uint32_t side) {
  return side == WorldView::none ? 1 : world.steering.sides[side].alpha;
}
STRAY_HD double mixture_pdf(WorldView const& world, std::uint32_t side, double law_pdf, std::uint32_t patch,
                            double distance, double cosine) {
  double const alpha = law_share(world, side);
  return alpha < 1 ? alpha * law_pdf + (1 - alpha) * aimed_pdf(world, side, patch, distance, cosine) : law_pdf;
}

// Whether a ray met the point of `aim` it was sent to: what is met earlier, by more than rounding, hides that point.
STRAY_HD bool met_aim(WorldView const& world, Hop const& hop, Vertex const* met) {
  if (!met || met->surface != hop.aim) return false;
  return met->leg >= hop.aim_distance - world.slack(hop.aim, hop.aim_distance, met->wi.z);
}

// Weight of the hop now that its end is known; 0 when something hides the target that was aimed at. Sets hop.pdf.
// `vertex`: where the ray arrived; null when it escaped.
STRAY_HD double finish_hop_weight(WorldView const& world, PathState& path, Vertex const* vertex) {
  Hop& hop = path.hop;
  if (!(hop.law_pdf > 0) && !hop.aim.valid()) {  // specular
    hop.pdf = 0;
    return hop.value / hop.lobe;
  }
  if (hop.aim.valid() && !met_aim(world, hop, vertex)) {
    hop.pdf = 0;
    return 0;
  }
  double const alpha = law_share(world, hop.side);
  double const aimed = vertex && alpha < 1 ? aimed_pdf(world, hop.side, vertex->patch, vertex->leg, vertex->wi.z) : 0;
  hop.aimed = alpha < 1;
  hop.off_list = vertex && alpha < 1 && aimed == 0;
  hop.pdf = hop.lobe * (alpha * hop.law_pdf + (1 - alpha) * aimed);
  double const n = index_of(world, path.media.current());
  path.left_pdf = hop.pdf / (hop.cosine * n * n);
  return hop.pdf > 0 ? hop.value / hop.pdf : 0;
}

// A direction towards a point drawn on one of the targets of `side`; hop.aim says which.
STRAY_HD Vec3 aimed_direction(WorldView const& world, Vertex const& vertex, double choice, double u, double v,
                              Hop& hop) {
  Steering const& steering = world.steering;
  Target const& target = steering.targets[steering.draw(steering.sides[vertex.side()], choice)];
  Steering::Place const place = steering.place(target.patch, u);
  SurfaceId const aim = steering.strips[place.strip].surface;
  Vec3 const y =
      world.shapes.visit(world.surfaces[aim.value].shape, [&](auto const& s) { return sample_in_strip(s, place.u, v); })
          .point;
  Vec3 const span = y - vertex.point;
  hop.aim = aim;
  hop.aim_distance = length(span);
  return hop.aim_distance > 0 ? (1 / hop.aim_distance) * span : vertex.frame.e3;
}

}  // namespace straytrace
