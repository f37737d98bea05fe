// SPDX-License-Identifier: BSD-3-Clause
// Curves hold averages over bins, which stand at the centres: in between they are straight lines in log-log. A line
// fills one bin and no other, so beside it, and where a curve is 0, the average of the bin is all there is to say.
#include <algorithm>
#include <cmath>

#include "report/band.hpp"

namespace straytrace {
namespace {

using Curve = std::vector<double>;

// The bin that holds hz; the number of bins outside them.
std::size_t bin_of(FrequencyGrid const& grid, double hz) {
  if (grid.size() == 0 || !(hz >= grid.edges.front() && hz < grid.edges.back())) return grid.size();
  return std::size_t(std::upper_bound(grid.edges.begin(), grid.edges.end(), hz) - grid.edges.begin()) - 1;
}

// Above twice the geometric mean of its neighbours, whatever the slope there.
bool stands_out(Curve const& curve, std::size_t i) {
  return i > 0 && i + 1 < curve.size() && curve[i] * curve[i] > 4 * curve[i - 1] * curve[i + 1];
}

// Above twice either neighbour.
bool is_line(Curve const& curve, std::size_t i) {
  double const before = i > 0 ? curve[i - 1] : 0, after = i + 1 < curve.size() ? curve[i + 1] : 0;
  return curve.size() > 1 && curve[i] > 2 * std::max(before, after);
}

WithError curve_at(Curve const& mean, Curve const& sigma, FrequencyGrid const& grid, double hz) {
  std::size_t const n = grid.size(), own = bin_of(grid, hz);
  if (own == n) return {not_a_number, not_a_number};
  std::size_t low = 0;
  while (low + 2 < n && grid.centre(low + 1) <= hz) ++low;
  bool const smooth =
      n > 1 && mean.at(low) > 0 && mean.at(low + 1) > 0 && !stands_out(mean, low) && !stands_out(mean, low + 1);
  if (!smooth) return {mean.at(own), sigma.at(own)};
  double const x = std::log(hz / grid.centre(low)) / std::log(grid.centre(low + 1) / grid.centre(low));
  double const value = mean[low] * std::pow(mean[low + 1] / mean[low], x);
  double const relative = (1 - x) * sigma.at(low) / mean[low] + x * sigma.at(low + 1) / mean[low + 1];
  return {value, value * std::fabs(relative)};
}

}  // namespace

std::pair<double, double> band_of(FrequencyGrid const& grid, double low, double high) {
  if (grid.size() == 0 || high > low) return {low, high};
  return {grid.edges.front(), grid.edges.back()};
}

bool at_most(double value, double sigma, double bound_share) {
  constexpr double shown = 5e-4;  // less shows in no printed digit
  double const less = value * (1 - std::sqrt(std::max(0.0, 1 - bound_share)));
  return less > std::max(sigma, shown * value);
}

bool at_most(NoiseTrace const& trace, std::size_t bin) {
  return trace.upper_bound ||
         (bin < trace.bound_share.size() && at_most(trace.asd.at(bin), trace.sigma.at(bin), trace.bound_share[bin]));
}

WithError strain_at(NoiseTrace const& trace, FrequencyGrid const& grid, double hz) {
  WithError h = curve_at(trace.asd, trace.sigma, grid, hz);
  h.at_most = !std::isnan(h.value) && at_most(trace, bin_of(grid, hz));
  return h;
}

BinLine line_at(NoiseTrace const& trace, FrequencyGrid const& grid, double hz) {
  std::size_t const i = bin_of(grid, hz);
  if (i == grid.size() || !is_line(trace.asd, i)) return {};
  double const width = std::sqrt(grid.width(i));
  return {{trace.asd[i] * width, trace.sigma.at(i) * width, at_most(trace, i)}, grid.edges[i], grid.edges[i + 1]};
}

double band_at(Curve const& curve, FrequencyGrid const& grid, double hz) {
  return curve_at(curve, Curve(curve.size(), 0.0), grid, hz).value;
}

double design_at(DesignCurve const& curve, FrequencyGrid const& grid, double hz) {
  return band_at(curve.asd, grid, hz);
}

WithError band_power(NoiseTrace const& trace, FrequencyGrid const& grid, double low, double high) {
  WithError power;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.centre(i) < low || grid.centre(i) > high) continue;
    power.value += trace.asd.at(i) * trace.asd.at(i) * grid.width(i);
    power.sigma += 2 * trace.asd.at(i) * trace.sigma.at(i) * grid.width(i);
  }
  return power;
}

}  // namespace straytrace
