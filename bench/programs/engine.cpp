// SPDX-License-Identifier: BSD-3-Clause
// Rays per second of the engine and of Embree, in one process on one core, taking turns. One JSON line per comparison
// (bench/record.py).
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <malloc.h>
#include <time.h>

#include "embree_scene.hpp"
#include "trace/step/flight.hpp"
#include "trace/tally/history_tally.hpp"

namespace straytrace::bench {
namespace {

// Processor time of this thread, s: what others do on the machine counts less.
double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

// Bytes that this program holds now.
std::size_t heap() {
  auto const held = mallinfo2();
  return held.uordblks + held.hblkhd;
}

// A scene, and what its surfaces, shapes and search structure take.
struct Held {
  BenchScene scene;
  std::size_t bytes;
};
Held hold(std::function<BenchScene()> const& make) {
  std::size_t const before = heap();
  Held h{make(), 0};
  h.bytes = heap() - before - h.scene.triangles.capacity() * sizeof(Triangle);
  return h;
}

struct Engine {
  std::string name;
  std::function<void()> run;
  std::size_t bytes;          // of its scene
  std::vector<double> rates;  // 1/s
};

struct Comparison {
  std::string name;
  std::size_t rays;
  nlohmann::ordered_json goal;  // bench/record.py; null: none
  std::string with;             // which of the others; empty: the best
};

nlohmann::ordered_json at_least(double value, char const* of = "ratio") { return {{"of", of}, {"at_least", value}}; }

class Turns {
 public:
  explicit Turns(int repeats) : repeats_(repeats) {}

  // Runs the engines in turns; the first is ours.
  void compare(Comparison const& c, std::vector<Engine> engines) const {
    for (int k = -1; k < repeats_; ++k)  // the first round warms up
      for (Engine& e : engines) {
        double const start = now();
        e.run();
        if (double const rate = double(c.rays) / (now() - start); k >= 0) e.rates.push_back(rate);
      }
    std::size_t best = 1;
    for (std::size_t i = 1; i < engines.size(); ++i)
      if (c.with.empty() ? median(engines[i].rates) > median(engines[best].rates) : engines[i].name == c.with) best = i;
    tell(c, engines, engines[best]);
  }

 private:
  void tell(Comparison const& c, std::vector<Engine> const& engines, Engine const& theirs) const {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < theirs.rates.size(); ++k) ratios.push_back(engines[0].rates[k] / theirs.rates[k]);
    auto const [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    nlohmann::ordered_json line = {{"case", c.name},
                                   {"ours", median(engines[0].rates)},
                                   {"theirs", median(theirs.rates)},
                                   {"ratio", median(ratios)},
                                   {"spread", (*most - *least) / median(ratios)},
                                   {"repeats", repeats_},
                                   {"unit", "1/s"},
                                   {"compared_with", theirs.name},
                                   {"memory", engines[0].bytes},
                                   {"theirs_memory", theirs.bytes}};
    if (!c.goal.is_null()) line["goal"] = c.goal;
    for (Engine const& e : engines) line["per_s"][e.name] = median(e.rates);
    std::puts(line.dump().c_str());
    std::fflush(stdout);
  }

  int repeats_;
};

void closest_of_all(WorldView const& view, std::span<BenchRay const> rays, SearchKernels const& kernels) {
  std::size_t hits = 0;
  for (BenchRay const& r : rays) hits += kernels.closest(view, r.ray, r.from).surface.valid();
  if (hits == 0) std::exit(1);
}

// As the trace does: as many rays together as it has paths in flight.
void closest_together(WorldView const& view, std::span<BenchRay const> rays) {
  constexpr std::size_t together = Flight<HistoryTally>::in_flight;
  RayQuery queries[together];
  Hit hits[together];
  std::size_t found = 0;
  for (std::size_t first = 0; first < rays.size(); first += together) {
    std::size_t const count = std::min(together, rays.size() - first);
    for (std::size_t i = 0; i < count; ++i) queries[i] = {rays[first + i].ray, rays[first + i].from};
    view.closest_together(queries, hits, std::uint32_t(count));
    for (std::size_t i = 0; i < count; ++i) found += hits[i].surface.valid();
  }
  if (found == 0) std::exit(1);
}

Engine ours(Held const& held, std::vector<BenchRay> const& rays, SearchKernels const& kernels = *search_kernels) {
  return {"straytrace, " + std::string(kernels.name),
          [&] { closest_of_all(held.scene.world.view(), rays, kernels); },
          held.bytes,
          {}};
}
Engine full(Held const& held, std::size_t count) {
  return {"straytrace, full bounces", [&held, count] { full_bounces(held.scene, count); }, held.bytes, {}};
}

struct Yardsticks {
  EmbreeScene robust, fast;
  Yardsticks(RTCDevice device, BenchScene const& scene)
      : robust(device, scene.triangles, EmbreeScene::Mode::robust),
        fast(device, scene.triangles, EmbreeScene::Mode::fast) {}
  // `first`, then the six ways of Embree.
  std::vector<Engine> against(Engine first, std::vector<BenchRay> const& rays) const {
    std::vector<Engine> all{std::move(first)};
    for (auto const& [name, scene] : {std::pair{"robust triangles", &robust}, std::pair{"fast triangles", &fast}}) {
      all.push_back({name + std::string(", single"), [&, s = scene] { s->single(rays); }, scene->bytes(), {}});
      all.push_back(
          {name + std::string(", packets of 8"), [&, s = scene] { s->packets_of_8(rays); }, scene->bytes(), {}});
      all.push_back(
          {name + std::string(", packets of 16"), [&, s = scene] { s->packets_of_16(rays); }, scene->bytes(), {}});
    }
    return all;
  }
};

// AVX2, the instruction set of most processors, compared with AVX-512.
void avx2_over_avx512(Held const& held, std::vector<BenchRay> const& rays, Turns const& turns) {
  SearchKernels const *const avx2 = find_search_kernels("avx2"), *const avx512 = find_search_kernels("avx512");
  if (avx2 && avx512)
    turns.compare({held.scene.name + " walk, AVX2 over AVX-512", rays.size(), at_least(0.9), {}},
                  {ours(held, rays, *avx2), ours(held, rays, *avx512)});
}

void callbacks(RTCDevice device, Held const& held, std::vector<BenchRay> const& rays, Turns const& turns) {
  EmbreeScene const user(device, held.scene.world);
  turns.compare({held.scene.name + " walk over double callbacks", rays.size(), at_least(1.6), {}},
                {ours(held, rays), {"double callbacks", [&] { user.double_callbacks(rays); }, user.bytes(), {}}});
}

void tube(RTCDevice device, Held const& held, std::size_t count, Turns const& turns) {
  std::string const name = held.scene.name;
  Yardsticks const embree(device, held.scene);
  std::vector<BenchRay> const walk = walk_rays(held.scene, count), mirror = mirror_rays(count / 8);
  turns.compare({name + " walk over the best triangles", count, at_least(8), {}},
                embree.against(ours(held, walk), walk));
  turns.compare({name + " mirror over the best triangles", mirror.size(), at_least(30), {}},
                embree.against(ours(held, mirror), mirror));
  Engine const one{"one path at a time", [&] { bounce(held.scene, count); }, held.bytes, {}};
  Engine const eight{"eight paths at once", [&] { bounce_together(held.scene, count); }, held.bytes, {}};
  turns.compare({name + " whole bounces over bare rays", count, at_least(1), {}}, embree.against(one, walk));
  turns.compare({name + " whole bounces of eight paths over bare rays", count, at_least(1.25), {}},
                embree.against(eight, walk));
  turns.compare({name + " full bounces over its bare rays", count, at_least(12e6, "ours"), {}},
                {full(held, count), ours(held, walk)});
  callbacks(device, held, walk, turns);
  avx2_over_avx512(held, walk, turns);
}

void analytic_bench(RTCDevice device, Held const& held, std::size_t count, Turns const& turns) {
  std::vector<BenchRay> const walk = walk_rays(held.scene, count);
  callbacks(device, held, walk, turns);
  turns.compare({"bench full bounces over its bare rays", count, at_least(0.6), {}},
                {full(held, count), ours(held, walk)});
  turns.compare({"bench full bounces", count, at_least(8e6, "ours"), {}}, {full(held, count), ours(held, walk)});
  avx2_over_avx512(held, walk, turns);
}

void mesh(RTCDevice device, Held const& held, std::size_t count, Turns const& turns) {
  Yardsticks const embree(device, held.scene);
  EmbreeScene const unasked(device, held.scene.triangles, EmbreeScene::Mode::robust_default);
  std::vector<BenchRay> const walk = walk_rays(held.scene, count);
  Engine const together{
      "straytrace, sixteen rays together", [&] { closest_together(held.scene.world.view(), walk); }, held.bytes, {}};
  std::string const single = "robust triangles, single";
  turns.compare({"mesh walk, sixteen rays together, over robust single rays", count, at_least(1.2), single},
                embree.against(together, walk));
  turns.compare(
      {"mesh walk, sixteen rays together, over Embree's default build", count, {}, {}},
      {together, {"robust triangles, single, default build", [&] { unasked.single(walk); }, unasked.bytes(), {}}});
  turns.compare({"mesh walk, one ray at a time, over robust single rays", count, {}, single},
                embree.against(ours(held, walk), walk));
  turns.compare({"mesh full bounces over its bare rays", count, at_least(1.2e6, "ours"), {}},
                {full(held, count), together});
  avx2_over_avx512(held, walk, turns);
}

}  // namespace
}  // namespace straytrace::bench

// bench_engine SCENE [RAYS] [TURNS]
int main(int argc, char** argv) {
  using namespace straytrace::bench;
  std::string const which = argc > 1 ? argv[1] : "";
  std::size_t const count = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1 << 18;
  Turns const turns(argc > 3 ? std::atoi(argv[3]) : 7);
  RTCDevice const device = counting_device();
  if (which == "tube3")
    tube(device, hold(tube3), count, turns);
  else if (which == "tube40")
    tube(device, hold(tube40), count, turns);
  else if (which == "bench")
    analytic_bench(device, hold(optical_bench), count, turns);
  else if (which == "mesh")
    mesh(device, hold([] { return million_triangles(); }), count, turns);
  else
    return std::fputs("usage: bench_engine tube3|tube40|bench|mesh [RAYS] [TURNS]\n", stderr), 2;
  rtcReleaseDevice(device);
}
