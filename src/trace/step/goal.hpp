// SPDX-License-Identifier: BSD-3-Clause
// Where light is scored: a lit surface, where it rejoins a mode (docs/theory/path_integral.md), or a receiver, which
// counts watts. The power heuristic over all ways to get there is the same for both.
#pragma once

#include "trace/step/way.hpp"

namespace straytrace::trace {

// Goals are numbered: footprints first, then receivers. The number of a score within its vertex is even for a hit of
// the walk and odd for a connection.
STRAY_HD std::uint32_t arrival_number(std::uint32_t goal) { return 2 * goal; }
STRAY_HD std::uint32_t connection_number(std::uint32_t goal) { return 2 * goal + 1; }
STRAY_HD bool is_hit(std::uint32_t number) { return number % 2 == 0; }

STRAY_HD std::uint32_t goal_of_receiver(WorldView const& world, std::uint32_t receiver) {
  return std::uint32_t(world.lit.size) + receiver;
}
STRAY_HD bool is_receiver(WorldView const& world, std::uint32_t goal) { return goal >= world.lit.size; }
STRAY_HD Receiver const& receiver_of(WorldView const& world, std::uint32_t goal) {
  return world.receivers[goal - world.lit.size];
}
// Their order where the number of a goal decides random numbers: receivers first.
STRAY_HD std::uint32_t goal_count(WorldView const& world) {
  return std::uint32_t(world.lit.size + world.receivers.size);
}
STRAY_HD std::uint32_t place_of(WorldView const& world, std::uint32_t goal) {
  return is_receiver(world, goal) ? goal - std::uint32_t(world.lit.size) : goal + std::uint32_t(world.receivers.size);
}
STRAY_HD std::uint32_t goal_at(WorldView const& world, std::uint32_t place) {
  return place < world.receivers.size ? place + std::uint32_t(world.lit.size)
                                      : place - std::uint32_t(world.receivers.size);
}
STRAY_HD SurfaceId surface_of(WorldView const& world, std::uint32_t goal) {
  return is_receiver(world, goal) ? receiver_of(world, goal).surface : world.lit[goal].surface;
}
// Mean number of sub-paths per history that start there (sub_path.hpp).
STRAY_HD double sub_paths_of(WorldView const& world, std::uint32_t goal) {
  if (!is_receiver(world, goal)) return world.lit[goal].sub_paths;
  return receiver_of(world, goal).clear ? 0 : receiver_of(world, goal).sub_paths;
}

// The points of the goals to which the vertices of a history are connected: on lit surfaces drawn by |u|^2 |cos|, on
// receivers evenly. All vertices of a history share them, because that saves the work of drawing, and because dealt
// numbers then serve every vertex (docs/theory/sampling.md, Strata).
class GoalPoints {
 public:
  STRAY_HD void begin() { drawn_ = 0; }
  // Nothing where the line drawn of a mode misses its surface.
  STRAY_HD SurfaceSpot const* of(WorldView const& world, std::uint64_t seed, PathState const& path,
                                 std::uint32_t goal) {
    std::uint32_t const place = place_of(world, goal), slot = place < kept ? place : kept;
    if (slot == kept || !(drawn_ >> slot & 1u)) {
      spot_[slot] = draw(world, seed, path, goal);
      drawn_ |= 1u << slot;
    }
    return spot_[slot].surface.valid() ? &spot_[slot] : nullptr;
  }

 private:
  static constexpr std::uint32_t kept = 15;  // receivers first; points on other goals are computed at every vertex
  STRAY_HD static SurfaceSpot draw(WorldView const& world, std::uint64_t seed, PathState const& path,
                                   std::uint32_t goal) {
    bool const receiver = is_receiver(world, goal);
    Rng rng(seed, path.history, place_of(world, goal), receiver ? Stream::receiver : Stream::connection);
    double u = rng.uniform(), v = rng.uniform();
    path.strata.deal(Dealt::end, u, v);
    SurfaceId const id = surface_of(world, goal);
    if (receiver) {
      SurfacePoint const drawn =
          world.shapes.visit(world.surfaces[id.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
      return spot_on(world, id, drawn.point, drawn.piece);
    }
    Ray const line = world.lit[goal].sample(u, v);
    Crossing const met = world.cross(id.value, line, {});
    if (!(met.distance < infinity)) return {};
    return spot_on(world, id, line.origin + met.distance * line.dir, met.piece);
  }

  SurfaceSpot spot_[kept + 1];
  std::uint32_t drawn_ = 0;  // bits
};

// Density per area of the lit surface with which a connection draws the point y: |u|^2 |cos| (eq. 1.1 over q), 1/m^2.
STRAY_HD double connection_density(Footprint const& lit, Vec3 y, Vec3 normal) {
  return lit.intensity(y) * std::fabs(dot(normal, lit.travel));
}
// Whether the mode lights the point y of its surface: a line parallel to the chief ray, like those that connections
// draw, reaches y before it meets the surface elsewhere (eq. 1.14). The rest of a closed surface lies in its own
// shadow.
STRAY_HD bool lights(WorldView const& world, Footprint const& lit, Vec3 y, Vec3 normal) {
  double const way = dot(y - lit.centre, lit.travel) + lit.backoff;
  if (!(way > 0)) return false;
  Ray line{y - way * lit.travel, lit.travel};
  line.t_max = way - world.slack(lit.surface, way, std::fabs(dot(normal, lit.travel)));
  return !(world.cross(lit.surface.value, line, {}).distance < line.t_max);
}

// BSDF at the lit surface from the direction of arrival into the reversed mode, 1/sr. Light from behind rejoins through
// the surface, with the indices of the vertex.
STRAY_HD double rejoin_bsdf(WorldView const& world, Vertex const& at, Footprint const& lit) {
  Vec3 const out = -lit.direction(at.point), reversed = at.frame.to_local(out);
  if (at.beyond_facet(reversed, out)) return 0;
  if (reversed.z > 0) return scatter_eval(world.laws, *at.optic, at.wi, reversed);
  return scatter_eval(world.laws, *at.optic, at.wi, reversed, at.n_in, at.n_out);
}
STRAY_HD bool scatters_through(Optic const& optic) {
  for (int i = 0; i < optic.laws; ++i)
    if (optic.through[i]) return true;
  return false;
}
// Etendue of one mode in the medium where it arrives, m^2 sr (docs/theory/path_integral.md), times q.
STRAY_HD double accepted(WorldView const& world, Footprint const& lit) {
  double const wavelength = world.wavelength / lit.index;
  return wavelength * wavelength * lit.share;
}

// Share of light of this polarisation, travelling along `out`, that the mode accepts after the scatter at `y`; 1
// without polarisation (docs/theory/conventions.md: BSDF models then describe the main polarisation alone).
STRAY_HD double mode_share(WorldView const& world, Polarisation const& light, Vec3 out, Vertex const& y,
                           Footprint const& lit) {
  if (!world.polarised) return 1;
  Vec3 const reversed = -lit.direction(y.point);
  bool const through = dot(reversed, y.normal()) < 0;
  Polarisation const after = scattered(light, out, reversed, through, y.optic->depolarise);
  return polarisation_overlap(after, lit.polarisation, reversed);
}

// Density of a point drawn evenly on a surface, 1/m^2.
STRAY_HD double area_density(WorldView const& world, SurfaceId id) {
  return 1 / world.shapes.visit(world.surfaces[id.value].shape, [](auto const& s) { return s.area(); });
}
// Density per area with which a connection draws its point.
STRAY_HD double receiver_density(WorldView const& world, Receiver const& r) { return area_density(world, r.surface); }

// Probability with which a vertex on this side of a patch is connected to a goal (docs/theory/sampling.md, eq. 1.27).
STRAY_HD double connection_probability(WorldView const& world, std::uint32_t side, std::uint32_t goal) {
  if (side == WorldView::none || is_receiver(world, goal) || sub_paths_of(world, goal) > 0) return 1;
  return world.steering.connection(side, goal);
}

// Density per area with which a connection draws the point y of a goal.
STRAY_HD double density_on(WorldView const& world, std::uint32_t goal, Vertex const& y) {
  if (is_receiver(world, goal)) return receiver_density(world, receiver_of(world, goal));
  return connection_density(world.lit[goal], y.point, y.normal());
}

// Densities with which sub-paths (sub_path.hpp) start along `out`, per projected solid angle, 1/sr (eq. 1.28).
// By the cosine law on the sides that count:
STRAY_HD double cosine_density(Receiver const& r) { return 1 / (pi * r.sides()); }
// Towards a point drawn uniformly on an aim, hidden or not; `cosine`: at the receiver.
STRAY_HD double aim_density(WorldView const& world, SurfaceId aim, Ray const& out, double cosine) {
  Crossing const met = world.cross(aim.value, out, {});
  if (!(met.distance < infinity)) return 0;
  Vec3 const normal = world.normal(aim, out.origin + met.distance * out.dir, met.piece);
  return per_solid_angle(area_density(world, aim), met.distance, std::fabs(dot(normal, out.dir))) / cosine;
}
// All together, per area as well, 1/(m^2 sr).
STRAY_HD double start_density(WorldView const& world, Receiver const& r, Ray const& out, double cosine) {
  double density = r.cosine_share * cosine_density(r);
  for (std::uint32_t i = 0; i < r.aims; ++i)
    density += r.aim[i].share * aim_density(world, r.aim[i].surface, out, cosine);
  return receiver_density(world, r) * density;
}

// The lit surface as the mode meets it.
STRAY_HD Vertex met_by_mode(WorldView const& world, Footprint const& lit, Vec3 point, std::uint32_t piece) {
  Vec3 const travel = lit.direction(point);
  Vertex at = make_vertex(world, lit.surface, point, travel, piece);
  evaluate_scattering(world, {}, lit.polarisation, travel, at);
  return at;
}

// y on a goal as the first link of a path whose light arrives along `travel`.
STRAY_HD Ends ends_on(WorldView const& world, std::uint32_t goal, Vertex const& y, Vec3 travel) {
  Ends ends;
  ends.sub_paths = sub_paths_of(world, goal);
  ends.area = density_on(world, goal, y);
  if (!(ends.sub_paths > 0)) return ends;
  if (is_receiver(world, goal)) {
    ends.link[0].backward = start_density(world, receiver_of(world, goal), {y.point, -travel}, y.cosine()) / ends.area;
  } else {
    Vertex const at = met_by_mode(world, world.lit[goal], y.point, y.piece);
    ends.link[0].backward = scattered_density(world, at, at.frame.to_local(-travel));
  }
  return ends;
}

// Shares of a walk that hits the goal at y, and of a connection to y.
STRAY_HD Shares shares_of_hit(WorldView const& world, PathState const& path, Vertex const& y, std::uint32_t goal) {
  if (!(sub_paths_of(world, goal) > 0)) {
    double const walk = per_area(path.hop.pdf, y.leg, y.cosine());
    if (!(path.hop.pdf > 0)) return Shares(1);
    return Shares(weight_of(walk, connection_probability(world, path.hop.side, goal) * density_on(world, goal, y)));
  }
  if (path.trail.count == 0) return Shares(1);
  Ends ends = ends_on(world, goal, y, path.ray.dir);
  ends.append(path.trail, 1);
  ends.start = path.trail.start;
  ends.link[0].backward *= path.trail.back;
  ends.link[0].geometry = arrival_geometry(path.hop, y);
  return ends.shares(0);
}

// The vertex x of the walk and those before it, behind the first `t` of `ends`, for light that leaves x along `way`.
// `walk`: density per area with which the walk goes that way.
STRAY_HD void append_walk(WorldView const& world, PathState const& path, Vertex const& x, Way const& way, double cosine,
                          double walk, std::uint32_t t, Ends& ends) {
  double const geometry = line_geometry(x, way, cosine);
  ends.link[t - 1].geometry = geometry;
  ends.link[t] = link_at(world, path.trail, path.hop, x, path.ray.dir, way.out, way.wo.z < 0);
  ends.link[t].forward = walk / geometry;
  ends.append(path.trail, t + 1);
  ends.start = start_of(world, path, x, path.hop);
}

STRAY_HD Shares shares_of_connection(WorldView const& world, PathState const& path, Vertex const& vertex,
                                     Way const& way, Vertex const& y, double walk, std::uint32_t goal) {
  if (!(sub_paths_of(world, goal) > 0)) {
    return Shares(weight_of(connection_probability(world, vertex.side(), goal) * density_on(world, goal, y), walk));
  }
  Ends ends = ends_on(world, goal, y, way.out);
  append_walk(world, path, vertex, way, y.cosine(), walk, 1, ends);
  return ends.shares(1);
}

}  // namespace straytrace::trace
