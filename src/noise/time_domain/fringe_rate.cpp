// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/fringe_rate.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/math/constants.hpp"

namespace straytrace {
namespace {

struct PhaseSensitivitySums {
  double weight = 0, size = 0, square = 0;
  double mean[6] = {};
};

std::map<std::uint32_t, PhaseSensitivitySums> phase_sensitivity_sums(CouplingClass const& c, double& weight) {
  std::map<std::uint32_t, PhaseSensitivitySums> sums;
  weight = 0;
  for (PathRecord const& r : c.records) {
    weight += r.weight;
    for (PhaseSensitivity const& phase_sensitivity : r.phase_sensitivities) {
      PhaseSensitivitySums& s = sums[phase_sensitivity.body.value];
      double const size = std::hypot(phase_sensitivity.d[0], phase_sensitivity.d[1], phase_sensitivity.d[2]);
      s.size += r.weight * size;
      s.square += r.weight * size * size;
      for (int axis = 0; axis < 6; ++axis) s.mean[axis] += r.weight * phase_sensitivity.d[axis];
    }
  }
  return sums;
}

double at(std::vector<double> const& sorted, double below) {
  return sorted[std::size_t(std::lround(below * double(sorted.size() - 1)))];
}

}  // namespace

std::vector<double> fringe_frequency(std::span<double const> velocity, double wavelength, double bounces) {
  std::vector<double> hz;
  for (double v : velocity) hz.push_back(bounces * 2 * std::fabs(v) / wavelength);
  return hz;
}

FringeCurve fringe_curve(CouplingTable const& table, std::uint32_t route, MotionSeries const& motion) {
  CouplingClass const& c = table.classes.at(route);
  FringeCurve out{route, route_name(table, c), {}, std::vector<double>(motion.times.samples)};
  double weight = 0;
  double const two_k = 4 * pi / table.wavelength;
  for (auto const& [body, s] : phase_sensitivity_sums(c, weight)) {
    bool moves = false;
    for (MovingCoordinate const& m : motion.coordinates) {
      if (m.body.value != body) continue;
      moves = moves || m.axis < 3;
      double const turns = s.mean[m.axis] / weight / (2 * pi);
      for (std::size_t i = 0; i < out.hz.size(); ++i) out.hz[i] += turns * m.velocity[i];
    }
    double const mean = s.size / weight;
    double const spread = std::sqrt(std::max(0.0, s.square / weight - mean * mean));
    if (moves && mean > 0) out.bodies.push_back({BodyId{body}, mean / two_k, spread / two_k});
  }
  for (double& f : out.hz) f = std::fabs(f);
  std::stable_sort(out.bodies.begin(), out.bodies.end(),
                   [](Multiplicity const& a, Multiplicity const& b) { return a.bounces > b.bounces; });
  return out;
}

std::vector<FringeStride> by_stride(std::span<double const> hz, SampleTimes const& times, double stride,
                                    double threshold) {
  auto const n = std::max<std::size_t>(1, std::size_t(std::llround(stride * times.rate)));
  std::vector<FringeStride> out;
  for (std::size_t from = 0; from < hz.size(); from += n) {
    std::size_t const to = std::min(from + n, hz.size());
    std::vector<double> sorted(hz.begin() + std::ptrdiff_t(from), hz.begin() + std::ptrdiff_t(to));
    std::sort(sorted.begin(), sorted.end());
    auto const above = sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), threshold);
    out.push_back({times.start + double(from) / times.rate, times.start + double(to) / times.rate, at(sorted, 0.5),
                   at(sorted, 0.95), sorted.back(), double(above) / double(sorted.size())});
  }
  return out;
}

std::vector<StretchAbove> stretches_above(std::span<FringeStride const> strides, double threshold) {
  std::vector<StretchAbove> out;
  bool inside = false;
  for (FringeStride const& s : strides) {
    bool const above = s.largest > threshold;
    if (above && !inside) out.push_back({s.from, s.to, 0});
    if (above) {
      out.back().to = s.to;
      out.back().largest = std::max(out.back().largest, s.largest);
    }
    inside = above;
  }
  return out;
}

}  // namespace straytrace
