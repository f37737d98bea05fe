// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/injections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/units/quantity.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/integration.hpp"

namespace straytrace::analysis {

void refuse_overlaps(std::vector<FoundStretch> const& all) {
  constexpr double surely_gps = 1e8;  // s; other files count from 0
  std::vector<InputError> errors;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      FoundStretch const &a = all[j], &b = all[i];
      double const from = std::max(a.from, b.from), to = std::min(a.to, b.to);
      if (to <= from || (a.file != b.file && from < surely_gps)) continue;
      errors.emplace_back(
          fmt::format("{} and {} share the time from {} to {}", a.name, b.name, gps_text(from), gps_text(to)),
          "name stretches that do not overlap");
    }
  throw_all(errors);
}

ToMetres to_metres(bool displacement, std::string const& unit) {
  if (!displacement) return {0, 1, unit};
  auto const known = parse_unit(unit);
  return {integrations_to_displacement(unit), known ? known->si : 1, "m"};
}

namespace {

double factor_at(ToMetres const& m, double hz) { return m.scale / std::pow(2 * pi * hz, m.times); }

CrossSpectra in_metres(ToMetres const& m, CrossSpectra s) {
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const f = s.hz[k] > 0 ? factor_at(m, s.hz[k]) : not_a_number;
    s.input[k] *= f * f;
    s.cross[k] *= f;  // its phase is not used
  }
  return s;
}

CrossSpectra pooled(std::vector<CrossSpectra> const& all) {
  CrossSpectra sum = all.front();
  for (std::size_t i = 1; i < all.size(); ++i) {
    for (std::size_t k = 0; k < sum.hz.size(); ++k) {
      double const a = sum.effective_averages, b = all[i].effective_averages;
      sum.input[k] = (a * sum.input[k] + b * all[i].input[k]) / (a + b);
      sum.output[k] = (a * sum.output[k] + b * all[i].output[k]) / (a + b);
      sum.cross[k] = (a * sum.cross[k] + b * all[i].cross[k]) / (a + b);
    }
    sum.effective_averages += all[i].effective_averages;
    sum.segments += all[i].segments;
  }
  return sum;
}

}  // namespace

void in_metres(ToMetres const& m, std::vector<LinePoint>& points) {
  for (LinePoint& p : points) {
    p.amplitude *= factor_at(m, p.hz);
    p.sigma *= factor_at(m, p.hz);
  }
}

void in_metres(ToMetres const& m, std::vector<RidgePoint>& ridge) {
  for (RidgePoint& p : ridge) {
    double const f = factor_at(m, p.coupling.hz);
    p.witness *= f;
    p.modulus /= f;
    p.sigma /= f;
    p.coupling.factor /= f;
    p.coupling.sigma /= f;
  }
}

std::size_t InjectionCoupling::line_at(double hz) const { return std::size_t(std::lround(hz / quiet.hz[1])); }

double InjectionCoupling::share(CouplingPoint const& p) const {
  std::size_t const k = line_at(p.hz);
  return p.factor * std::sqrt(quiet.input[k] / quiet.output[k]);
}

InjectionCoupling couple_injections(StretchSpectra const& quiet, std::span<StretchSpectra const> injections,
                                    bool displacement, CouplingThresholds const& thresholds, double low, double high) {
  ToMetres const metres = to_metres(displacement, quiet.witness_unit);
  InjectionCoupling out;
  out.quiet = in_metres(metres, quiet.cross);
  std::vector<CouplingFunction> each;
  std::vector<CrossSpectra> loud;
  for (StretchSpectra const& s : injections) {
    loud.push_back(in_metres(metres, s.cross));
    CouplingFunction c{s.witness, s.target, metres.unit, coupling_unit(s.target_unit, metres.unit), {}};
    for (CouplingPoint const& p : measure_coupling(loud.back(), out.quiet, thresholds))
      if (p.hz >= low && p.hz <= high) c.points.push_back(p);
    each.push_back(std::move(c));
  }
  out.coupling = combine(each);
  CrossSpectra const all = pooled(loud);
  out.linear = h1(all);
  auto const is_wrapped = [](CouplingPoint const& p) { return p.flag == CouplingFlag::not_linear; };
  if (std::any_of(out.coupling.points.begin(), out.coupling.points.end(), is_wrapped))
    out.whole = band_coupling(all, out.quiet, low, high, quiet.welch);
  return out;
}

std::vector<std::size_t> peaks_of(std::span<double const> heights) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (heights[i] > 0 && (i == 0 || heights[i] >= heights[i - 1]) &&
        (i + 1 == heights.size() || heights[i] > heights[i + 1]))
      all.push_back(i);
  return all;
}

}  // namespace straytrace::analysis
