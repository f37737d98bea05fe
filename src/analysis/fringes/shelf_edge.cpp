// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/shelf_edge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/linear_algebra.hpp"
#include "base/math/rng.hpp"
#include "spectra/curve.hpp"
#include "spectra/fourier.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {
namespace {

struct Layout {
  std::size_t factor = 1, segment = 0, stride = 0, from = 0, count = 0;  // samples of the target, strides
};

ShelfProfile profile_of(ShelfStride const& d, ShelfEdgeSettings const& s, double ratio) {
  std::vector<double> const u = motion_of(d, ratio);
  double const edge = 2 * fastest(u, d.rate) / s.wavelength;
  // Only edges inside the band are visible.
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
    throw InputError(
        fmt::format("segments of {:g} s are too long for strides of {:g} s, or too short for a band of {:g} Hz",
                    s.segment, s.stride, s.high - s.low),
        "a stride needs at least four segments, and the band a dozen lines of 1/segment");
  double const fringe =
      2 * s.factor.high * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  // Shapes whose edge lies beyond the band are not needed.
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

// Offsets subtracted, errors by repetition.
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
  // Repetition scales the likelihood's error of the ratio as it scales that of the factor.
  double const scale = out.used > 0 ? out.factor.sigma / out.of_likelihood.sigma : 1;
  out.ratio.sigma = std::max(scale / std::sqrt(curvature), spacing / 2);
  for (AtRatio const& a : all)  // other maxima that are equally good
    if (best->twice_log - a.twice_log < std::max(1.0, scale * scale))
      out.ratio.sigma = std::max(out.ratio.sigma, std::fabs(a.fit.ratio.value - out.ratio.value));
  // The factor follows the ratio; NaN where a neighbour shows no edge.
  double const slope = (best[1].fit.factor.value - best[-1].fit.factor.value) / (2 * spacing);
  if (std::isfinite(slope)) out.factor.sigma = std::hypot(out.factor.sigma, slope * out.ratio.sigma);
  return out;
}

namespace {

constexpr double blur = 0.01;            // of the factor, to either side
constexpr double turn_of_a_step = 1;     // rad, of the largest phase between two shapes that are averaged
constexpr double settled_change = 3e-3;  // of 2 ln L
constexpr std::array floor_powers{0, -2, -4};
constexpr std::array<double, 5> choose{1, 4, 6, 4, 1};  // Bernstein polynomials of ln(f) across the band

Eigen::VectorXd one_shape(ShelfStride const& d, std::vector<double> const& u, double factor, double wavelength) {
  thread_local Fourier fourier;
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
    fourier.forward(part, lines);
    for (Eigen::Index k = 0; k < sum.size(); ++k)
      sum[k] += std::norm(lines[d.first + std::size_t(k)]) + std::norm(lines[n - d.first - std::size_t(k)]);
  }
  return sum / (2 * d.rate * 0.375 * double(n) * segments);
}

// x >= 0 of least x'Ax/2 - b'x (Lawson and Hanson 1974); A has a unit diagonal.
Eigen::VectorXd least_squares_not_negative(Eigen::MatrixXd const& a, Eigen::VectorXd const& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  std::vector<Eigen::Index> in;
  for (Eigen::Index round = 0; round < 3 * b.size(); ++round) {
    Eigen::VectorXd slope = b - a * x;
    for (Eigen::Index const i : in) slope[i] = 0;
    Eigen::Index steepest = 0;
    if (!(slope.maxCoeff(&steepest) > 1e-9 * b.maxCoeff())) break;
    in.push_back(steepest);
    for (;;) {
      Eigen::VectorXd const some = solve_symmetric(a(in, in), b(in));
      if (some.minCoeff() > 0) {
        x.setZero();
        x(in) = some;
        break;
      }
      double share = 1;
      for (std::size_t i = 0; i < in.size(); ++i)
        if (double const s = some[Eigen::Index(i)]; s <= 0) share = std::min(share, x[in[i]] / (x[in[i]] - s));
      std::vector<Eigen::Index> left;
      for (std::size_t i = 0; i < in.size(); ++i) {
        double& v = x[in[i]];
        v += share * (some[Eigen::Index(i)] - v);
        if (v > 1e-12)
          left.push_back(in[i]);
        else
          v = 0;
      }
      if (left.empty()) return x;
      in = left;
    }
  }
  return x;
}

}  // namespace

std::vector<double> motion_of(ShelfStride const& d, double ratio) {
  std::vector<double> u = d.x;
  for (std::size_t i = 0; i < d.y.size(); ++i) u[i] -= ratio * d.y[i];
  return u;
}

double fastest(std::vector<double> const& u, double rate) {
  double v = 0;
  for (std::size_t i = 1; i < u.size(); ++i) v = std::max(v, std::fabs(u[i] - u[i - 1]) * rate);
  return v;
}

Eigen::MatrixXd shelf_shapes(ShelfStride const& d, std::vector<double> const& u, FactorGrid const& grid,
                             double wavelength) {
  auto const [low, high] = std::minmax_element(u.begin(), u.end());
  double const swing = 4 * pi / wavelength * (*high - *low) * std::exp(grid.at(grid.count - 1));
  int const parts = std::max(2, int(std::ceil(grid.step * swing / turn_of_a_step)));
  int const reach = std::max(1, int(std::lround(blur / grid.step * parts)));
  std::vector<Eigen::VectorXd> fine;
  for (int i = -reach; i <= (grid.count - 1) * parts + reach; ++i)
    fine.push_back(one_shape(d, u, std::exp(grid.at(double(i) / parts)), wavelength));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(Eigen::Index(d.hz.size()), grid.count);
  for (int i = 0; i < grid.count; ++i)
    for (int j = -reach; j <= reach; ++j) out.col(i) += fine[std::size_t(i * parts + j + reach)] / (2 * reach + 1);
  return out;
}

ShelfSpectrum::ShelfSpectrum(ShelfStride const& d)
    : hz_(Eigen::Map<Eigen::VectorXd const>(d.hz.data(), Eigen::Index(d.hz.size()))),
      middle_(std::sqrt(d.hz.front() * d.hz.back())),
      weight_(d.weight),
      floors_(hz_.size(), Eigen::Index(floor_powers.size())),
      responses_(hz_.size(), Eigen::Index(choose.size())) {
  for (Eigen::Index k = 0; k < hz_.size(); ++k) {
    floors_.row(k) = floor_terms(hz_[k]);
    responses_.row(k) = response_terms(hz_[k]);
  }
}

Eigen::RowVectorXd ShelfSpectrum::floor_terms(double hz) const {
  Eigen::RowVectorXd out(floor_powers.size());
  for (std::size_t i = 0; i < floor_powers.size(); ++i)
    out[Eigen::Index(i)] = std::pow(std::max(hz, hz_[0]) / middle_, floor_powers[i]);
  return out;
}

Eigen::RowVectorXd ShelfSpectrum::response_terms(double hz) const {
  double const last = hz_[hz_.size() - 1], x = log_share(std::clamp(hz, hz_[0], last), hz_[0], last);
  auto const degree = int(choose.size()) - 1;
  Eigen::RowVectorXd out(choose.size());
  for (int i = 0; i <= degree; ++i) out[i] = choose[std::size_t(i)] * std::pow(x, i) * std::pow(1 - x, degree - i);
  return out;
}

ShelfSpectrum::Best ShelfSpectrum::best(Eigen::Ref<Eigen::VectorXd const> const& psd, Eigen::VectorXd const& shape,
                                        Eigen::VectorXd model) const {
  Eigen::MatrixXd columns(psd.size(), floors_.cols() + (shape.size() > 0 ? responses_.cols() : 0));
  columns.leftCols(floors_.cols()) = floors_;
  if (shape.size() > 0) columns.rightCols(responses_.cols()) = shape.asDiagonal() * responses_;
  Best out{-infinity, {}, {}};
  if (model.size() == 0) model = Eigen::VectorXd::Constant(psd.size(), psd.mean());
  for (int round = 0; round < 30; ++round) {
    Eigen::MatrixXd const weighted = model.cwiseInverse().asDiagonal() * columns;
    Eigen::VectorXd const scale = weighted.colwise().norm().cwiseInverse();
    Eigen::MatrixXd const unit = weighted * scale.asDiagonal();
    Eigen::VectorXd const share = scale.cwiseProduct(
        least_squares_not_negative(unit.transpose() * unit, unit.transpose() * psd.cwiseQuotient(model)));
    model = (columns * share).cwiseMax(1e-9 * psd.mean());
    double const twice_log = -2 * weight_ * (model.array().log() + psd.array() / model.array()).sum();
    bool const settled = std::fabs(twice_log - out.twice_log) < settled_change;
    if (round == 0 || twice_log > out.twice_log) out = {twice_log, share, model};
    if (settled) break;
  }
  return out;
}

double ShelfSpectrum::floor(Best const& b, double hz) const {
  return floor_terms(hz).dot(b.share.head(floors_.cols()));
}

double ShelfSpectrum::response(Best const& b, double hz) const {
  return response_terms(hz).dot(b.share.tail(responses_.cols()));
}

namespace {

constexpr int repetitions = 64;
constexpr double spread = 0.01;  // of the true factor, to either side

// A complex number of unit mean square.
std::complex<double> normal_line(Rng& rng) {
  SinCos const turn = sincos_turn(rng.uniform());
  return std::sqrt(-std::log(rng.uniform())) * std::complex<double>(turn.cos, turn.sin);
}

// PSD of a simulated stride with the fitted floor and shelf, at another factor and static phase.
Eigen::VectorXd made_again(FoundEdge const& e, std::vector<double> const& u, double factor, double phase, Rng noise,
                           double wavelength) {
  ShelfStride const& d = *e.stride;
  ShelfSpectrum const spectrum(d);
  thread_local Fourier fourier;
  std::size_t const n = u.size();
  std::vector<std::complex<double>> lines, series(n);
  for (std::size_t i = 0; i < n; ++i) series[i] = sincos_turn(phase + 2 * factor * u[i] / wavelength).sin;
  fourier.forward(series, lines);
  lines[0] = 0;
  for (std::size_t k = 1; 2 * k <= n; ++k) {
    double const hz = double(k) * d.rate / double(n);
    lines[k] = std::sqrt(spectrum.response(e.best, hz)) * lines[k] +
               std::sqrt(spectrum.floor(e.best, hz) * d.rate * double(n) / 2) * normal_line(noise);
    lines[n - k] = std::conj(lines[k]);
  }
  fourier.inverse(lines, series);
  std::vector<double> real(n);
  for (std::size_t i = 0; i < n; ++i) real[i] = series[i].real();
  WelchSpectrum const w = welch(real, d.rate, {d.segment});
  return Eigen::Map<Eigen::VectorXd const>(w.psd.data() + d.first, Eigen::Index(d.hz.size()));
}

struct Local {
  std::vector<double> motion;
  FactorGrid grid;
  Eigen::MatrixXd shapes;
};

Local local_of(FoundEdge const& e, double ratio, double wavelength) {
  double const reach = spread + std::max(0.03, 8 * e.top.sigma);
  int const half = int(std::ceil(reach / factor_step));
  Local out{motion_of(*e.stride, ratio), {e.top.log_factor - half * factor_step, factor_step, 2 * half + 1}, {}};
  out.shapes = shelf_shapes(*e.stride, out.motion, out.grid, wavelength);
  return out;
}

double mean_of(Eigen::ArrayXd const& v) { return v.mean(); }
double deviation_of(Eigen::ArrayXd const& v) {
  return std::sqrt((v - v.mean()).square().sum() / double(v.size() - 1) * (1 + 1 / double(v.size())));
}

}  // namespace

std::size_t ShelfProfile::top() const {
  return std::size_t(std::max_element(twice_log.begin(), twice_log.end()) - twice_log.begin());
}

ProfileTop top_of(ShelfProfile const& p) {
  ProfileTop out;
  std::size_t const at = p.top(), last = p.twice_log.size() - 1;
  std::size_t low = at, high = at;
  while (low > 0 && p.twice_log[at] - p.twice_log[low] < 2) --low;
  while (high < last && p.twice_log[at] - p.twice_log[high] < 2) ++high;
  out.at_end = low == 0 || high == last;
  out.log_factor = p.grid.at(double(at));
  double const a = p.grid.step * (double(low) - double(at)), b = p.grid.step * (double(high) - double(at));
  double const fall_a = p.twice_log[at] - p.twice_log[low], fall_b = p.twice_log[at] - p.twice_log[high];
  if (!(fall_a > 0 && fall_b > 0)) return out;
  // fall = c (x - top)^2 - c top^2
  double const curvature = (fall_a / a - fall_b / b) / (a - b), top = (curvature * b - fall_b / b) / (2 * curvature);
  out.log_factor += std::clamp(top, a, b);
  out.sigma = 1 / std::sqrt(curvature);
  return out;
}

ShelfProfile profile_on(ShelfStride const& d, Eigen::Ref<Eigen::VectorXd const> const& psd,
                        Eigen::MatrixXd const& shapes, FactorGrid const& grid) {
  ShelfSpectrum const spectrum(d);
  ShelfProfile out{grid, {}, spectrum.best(psd, {}).twice_log, {-infinity, {}, {}}};
  ShelfSpectrum::Best best;
  for (int i = 0; i < grid.count; ++i) {
    best = spectrum.best(psd, shapes.col(i), best.model);
    out.twice_log.push_back(best.twice_log);
    if (best.twice_log > out.best.twice_log) out.best = best;
  }
  return out;
}

RepeatedEdges repeated(std::vector<FoundEdge> const& edges, double ratio, double wavelength) {
  Eigen::ArrayXXd off(repetitions, Eigen::Index(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    Local const local = local_of(edges[i], ratio, wavelength);
    for (int r = 0; r < repetitions; ++r) {
      // Truth and static phase are those of the whole record; the noise is the stride's own.
      Rng common(1, std::uint64_t(r), 0, Stream::static_phase);
      double const truth = spread * (2 * common.uniform() - 1), phase = common.uniform();
      Eigen::VectorXd const psd =
          made_again(edges[i], local.motion, std::exp(edges[i].top.log_factor + truth), phase,
                     Rng(1, std::uint64_t(r), std::uint32_t(i + 1), Stream::source), wavelength);
      ProfileTop const found = top_of(profile_on(*edges[i].stride, psd, local.shapes, local.grid));
      off(r, Eigen::Index(i)) = found.log_factor - edges[i].top.log_factor - truth;
    }
  }
  RepeatedEdges out;
  Eigen::VectorXd weight(off.cols());
  for (Eigen::Index i = 0; i < off.cols(); ++i) {
    out.offset.push_back(mean_of(off.col(i)));
    out.sigma.push_back(deviation_of(off.col(i)));
    weight[i] = 1 / (out.sigma.back() * out.sigma.back());
  }
  weight /= weight.sum();
  Eigen::ArrayXd const mean = (off.matrix() * weight).array();
  out.mean_offset = mean_of(mean);
  out.mean_sigma = deviation_of(mean);
  for (std::size_t i = 0; i < edges.size(); ++i) out.mean += weight[Eigen::Index(i)] * edges[i].top.log_factor;
  return out;
}

}  // namespace straytrace::analysis
