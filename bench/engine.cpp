// SPDX-License-Identifier: BSD-3-Clause
// Rays per second of the engine and of Embree, in one run on one core, taking turns. One JSON line per comparison.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <thread>
#include <time.h>

#include "embree_scene.hpp"
#include "trace/history/flight.hpp"
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

struct Engine {
  std::string name;
  std::function<std::size_t()> run;  // returns how many rays hit
  std::vector<double> rates;         // 1/s
};

std::size_t closest_of_all(WorldView const& view, std::span<BenchRay const> rays) {
  std::size_t hits = 0;
  for (BenchRay const& r : rays) hits += view.closest(r.ray, r.from).surface.valid();
  return hits;
}

// As the trace does: as many rays together as it has paths in flight.
std::size_t closest_together(WorldView const& view, std::span<BenchRay const> rays) {
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
  return found;
}

// Runs the engines in turns; the first is ours. Compares with the one named, or the best of the others.
void compare(std::string const& name, std::size_t rays, std::vector<Engine> engines, int repeats, double goal,
             std::string const& with = {}) {
  std::vector<std::size_t> hits;
  for (int k = -1; k < repeats; ++k)  // the first round warms up
    for (Engine& e : engines) {
      double const start = now();
      std::size_t const found = e.run();
      double const rate = double(rays) / (now() - start);
      if (k < 0)
        hits.push_back(found);
      else
        e.rates.push_back(rate);
    }
  std::size_t best = 1;
  for (std::size_t i = 2; i < engines.size(); ++i)
    if (with.empty() ? median(engines[i].rates) > median(engines[best].rates) : engines[i].name == with) best = i;
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::size_t(repeats); ++k) ratios.push_back(engines[0].rates[k] / engines[best].rates[k]);
  auto const [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  nlohmann::ordered_json line;
  line["name"] = name;
  line["ours"] = median(engines[0].rates);
  line["theirs"] = median(engines[best].rates);
  line["ratio"] = median(ratios);
  line["spread"] = (*most - *least) / median(ratios);
  line["goal"] = goal;
  line["compared_with"] = engines[best].name;
  for (std::size_t i = 0; i < engines.size(); ++i)
    line["engines"][engines[i].name] = {{"per_s", median(engines[i].rates)}, {"hits", double(hits[i]) / double(rays)}};
  std::puts(line.dump().c_str());
  std::fflush(stdout);
}

std::vector<Engine> engines_for(BenchScene const& scene, std::vector<BenchRay> const& rays, EmbreeScene const& robust,
                                EmbreeScene const& fast) {
  return {{"straytrace", [&] { return closest_of_all(scene.world.view(), rays); }, {}},
          {"robust triangles, single", [&] { return robust.single(rays); }, {}},
          {"robust triangles, packets of 8", [&] { return robust.packets_of_8(rays); }, {}},
          {"robust triangles, packets of 16", [&] { return robust.packets_of_16(rays); }, {}},
          {"fast triangles, single", [&] { return fast.single(rays); }, {}},
          {"fast triangles, packets of 8", [&] { return fast.packets_of_8(rays); }, {}},
          {"fast triangles, packets of 16", [&] { return fast.packets_of_16(rays); }, {}}};
}

void tube(RTCDevice device, BenchScene const& scene, std::size_t count, int repeats) {
  EmbreeScene const robust(device, scene.triangles, EmbreeScene::Mode::robust);
  EmbreeScene const fast(device, scene.triangles, EmbreeScene::Mode::fast);
  EmbreeScene const user(device, scene.world);
  std::vector<BenchRay> const walk = walk_rays(scene, count), mirror = mirror_rays(count / 8);
  compare(scene.name + " walk", count, engines_for(scene, walk, robust, fast), repeats, 6);
  compare(scene.name + " mirror", mirror.size(), engines_for(scene, mirror, robust, fast), repeats, 30);
  std::vector<Engine> bounces = engines_for(scene, walk, robust, fast);
  bounces[0] = {"straytrace, whole bounces", [&] { return bounce(scene, count); }, {}};
  compare(scene.name + " whole bounces over bare rays", count, bounces, repeats, 1);
  bounces = engines_for(scene, walk, robust, fast);
  bounces[0] = {"straytrace, whole bounces of eight paths", [&] { return bounce_together(scene, count); }, {}};
  compare(scene.name + " whole bounces of eight paths over bare rays", count, bounces, repeats, 1.25);
  Engine const ours{"straytrace", [&] { return closest_of_all(scene.world.view(), walk); }, {}};
  compare(scene.name + " walk, double callbacks", count,
          {ours, {"double callbacks", [&] { return user.double_callbacks(walk); }, {}}}, repeats, 1.6);
}

void analytic_bench(RTCDevice device, std::size_t count, int repeats) {
  BenchScene const scene = optical_bench();
  EmbreeScene const user(device, scene.world);
  std::vector<BenchRay> const walk = walk_rays(scene, count);
  compare("bench walk, double callbacks", count,
          {{"straytrace", [&] { return closest_of_all(scene.world.view(), walk); }, {}},
           {"double callbacks", [&] { return user.double_callbacks(walk); }, {}}},
          repeats, 1.6);
}

void mesh(RTCDevice device, std::size_t count, int repeats) {
  BenchScene const scene = million_triangles();
  EmbreeScene const robust(device, scene.triangles, EmbreeScene::Mode::robust);
  EmbreeScene const fast(device, scene.triangles, EmbreeScene::Mode::fast);
  std::vector<BenchRay> const walk = walk_rays(scene, count);
  std::vector<Engine> engines = engines_for(scene, walk, robust, fast);
  compare("mesh walk, one ray at a time, over robust single rays", count, engines, repeats, 1, engines[1].name);
  engines[0] = {"straytrace", [&] { return closest_together(scene.world.view(), walk); }, {}};
  compare("mesh walk over robust single rays", count, engines, repeats, 1, engines[1].name);
  EmbreeScene const unasked(device, scene.triangles, EmbreeScene::Mode::robust_default);
  compare("mesh walk over robust single rays, default build", count,
          {engines[0], {"robust triangles, single, default build", [&] { return unasked.single(walk); }, {}}}, repeats,
          1);
}

// Two threads at once against one, by the clock on the wall.
void scaling(std::size_t count, int repeats) {
  BenchScene const scene = tube3();
  auto const seconds = [&](unsigned threads) {
    auto const start = std::chrono::steady_clock::now();
    {
      std::vector<std::jthread> workers;
      for (unsigned i = 0; i < threads; ++i) workers.emplace_back([&, i] { bounce(scene, 8 * count, 5 + i); });
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::vector<double> one, ratio;
  for (int k = 0; k < repeats; ++k) {
    one.push_back(seconds(1));
    ratio.push_back(2 * one.back() / seconds(2));
  }
  auto const [least, most] = std::minmax_element(ratio.begin(), ratio.end());
  nlohmann::ordered_json line;
  line["name"] = "tube3 whole bounces, two threads over one";
  line["ours"] = median(ratio) * 8 * double(count) / median(one);
  line["theirs"] = 8 * double(count) / median(one);
  line["ratio"] = median(ratio);
  line["spread"] = (*most - *least) / median(ratio);
  line["goal"] = 1.9;
  std::puts(line.dump().c_str());
}

}  // namespace
}  // namespace straytrace::bench

int main(int argc, char** argv) {
  using namespace straytrace::bench;
  std::string const only = argc > 1 ? argv[1] : "";
  RTCDevice const device = rtcNewDevice("threads=1");
  constexpr std::size_t count = 1 << 18;
  constexpr int repeats = 7;
  for (auto const& make : {tube3, tube40})
    if (BenchScene const scene = make(); only.empty() || scene.name == only) tube(device, scene, count, repeats);
  if (only.empty() || only == "bench") analytic_bench(device, count, repeats);
  if (only.empty() || only == "mesh") mesh(device, count, repeats);
  if (only.empty() || only == "scaling") scaling(count, repeats);
  rtcReleaseDevice(device);
}
