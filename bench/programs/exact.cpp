// SPDX-License-Identifier: BSD-3-Clause
// Long diffuse walks with every hit checked. Tubes: against 80-bit arithmetic. The bench and the mesh: against a second
// tree over the same surfaces or triangles in reverse order, and one hit in 100,000 against a test of every one; both
// are closed, so a ray that hits nothing is lost. Ends with 1 when anything is wrong.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "scenes.hpp"
#include "support/exact_tube.hpp"
#include "support/mesh_shapes.hpp"

namespace straytrace::bench {
namespace {

bool report(std::string const& name, long long bounces, long long lost, long long wrong, long long self, double error) {
  std::printf("{\"name\":\"%s\",\"bounces\":%lld,\"lost\":%lld,\"wrong\":%lld,\"self\":%lld,\"worst_error\":%.3g}\n",
              name.c_str(), bounces, lost, wrong, self, error);
  std::fflush(stdout);
  return lost == 0 && wrong == 0 && self == 0;
}

bool check_tube(std::string const& name, testing::Tube const& tube, long long bounces, std::uint64_t seed) {
  testing::TubeScene const scene(tube);
  WorldView const view = scene.world.view();
  auto const tracer = [&](Ray const& r, SurfaceId from) { return view.closest(r, from); };
  testing::Tally const t = testing::walk(scene, bounces, seed, tracer);
  return report(name, t.bounces, t.lost, t.wrong, t.self, t.worst_error) && testing::exact_to_rounding(t);
}

World reversed_world(World const& world) {
  World out;
  out.add_optic({});
  WorldView const view = world.view();
  for (auto s = world.surfaces().rbegin(); s != world.surfaces().rend(); ++s)
    view.shapes.visit(s->shape, [&](auto const& shape) { out.add_surface(shape, 0, 0, {}, {}); });
  out.finish();
  return out;
}

// `again(ray, from)` and, for one bounce in 100,000, `by_force(ray, from)` must give the hit of the scene itself.
template <class Again, class ByForce>
bool check(BenchScene const& scene, long long bounces, Again const& again, ByForce const& by_force) {
  long long done = 0, lost = 0, wrong = 0, self = 0;
  walk(scene, std::size_t(bounces), 100, [&](Ray const& ray, Departure const& from, Hit const& hit) {
    lost += !hit.surface.valid();
    self += hit.surface == from.surface && hit.piece == from.piece && hit.distance < 1e-12;
    wrong += again(ray, from) != hit.distance;
    if (done++ % 100000 == 0) {
      Hit const sure = by_force(ray, from);
      wrong += sure.surface != hit.surface || sure.piece != hit.piece || sure.distance != hit.distance;
    }
  });
  return report(scene.name, done, lost, wrong, self, 0);
}

bool check_bench(long long bounces) {
  BenchScene const scene = optical_bench();
  World const other = reversed_world(scene.world);
  WorldView const second = other.view();
  WorldView every = scene.world.view();
  every.limits.brute_force = true;
  auto const last = std::uint32_t(every.surfaces.size - 1);
  return check(
      scene, bounces,
      [&](Ray const& r, Departure const& from) {
        return second.closest(r, SurfaceId{last - from.surface.value}).distance;
      },
      [&](Ray const& r, Departure const& from) { return every.closest(r, from); });
}

bool check_mesh(long long bounces) {
  BenchScene const scene = million_triangles(), reversed = million_triangles(true);
  WorldView const view = scene.world.view(), second = reversed.world.view();
  TriangleMesh const& mesh = std::get<View<TriangleMesh const>>(view.shapes.arrays)[0];
  auto const last = std::uint32_t(mesh.content.triangles.size - 1);
  return check(
      scene, bounces,
      [&](Ray const& r, Departure const& from) {
        return second.closest(r, {from.surface, last - from.piece}).distance;
      },
      [&](Ray const& r, Departure const& from) {
        Crossing const c = testing::crossing_by_force(mesh, r, from.piece);
        return Hit{{0}, c.distance, c.piece};
      });
}

}  // namespace
}  // namespace straytrace::bench

int main(int argc, char** argv) {
  using namespace straytrace;
  auto const bounces = static_cast<long long>(argc > 1 ? std::strtod(argv[1], nullptr) : 1e8);
  if (bounces < 1) {
    std::fputs("usage: bench_exact [BOUNCES]\n", stderr);
    return 2;
  }
  bool right = bench::check_tube("tube3", testing::tube3, bounces, 11);
  right = bench::check_tube("tube40", testing::tube40, bounces, 12) && right;
  right = bench::check_bench(bounces) && right;
  right = bench::check_mesh(bounces) && right;
  return right ? 0 : 1;
}
