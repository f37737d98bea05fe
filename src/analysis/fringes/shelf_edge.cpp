// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/shelf_edge.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "analysis/fringes/shelf_shape.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace {
namespace {

struct Layout {
  std::size_t factor = 1, segment = 0, stride = 0, from = 0, count = 0;  // samples of the target, strides
};

ShelfProfile profile_of(ShelfStride const& d, ShelfEdgeSettings const& s, double ratio) {
  std::vector<double> const u = motion_of(d, ratio);
  double const edge = 2 * fastest(u, d.rate) / s.wavelength;
  // The edge lies inside the band: beyond, there is nothing of it to see.
  FactorGrid grid{std::log(std::max(s.factor.low, 1.1 * s.low / edge)), factor_step, 0};
  grid.count = int((std::log(std::min(s.factor.high, s.high / (1.05 * edge))) - grid.low) / factor_step) + 1;
  if (grid.count <= 10) grid.count = 0;
  Eigen::Map<Eigen::VectorXd const> const psd(d.psd.data(), Eigen::Index(d.psd.size()));
  return profile_on(d, psd, shelf_shapes(d, u, grid, s.wavelength), grid);
}

EdgeStride edge_of(ShelfStride const& d, ShelfEdgeSettings const& s, double ratio, ShelfProfile const& p) {
  EdgeStride out;
  out.start = d.start;
  out.predicted = 2 * fastest(motion_of(d, ratio), d.rate) / s.wavelength;
  if (p.twice_log.empty()) return out;
  ProfileTop const top = top_of(p);
  out.gain = p.best.twice_log - p.without;
  out.factor = {std::exp(top.log_factor), std::exp(top.log_factor) * top.sigma, top.at_end};
  out.amplitude = std::sqrt(ShelfSpectrum(d).response(p.best, out.factor.value * out.predicted));
  double const places = double(p.twice_log.size());
  out.significant = !top.at_end && out.gain > 0 && -out.gain / 2 + std::log(places) < std::log(s.false_alarm);
  return out;
}

Layout layout_of(FringeRecords const& r, ShelfEdgeSettings const& s) {
  double from = r.target.start, to = r.target.end();
  for (TimeSeries const& x : r.witnesses) {
    from = std::max(from, x.start);
    to = std::min(to, x.end());
  }
  if (!(to - from >= s.stride))
    throw InputError(
        fmt::format("the records share {:.3g} s, a stride takes {:g} s", std::max(0.0, to - from), s.stride),
        "give records of the same time, or a shorter stride");
  if (!(s.low > 0 && s.high > s.low && s.high < r.target.rate / 2))
    throw InputError(fmt::format("the band {:g} to {:g} Hz is not inside 0 to {:g} Hz, half the sample rate of '{}'",
                                 s.low, s.high, r.target.rate / 2, r.target.name),
                     "choose a band inside");
  if (!(s.segment * 4 <= s.stride && (s.high - s.low) * s.segment > 12))
    throw InputError(fmt::format("segments of {:g} s do not suit strides of {:g} s and a band of {:g} Hz", s.segment,
                                 s.stride, s.high - s.low),
                     "a stride holds at least four, and the band a dozen lines of 1/segment");
  double const fringe =
      2 * s.factor.high * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  // Shapes whose edge lies beyond the band are not asked for.
  double const highest = std::min(fringe, 1.2 * s.high);
  if (2.2 * highest >= r.target.rate)
    throw InputError(
        fmt::format("'{}' is sampled at {:g} Hz; fringes up to {:.4g} Hz need more than {:.0f} Hz (eq. 7.13)",
                    r.target.name, r.target.rate, highest, std::ceil(2.2 * highest)),
        "lower the band or the factor");
  Layout out;
  out.factor = std::size_t(std::max(1.0, std::floor(r.target.rate / (2.4 * 1.2 * s.high))));
  out.segment = out.factor * 2 * std::size_t(std::lround(s.segment * r.target.rate / double(2 * out.factor)));
  out.stride = out.factor * std::size_t(std::lround(s.stride * r.target.rate / double(out.factor)));
  out.from = std::size_t(std::ceil((from - r.target.start) * r.target.rate - 1e-3));
  out.count = std::size_t(std::floor((to - r.target.time(out.from)) * r.target.rate + 1e-3)) / out.stride;
  return out;
}

ShelfStride stride_of(FringeRecords const& r, ShelfEdgeSettings const& s, Layout const& l, std::size_t i) {
  ShelfStride d;
  std::size_t const begin = l.from + i * l.stride;
  d.start = r.target.time(begin);
  d.rate = r.target.rate / double(l.factor);
  d.segment = l.segment / l.factor;
  WelchSpectrum const w = welch({r.target.samples.data() + begin, std::min(l.stride, r.target.samples.size() - begin)},
                                r.target.rate, {l.segment});
  for (std::size_t k = 0; k < w.hz.size(); ++k) {
    if (w.hz[k] < s.low || w.hz[k] > s.high) continue;
    if (d.hz.empty()) {
      d.first = k;
      // Averages, and the share of lines that are independent under the window.
      d.weight = std::pow(w.psd[k] / w.sigma[k], 2) / (w.noise_bandwidth * double(l.segment) / r.target.rate);
    }
    d.hz.push_back(w.hz[k]);
    d.psd.push_back(w.psd[k]);
  }
  d.x = interpolated(r.witnesses[0], d.start, d.rate, l.stride / l.factor);
  if (r.witnesses.size() > 1) d.y = interpolated(r.witnesses[1], d.start, d.rate, l.stride / l.factor);
  return d;
}

struct AtRatio {
  ShelfEdgeFit fit;
  double twice_log = 0;
  std::vector<FoundEdge> found;
};

// Mean of the edges, weighted as if each shelf were Gaussian noise.
Fitted likelihood_mean(std::vector<FoundEdge> const& found) {
  if (found.empty()) return {not_a_number, not_a_number};
  double weights = 0, sum = 0;
  for (FoundEdge const& e : found) {
    weights += 1 / squared(e.top.sigma);
    sum += e.top.log_factor / squared(e.top.sigma);
  }
  double const mean = std::exp(sum / weights);
  return {mean, mean / std::sqrt(weights)};
}

AtRatio at_ratio(std::vector<ShelfStride> const& data, ShelfEdgeSettings const& s, double ratio) {
  AtRatio out;
  out.fit.ratio = {ratio};
  for (ShelfStride const& d : data) {
    ShelfProfile const p = profile_of(d, s, ratio);
    out.fit.strides.push_back(edge_of(d, s, ratio, p));
    out.twice_log += p.twice_log.empty() ? p.without : p.best.twice_log;
    if (out.fit.strides.back().significant) out.found.push_back({&d, top_of(p), p.best});
  }
  out.fit.used = out.found.size();
  out.fit.factor = out.fit.of_likelihood = likelihood_mean(out.found);
  return out;
}

// Offsets taken off, errors by repetition.
ShelfEdgeFit with_errors(AtRatio const& a, ShelfEdgeSettings const& s) {
  ShelfEdgeFit fit = a.fit;
  if (fit.used == 0) return fit;
  RepeatedEdges const again = repeated(a.found, fit.ratio.value, s.wavelength);
  double const mean = again.mean - again.mean_offset;
  std::size_t i = 0;
  for (EdgeStride& e : fit.strides) {
    if (!e.significant) continue;
    double const log_factor = a.found[i].top.log_factor - again.offset[i];
    e.factor = {std::exp(log_factor), std::exp(log_factor) * again.sigma[i]};
    fit.chi2 += squared((log_factor - mean) / again.sigma[i++]);
  }
  double const scatter = fit.used > 1 ? fit.chi2 / double(fit.used - 1) : 1;
  fit.factor = {std::exp(mean), std::exp(mean) * again.mean_sigma * std::sqrt(std::max(1.0, scatter))};
  return fit;
}

}  // namespace

ShelfEdgeFit fit_shelf_edge(FringeRecords const& records, ShelfEdgeSettings const& s) {
  Layout const layout = layout_of(records, s);
  std::vector<ShelfStride> data;
  for (std::size_t i = 0; i < layout.count; ++i) data.push_back(stride_of(records, s, layout, i));
  if (!s.ratio.free()) return with_errors(at_ratio(data, s, s.ratio.low), s);
  constexpr int places = 40;
  double const spacing = (s.ratio.high - s.ratio.low) / places;
  std::vector<AtRatio> all;
  for (int i = 0; i <= places; ++i) all.push_back(at_ratio(data, s, s.ratio.low + spacing * i));
  auto const best = std::max_element(all.begin(), all.end(),
                                     [](AtRatio const& a, AtRatio const& b) { return a.twice_log < b.twice_log; });
  if (best == all.begin() || best == all.end() - 1) {
    ShelfEdgeFit out = with_errors(*best, s);
    out.ratio = {out.ratio.value, spacing, true};
    return out;
  }
  double const left = best->twice_log - best[-1].twice_log, right = best->twice_log - best[1].twice_log;
  double const curvature = (left + right) / (2 * spacing * spacing), top = (left - right) / (4 * curvature * spacing);
  ShelfEdgeFit out = with_errors(at_ratio(data, s, best->fit.ratio.value + top), s);
  // What repetition makes of the likelihood's error of the factor it makes of that of the ratio.
  double const scale = out.used > 0 ? out.factor.sigma / out.of_likelihood.sigma : 1;
  out.ratio.sigma = std::max(scale / std::sqrt(curvature), spacing / 2);
  for (AtRatio const& a : all)  // other maxima that are as good
    if (best->twice_log - a.twice_log < std::max(1.0, scale * scale))
      out.ratio.sigma = std::max(out.ratio.sigma, std::fabs(a.fit.ratio.value - out.ratio.value));
  // The factor follows the ratio; NaN where a neighbour shows no edge.
  double const slope = (best[1].fit.factor.value - best[-1].fit.factor.value) / (2 * spacing);
  if (std::isfinite(slope)) out.factor.sigma = std::hypot(out.factor.sigma, slope * out.ratio.sigma);
  return out;
}

}  // namespace straytrace
