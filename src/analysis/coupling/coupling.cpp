// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/coupling/band_coupling.hpp"
#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace {
namespace {

// Relative variance of H^2. Witness and target of one stretch fluctuate together as far as they are coherent:
// cov(Sxx, Syy) = |Sxy|^2/n.
double relative_variance(CouplingLevels const& i, CouplingLevels const& q) {
  double const y = i.y - q.y, x = i.x - q.x;
  auto const own = [](CouplingLevels const& l, double from_x, double from_y) {
    return (squared(l.x / from_x) + squared(l.y / from_y) - 2 * l.coherence * (l.x / from_x) * (l.y / from_y)) /
           l.averages;
  };
  return own(i, x, y) + own(q, x, y);
}

// Share of the target's gain that is coherent with the witness is what linear coupling can be. The rest of a linear
// coupling is quiet noise of the target, and sensor noise of the witness seen through the coupling.
bool is_not_linear(CouplingLevels const& i, CouplingLevels const& q, double raw_coherence, double threshold) {
  if (i.averages < 2) return false;
  double const left = i.y * (1 - raw_coherence) * i.averages / (i.averages - 1);
  double const allowed = q.y + i.y * q.x / i.x;
  double const sure = excess_significance({left, i.averages - 1}, {allowed, q.averages});
  return sure > threshold && left - allowed > (i.y - q.y) / 2;
}

CouplingPoint point(CouplingLevels const& i, CouplingLevels const& q, double raw_coherence,
                    CouplingThresholds const& t) {
  CouplingPoint p;
  if (!(i.x > 0 && i.y > 0 && q.x > 0 && q.y > 0)) return p;
  p.witness_ratio = std::sqrt(i.x / q.x);
  p.target_ratio = std::sqrt(i.y / q.y);
  p.coherence = i.coherence;
  p.significance = excess_significance({i.y, i.averages}, {q.y, q.averages});
  double const witness = excess_significance({i.x, i.averages}, {q.x, q.averages});
  p.flag = CouplingFlag::below_thresholds;
  if (!(p.witness_ratio >= t.witness && p.witness_ratio > 1 && witness >= t.significance)) return p;
  double const gained = i.x - q.x;
  if (p.target_ratio >= t.target && p.target_ratio > 1 && p.significance >= t.significance) {
    bool const wrapped = t.check_linear && is_not_linear(i, q, raw_coherence, t.not_linear);
    p.flag = wrapped ? CouplingFlag::not_linear : CouplingFlag::measured;
    p.factor = std::sqrt((i.y - q.y) / gained);
    p.sigma = p.factor / 2 * std::sqrt(std::max(0.0, relative_variance(i, q)));
    return p;
  }
  double const limit = coupling_limit(i, q, t.confidence);
  if (!std::isfinite(limit)) return p;
  p.flag = CouplingFlag::upper_limit;
  p.factor = limit;
  return p;
}

// One frequency of all injections.
CouplingPoint combined(std::vector<CouplingPoint const*> const& all) {
  CouplingPoint best = *all.front();
  double weight = 0, mean = 0, chi = 0;
  int measured = 0;
  for (CouplingPoint const* p : all) {
    if (p->flag == CouplingFlag::not_linear) return *p;
    if (p->flag == CouplingFlag::measured && p->sigma > 0) {
      weight += 1 / squared(p->sigma);
      mean += p->factor / squared(p->sigma);
      ++measured;
    }
    bool const lower = p->flag == best.flag && p->flag == CouplingFlag::upper_limit && p->factor < best.factor;
    bool const surer =
        p->flag == best.flag && p->significance > best.significance && p->flag != CouplingFlag::upper_limit;
    if (p->flag < best.flag || lower || surer) best = *p;
  }
  if (measured < 2) return best;
  best.factor = mean / weight;
  for (CouplingPoint const* p : all)
    if (p->flag == CouplingFlag::measured && p->sigma > 0) chi += squared((p->factor - best.factor) / p->sigma);
  best.sigma = std::sqrt(std::max(1.0, chi / (measured - 1)) / weight);
  return best;
}

}  // namespace

double coupling_limit(CouplingLevels const& i, CouplingLevels const& q, double confidence) {
  auto const above = [&](double psd, double n) { return psd * (upper_factor(n, confidence) - 1); };
  auto const below = [&](double psd, double n) { return psd * (1 - upper_factor(n, 1 - confidence)); };
  double const loud = std::max(i.y, q.y), y = loud - q.y, x = i.x - q.x;
  double const up = above(loud, i.averages), down = below(i.x, i.averages);
  double const a = x * x - squared(down) - squared(above(q.x, q.averages));
  double const b = x * y - i.coherence * up * down;
  double const c = y * y - squared(up) - squared(below(q.y, q.averages));
  return a > 0 ? std::sqrt((b + std::sqrt(b * b - a * c)) / a) : infinity;
}

char const* name_of(CouplingFlag flag) {
  switch (flag) {
    case CouplingFlag::measured:
      return "Real";
    case CouplingFlag::upper_limit:
      return "Upper Limit";
    case CouplingFlag::below_thresholds:
      return "Thresholds not met";
    case CouplingFlag::no_data:
      return "No data";
    case CouplingFlag::not_linear:
      return "Fringe wrapped";
  }
  return "";
}

std::string coupling_unit(std::string const& target, std::string const& witness) {
  return target == witness && target != "1" ? target + "/" + target : ratio_unit(target, witness);
}

double unbiased_coherence(double c, double averages) {
  double const chance = 1 / std::max(averages, 1.0);
  return chance < 1 ? std::max(0.0, (c - chance) / (1 - chance)) : 0;
}

std::vector<CouplingPoint> measure_coupling(CrossSpectra const& injection, CrossSpectra const& quiet,
                                            CouplingThresholds const& t) {
  if (injection.hz != quiet.hz)
    throw InputError("injection and quiet stretch differ in their frequencies", "use one segment length for both");
  std::vector<double> const loud = coherence(injection), still = coherence(quiet);
  auto const levels = [](CrossSpectra const& s, std::vector<double> const& c, std::size_t k) {
    return CouplingLevels{s.input[k], s.output[k], unbiased_coherence(c[k], s.effective_averages),
                          s.effective_averages};
  };
  std::vector<CouplingPoint> points;
  for (std::size_t k = 1; k < injection.hz.size(); ++k) {
    points.push_back(point(levels(injection, loud, k), levels(quiet, still, k), loud[k], t));
    points.back().hz = injection.hz[k];
  }
  return points;
}

CouplingFunction combine(std::span<CouplingFunction const> all) {
  if (all.empty()) return {};
  CouplingFunction out = all.front();
  for (CouplingFunction const& c : all)
    if (c.unit != out.unit || c.points.size() != out.points.size())
      throw InputError(fmt::format("couplings of '{}' and '{}' differ in unit or frequencies and cannot be combined",
                                   out.witness, c.witness),
                       "use one segment length and one unit");
  for (std::size_t k = 0; k < out.points.size(); ++k) {
    std::vector<CouplingPoint const*> at;
    for (CouplingFunction const& c : all) {
      if (c.points[k].hz != out.points[k].hz)
        throw InputError("couplings on different frequencies cannot be combined", "use one segment length");
      at.push_back(&c.points[k]);
    }
    out.points[k] = combined(at);
  }
  return out;
}

}  // namespace straytrace
