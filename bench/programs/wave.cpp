// SPDX-License-Identifier: BSD-3-Clause
// The Fourier transforms of a leg between two baffles: there and back, with 42 % of the rows and 70 % of the columns,
// as in a long arm. One JSON line for bench/wave.py: processor seconds.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <time.h>

#include "base/every_module.hpp"
#include "wave/transform.hpp"

namespace straytrace::bench {
namespace {

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double least_of(int repeats, std::function<void()> const& work) {
  double least = 1e9;
  for (int i = 0; i < repeats; ++i) {
    double const start = processor_seconds();
    work();
    least = std::min(least, processor_seconds() - start);
  }
  return least;
}

int measure(int points, int repeats) {
  Field field({points, 1.0});
  for (std::size_t i = 0; i < field.values.size(); ++i) field.values[i] = {double(i % 97), double(i % 31)};
  Field copy = field;
  Transform const transform(points);
  int const rows = points * 21 / 100 * 2, columns = points * 35 / 100 * 2;
  double const pruned = least_of(repeats, [&] {
    transform.forward(field, rows, columns);
    transform.inverse(field, columns, rows);
  });
  double const whole = least_of(repeats, [&] {
    transform.forward(field, points, points);
    transform.inverse(field, points, points);
  });
  double const copied = least_of(repeats, [&] { copy.values = field.values; });
  std::printf("{\"library\": \"%s\", \"pruned\": %.9g, \"whole\": %.9g, \"copy\": %.9g}\n", Transform::library(),
              pruned, whole, copied);
  return 0;
}

}  // namespace
}  // namespace straytrace::bench

// bench_wave POINTS REPEATS
int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: bench_wave POINTS REPEATS\n", stderr);
    return 2;
  }
  return straytrace::bench::measure(std::atoi(words[1]), std::atoi(words[2]));
}
