// SPDX-License-Identifier: BSD-3-Clause
#include "commission/shelf_edge.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "base/functions.hpp"
#include "base/message.hpp"
#include "signal/interpolate.hpp"
#include "signal/welch.hpp"

namespace straytrace {
namespace {

constexpr double step = 0.005;  // of ln(factor) between shapes
constexpr int smear = 2;        // shapes to either side that are averaged: fringes of one arch with another go away

struct StrideData {
  double start = 0;
  std::vector<double> hz, psd;
  double averages = 0;       // independent ones, of the spectrum
  double independent = 0;    // share of the lines
  std::vector<double> x, y;  // witnesses at the model's rate
  double rate = 0;
  std::size_t segment = 0, first = 0;  // samples of the model; first line in the band
};

struct Layout {
  std::size_t factor = 1, segment = 0, stride = 0, from = 0, count = 0;  // samples of the target, strides
};

std::vector<double> difference(StrideData const& d, double ratio) {
  std::vector<double> u = d.x;
  for (std::size_t i = 0; i < d.y.size(); ++i) u[i] -= ratio * d.y[i];
  return u;
}

double fastest(std::vector<double> const& u, double rate) {
  double v = 0;
  for (std::size_t i = 1; i < u.size(); ++i) v = std::max(v, std::fabs(u[i] - u[i - 1]) * rate);
  return v;
}

// One-sided PSD of sin(phi + theta), mean over phi, on the lines of the band.
Eigen::VectorXd shape(StrideData const& d, std::vector<double> const& u, double factor, double wavelength) {
  thread_local Eigen::FFT<double> fft;
  std::size_t const n = d.segment;
  std::vector<std::complex<double>> field(u.size()), part(n), lines;
  for (std::size_t i = 0; i < u.size(); ++i) {
    SinCos const turn = sincos_turn(2 * factor * u[i] / wavelength);
    field[i] = {turn.cos, turn.sin};
  }
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(Eigen::Index(d.hz.size()));
  double segments = 0;
  for (std::size_t begin = 0; begin + n <= u.size(); begin += n / 2, ++segments) {
    for (std::size_t i = 0; i < n; ++i)
      part[i] = field[begin + i] * (0.5 - 0.5 * std::cos(2 * pi * double(i) / double(n)));
    fft.fwd(lines, part);
    for (Eigen::Index k = 0; k < sum.size(); ++k)
      sum[k] += std::norm(lines[d.first + std::size_t(k)]) + std::norm(lines[n - d.first - std::size_t(k)]);
  }
  return sum / (2 * d.rate * 0.375 * double(n) * segments);
}

struct FloorFit {
  double twice_log = -infinity;  // 2 ln L
  double shelf = 0;              // G^2
};

// Largest likelihood over non-negative shares of the columns: each step is a weighted least-squares fit in which the
// negative ones leave.
FloorFit best_floor(StrideData const& d, Eigen::MatrixXd const& columns) {
  Eigen::Map<Eigen::VectorXd const> const psd(d.psd.data(), Eigen::Index(d.psd.size()));
  Eigen::VectorXd model = Eigen::VectorXd::Constant(psd.size(), psd.mean()), share;
  std::vector<Eigen::Index> in;
  for (int round = 0; round < 12; ++round) {
    Eigen::VectorXd const w = model.cwiseInverse();
    in.resize(std::size_t(columns.cols()));
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = Eigen::Index(i);
    for (;;) {
      Eigen::MatrixXd const some = w.asDiagonal() * columns(Eigen::all, in);
      share = some.colPivHouseholderQr().solve(w.cwiseProduct(psd));
      Eigen::Index worst = 0;
      if (share.minCoeff(&worst) >= 0 || in.size() == 1) break;
      in.erase(in.begin() + worst);
    }
    Eigen::VectorXd const next = columns(Eigen::all, in) * share;
    if (!(next.minCoeff() > 0)) break;
    model = next;
  }
  FloorFit out;
  out.twice_log = -2 * d.averages * d.independent * (model.array().log() + psd.array() / model.array()).sum();
  if (in.back() == columns.cols() - 1) out.shelf = share[share.size() - 1];
  return out;
}

Eigen::MatrixXd floor_columns(StrideData const& d, bool shelf) {
  Eigen::MatrixXd columns(Eigen::Index(d.hz.size()), shelf ? 4 : 3);
  double const level = *std::min_element(d.psd.begin(), d.psd.end()), middle = std::sqrt(d.hz.front() * d.hz.back());
  for (std::size_t k = 0; k < d.hz.size(); ++k)
    for (int i = 0; i < 3; ++i) columns(Eigen::Index(k), i) = level * std::pow(middle / d.hz[k], 2 * i);
  return columns;
}

// 2 ln L over ln(factor), best amplitude and floor at each.
struct Profile {
  std::vector<double> log_factor, twice_log, shelf;
  double without = 0;
};

Profile profile_of(StrideData const& d, ShelfEdgeSettings const& s, double ratio) {
  std::vector<double> const u = difference(d, ratio);
  double const edge = 2 * fastest(u, d.rate) / s.wavelength;
  Profile out;
  out.without = best_floor(d, floor_columns(d, false)).twice_log;
  // The edge lies inside the band: beyond, there is nothing of it to see.
  double const low = std::log(std::max(s.factor.low, 1.1 * s.low / edge));
  double const high = std::log(std::min(s.factor.high, s.high / (1.05 * edge)));
  if (!(high - low > 10 * step)) return out;
  std::vector<Eigen::VectorXd> shapes;
  auto const n = int((high - low) / step);
  for (int i = -smear; i <= n + smear; ++i) shapes.push_back(shape(d, u, std::exp(low + step * i), s.wavelength));
  Eigen::MatrixXd columns = floor_columns(d, true);
  for (int i = 0; i <= n; ++i) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(columns.rows());
    for (int j = 0; j <= 2 * smear; ++j) mean += shapes[std::size_t(i + j)] / (2 * smear + 1);
    double const scale = columns.col(0)[0] / mean.maxCoeff();
    columns.col(3) = scale * mean;
    FloorFit const fit = best_floor(d, columns);
    out.log_factor.push_back(low + step * i);
    out.twice_log.push_back(fit.twice_log);
    out.shelf.push_back(fit.shelf * scale);
  }
  return out;
}

// Top of a parabola through the best place and those where the profile has fallen by about 2 to either side.
EdgeStride edge_of(StrideData const& d, ShelfEdgeSettings const& s, double ratio, Profile const& p) {
  EdgeStride out;
  out.start = d.start;
  out.predicted = 2 * fastest(difference(d, ratio), d.rate) / s.wavelength;
  if (p.twice_log.empty()) return out;
  auto const best = std::max_element(p.twice_log.begin(), p.twice_log.end()) - p.twice_log.begin();
  auto const at = std::size_t(best), last = p.twice_log.size() - 1;
  out.gain = p.twice_log[at] - p.without;
  out.amplitude = std::sqrt(p.shelf[at]);
  std::size_t low = at, high = at;
  while (low > 0 && p.twice_log[at] - p.twice_log[low] < 2) --low;
  while (high < last && p.twice_log[at] - p.twice_log[high] < 2) ++high;
  double const a = p.log_factor[low] - p.log_factor[at], b = p.log_factor[high] - p.log_factor[at];
  double const fall_a = p.twice_log[at] - p.twice_log[low], fall_b = p.twice_log[at] - p.twice_log[high];
  out.factor.at_end = low == 0 || high == last;
  if (out.factor.at_end) return out;
  // fall = c (x - top)^2 - c top^2
  double const curvature = (fall_a / a - fall_b / b) / (a - b), top = (curvature * b - fall_b / b) / (2 * curvature);
  out.factor.value = std::exp(p.log_factor[at] + std::clamp(top, a, b));
  out.factor.sigma = out.factor.value * std::max(1 / std::sqrt(curvature), step / 2);
  double const places = double(last + 1);
  out.significant = out.gain > 0 && -out.gain / 2 + std::log(places) < std::log(s.false_alarm);
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
        fmt::format("error: the records share {:.3g} s, a stride takes {:g} s\n  give records of the same "
                    "time, or a shorter stride",
                    std::max(0.0, to - from), s.stride));
  if (!(s.low > 0 && s.high > s.low && s.high < r.target.rate / 2))
    throw InputError(
        fmt::format("error: the band {:g} to {:g} Hz is not inside 0 to {:g} Hz, half the sample rate of "
                    "'{}'\n  choose a band inside",
                    s.low, s.high, r.target.rate / 2, r.target.name));
  if (!(s.segment * 4 <= s.stride && (s.high - s.low) * s.segment > 12))
    throw InputError(
        fmt::format("error: segments of {:g} s do not suit strides of {:g} s and a band of {:g} Hz\n  a "
                    "stride holds at least four, and the band a dozen lines of 1/segment",
                    s.segment, s.stride, s.high - s.low));
  double const fringe =
      2 * s.factor.high * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  // Shapes whose edge lies beyond the band are not asked for.
  double const highest = std::min(fringe, 1.2 * s.high);
  if (2.2 * highest >= r.target.rate)
    throw InputError(
        fmt::format("error: '{}' is sampled at {:g} Hz; fringes up to {:.4g} Hz need more than {:.0f} Hz "
                    "(eq. 7.13)\n  lower the band or the factor",
                    r.target.name, r.target.rate, highest, std::ceil(2.2 * highest)));
  Layout out;
  out.factor = std::size_t(std::max(1.0, std::floor(r.target.rate / (2.4 * 1.2 * s.high))));
  out.segment = out.factor * 2 * std::size_t(std::lround(s.segment * r.target.rate / double(2 * out.factor)));
  out.stride = out.factor * std::size_t(std::lround(s.stride * r.target.rate / double(out.factor)));
  out.from = std::size_t(std::ceil((from - r.target.start) * r.target.rate - 1e-3));
  out.count = std::size_t(std::floor((to - r.target.time(out.from)) * r.target.rate + 1e-3)) / out.stride;
  return out;
}

StrideData stride_data(FringeRecords const& r, ShelfEdgeSettings const& s, Layout const& l, std::size_t i) {
  StrideData d;
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
      d.averages = std::pow(w.psd[k] / w.sigma[k], 2);
    }
    d.hz.push_back(w.hz[k]);
    d.psd.push_back(w.psd[k]);
  }
  d.independent = 1 / (w.noise_bandwidth * double(l.segment) / r.target.rate);
  d.x = interpolated(r.witnesses[0], d.start, d.rate, l.stride / l.factor);
  if (r.witnesses.size() > 1) d.y = interpolated(r.witnesses[1], d.start, d.rate, l.stride / l.factor);
  return d;
}

void combine(ShelfEdgeFit& fit) {
  double weights = 0, sum = 0;
  for (EdgeStride const& e : fit.strides) {
    if (!e.significant) continue;
    weights += 1 / (e.factor.sigma * e.factor.sigma);
    sum += e.factor.value / (e.factor.sigma * e.factor.sigma);
    ++fit.used;
  }
  if (fit.used == 0) {
    fit.factor = {not_a_number, not_a_number};
    return;
  }
  fit.factor.value = sum / weights;
  for (EdgeStride const& e : fit.strides)
    if (e.significant) fit.chi2 += std::pow((e.factor.value - fit.factor.value) / e.factor.sigma, 2);
  double const scatter = fit.used > 1 ? fit.chi2 / double(fit.used - 1) : 1;
  fit.factor.sigma = std::sqrt(std::max(1.0, scatter) / weights);
}

struct AtRatio {
  ShelfEdgeFit fit;
  double twice_log = 0;
};

AtRatio at_ratio(std::vector<StrideData> const& data, ShelfEdgeSettings const& s, double ratio) {
  AtRatio out;
  std::vector<Profile> profiles;
  for (StrideData const& d : data) {
    profiles.push_back(profile_of(d, s, ratio));
    Profile const& p = profiles.back();
    out.fit.strides.push_back(edge_of(d, s, ratio, p));
    out.twice_log += p.twice_log.empty() ? p.without : *std::max_element(p.twice_log.begin(), p.twice_log.end());
  }
  out.fit.ratio = {ratio};
  combine(out.fit);
  return out;
}

}  // namespace

ShelfEdgeFit fit_shelf_edge(FringeRecords const& records, ShelfEdgeSettings const& s) {
  Layout const layout = layout_of(records, s);
  std::vector<StrideData> data;
  for (std::size_t i = 0; i < layout.count; ++i) data.push_back(stride_data(records, s, layout, i));
  if (!s.ratio.free()) return at_ratio(data, s, s.ratio.low).fit;
  constexpr int places = 40;
  double const spacing = (s.ratio.high - s.ratio.low) / places;
  std::vector<AtRatio> all;
  for (int i = 0; i <= places; ++i) all.push_back(at_ratio(data, s, s.ratio.low + spacing * i));
  auto const best = std::max_element(all.begin(), all.end(),
                                     [](AtRatio const& a, AtRatio const& b) { return a.twice_log < b.twice_log; });
  bool const at_end = best == all.begin() || best == all.end() - 1;
  ShelfEdgeFit out = best->fit;
  out.ratio.at_end = at_end;
  out.ratio.sigma = spacing;
  if (at_end) return out;
  double const left = best->twice_log - best[-1].twice_log, right = best->twice_log - best[1].twice_log;
  double const curvature = (left + right) / (2 * spacing * spacing), top = (left - right) / (4 * curvature * spacing);
  out = at_ratio(data, s, best->fit.ratio.value + top).fit;
  out.ratio.sigma = std::max(1 / std::sqrt(curvature), spacing / 2);
  for (AtRatio const& a : all)  // other maxima that are as good
    if (best->twice_log - a.twice_log < 1)
      out.ratio.sigma = std::max(out.ratio.sigma, std::fabs(a.fit.ratio.value - out.ratio.value));
  // The factor follows the ratio; NaN where a neighbour shows no edge.
  double const slope = (best[1].fit.factor.value - best[-1].fit.factor.value) / (2 * spacing);
  if (std::isfinite(slope)) out.factor.sigma = std::hypot(out.factor.sigma, slope * out.ratio.sigma);
  return out;
}

}  // namespace straytrace
