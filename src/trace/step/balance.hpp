// SPDX-License-Identifier: BSD-3-Clause
// The power heuristic over all ways to make a path from its source to a receiver (docs/theory/sampling.md, eq. 1.15
// to 1.18). Strategy t takes t vertices from the receiver and the others from the source, and connects the two:
// t = 0: the walk hits the receiver; t = 1: a connection to a point drawn on it; t >= 2: a connection to a vertex of a
// sub-path; t = m, all scattering vertices: the sub-path meets light of a beam.
// Only functions of the vertices are densities: neither depth nor power nor the weight window enters.
#pragma once

#include "trace/step/path.hpp"

namespace straytrace::trace {

// Conversion between densities per area and per solid angle.
STRAY_HD double per_solid_angle(double per_area, double distance, double cosine) {
  return cosine > 0 ? per_area * distance * distance / cosine : 0;
}
STRAY_HD double per_area(double per_solid_angle, double distance, double cosine) {
  return per_solid_angle * cosine / (distance * distance);
}

constexpr std::uint32_t most_specular_hops = 32;  // of a sub-path between two scattering vertices

// What a sub-path does at a vertex that it meets along -out.
struct Reversed {
  double backward = 0;  // density per etendue with which it leaves against the light that arrives, 1/(m^2 sr)
  double chance = 1;    // with which it can be connected there
};
// Density per etendue of the scattered lobe of a vertex seen from the goal. Normals of smooth meshes depend on the
// direction of arrival: no sub-path is scattered by them.
STRAY_HD double scattered_density(WorldView const& world, Vertex const& at, Vec3 wo) {
  if (at.smooth) return 0;
  double const n = wo.z < 0 ? at.n_out : at.n_in;
  double const law = scatter_both(world.laws, *at.optic, at.albedos, at.wi, wo, at.n_in, at.n_out).pdf;
  return law / (n * n * std::fabs(wo.z));
}
STRAY_HD double back_density(WorldView const& world, Vertex const& at, Vec3 wo) {
  return at.albedo * scattered_density(world, at, wo);
}
// `travel`, `out`: of light at the vertex on its way to the receiver.
STRAY_HD Reversed reversed_at(WorldView const& world, Vertex const& vertex, Vec3 travel, Vec3 out, bool through) {
  Vertex const back = seen_along(world, vertex, -out, through ? vertex.after : vertex.before);
  return {back_density(world, back, back.frame.to_local(-travel)), 1 - back.reflect - back.transmit};
}

// n^2 cos cos'/d^2 of the leg on which the walk has arrived (eq. 1.16); 0 for a specular hop.
STRAY_HD double arrival_geometry(Hop const& hop, Vertex const& vertex) {
  if (!(hop.pdf > 0)) return 0;
  return vertex.n_in * vertex.n_in * hop.cosine * vertex.cosine() / (vertex.leg * vertex.leg);
}

// The vertex as a link, for light that leaves it along `out`; `forward` is left to the caller. `arrived`: the hop to
// it.
STRAY_HD Link link_at(WorldView const& world, Trail const& trail, Hop const& arrived, Vertex const& vertex, Vec3 travel,
                      Vec3 out, bool through) {
  Link link;
  if (trail.count == 0) return link;  // the first one: no sub-path leaves it
  Reversed const back = reversed_at(world, vertex, travel, out, through);
  link.backward = back.backward * trail.back;
  link.chance = back.chance;
  link.geometry = arrival_geometry(arrived, vertex);
  return link;
}

// Density per area of the first scattering vertex of a path: drawn on a lit surface, or reached straight from the plane
// of a free beam.
STRAY_HD double start_of(WorldView const& world, PathState const& path, Vertex const& vertex, Hop const& arrived) {
  if (path.trail.count > 0 || path.order == 0) return path.trail.start;
  if (!path.coherent || arrived.left_by != Event::emit) return 0;
  return world.lit[path.source].passing(vertex.point).irradiance * vertex.cosine() / world.draws();
}

// Shares of light that comes from the other side of a specular way and takes it against `vertex.wi`.
struct ReversedWay {
  double share = 0, kept = 1;
};
STRAY_HD ReversedWay reversed_way(WorldView const& world, Vertex const& vertex, SpecularWay const& way) {
  if (!way.through) return {vertex.reflect, vertex.kept()};
  if (vertex.optic->diffracts || vertex.smooth) return {vertex.transmit, vertex.kept()};
  Vertex const back = seen_along(world, vertex, -way.out, vertex.after);
  return {back.transmit, back.kept()};
}

// The walk leaves the vertex by a specular way, chosen with probability `lobe`.
STRAY_HD void pass_specular(WorldView const& world, Trail& trail, Vertex const& vertex, SpecularWay const& way,
                            double lobe) {
  if (trail.count == 0) return;
  trail.link[0].forward *= lobe;
  trail.back *= ++trail.hops > most_specular_hops ? 0 : reversed_way(world, vertex, way).share;
}

// Sums of powers of numbers of samples.
struct Powers {
  double squares = 0, cubes = 0;
  STRAY_HD void add(double samples) {
    double const square = samples * samples;
    squares += square;
    cubes += samples * square;
  }
};

// What the other strategies of a path do for a score.
struct Shares {
  double weight;      // of the score, eq. 1.18
  double own = 1;     // samples of the strategy that made it
  Powers walk{1, 1};  // strategies 0 and 1
  Powers sub_paths;   // the others
  STRAY_HD explicit Shares(double of_score = 1) : weight(of_score) {}
  // Second moment with `times` as many sub-paths, over the square of the score (eq. 1.20).
  STRAY_HD double moment(double times) const {
    constexpr double never = 1e12;
    double const square = times * times, squares = walk.squares + square * sub_paths.squares;
    double const cubes = walk.cubes + times * square * sub_paths.cubes, factor = cubes / (squares * squares);
    double const all = walk.squares + sub_paths.squares;
    return squares > 0 && all / own * factor < never ? all / own * factor : never;
  }
  // Score with `times` as many sub-paths over the score.
  STRAY_HD double change(bool of_sub_path, double times) const {
    double const squares = walk.squares + times * times * sub_paths.squares;
    if (!(squares > 0)) return 0;
    return (of_sub_path ? times : 1) * (walk.squares + sub_paths.squares) / squares;
  }
};
// Weight of one of two strategies (eq. 1.9).
STRAY_HD double weight_of(double own, double other) {
  double const ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

// A path for the heuristic: its last scattering vertices, the receiver first.
struct Ends {
  Link link[most_ends + 1];
  std::uint32_t vertices = 0;  // m, scattering vertices of the path and the receiver
  double area = 0;             // 1/m^2, density of the point on the receiver
  double start = 0;            // 1/m^2, that of the first vertex; 0: no sub-path ends there
  double sub_paths = 0;        // mean number of sub-paths per history

  // The vertices of a walk behind the first `t`.
  STRAY_HD void append(Trail const& trail, std::uint32_t t) {
    for (std::uint32_t i = 0; t + i <= most_ends && i < most_ends && i < trail.count; ++i) link[t + i] = trail.link[i];
    vertices = t + trail.count;
  }
  // Strategy t over the product of the factors up to it.
  STRAY_HD double samples(std::uint32_t t) const {
    if (t == 0) return 1;
    if (t == vertices) return start > 0 ? sub_paths : 0;
    if (!(link[t - 1].geometry > 0)) return 0;
    return (t == 1 ? 1 : sub_paths) * link[t - 1].chance / link[t - 1].geometry;
  }
  // Factor from strategy t to t + 1, as numerator and denominator (eq. 1.17).
  STRAY_HD double taken(std::uint32_t t) const { return t == 0 ? area : link[t - 1].backward; }
  STRAY_HD double left_out(std::uint32_t t) const { return t + 1 == vertices ? start : link[t + 1].forward; }

  STRAY_HD Shares shares(std::uint32_t t) const {
    Shares found(0);
    found.own = samples(t);
    found.walk = {};
    auto const count = [&found](std::uint32_t strategy, double n) {
      (strategy <= 1 ? found.walk : found.sub_paths).add(n);
    };
    count(t, found.own);
    double ratio = 1;
    std::uint32_t const end = vertices < most_ends ? vertices : most_ends;
    for (std::uint32_t i = t; i < end && (i == 0 || sub_paths > 0); ++i) {
      double const over = left_out(i);
      if (!(over > 0)) break;
      ratio *= taken(i) / over;
      if (!(ratio > 0)) break;
      count(i + 1, ratio * samples(i + 1));
    }
    ratio = 1;
    for (std::uint32_t i = t; i-- > 0;) {
      ratio *= left_out(i) / taken(i);
      count(i, ratio * samples(i));
    }
    double const all = found.walk.squares + found.sub_paths.squares;
    if (all > 0) found.weight = found.own * found.own / all;
    return found;
  }
};

// Tells a sink that asks for them the shares of the score that follows.
template <class Sink>
STRAY_HD void tell_shares(Sink& sink, Shares const& shares) {
  if constexpr (requires { sink.shares(shares); }) sink.shares(shares);
}

}  // namespace straytrace::trace
