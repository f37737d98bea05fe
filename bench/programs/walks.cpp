// SPDX-License-Identifier: BSD-3-Clause
// Walks through the scenes, from single rays to whole bounces.
#include <cmath>

#include "base/math/rng.hpp"
#include "optics/scatter/diffuse.hpp"
#include "optics/scatter/shift_invariant.hpp"
#include "scenes.hpp"
#include "trace/step/path.hpp"

namespace straytrace::bench {
namespace {

// State of a diffuse walk.
struct Place {
  Departure from;
  Vec3 point, normal;
};
Place start_of(BenchScene const& scene, WorldView const& view, std::uint64_t seed, std::uint64_t number) {
  auto const choices = std::uint32_t(view.surfaces.size) - scene.first_start;
  SurfaceId const first{scene.first_start + std::uint32_t(number % 2 ? 0 : number / 2 % choices)};
  Rng rng(seed, number, 0, Stream::source);
  double const u = rng.uniform(), v = rng.uniform();
  SurfacePoint const at =
      view.shapes.visit(view.surfaces[first.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
  Vec3 const p = view.project(first, at.point, at.piece), n = view.normal(first, p, at.piece);
  return {Departure(first, at.piece), p, scene.inward && dot(n, p) > 0 ? -n : n};
}
constexpr std::uint32_t hops = 1000;  // of one walk

// Direction about the normal.
Vec3 drawn(std::uint64_t seed, std::uint64_t number, std::uint32_t event) {
  Rng rng(seed, number, event, Stream::direction);
  double const x = rng.uniform(), y = rng.uniform();
  return Lambertian{1}.sample({0, 0, 1}, x, y).wo;
}

}  // namespace

void walk(BenchScene const& scene, std::size_t count, std::uint64_t seed, Visit const& visit) {
  WorldView const view = scene.world.view();
  std::size_t done = 0;
  for (std::uint64_t number = 0; done < count; ++number) {
    auto [from, p, n] = start_of(scene, view, seed, number);
    for (std::uint32_t event = 1; event <= hops && done < count; ++event, ++done) {
      Vec3 const local = drawn(seed, number, event);
      Ray const ray{p, unit(Frame::around(n).to_world(local))};
      Hit const hit = view.closest(ray, from);
      visit(ray, from, hit);
      if (!hit.surface.valid()) break;
      from = {hit.surface, hit.piece};
      p = view.project(hit.surface, ray.origin + hit.distance * ray.dir, hit.piece);
      n = view.normal(hit.surface, p, hit.piece);
      if (dot(n, ray.dir) > 0) n = -n;
    }
  }
}

std::vector<BenchRay> walk_rays(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  std::vector<BenchRay> rays;
  walk(scene, count, seed, [&](Ray const& ray, Departure const& from, Hit const&) { rays.push_back({ray, from}); });
  return rays;
}

std::size_t bounce(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  std::size_t hits = 0;
  walk(scene, count, seed, [&](Ray const&, Departure const&, Hit const& hit) { hits += hit.surface.valid(); });
  return hits;
}

std::size_t bounce_together(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  struct Walk {
    std::uint64_t number = 0;
    std::uint32_t event = 0;
    Place at;
    Vec3 local;
    Ray ray;
    Hit hit;
  } walks[8];
  WorldView const view = scene.world.view();
  std::uint64_t number = 0;
  std::size_t hits = 0;
  for (std::size_t done = 0; done < count; done += std::size(walks)) {
    for (Walk& w : walks) {
      if (w.event % hops != 0 && w.hit.surface.valid()) continue;
      w.number = number++;
      w.event = 0;
      w.at = start_of(scene, view, seed, w.number);
    }
    for (Walk& w : walks) w.local = drawn(seed, w.number, ++w.event);
    for (Walk& w : walks) w.ray = {w.at.point, unit(Frame::around(w.at.normal).to_world(w.local))};
    for (Walk& w : walks) w.hit = view.closest(w.ray, w.at.from);
    for (Walk& w : walks)
      if (w.hit.surface.valid()) {
        w.at.from = {w.hit.surface, w.hit.piece};
        w.at.point = view.project(w.hit.surface, w.ray.origin + w.hit.distance * w.ray.dir, w.hit.piece);
      }
    for (Walk& w : walks)
      if (w.hit.surface.valid()) {
        Vec3 const n = view.normal(w.hit.surface, w.at.point, w.hit.piece);
        w.at.normal = dot(n, w.ray.dir) > 0 ? -n : n;
        ++hits;
      }
  }
  return hits;
}

namespace {

// Half of the light by Lambert's law, half by ABg.
struct Mixture {
  Lambertian even{0.9};
  Abg lobe;
  Mixture() {
    lobe.a = 6.9e-3;  // albedo 0.1
    lobe.b = 1e-2;
    lobe.g = 2;
    lobe.prepare();
  }
  Vec3 sample(Vec3 wi, Rng& rng) const {
    bool const diffuse = rng.uniform() < 0.5;
    double const x = rng.uniform(), y = rng.uniform();
    return diffuse ? even.sample(wi, x, y).wo : lobe.sample(wi, x, y).wo;
  }
  double weight(Vec3 wi, Vec3 wo) const {
    ValueAndPdf const a = both_of(even, wi, wo), b = both_of(lobe, wi, wo);
    double const pdf = 0.5 * (a.pdf + b.pdf);
    return pdf > 0 ? (a.value + b.value) * wo.z / pdf : 0;
  }
};

struct ClassSums {
  struct Sum {
    std::uint64_t key = 0;
    double first = 0, second = 0;
  };
  std::vector<Sum> sums = std::vector<Sum>(1024);
  void add(std::uint64_t key, double w) {
    std::size_t at = mixed(key) % sums.size();
    while (sums[at].key != 0 && sums[at].key != key) at = (at + 1) % sums.size();
    sums[at].key = key;
    sums[at].first += w;
    sums[at].second += w * w;
  }
};

struct FullWalk {
  std::uint64_t number = 0;
  std::uint32_t event = 0;
  Place at;
  Frame frame;
  Vec3 wi{0, 0, 1};
  double weight = 1;
  bool over = true;
};

// Where a walk leaves to, by the mixture.
RayQuery departing(FullWalk& w, Mixture const& law, std::uint64_t seed) {
  Rng rng(seed, w.number, ++w.event, Stream::direction);
  Vec3 wo = law.sample(w.wi, rng);
  w.weight *= law.weight(w.wi, wo);
  if (!(w.weight > 0)) wo = {0, 0, 1};  // no direction was found: the walk ends with this hop
  return {{w.at.point, unit(w.frame.to_world(wo))}, w.at.from};
}
void set_out(FullWalk& w, std::uint64_t number, Place const& at) {
  w = {number, 0, at, Frame::around(at.normal)};
  w.over = false;
}
void arrive(FullWalk& w, WorldView const& view, Ray const& ray, Hit const& hit) {
  w.over = !hit.surface.valid() || w.event == hops || !(w.weight > 0);
  if (!hit.surface.valid()) return;
  w.at.from = {hit.surface, hit.piece};
  w.at.point = view.project(hit.surface, ray.origin + hit.distance * ray.dir, hit.piece);
  Vec3 const n = view.normal(hit.surface, w.at.point, hit.piece);
  w.at.normal = dot(n, ray.dir) > 0 ? -n : n;
  w.frame = Frame::around(w.at.normal);
  w.wi = w.frame.to_local(-ray.dir);
}

}  // namespace

double full_bounces(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  static Mixture const law;
  constexpr std::uint32_t together = 16;
  FullWalk walks[together];
  RayQuery rays[together];
  Hit hits[together];
  ClassSums sums;
  WorldView const view = scene.world.view();
  std::uint64_t number = 0;
  for (std::size_t done = 0; done < count; done += together) {
    for (std::uint32_t i = 0; i < together; ++i) {
      FullWalk& w = walks[i];
      if (w.over) set_out(w, number, start_of(scene, view, seed, number));
      number = std::max(number, w.number + 1);
      rays[i] = departing(w, law, seed);
    }
    view.closest_together(rays, hits, together);
    for (std::uint32_t i = 0; i < together; ++i) {
      arrive(walks[i], view, rays[i].ray, hits[i]);
      sums.add(1 + hits[i].surface.value % 256, walks[i].weight);
    }
  }
  double all = 0;
  for (ClassSums::Sum const& s : sums.sums) all += s.first + 0 * s.second;
  return all;
}

std::vector<BenchRay> mirror_rays(std::size_t count) {
  std::vector<BenchRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(6, i, 0, Stream::direction);
    double const r = 0.17 * std::sqrt(rng.uniform()), angle = 1e-6 * std::pow(3e5, rng.uniform());
    SinCos const place = sincos_turn(rng.uniform()), heading = sincos_turn(rng.uniform());
    SinCos const polar = sincos_turn(angle / (2 * pi));
    rays.push_back(
        {{{r * place.cos, r * place.sin, 0.5}, {polar.sin * heading.cos, polar.sin * heading.sin, polar.cos}}, {}});
  }
  return rays;
}

}  // namespace straytrace::bench
