// SPDX-License-Identifier: BSD-3-Clause
// Paths from the goal (docs/theory/sampling.md): a sub-path starts on a receiver, or in the reversed mode on a lit
// surface, is scattered by the BSDF models and passes mirrors and glass, and every vertex of the walk is connected to
// each of its scattering vertices. The power heuristic (balance.hpp) combines these connections with all other ways
// to make the same path. Where a sub-path meets a surface that a beam lights, directly or as a free beam by the
// straight way from its plane, that light's own scatter is scored as well.
#pragma once

#include "trace/step/goal.hpp"

namespace straytrace::trace {

// Names of the vertices between the end of a sub-path and the goal, nearest the goal first. Routes with more
// vertices than it holds have no names.
struct Chain {
  static constexpr std::uint32_t most_names = 16;
  std::uint64_t name[most_names];
  std::uint32_t hops = 0;  // all vertices between
  std::uint32_t ends = 1;  // scattering ones and that on the goal
  STRAY_HD void add(WorldView const& world, Vertex const& at, Event event) {
    if (hops < most_names)
      name[hops] = std::uint64_t(world.surfaces[at.surface.value].group.value) << 8 | std::uint64_t(event);
    ++hops;
  }
};

// A surface that a sub-path has met.
struct SubVertex {
  Vertex at;                              // for light that comes from the goal
  Vec3 towards;                           // unit vector back, along the way of the light
  double power = 0;                       // what light along the sub-path scores per power, times etendue, m^2 sr
  double chance = 1;                      // Link::chance
  double forward = 1;                     // probability with which the walk passes the specular surfaces behind it
  double distance = 0;                    // m along `towards` to the surface met there
  double cosine = 1;                      // of incidence on it
  std::uint32_t patch = WorldView::none;  // of it
  std::uint32_t hops = 0;                 // Chain::hops
};

struct SubPath {
  std::uint32_t goal = 0;
  std::uint32_t count = 0;          // of scattering vertices
  double area = 0;                  // 1/m^2, density of its point on the goal
  double density = 0;               // with which it started, 1/(m^2 sr)
  Vertex end;                       // on the goal, for the light that arrives
  SubVertex vertex[most_ends - 1];  // scattering ones
  Link link[most_ends];             // the goal and they
  Chain chain;

  // Links for a path that is connected to scattering vertex number i; its own is left to the caller.
  STRAY_HD Ends ends_behind(WorldView const& world, std::uint32_t i) const {
    Ends ends;
    for (std::uint32_t j = 0; j <= i; ++j) ends.link[j] = link[j];
    ends.area = area;
    ends.sub_paths = sub_paths_of(world, goal);
    return ends;
  }
  STRAY_HD Chain chain_to(std::uint32_t i) const {
    Chain to = chain;
    to.hops = vertex[i].hops;
    to.ends = i + 1;
    return to;
  }
};

// Numbers of the sub-path from a goal; those of its start are dealt.
class BackwardNumbers {
 public:
  STRAY_HD BackwardNumbers(WorldView const& world, std::uint64_t seed, std::uint64_t history, Strata const& strata,
                           std::uint32_t goal)
      : random_(seed, history, 0, static_cast<Stream>(std::uint32_t(Stream::backward) + (place_of(world, goal) << 8))),
        strata_(strata) {}
  STRAY_HD double uniform() { return random_.uniform(); }
  struct Pair {
    double u, v;
  };
  STRAY_HD Pair dealt(Dealt what) {
    double u = uniform(), v = uniform();
    strata_.deal(what, u, v);
    return {u, v};
  }

 private:
  Rng random_;
  Strata strata_;
};

// Direction of a sub-path from a point of the receiver; zero: none.
STRAY_HD Vec3 start_direction(WorldView const& world, Receiver const& r, Vec3 start, Vec3 normal,
                              BackwardNumbers& numbers) {
  auto const [a, b] = numbers.dealt(Dealt::end_direction);
  double choice = r.aims > 0 ? numbers.uniform() : 1;
  for (std::uint32_t i = 0; i < r.aims; choice -= r.aim[i++].share) {
    if (!(choice < r.aim[i].share)) continue;
    SurfaceId const aim = r.aim[i].surface;
    Vec3 const span = world.shapes.visit(world.surfaces[aim.value].shape, [&](auto const& s) {
      return sample_of(s, a, b).point;
    }) - start;
    double const far = length(span);
    if (!(far > 0)) return {};
    Ray const out{start, (1 / far) * span};
    Crossing const met = world.cross(aim.value, out, {});
    if (!(met.distance < infinity)) return {};
    double const cosine = std::fabs(dot(world.normal(aim, start + met.distance * out.dir, met.piece), out.dir));
    bool const same = std::fabs(met.distance - far) <= world.slack(aim, far, cosine);
    return same ? out.dir : Vec3{};  // a nearer part of the surface has its own density
  }
  bool const front = r.sides() == 2 ? numbers.uniform() < 0.5 : r.front;
  SinCos const azimuth = sincos_turn(b);
  double const rho = std::sqrt(a);
  return Frame::around(front ? normal : -normal).to_world({rho * azimuth.cos, rho * azimuth.sin, std::sqrt(1 - a)});
}

// The BSDF models of z for light that continues along the sub-path; a value of 0: none does.
STRAY_HD optics::ValueAndPdf passed_on(WorldView const& world, SubVertex const& met, Vertex const& z, Vec3 wo) {
  if (!(z.wi.z > 0) || z.beyond_facet(wo, met.towards)) return {};
  return scatter_both(world.laws, *z.optic, z.albedos, z.wi, wo, z.n_in, z.n_out);
}
STRAY_HD double index_towards(Vertex const& v, Vec3 wo) { return wo.z < 0 ? v.n_out : v.n_in; }

// Density per etendue with which the walk that has reached z leaves it there. `law`: of the BSDF models, 1/sr.
STRAY_HD double leaving_density(WorldView const& world, SubVertex const& met, Vertex const& z, Vec3 wo, double law,
                                double lobe) {
  double const n = index_towards(z, wo);
  double const cosine = z.smooth ? std::fabs(dot(met.towards, z.facet)) : std::fabs(wo.z);
  return lobe * mixture_pdf(world, z.side(), law, met.patch, met.distance, met.cosine) / (n * n * cosine) * met.forward;
}

// The path of a sub-path while it grows.
struct Growing {
  Ray ray;
  Departure from;
  MediaStack media;
  SubVertex next;          // what is known of the surface to be met
  double left_cosine = 1;  // of the scattering vertex left, for the geometry of the next leg
  bool straight = true;    // no specular surface since
  std::uint32_t hops = 0;  // specular surfaces since
};

// Starts the sub-path on a receiver; false: it leaves on a side that does not count.
STRAY_HD bool start_on_receiver(WorldView const& world, Receiver const& r, BackwardNumbers& numbers, SubPath& sub,
                                Growing& g) {
  auto const [u, v] = numbers.dealt(Dealt::end);
  SurfacePoint const start =
      world.shapes.visit(world.surfaces[r.surface.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
  Vec3 const normal = world.normal(r.surface, start.point, start.piece);
  g.ray = {start.point, start_direction(world, r, start.point, normal, numbers)};
  g.from = {r.surface, start.piece};
  double const cosine = dot(g.ray.dir, normal);
  if (cosine == 0 || !r.counts(cosine > 0)) return false;
  sub.area = receiver_density(world, r);
  sub.density = start_density(world, r, g.ray, std::fabs(cosine));
  sub.end = make_vertex(world, r.surface, start.point, -g.ray.dir, start.piece);
  g.next.power = 1 / sub.density;
  return true;
}
// Starts it on a lit surface, which scatters the reversed mode (eq. 1.21); false: no light.
STRAY_HD bool start_in_mode(WorldView const& world, Footprint const& lit, BackwardNumbers& numbers, SubPath& sub,
                            Growing& g) {
  auto const [a, b] = numbers.dealt(Dealt::end);
  double const choice = numbers.uniform();
  auto const [u, v] = numbers.dealt(Dealt::end_direction);
  Ray const line = lit.sample(a, b);
  Crossing const met = world.cross(lit.surface.value, line, {});
  if (!(met.distance < infinity)) return false;
  Vertex const at = met_by_mode(world, lit, line.origin + met.distance * line.dir, met.piece);
  if (at.smooth || !(at.albedo > 0)) return false;
  BsdfSample const s = scatter_sample(world.laws, *at.optic, at.albedos, at.wi, choice, u, v, at.n_in, at.n_out);
  if (!(s.pdf > 0)) return false;
  g.ray = {at.point, unit(at.frame.to_world(s.wo))};
  g.from = {at.surface, at.piece, at.contact};
  g.media = s.wo.z < 0 ? at.after : at.before;
  sub.end = seen_along(world, at, -g.ray.dir, g.media);
  double const n = index_towards(at, s.wo), backward = s.pdf / (n * n * std::fabs(s.wo.z));
  sub.area = connection_density(lit, at.point, at.normal());
  sub.density = sub.area * backward;
  g.next.power = rejoin_bsdf(world, sub.end, lit) * accepted(world, lit) / backward;
  return g.next.power > 0;
}
STRAY_HD bool start_sub_path(WorldView const& world, BackwardNumbers& numbers, SubPath& sub, Growing& g) {
  bool const starts = is_receiver(world, sub.goal)
                          ? start_on_receiver(world, receiver_of(world, sub.goal), numbers, sub, g)
                          : start_in_mode(world, world.lit[sub.goal], numbers, sub, g);
  sub.link[0] = {};
  sub.link[0].backward = sub.density / sub.area;
  g.next.patch = sub.end.patch;
  g.next.cosine = g.left_cosine = sub.end.cosine();
  return starts;
}

// Leaves the surface `met` by a specular way.
STRAY_HD void pass_backwards(WorldView const& world, SubVertex const& met, SpecularWay const& way, SubPath& sub,
                             Growing& g) {
  Vertex const& at = met.at;
  ReversedWay const walk = reversed_way(world, at, way);
  sub.link[sub.count].backward *= way.through ? at.transmit : at.reflect;
  sub.link[sub.count].geometry = 0;
  sub.chain.add(world, at, way.event());
  g.next = met;
  g.next.forward *= walk.share / walk.kept;
  g.next.patch = at.patch;
  g.next.cosine = std::fabs(dot(way.out, at.normal()));
  g.ray = {at.point, way.out};
  g.from = {at.surface, at.piece, at.contact};
  g.media = way.through ? at.after : at.before;
  g.straight = false;
  ++g.hops;
}

// The scattering vertex met last leaves along a direction drawn from its BSDF models; false: the sub-path ends there.
STRAY_HD bool scatter_backwards(WorldView const& world, double choice, BackwardNumbers& numbers, SubPath& sub,
                                Growing& g) {
  SubVertex const& met = sub.vertex[sub.count - 1];
  Vertex const& at = met.at;
  double const u = numbers.uniform(), v = numbers.uniform();
  BsdfSample const s = scatter_sample(world.laws, *at.optic, at.albedos, at.wi, choice, u, v, at.n_in, at.n_out);
  if (at.smooth || !(s.pdf > 0)) return false;
  Vec3 const out = unit(at.frame.to_world(s.wo));
  g.media = s.wo.z < 0 ? at.after : at.before;
  Vertex const z = seen_along(world, at, -out, g.media);
  Vec3 const wo = z.frame.to_local(met.towards);
  optics::ValueAndPdf const law = passed_on(world, met, z, wo);
  if (!(law.value > 0)) return false;
  double const n = index_towards(at, s.wo), n_z = index_towards(z, wo);
  Link& link = sub.link[sub.count];
  link = {};
  link.backward = at.albedo * s.pdf / (n * n * std::fabs(s.wo.z));
  link.forward = leaving_density(world, met, z, wo, law.pdf, z.albedo / z.kept());
  link.chance = met.chance;
  sub.chain.add(world, at, Event::scatter);
  g.next = {};
  g.next.power = met.power * met.chance * law.value / (n_z * n_z * link.backward);
  g.next.patch = at.patch;
  g.next.cosine = g.left_cosine = std::fabs(s.wo.z);
  g.ray = {at.point, out};
  g.from = {at.surface, at.piece, at.contact};
  g.straight = true;
  g.hops = 0;
  return true;
}

// Grows a sub-path from its goal to at most `most` scattering vertices. Calls met(vertex) for every surface, scattering
// or not, and passed(vertex, event, through) where it continues.
template <class Passed, class Met>
STRAY_HD void grow(WorldView const& world, std::uint32_t most, BackwardNumbers& numbers, SubPath& sub, Passed&& passed,
                   Met&& met) {
  sub.count = sub.chain.hops = 0;
  Growing g;
  if (!start_sub_path(world, numbers, sub, g)) return;
  while (g.hops <= most_specular_hops) {
    Hit const hit = world.closest(g.ray, g.from);
    if (!hit.surface.valid()) return;
    SubVertex now = g.next;
    now.at = make_vertex(world, hit.surface, g.ray.origin + hit.distance * g.ray.dir, g.ray.dir, hit.piece);
    evaluate_scattering(world, g.media, {}, g.ray.dir, now.at);
    now.towards = -g.ray.dir;
    now.distance = hit.distance;
    now.power *= kept_along(world, g.media, hit.distance);
    now.hops = sub.chain.hops;
    double const cosine = now.at.cosine(), n = now.at.n_in;
    if (g.straight) sub.link[sub.count].geometry = n * n * g.left_cosine * cosine / (hit.distance * hit.distance);
    met(now);
    double const choice = numbers.uniform(), specular = now.at.reflect + now.at.transmit;
    if (choice < specular) {
      bool const through = choice >= now.at.reflect;
      SpecularWay const way =
          specular_way(world, g.ray.dir, now.at, through, through ? choice - now.at.reflect : choice);
      passed(now.at, way.event(), way.through);
      pass_backwards(world, now, way, sub, g);
      continue;
    }
    if (!(now.at.albedo > 0)) return;
    now.chance = 1 - specular;
    now.power /= now.chance;
    sub.vertex[sub.count++] = now;
    if (choice >= now.at.kept() || sub.count == most) return;
    if (!scatter_backwards(world, (choice - specular) / now.at.albedo, numbers, sub, g)) return;
    passed(now.at, Event::scatter, dot(g.ray.dir, now.at.frame.e3) < 0);
  }
}

// Light of a beam where a sub-path meets a surface.
struct Lit {
  Vec3 travel;
  double density = 0;  // over the power of the beam, per area of the surface, 1/m^2; 0: none
};
STRAY_HD Lit light_at(WorldView const& world, Footprint const& beam, Vec3 point, SurfaceId surface, Vec3 normal) {
  if (beam.profile == Profile::point) return {};
  if (!beam.free) {
    bool const lit = beam.surface == surface && lights(world, beam, point, normal);
    return {beam.direction(point), lit ? connection_density(beam, point, normal) : 0};
  }
  Footprint::Passing const light = beam.passing(point);
  double const cosine = std::fabs(dot(normal, light.travel)), density = light.irradiance * cosine;
  if (!(density > 0)) return {};
  double const way = length(point - light.start), clear = way - world.slack(surface, way, cosine);
  return {light.travel, world.occluded({light.start, light.travel, clear}, {}) ? 0 : density};
}

// Light of the beam `source`, scattered once where a sub-path meets it: irradiance x BSDF x etendue.
template <class Sink>
STRAY_HD void score_lit_by(WorldView const& world, PathState const& path, std::uint32_t source, SubVertex const& met,
                           SubPath const& sub, Sink& sink) {
  Footprint const& beam = world.lit[source];
  if (sub.chain.hops + (beam.free ? 1 : 0) >= world.limits.max_order) return;
  Vertex const& at = met.at;
  Lit const lit = light_at(world, beam, at.point, at.surface, world.normal(at.surface, at.point, at.piece));
  if (!(lit.density > 0)) return;
  Vertex z = make_vertex(world, at.surface, at.point, lit.travel, at.piece);
  evaluate_scattering(world, {}, beam.polarisation, lit.travel, z);
  Vec3 const wo = z.frame.to_local(met.towards);
  optics::ValueAndPdf const law = passed_on(world, met, z, wo);
  if (!(law.value > 0)) return;
  double const n_z = index_towards(z, wo), f = law.value / (n_z * n_z);
  Ends ends = sub.ends_behind(world, sub.count);
  ends.vertices = sub.count + 2;
  ends.start = lit.density / world.draws();
  ends.link[sub.count + 1].forward = leaving_density(world, met, z, wo, law.pdf, beam.free ? z.albedo / z.kept() : 1);
  Shares const shares = ends.shares(ends.vertices);
  double const power = beam.share * lit.density * f * met.power * shares.weight / ends.sub_paths;
  if (!(power > 0)) return;
  tell_shares(sink, shares);
  Chain chain = sub.chain;
  chain.ends = ends.vertices;
  sink.score_lit(path, source, z, chain, sub.goal, sub.end, power);
}

// Connects the vertex x to scattering vertex number i of a sub-path.
template <class Sink>
STRAY_HD void connect_to_sub_path(WorldView const& world, PathState const& path, Vertex const& x, SubPath const& sub,
                                  std::uint32_t i, Sink& sink) {
  SubVertex const& met = sub.vertex[i];
  if (path.order + met.hops + 2 > world.limits.max_order) return;
  Way const way = way_to(world, x, met.at.point);
  if (!(way.bsdf > 0)) return;
  MediaStack const& media = way.wo.z < 0 ? x.after : x.before;
  Vertex const z = seen_along(world, met.at, way.out, media);
  Vec3 const wo = z.frame.to_local(met.towards);
  optics::ValueAndPdf const law = passed_on(world, met, z, wo);
  if (!(law.value > 0) || blocked(world, x, way, z)) return;
  double const n_z = index_towards(z, wo), f = law.value / (n_z * n_z);
  double const walk = walk_density(world, path, x, way, z.patch, z.cosine());
  Ends ends = sub.ends_behind(world, i);
  Link& link = ends.link[i + 1];
  link.chance = met.chance;
  link.forward = leaving_density(world, met, z, wo, law.pdf, z.albedo / z.kept());
  link.backward = back_density(world, met.at, met.at.frame.to_local(-way.out));
  append_walk(world, path, x, way, z.cosine(), walk, i + 2, ends);
  Shares const shares = ends.shares(i + 2);
  double const power =
      path.power * way.bsdf * way.kept * way.geometry(z.cosine()) * f * met.power * shares.weight / ends.sub_paths;
  if (!(power > 0)) return;
  tell_shares(sink, shares);
  if constexpr (requires(Chain const& c) { sink.score_through(path, x, z, c, 0u, z, power); })
    sink.score_through(path, x, z, sub.chain_to(i), sub.goal, sub.end, power);
}

// A history and the sub-paths that were drawn with it.
struct SubPaths {
  static constexpr std::uint32_t most = 5;
  std::uint32_t count = 0;
  SubPath sub[most];
};

// The sub-paths of a history, each goal with its mean number (systematic sampling), and the light of all beams on the
// surfaces that they meet.
template <class Sink>
STRAY_HD void grow_sub_paths(WorldView const& world, std::uint64_t seed, PathState const& path, SubPaths& all,
                             Sink& sink) {
  constexpr bool hears_lit = requires(Vertex const& v, Chain const& c) { sink.score_lit(path, 0u, v, c, 0u, v, 0.0); };
  double sum = Rng(seed, path.history, 1, Stream::backward).uniform();
  for (std::uint32_t place = 0; place < goal_count(world) && all.count < SubPaths::most; ++place) {
    std::uint32_t const goal = goal_at(world, place);
    double const before = std::floor(sum);
    sum += sub_paths_of(world, goal);
    if (!(std::floor(sum) > before)) continue;
    SubPath& sub = all.sub[all.count++];
    sub.goal = goal;
    BackwardNumbers numbers(world, seed, path.history, path.strata, goal);
    grow(
        world, most_ends - 1, numbers, sub, [](Vertex const&, Event, bool) {},
        [&](SubVertex const& met) {
          if constexpr (hears_lit)
            for (std::size_t i = 0; i < world.emitters.size && hears(sink, path); ++i)
              score_lit_by(world, path, world.emitters[i], met, sub, sink);
        });
  }
}

// A vertex of the walk and all sub-paths of its history.
template <class Sink>
STRAY_HD void connect_sub_paths(WorldView const& world, PathState const& path, Vertex const& vertex,
                                SubPaths const& all, Sink& sink) {
  if (!(vertex.albedo > 0) || !hears(sink, path)) return;
  for (std::uint32_t s = 0; s < all.count; ++s)
    for (std::uint32_t i = 0; i < all.sub[s].count; ++i) connect_to_sub_path(world, path, vertex, all.sub[s], i, sink);
}

}  // namespace straytrace::trace
