// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/measured.hpp"

#include <algorithm>

#include "optics/lobes/lobe_prepare.hpp"

namespace straytrace::optics {
namespace {

constexpr double same = 1e-6;     // incidences closer than this in their sine are one
constexpr double dark = -1e4;     // log of zero
constexpr double nearest = 1e-9;  // offset used for the specular direction itself

struct Curve {
  std::vector<double> log_offset, log_value;  // increasing offsets
  double spread = 1;

  double at(double x) const {
    auto const next = std::ranges::lower_bound(log_offset, x) - log_offset.begin();
    if (next == 0) return log_value.front();
    if (std::size_t(next) == log_offset.size()) return log_value.back();
    auto const i = std::size_t(next);
    double const share = (x - log_offset[i - 1]) / (log_offset[i] - log_offset[i - 1]);
    return log_value[i - 1] + share * (log_value[i] - log_value[i - 1]);
  }
  double end_slope() const {  // over the last quarter decade, or two points
    std::size_t i = log_offset.size() - 2;
    while (i > 0 && log_offset.back() - log_offset[i] < 0.5756) --i;
    return (log_value.back() - log_value[i]) / (log_offset.back() - log_offset[i]);
  }
};

// Points of one incidence, those at the same offset (within 1 %: the two sides of the specular direction) joined by
// their geometric mean.
Curve curve_of(std::vector<MeasuredPoint> points) {
  std::ranges::sort(points, [](auto const& a, auto const& b) { return a.offset < b.offset; });
  Curve c;
  for (std::size_t i = 0; i < points.size();) {
    double x = 0, y = 0, low = infinity, high = 0;
    std::size_t j = i;
    for (; j < points.size() && points[j].offset <= std::fmax(1.01 * points[i].offset, nearest); ++j) {
      x += log_positive(std::fmax(points[j].offset, nearest));
      y += log_positive(points[j].value);
      low = std::fmin(low, points[j].value);
      high = std::fmax(high, points[j].value);
    }
    c.log_offset.push_back(x / double(j - i));
    c.log_value.push_back(y / double(j - i));
    c.spread = std::fmax(c.spread, high / low);
    i = j;
  }
  return c;
}

// Where light was measured in both directions: they should agree.
void compare_directions(Measured const& law, std::size_t incidences, MeasuredSummary& summary) {
  for (std::size_t i = 0; i < incidences; ++i)
    for (std::size_t k = 0; k < i; ++k)
      for (double offset : {law.sine[i] - law.sine[k], law.sine[i] + law.sine[k]}) {
        if (offset < summary.smallest_offset || offset > summary.largest_offset) continue;
        double const there = law.one_way(law.sine[i], offset), back = law.one_way(law.sine[k], offset);
        if (there > 0 && back > 0)
          summary.asymmetry = std::fmax(summary.asymmetry, std::fmax(there / back, back / there));
      }
}

}  // namespace

void Measured::prepare() { lobe.prepare(*this, first); }

MeasuredSummary fit_measured(Measured& law, std::vector<MeasuredPoint> points, Beyond beyond) {
  std::ranges::sort(points, [](auto const& a, auto const& b) { return a.sin_i < b.sin_i; });
  std::vector<Curve> curves;
  MeasuredSummary summary;
  law.incidences = 0;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t j = i;
    while (j < points.size() && points[j].sin_i - points[i].sin_i < same) ++j;
    law.sine[curves.size()] = points[i].sin_i;
    curves.push_back(curve_of({points.begin() + long(i), points.begin() + long(j)}));
    summary.spread = std::fmax(summary.spread, curves.back().spread);
    i = j;
  }
  law.incidences = double(curves.size());
  double low = infinity, high = -infinity, inner = -infinity, outer = infinity;
  for (Curve const& c : curves) {
    low = std::fmin(low, c.log_offset.front());
    high = std::fmax(high, c.log_offset.back());
    inner = std::fmax(inner, c.log_offset.front());
    outer = std::fmin(outer, c.log_offset.back());
  }
  for (std::size_t k = 0; k < curves.size(); ++k)
    summary.reach = std::fmin(summary.reach, exp_number(curves[k].log_offset.back()) / (1 + law.sine[k]));
  low = std::fmax(low, -18.0);
  law.first = exp_number(low);
  law.last = exp_number(high);
  law.dark_inside = beyond == Beyond::zero ? law.first * (1 - 1e-9) : 0;
  summary.smallest_offset = exp_number(inner);
  summary.largest_offset = exp_number(outer);
  double const step = (high - low) / (Measured::points - 1);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    Curve const& c = curves[k];
    double const slope = beyond == Beyond::power ? c.end_slope() : beyond == Beyond::zero ? dark : 0;
    law.slope[k] = slope;
    for (int i = 0; i < Measured::points; ++i) {
      double const x = low + i * step, above = x - c.log_offset.back(), tiny = 1e-9;
      double value = c.at(x);
      if (above > tiny) value += beyond == Beyond::zero ? dark : slope * above;
      if (beyond == Beyond::zero && x < c.log_offset.front() - tiny) value = dark;
      law.log_value[k][i] = value;
    }
  }
  compare_directions(law, curves.size(), summary);
  return summary;
}

}  // namespace straytrace::optics
