// SPDX-License-Identifier: BSD-3-Clause
// Fixed kernels for callgrind, which counts their instructions (bench/instructions.py): each is a separate function,
// `counted_NAME`, that does `rounds` times the same work. bench_instructions [TWICE]: the kernel of this name does it
// twice, which the count must show. Prints how many items each round of a kernel has.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/math/rng.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "optics/scatter/diffuse.hpp"
#include "optics/scatter/shift_invariant.hpp"
#include "scene/scene.hpp"
#include "scenes.hpp"
#include "spectra/spectrum.hpp"
#include "trace/backend/backend.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::bench {
namespace {

constexpr std::size_t count = 4096;
double result = 0;  // of everything, so that the compiler keeps all work

struct Search {
  BenchScene scene;
  std::vector<BenchRay> rays;
  explicit Search(BenchScene made) : scene(std::move(made)), rays(walk_rays(scene, count)) {}
  void closest() const {
    WorldView const view = scene.world.view();
    for (BenchRay const& r : rays) result += view.closest(r.ray, r.from).distance;
  }
};

std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(1, i, 0, Stream::direction);
    double const x = rng.uniform(), y = rng.uniform();
    all.push_back(Lambertian{1}.sample({0, 0, 1}, x, y).wo);
  }
  return all;
}

void scatter(Abg const& law, std::vector<Vec3> const& from) {
  for (std::size_t i = 0; i < count; ++i) {
    double const u = (double(i) + 0.5) / count;
    BsdfSample const s = law.sample(from[i], u, 1 - u);
    result += s.pdf + law.eval(from[i], s.wo);
  }
}

void philox() {
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(1, i, 7, Stream::direction);
    result += rng.uniform() + rng.uniform();
  }
}

void spectrum(PhaseSpectra const& spectra) {
  double const kappa[] = {1e13};
  result += spectra(kappa).psd[0];
}

PhaseSpectra spectra_of_ground() {
  MotionSet set;
  set.bodies = {"tube"};
  set.inputs.push_back({"tube", power_law_asd(1e-6, 1, -2, 0.7, 2000), 0, {{BodyId{0}, 2, 1}}});
  return {group_by_shape(set), logarithmic_grid(3, 1000, 60)};
}

World arm() {
  Scene const scene = read_scene(STRAY_SOURCE_DIR "/examples/arm_tube.yaml");
  World world = build_world(scene);
  scene.throw_if_problems();
  steer(world);
  return world;
}

}  // namespace
}  // namespace straytrace::bench

using namespace straytrace;
using namespace straytrace::bench;

// Not inlined, with names that callgrind finds.
#define COUNTED extern "C" __attribute__((noinline, noclone)) void
COUNTED counted_tube_walk(Search const& s, int rounds) {
  for (int k = 0; k < rounds; ++k) s.closest();
}
COUNTED counted_bench_bounce(BenchScene const& s, int rounds) {
  for (int k = 0; k < rounds; ++k) result += double(bounce(s, count));
}
COUNTED counted_mesh_ray(Search const& s, int rounds) {
  for (int k = 0; k < rounds; ++k) s.closest();
}
COUNTED counted_scatter_sample(Abg const& law, std::vector<Vec3> const& from, int rounds) {
  for (int k = 0; k < rounds; ++k) scatter(law, from);
}
COUNTED counted_philox(int rounds) {
  for (int k = 0; k < rounds; ++k) philox();
}
COUNTED counted_noise_spectrum(PhaseSpectra const& spectra, int rounds) {
  for (int k = 0; k < rounds; ++k) spectrum(spectra);
}
COUNTED counted_arm_history(Backend const& backend, World const& world, int rounds) {
  for (int k = 0; k < rounds; ++k) result += double(backend.run_block(SteeredWorld::as_given(world), 1, 0).rays);
}

int main(int argc, char** argv) {
  std::string const twice = argc > 1 ? argv[1] : "";
  auto const rounds = [&](char const* name, std::size_t items) {
    std::printf("%s %zu\n", name, items);
    return name == twice ? 2 : 1;
  };
  Search const tube(tube3()), mesh(knobbly_bodies(8));
  BenchScene const lenses = optical_bench();
  Abg law;
  law.a = 6.9e-3;
  law.b = 1e-2;
  law.prepare();
  std::vector<Vec3> const from = directions();
  PhaseSpectra const spectra = spectra_of_ground();
  World const world = arm();
  counted_tube_walk(tube, rounds("tube_walk", count));
  counted_bench_bounce(lenses, rounds("bench_bounce", count));
  counted_mesh_ray(mesh, rounds("mesh_ray", count));
  counted_scatter_sample(law, from, rounds("scatter_sample", count));
  counted_philox(rounds("philox", count));
  counted_noise_spectrum(spectra, rounds("noise_spectrum", 1));
  counted_arm_history(*make_backend("cpu"), world, rounds("arm_history", largest_block));
  return std::isfinite(result) ? 0 : 1;
}
