// SPDX-License-Identifier: BSD-3-Clause
// Costs of fields in a cavity, one JSON line for bench/wave.py: seconds of the processor, with `wall` of the clock.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string_view>
#include <time.h>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "wave/cavity_rims.hpp"

namespace straytrace::bench {
namespace {

double seconds(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double least_of(int repeats, std::function<void()> const& work, clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
  double least = 1e9;
  for (int i = 0; i < repeats; ++i) {
    double const start = seconds(clock);
    work();
    least = std::min(least, seconds(clock) - start);
  }
  return least;
}

// The arm of ET-HF: 10 km in a window of 2 m, mirrors of 0.31 m and edges of 0.42 m, which leave 42 % of the rows.
WaveCavity long_arm(int points, int rims) {
  WaveCavity arm;
  arm.wavelength = 1064e-9;
  arm.length = 10000;
  arm.grid = {points, 2.0};
  arm.mirror1.curvature = arm.mirror2.curvature = 1 / 5070.0;
  arm.mirror1.outline.radius = arm.mirror2.outline.radius = 0.31;
  for (int i = 0; i < rims; ++i) arm.baffles.push_back({100 + 9800.0 * i / (rims - 1), {0.42}});
  return arm;
}

int legs(int points, int repeats) {
  constexpr int rims = 9, per_trip = 2 * (rims + 1);
  CavityWaves const waves(long_arm(points, rims));
  Field field = waves.hermite_gauss(), copy = field;
  double const leg = least_of(repeats, [&] { waves.round_trip(field); }) / per_trip;
  double const whole = least_of(repeats, [&] {
    waves.transform().forward(field, points, points);
    waves.transform().inverse(field, points, points);
  });
  double const copied = least_of(repeats, [&] { copy.values = field.values; });
  std::printf("{\"leg\": %.9g, \"whole\": %.9g, \"copy\": %.9g}\n", leg, whole, copied);
  return 0;
}

int mode(int points, int round_trips) {
  CavityWaves const waves(long_arm(points, 0));
  SolveOptions options;
  options.most_round_trips = round_trips;
  options.loss_error = 0;
  double const taken = least_of(1, [&] {
    try {
      waves.mode(waves.hermite_gauss(), options);
    } catch (NumericalError const&) {  // it does not settle to nothing
    }
  });
  std::printf("{\"mode\": %.9g}\n", taken);
  return 0;
}

int arm(int points, int threads) {
  CavityWaves const waves(long_arm(points, 98), threads);
  Field field = waves.hermite_gauss();
  double const wall = least_of(
      3, [&] { waves.round_trip(field); }, CLOCK_MONOTONIC);
  if (threads > 1) {
    std::printf("{\"wall\": %.9g}\n", wall);
    return 0;
  }
  double const trip = least_of(3, [&] { waves.round_trip(field); });
  WaveMode const as_mode{1.0, 0, 0, field};
  std::vector<std::vector<RimCurve>> curves;
  for (WaveBaffle const& baffle : waves.cavity().baffles) curves.push_back({round_curve(baffle, waves.cavity())});
  double const levers = least_of(1, [&] { rim_responses(waves, as_mode, curves); });
  std::printf("{\"wall\": %.9g, \"trip\": %.9g, \"levers\": %.9g}\n", wall, trip, levers);
  return 0;
}

// On a GPU: copies of the field to and from it are in the round trip, but not in the leg.
int device(int points, int repeats) {
  std::shared_ptr<WaveDevice> gpu;
  try {
    gpu = cuda_waves();
  } catch (InputError const& e) {
    std::printf("{\"skipped\": \"%s\"}\n", e.reason().c_str());
    return 0;
  }
  auto const trip = [&](int rims) {
    CavityWaves const waves(long_arm(points, rims), {1, gpu});
    Field field = waves.hermite_gauss();
    waves.round_trip(field);
    return least_of(
        repeats, [&] { waves.round_trip(field); }, CLOCK_MONOTONIC);
  };
  double const few = trip(9), many = trip(98);
  std::printf("{\"device\": \"%s\", \"leg\": %.9g, \"trip\": %.9g}\n", gpu->name().c_str(), (many - few) / (2 * 89),
              many);
  return 0;
}

}  // namespace
}  // namespace straytrace::bench

int main(int count, char** words) {
  using namespace straytrace::bench;
  std::string_view const what = count == 4 ? words[1] : "";
  if (what == "legs") return legs(std::atoi(words[2]), std::atoi(words[3]));
  if (what == "mode") return mode(std::atoi(words[2]), std::atoi(words[3]));
  if (what == "arm") return arm(std::atoi(words[2]), std::atoi(words[3]));
  if (what == "device") return device(std::atoi(words[2]), std::atoi(words[3]));
  std::fputs(
      "usage: bench_wave legs POINTS REPEATS | mode POINTS ROUND_TRIPS | arm POINTS THREADS | device POINTS REPEATS\n",
      stderr);
  return 2;
}
