// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/ridge.hpp"

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/coupling/band_coupling.hpp"
#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "spectra/segments.hpp"

namespace straytrace {
namespace {

constexpr double foot = 1e-3;       // of the highest power: where the ridge ends
constexpr std::size_t beside = 10;  // bins on each side that show the noise
// Noise of neighbouring lines under a Hann window is correlated: transform of w^2 over its sum.
constexpr double hann_correlation[] = {1, -2.0 / 3, 1.0 / 6};

struct Ridge {
  std::size_t low, high;  // lines, both within
};

// Within the band, `high` excluded: a drive outside of it is none of its ridge.
Ridge ridge_of(Complexes const& x, std::size_t low, std::size_t high) {
  auto const louder = [](auto const& a, auto const& b) { return std::norm(a) < std::norm(b); };
  auto const top = std::size_t(
      std::max_element(x.begin() + std::ptrdiff_t(low), x.begin() + std::ptrdiff_t(high), louder) - x.begin());
  Ridge r{top, top};
  double const least = foot * std::norm(x[top]);
  while (r.low > low && std::norm(x[r.low - 1]) > least) --r.low;
  while (r.high + 1 < high && std::norm(x[r.high + 1]) > least) ++r.high;
  return r;
}

struct Level {
  double mean = 0;   // |line|^2
  double lines = 0;  // independent ones
};

// Beside the ridge.
Level level_beside(Complexes const& lines, Ridge const& r) {
  constexpr double shared = 1 + 2 * (4.0 / 9 + 1.0 / 36);  // of neighbouring lines
  double sum = 0;
  int count = 0;
  for (std::size_t k = 2; k < beside + 2; ++k) {
    if (r.low > k) sum += std::norm(lines[r.low - k]), ++count;
    if (r.high + k + 1 < lines.size()) sum += std::norm(lines[r.high + k]), ++count;
  }
  return count > 0 ? Level{sum / count, count / shared} : Level{not_a_number, 0};
}

// Mean of the ratios and of the coherence.
void add_means(CouplingPoint& out, std::vector<RidgePoint> const& windows) {
  double const n = double(windows.size());
  out.witness_ratio = out.target_ratio = out.coherence = 0;
  for (RidgePoint const& w : windows) {
    out.witness_ratio += w.coupling.witness_ratio / n;
    out.target_ratio += w.coupling.target_ratio / n;
    out.coherence += w.coupling.coherence / n;
  }
}

// All windows of a bin together (C.12): sum of |H|^2/sigma^2 is chi-square of two degrees for each, off centre by
// H^2/sigma^2. The noise is the mean over the windows. Phases may differ, as behind a delay.
CouplingPoint judged(std::vector<RidgePoint> const& windows, double significance) {
  double const n = double(windows.size());
  CouplingPoint out;
  add_means(out, windows);
  double level = 0, lines = 0, sum = 0, weights = 0, scatter = 0;
  for (RidgePoint const& w : windows) level += w.level / n, lines += w.lines;
  auto const variance = [&](RidgePoint const& w) { return squared(w.sigma) * level / w.level; };
  for (RidgePoint const& w : windows) sum += squared(w.modulus) / variance(w), weights += 1 / variance(w);
  out.significance = excess_significance({sum / (2 * n), n}, {1, lines});
  if (!(out.significance >= significance)) {
    boost::math::non_central_chi_squared const any(2 * n, 0);
    out.flag = CouplingFlag::upper_limit;
    out.factor = std::sqrt(decltype(any)::find_non_centrality(2 * n, std::max(sum, 2 * n), 0.05) / weights);
    return out;
  }
  out.flag = CouplingFlag::measured;
  out.factor = std::sqrt((sum - 2 * n) / weights);
  for (RidgePoint const& w : windows) scatter += squared(w.modulus - out.factor) / variance(w);
  double const disagree = n > 1 ? std::max(1.0, scatter / (n - 1)) : 1;
  out.sigma = std::sqrt(disagree * (1 + n / (sum - 2 * n)) / weights);
  return out;
}

RidgePoint coupling_at(Complexes const& x, Complexes const& y, Ridge const& r, RidgeSettings const& s) {
  std::complex<double> cross = 0;
  double power = 0, answer = 0, noise = 0;
  for (std::size_t k = r.low; k <= r.high; ++k) {
    cross += std::conj(x[k]) * y[k];
    power += std::norm(x[k]);
    answer += std::norm(y[k]);
    for (std::size_t m = 0; m < 3 && k + m <= r.high; ++m)
      noise += (m == 0 ? 1 : 2) * hann_correlation[m] * std::real(std::conj(x[k]) * x[k + m]);
  }
  Level const beside_y = level_beside(y, r);
  double const level = beside_y.mean, top = power / double(r.high - r.low + 1);
  RidgePoint out;
  CouplingPoint& p = out.coupling;
  p.witness_ratio = std::sqrt(top / level_beside(x, r).mean);
  p.target_ratio = std::sqrt(answer / double(r.high - r.low + 1) / level);
  p.coherence = std::norm(cross) / (power * answer);
  p.flag = CouplingFlag::below_thresholds;
  if (!(p.witness_ratio >= s.witness_ratio)) return out;
  out.modulus = std::abs(cross) / power;
  out.sigma = std::sqrt(level * noise / 2) / power;
  out.level = level;
  out.lines = beside_y.lines;
  p = judged({out}, s.significance);
  return out;
}

}  // namespace

std::vector<RidgePoint> ridge_coupling(TimeSeries const& witness, TimeSeries const& target, RidgeSettings const& s) {
  if (witness.rate != target.rate || witness.samples.size() != target.samples.size())
    throw InputError("witness and target do not share their samples", "give both at one rate, over the same stretch");
  if (!(s.low > 0 && s.low < s.high && s.high <= witness.rate / 2))
    throw InputError(
        fmt::format("no sweep between {:g} and {:g} Hz can be seen at {:g} Hz", s.low, s.high, witness.rate),
        fmt::format("choose --band between 0 and {:g} Hz", witness.rate / 2));
  WelchSettings const settings{.segment = std::size_t(std::lround(s.window * witness.rate))};
  Segments of_x(witness.samples.size(), witness.rate, settings), of_y(target.samples.size(), target.rate, settings);
  auto const low = std::size_t(std::max(1.0, std::floor(s.low * s.window)));
  auto const high = std::min(std::size_t(std::ceil(s.high * s.window)) + 1, of_x.lines() - 1);
  std::vector<RidgePoint> out;
  for (std::size_t i = 0; i < of_x.count(); ++i) {
    Complexes const x = of_x.transform(witness.samples, i), y = of_y.transform(target.samples, i);
    Ridge const r = ridge_of(x, low, high);
    RidgePoint p = coupling_at(x, y, r, s);
    p.time = witness.time(of_x.begin(i)) + s.window / 2;
    double power = 0, mean = 0;
    for (std::size_t k = r.low; k <= r.high; ++k) {
      power += std::norm(x[k]);
      mean += std::norm(x[k]) * of_x.hz(k);
    }
    p.coupling.hz = mean / power;
    p.witness = std::sqrt(power * of_x.density(r.low) * of_x.hz(1));
    out.push_back(p);
  }
  return out;
}

CouplingFunction coupling_of_ridge(std::vector<RidgePoint> const& ridge, TimeSeries const& witness,
                                   TimeSeries const& target, double resolution, double significance) {
  CouplingFunction out{witness.name, target.name, witness.unit, coupling_unit(target.unit, witness.unit), {}};
  std::map<long, std::vector<RidgePoint>> bins;
  for (RidgePoint const& p : ridge) bins[std::lround(p.coupling.hz / resolution)].push_back(p);
  for (auto& [bin, windows] : bins) {
    CouplingPoint point = windows.front().coupling;
    std::erase_if(windows, [](RidgePoint const& p) { return p.coupling.flag == CouplingFlag::below_thresholds; });
    if (!windows.empty()) point = judged(windows, significance);
    point.hz = double(bin) * resolution;
    out.points.push_back(point);
  }
  return out;
}

}  // namespace straytrace
