// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/units/quantity.hpp"

namespace straytrace::analysis {
namespace {

// The number of bins where none holds it.
std::size_t bin_of(std::vector<double> const& edges, double hz) {
  auto const edge = std::upper_bound(edges.begin(), edges.end(), hz);
  return edge == edges.begin() || edge == edges.end() ? edges.size() - 1 : std::size_t(edge - edges.begin()) - 1;
}

double scale_to(CouplingFunction const& c, std::string const& unit) {
  auto const have = parse_unit(c.unit), want = parse_unit(unit);
  if (!have || !want || !(have->dimension == want->dimension))
    throw InputError(fmt::format("--measured: the coupling is in {}, the prediction in {}", c.unit, unit),
                     "measure strain against displacement: couple noise --displacement");
  return have->si / want->si;
}

OverlayPoint compared(CouplingPoint const& m, PredictedCurve const& predicted, std::size_t bin) {
  double const factor = predicted.factor[bin], sigma = predicted.sigma[bin];
  OverlayPoint p{m, factor, sigma, m.factor / factor, 0, 0, bin};
  bool const measured = m.flag == CouplingFlag::measured;
  if (!measured || std::isfinite(m.sigma)) p.error = std::hypot(measured ? m.sigma / m.factor : 0, sigma / factor);
  double const log = std::log(p.ratio);
  p.significance = p.error > 0 ? log / p.error : not_a_number;
  if (!measured) p.significance = log < 0 && p.error > 0 ? -log / p.error : 0;
  return p;
}

bool counts(OverlayPoint const& p) { return p.measured.flag == CouplingFlag::measured && p.error > 0; }

}  // namespace

Overlay overlay_of(CouplingFunction const& c, PredictedCurve const& p) {
  double const scale = scale_to(c, p.unit);
  Overlay out;
  out.unit = p.unit;
  double weight = 0;
  for (CouplingPoint m : c.points) {
    std::size_t const i = bin_of(p.edges, m.hz);
    if (i == p.factor.size() || !m.has_factor() || !(p.factor[i] > 0)) continue;
    m.factor *= scale;
    m.sigma *= scale;
    OverlayPoint const point = compared(m, p, i);
    out.points.push_back(point);
    bool const bounded = i < p.at_most.size() && p.at_most[i];
    out.above_limit += m.flag == CouplingFlag::upper_limit && !bounded && point.significance > 3;
    if (!counts(point)) continue;
    weight += 1 / (point.error * point.error);
    out.mean_ratio += std::log(point.ratio) / (point.error * point.error);
    ++out.measured;
  }
  if (out.points.empty())
    throw InputError("--measured: no measured factor or limit is inside the band of the prediction", "choose --band");
  if (out.measured > 0) out.mean_ratio /= weight;
  for (OverlayPoint const& q : out.points)
    if (counts(q)) out.chi_square += std::pow((std::log(q.ratio) - out.mean_ratio) / q.error, 2);
  double const spread = out.measured > 1 ? std::max(1.0, out.chi_square / double(out.measured - 1)) : 1;
  out.mean_sigma = out.measured > 0 ? std::sqrt(spread / weight) : not_a_number;
  return out;
}

std::vector<OverlayPoint const*> points_by_bin(Overlay const& o, std::size_t bins) {
  auto const rank = [](OverlayPoint const* p) {
    if (p == nullptr) return -1.0;
    if (p->measured.flag != CouplingFlag::measured) return 0.0;
    return 1 + (std::isfinite(p->measured.sigma) ? p->measured.factor / p->measured.sigma : 0);
  };
  std::vector<OverlayPoint const*> out(bins);
  for (OverlayPoint const& p : o.points)
    if (rank(&p) > rank(out[p.bin])) out[p.bin] = &p;
  return out;
}

}  // namespace straytrace::analysis
