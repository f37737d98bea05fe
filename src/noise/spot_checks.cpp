// SPDX-License-Identifier: BSD-3-Clause
#include "noise/spot_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace straytrace {
namespace {

constexpr double near_rounding = 1e-12;  // fringes there are near the rounding of a transform

struct Chosen {
  std::vector<std::size_t> route;         // of each path
  std::map<std::size_t, bool> at_random;  // by path
};

std::vector<std::size_t> routes_of(Strengths const& paths) {
  std::vector<std::size_t> route(paths.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < route.size(); ++i) {
    while (next + 1 < paths.first.size() && paths.first[next + 1] <= i) ++next;
    route[i] = next;
  }
  return route;
}

// Half of `count` at equal steps of the summed noise, the others the strongest of their routes.
Chosen choose(PhaseSpectra const& spectra, Strengths const& paths, std::size_t count) {
  Chosen chosen{routes_of(paths), {}};
  std::vector<double> noise;
  double sum = 0, strongest = -1;
  std::size_t most_moved = 0;
  std::map<std::size_t, std::pair<double, std::size_t>> best;  // by route: noise and path
  std::map<std::size_t, double> of_route;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    double const s = spectra.mean_square_phase(paths.of(i));
    noise.push_back(paths.weight_of(i) * s / (1 + s));
    if (s > strongest) most_moved = i;
    strongest = std::max(s, strongest);
    std::size_t const r = chosen.route[i];
    of_route[r] += noise[i];
    if (noise[i] > best[r].first) best[r] = {noise[i], i};
  }
  for (double n : noise) sum += n;
  if (!(sum > 0)) return chosen;
  std::vector<std::pair<double, std::size_t>> ranked;
  for (auto const& [r, total] : of_route) ranked.emplace_back(-total, r);
  std::sort(ranked.begin(), ranked.end());
  chosen.at_random[most_moved] = false;
  for (std::size_t k = 0; k < ranked.size() && k + 1 < count / 2; ++k)
    if (ranked[k].first < 0) chosen.at_random[best[ranked[k].second].second] = false;
  double const step = sum / static_cast<double>(count - count / 2);
  double at = step / 2;
  for (std::size_t i = 0; i < noise.size(); ++i)
    if ((at -= noise[i]) < 0) {
      chosen.at_random[i] = true;
      while (at < 0) at += step;
    }
  return chosen;
}

}  // namespace

SpotChecks::SpotChecks(PhaseSpectra const& spectra, Strengths const& paths, std::size_t count) {
  if (count == 0 || paths.size() == 0) return;
  Chosen const chosen = choose(spectra, paths, count);
  for (auto const& [path, at_random] : chosen.at_random)
    own_.push_back({path, chosen.route[path], at_random, spectra(paths.of(path))});
}

// Over the paths at equal steps, which stand for all; a route without one has its strongest.
std::vector<double> SpotChecks::mean(std::size_t route) const {
  auto const has = [&](Own const& o, bool only_random) { return o.route == route && (o.at_random || !only_random); };
  bool const random = std::any_of(own_.begin(), own_.end(), [&](Own const& o) { return has(o, true); });
  std::vector<double> sum(own_.front().spectrum.psd.size());
  double paths = 0;
  for (Own const& o : own_) {
    if (!has(o, random)) continue;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += o.spectrum.psd[i];
    ++paths;
  }
  for (double& s : sum) s /= paths;
  return sum;
}

std::vector<SpotCheck> SpotChecks::compared(std::function<std::vector<double>(std::size_t)> const& shared) const {
  std::vector<SpotCheck> out;
  for (Own const& o : own_) {
    SpotCheck& found = out.emplace_back();
    found.path = o.path;
    std::vector<double> const psd = shared(o.path), mean_psd = mean(o.route);
    std::vector<double> const &own = o.spectrum.psd, &linear = o.spectrum.linear;
    double const floor = near_rounding * *std::max_element(own.begin(), own.end());
    for (std::size_t i = 0; i < own.size(); ++i) {
      double const size = std::max(own[i], mean_psd[i]);
      if (!(size > 0) || (size < floor && !(linear[i] > 0.5 * own[i]))) continue;
      double const error = std::fabs(psd[i] - own[i]) / size;
      if (!(error <= found.error)) found = {o.path, error, i};
    }
  }
  return out;
}

}  // namespace straytrace
