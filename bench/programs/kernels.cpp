// SPDX-License-Identifier: BSD-3-Clause
// Single functions, over many different inputs each.
#include <benchmark/benchmark.h>

#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "scenes.hpp"

namespace straytrace::bench {
namespace {

constexpr std::size_t count = 1 << 16;

template <class Make>
void closest(benchmark::State& state, Make make, bool mirror, char const* isa) {
  BenchScene const scene = make();
  WorldView const view = scene.world.view();
  SearchKernels const* const kernels = find_search_kernels(isa);
  if (kernels == nullptr) return state.SkipWithError("this processor lacks the instruction set");
  std::vector<BenchRay> const rays = mirror ? mirror_rays(count) : walk_rays(scene, count);
  for (auto _ : state)
    for (BenchRay const& r : rays) benchmark::DoNotOptimize(kernels->closest(view, r.ray, r.from));
  state.SetItemsProcessed(std::int64_t(state.iterations() * count));
}
BENCHMARK_CAPTURE(closest, tube3_walk, tube3, false, "avx512");
BENCHMARK_CAPTURE(closest, tube3_walk_avx2, tube3, false, "avx2");
BENCHMARK_CAPTURE(closest, tube3_walk_portable, tube3, false, "portable");
BENCHMARK_CAPTURE(closest, tube3_mirror, tube3, true, "avx512");
BENCHMARK_CAPTURE(closest, tube40_mirror, tube40, true, "avx512");
BENCHMARK_CAPTURE(closest, bench_walk, optical_bench, false, "avx512");
BENCHMARK_CAPTURE(closest, bench_walk_avx2, optical_bench, false, "avx2");
BENCHMARK_CAPTURE(closest, bench_walk_portable, optical_bench, false, "portable");

void occluded(benchmark::State& state) {
  BenchScene const scene = tube3();
  WorldView const view = scene.world.view();
  std::vector<BenchRay> rays = walk_rays(scene, count);
  for (BenchRay& r : rays) r.ray.t_max = 0.5 * view.closest(r.ray, r.from).distance;
  for (auto _ : state)
    for (BenchRay const& r : rays) benchmark::DoNotOptimize(view.occluded(r.ray, r.from));
  state.SetItemsProcessed(std::int64_t(state.iterations() * count));
}
BENCHMARK(occluded);

void philox_pair(benchmark::State& state) {
  for (auto _ : state)
    for (std::size_t i = 0; i < count; ++i) {
      Rng rng(1, i, 7, Stream::direction);
      benchmark::DoNotOptimize(rng.uniform() + rng.uniform());
    }
  state.SetItemsProcessed(std::int64_t(state.iterations() * count));
}
BENCHMARK(philox_pair);

void sine_and_cosine(benchmark::State& state) {
  for (auto _ : state)
    for (std::size_t i = 0; i < count; ++i) benchmark::DoNotOptimize(sincos_turn(double(i) / count));
  state.SetItemsProcessed(std::int64_t(state.iterations() * count));
}
BENCHMARK(sine_and_cosine);

}  // namespace
}  // namespace straytrace::bench

BENCHMARK_MAIN();
