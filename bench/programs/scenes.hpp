// SPDX-License-Identifier: BSD-3-Clause
// Scenes and rays of the benchmarks (docs/develop/performance.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/every_module.hpp"
#include "world/model/world.hpp"

namespace straytrace::bench {

struct Triangle {
  float corner[3][3];  // m
};

struct BenchScene {
  std::string name;
  World world;
  std::uint32_t first_start = 0;    // walks start on surfaces from this number on, all inside the scene
  bool inward = false;              // and leave them to the side of the origin, otherwise to the front
  std::vector<Triangle> triangles;  // the same scene for a triangle tracer; empty: not requested
};

// A closed tube along z: wall, end discs, flat baffles, a mirror of radius 0.17 m at each end.
BenchScene tube3();   // 3 km, radius 0.5 m, 200 baffles of aperture 0.4 m
BenchScene tube40();  // 40 km, radius 0.6 m, 500 baffles of aperture 0.45 m
// 300 lenses (two caps and a rim), 300 mounts of twelve faces, in a closed box: 4512 surfaces.
BenchScene optical_bench();
// One mesh of 1.01 million triangles: 250 knobbly bodies in a closed box. `reversed`: the same triangles, numbered from
// the last to the first, so that another tree comes of them.
BenchScene million_triangles(bool reversed = false);
BenchScene knobbly_bodies(std::uint64_t bodies, bool reversed = false);  // the first of them, 4000 triangles each

struct BenchRay {
  Ray ray;
  Departure from;
};
// Diffuse random walks of 1000 bounces each, from random places; visit(ray, from, hit) for each of `count` bounces.
using Visit = std::function<void(Ray const&, Departure const&, Hit const&)>;
void walk(BenchScene const&, std::size_t count, std::uint64_t seed, Visit const&);
// The rays of such walks: incoherent.
std::vector<BenchRay> walk_rays(BenchScene const&, std::size_t count, std::uint64_t seed = 5);
// Follows such walks one after the other, bounce by bounce: closest hit, point put back, normal, frame, Philox, cosine
// lobe. Returns how many bounces had a hit.
std::size_t bounce(BenchScene const&, std::size_t count, std::uint64_t seed = 5);
// Such walks eight at a time, one stage of all of them after the other: what hiding the latency of one path gains.
std::size_t bounce_together(BenchScene const&, std::size_t count, std::uint64_t seed = 5);
// Sixteen such walks together with all the work of a bounce of a trace: in addition to the above, half of the light by
// ABg, its weight, and the weight added to the sums of one of 256 classes that is found by hash. Returns the sum of all
// weights.
double full_bounces(BenchScene const& scene, std::size_t count, std::uint64_t seed = 5);
// From a mirror of radius 0.17 m near z = 0, polar angle log-uniform from 1e-6 to 0.3 rad: the small-angle scatter of
// an arm.
std::vector<BenchRay> mirror_rays(std::size_t count);

// Flat pieces of every surface of a world: `segments` around (corners outside the circle, so that points of the true
// surface lie inside), long walls cut every `section` metres, curved profiles in eight steps.
std::vector<Triangle> tessellate(World const&, int segments, double section);

}  // namespace straytrace::bench
