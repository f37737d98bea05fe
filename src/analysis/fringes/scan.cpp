// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/scan.hpp"

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>

#include <algorithm>
#include <cmath>

namespace straytrace {
namespace {

constexpr int bits = 26;  // of the place of a minimum: half of a double

struct Minimum {
  double at, value;
};

// Where the function first reaches `level` going from `start` towards `end` in steps; `end` when it does not.
double crossing(std::function<double(double)> const& f, double level, double start, double end, double step,
                bool* open) {
  double const sign = end > start ? 1 : -1;
  for (double a = start; sign * (end - a) > 0;) {
    double const b = sign > 0 ? std::min(end, a + step) : std::max(end, a - step);
    if (f(b) >= level) {
      double inside = a, outside = b;
      for (int i = 0; i < 50; ++i) (f((inside + outside) / 2) >= level ? outside : inside) = (inside + outside) / 2;
      return (inside + outside) / 2;
    }
    a = b;
  }
  if (open) *open = true;
  return end;
}

}  // namespace

ScanResult scan_minimum(std::function<double(double)> const& f, double from, double to, int steps) {
  double const step = (to - from) / steps;
  std::vector<double> value;
  for (int i = 0; i <= steps; ++i) value.push_back(f(from + step * i));
  std::vector<Minimum> minima;
  for (int i = 0; i <= steps; ++i) {
    bool const left = i == 0 || value[std::size_t(i)] <= value[std::size_t(i) - 1];
    bool const right = i == steps || value[std::size_t(i)] < value[std::size_t(i) + 1];
    if (!left || !right) continue;
    auto const [at, v] = boost::math::tools::brent_find_minima(f, from + step * std::max(0, i - 1),
                                                               from + step * std::min(steps, i + 1), bits);
    minima.push_back(v <= value[std::size_t(i)] ? Minimum{at, v} : Minimum{from + step * i, value[std::size_t(i)]});
  }
  std::stable_sort(minima.begin(), minima.end(), [](Minimum const& a, Minimum const& b) { return a.value < b.value; });
  ScanResult r;
  r.best = minima.front().at;
  r.chi_square = minima.front().value;
  r.low = crossing(f, r.chi_square + 1, r.best, from, step / 4, nullptr);
  r.high = crossing(f, r.chi_square + 1, r.best, to, step / 4, nullptr);
  r.limit = crossing(f, r.chi_square + 2.71, r.best, to, step / 4, &r.open);
  for (std::size_t i = 1; i < minima.size(); ++i)
    if (minima[i].value < r.chi_square + 4) r.others.push_back(minima[i].at);
  return r;
}

}  // namespace straytrace
