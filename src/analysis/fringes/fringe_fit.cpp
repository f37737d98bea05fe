// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/fringe_fit.hpp"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>

#include "analysis/fringes/fringe_search.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "spectra/curve.hpp"
#include "spectra/fourier.hpp"
#include "spectra/series.hpp"

namespace straytrace::analysis {
namespace {

constexpr double margin = 1.1;  // of the fringe frequency in eq. 7.13

double furthest(SearchRange const& r) { return std::max(std::fabs(r.low), std::fabs(r.high)); }

double longest_delay(FringeFitSettings const& s) {
  double longest = s.clock;
  for (FringePath const& p : s.paths) longest = std::max(longest, furthest(p.delay));
  return longest;
}

SampleSpan overlap(FringeRecords const& r, double delay) {
  SampleSpan const span = covered(r, delay);
  if (span.to > span.from) return span;
  std::string spans = fmt::format("'{}' GPS {:.3f} to {:.3f}", r.target.name, r.target.start, r.target.end());
  for (TimeSeries const& x : r.witnesses) spans += fmt::format(", '{}' {:.3f} to {:.3f}", x.name, x.start, x.end());
  throw InputError(fmt::format("the records do not overlap: {}", spans), "give records of the same time");
}

void check_samples(TimeSeries const& x) {
  auto const bad = std::find_if(x.samples.begin(), x.samples.end(), [](double v) { return !std::isfinite(v); });
  if (bad != x.samples.end())
    throw InputError(
        fmt::format("'{}' is not a number at GPS {:.4f}", x.name, x.time(std::size_t(bad - x.samples.begin()))),
        "choose a span without gaps");
  auto const [low, high] = std::minmax_element(x.samples.begin(), x.samples.end());
  if (x.samples.empty() || *low == *high)
    throw InputError(fmt::format("'{}' is constant, so there is nothing to fit", x.name),
                     "check that the channel is connected");
}

void check(FringeRecords const& r, FringeFitSettings const& s) {
  if (r.witnesses.empty() || r.witnesses.size() > 2)
    throw InputError("a fit needs one witness of the motion, or two", "name them");
  double const most = r.target.rate / 2;
  if (!(s.low > 0 && s.high > s.low && s.high < most))
    throw InputError(fmt::format("the band {:g} to {:g} Hz is not inside 0 to {:g} Hz, half the sample rate of '{}'",
                                 s.low, s.high, most, r.target.name),
                     "choose a band inside");
  check_samples(r.target);
  for (TimeSeries const& x : r.witnesses) check_samples(x);
}

// The highest fringe frequency within the ranges; an error when the sample rate of the target is too low for it.
double highest_fringe(FringeRecords const& r, FringeFitSettings const& s) {
  double highest = 0;
  double const fastest = fastest_motion(r, furthest(s.ratio));
  for (FringePath const& p : s.paths) {
    double const f = 2 * furthest(p.multiplicity) * fastest / s.wavelength + furthest(p.drift) / (2 * pi);
    highest = std::max(highest, f);
    if (2 * margin * f >= r.target.rate)
      throw InputError(
          fmt::format("'{}' is sampled at {:g} Hz; fringes up to {:.4g} Hz ({} at multiplicity {:g}) need more than "
                      "{:.0f} Hz (eq. 7.13)",
                      r.target.name, r.target.rate, f, p.name, furthest(p.multiplicity), std::ceil(2 * margin * f)),
          "give a record of that rate, a witness without fast noise, or a smaller multiplicity");
  }
  return highest;
}

// The witnesses on the span, extended for interpolation and delays.
FringeRecords trimmed(FringeRecords const& r, SampleSpan span, double delay) {
  FringeRecords out;
  out.target = r.target;
  for (TimeSeries x : r.witnesses) {
    double const low = (r.target.time(span.from) - delay - x.start) * x.rate - 20;
    double const high = (r.target.time(span.to) + delay - x.start) * x.rate + 20;
    auto const first = std::size_t(std::max(0.0, std::floor(low)));
    auto const last = std::size_t(std::clamp(std::ceil(high), double(first) + 1, double(x.samples.size())));
    x.start = x.time(first);
    x.samples = {x.samples.begin() + std::ptrdiff_t(first), x.samples.begin() + std::ptrdiff_t(last)};
    out.witnesses.push_back(std::move(x));
  }
  return out;
}

FringeFrame frame_of(FringeRecords const& r, FringeFitSettings const& s, double middle) {
  FringeFrame frame{s.low, s.high, s.wavelength, middle, highest_fringe(r, s), longest_delay(s), {}};
  for (TimeSeries const& x : r.witnesses) {
    double sum = 0;
    for (double const v : x.samples) sum += v;
    frame.means.push_back(sum / double(x.samples.size()));
  }
  return frame;
}

void check_work(FringeStretch const& stretch, FringeFitSettings const& s, double& trials) {
  for (std::size_t p = 0; p < s.paths.size(); ++p) trials += search_grid(stretch, s, p, s.ratio.low).transforms();
  if (trials * double(stretch.model_samples()) > 1e10)  // about two minutes
    throw InputError(
        fmt::format("the search would take {:.3g} transforms of {} samples", trials, stretch.model_samples()),
        "narrow the ranges of multiplicity, drift and ratio, or give a shorter stretch");
}

// Reduction of chi^2 by one path, with the amplitudes of the others free.
double gain_of_path(FringeProblem const& problem, RefinedFit const& fit, Eigen::VectorXd const& target, std::size_t p) {
  FringePlace const others = [&] {
    FringePlace o = fit.place;
    o.shapes.erase(o.shapes.begin() + std::ptrdiff_t(p));
    return o;
  }();
  if (others.shapes.empty()) return target.squaredNorm() - fit.fit.chi2;
  FringeProblem rest = problem;
  rest.responses.erase(rest.responses.begin() + std::ptrdiff_t(p));
  return linear_fit(rest.columns(others), target).chi2 - fit.fit.chi2;
}

void report_significance(FringeFit& out, FringeProblem const& problem, RefinedFit const& fit) {
  Eigen::VectorXd const target = problem.features(problem.stretch.target());
  out.without = target.squaredNorm();
  out.with = fit.fit.chi2;
  out.degrees = double(problem.settings.method == FitMethod::time ? 0 : problem.stretch.degrees());
  if (problem.settings.method == FitMethod::time) {
    // Of pure noise of exactly this spectrum: the mask at the ends of the band and the missing tapers.
    double const middle = double(target.size()) / double(problem.stretch.model_samples());
    double const wide = problem.settings.high - problem.settings.low;
    out.degrees = 2 * problem.stretch.duration() * wide * (1 - 2 * 0.1 * (1 - 0.375)) * middle;
  }
  out.degrees -= double(out.names.size());
  out.ln_false_alarm = 0;
  for (std::size_t p = 0; p < out.paths.size(); ++p) {
    out.paths[p].gain = gain_of_path(problem, fit, target, p);
    out.paths[p].ln_false_alarm = ln_chance_of(out.paths[p].gain, range_lengths(problem, fit.place, p));
    out.ln_false_alarm = std::min(out.ln_false_alarm, out.paths[p].ln_false_alarm);
  }
}

// The fit again with a delay of the witness's clock.
struct Alternative {
  FringeFitSettings settings;
  RefinedFit fit;
  std::vector<double> psd;
  FringeFit report;
};

Alternative fitted(FringeProblem const& problem, FringeFitSettings settings) {
  Alternative out{std::move(settings), {}, problem.stretch.psd(problem.stretch.target()), {}};
  FringeProblem again{problem.stretch, out.settings, problem.responses, out.psd};
  again.responses.resize(out.settings.paths.size());
  out.fit = fit_all(again);
  report_parameters(out.report, again, out.fit);
  out.psd = again.psd;
  return out;
}

// The first path finds the delay, which all paths share.
Alternative with_delay(FringeProblem const& problem) {
  FringeFitSettings settings = problem.settings;
  SearchRange& delay = settings.paths[0].delay;
  delay = {delay.low - settings.clock, delay.high + settings.clock};
  settings.paths.resize(1);
  Alternative first = fitted(problem, settings);
  if (problem.settings.paths.size() == 1) return first;
  settings = problem.settings;
  Fitted const common = first.report.paths[0].delay;
  for (FringePath& p : settings.paths) p.delay = {common.value, common.value};
  Alternative all = fitted(problem, settings);
  for (FittedPath& p : all.report.paths) p.delay = common;
  return all;
}

// Whether the clock of the witness is right (docs/theory/fit.md, clocks): searches the delay within settings.clock of
// that of the fit. `found`: amplitudes of the fit, with their errors.
ClockCheck clock_check(FringeProblem const& problem, RefinedFit const& fit, FringeFit const& found) {
  Alternative const other = with_delay(problem);
  ClockCheck out{problem.settings.clock, other.report.paths[0].delay, 0, other.report.paths};
  // Both against one noise level: that of the fit with the delay.
  FringeProblem const same{problem.stretch, problem.settings, problem.responses, other.psd};
  out.gain = refine(same, fit.place).fit.chi2 - other.fit.fit.chi2;
  FringeFitSettings first = other.settings;
  first.paths[0].delay = {-out.range, out.range};
  SearchGrid const grid = search_grid(problem.stretch, first, 0, fit.place.ratio);
  double const places = grid.transforms() * double(grid.delay.size());
  out.better = out.gain / 2 - std::log(places) > -std::log(problem.settings.false_alarm);
  for (std::size_t p = 0; p < out.paths.size(); ++p)
    out.doubtful |= out.better && std::fabs(out.paths[p].amplitude.value - found.paths[p].amplitude.value) >
                                      found.paths[p].amplitude.sigma;
  return out;
}

}  // namespace

SampleSpan covered(FringeRecords const& r, double delay) {
  TimeSeries const& h = r.target;
  double from = h.start, to = h.end();
  for (TimeSeries const& x : r.witnesses) {
    double const reach = delay + (x.rate < h.rate || delay > 0 ? 16 / x.rate : 0);
    from = std::max(from, x.start + reach);
    to = std::min(to, x.end() - reach);
  }
  if (!(to > from)) return {};
  auto const first = std::size_t(std::ceil((from - h.start) * h.rate - 1e-3));
  return {first, std::min(h.samples.size(), std::size_t(std::floor((to - h.start) * h.rate + 1e-3)))};
}

FringeFit fit_fringes(FringeRecords const& given, FringeFitSettings const& settings) {
  check(given, settings);
  double const delay = longest_delay(settings);
  SampleSpan const span = overlap(given, delay);
  FringeRecords const records = trimmed(given, span, delay);
  auto const split = span.from + std::size_t(std::lround(settings.train * double(span.to - span.from)));
  FringeFit out;
  out.start = records.target.time(span.from);
  out.split = records.target.time(split);
  out.end = records.target.time(span.to);
  out.middle = 0.5 * (out.start + out.split);
  FringeFrame const frame = frame_of(records, settings, out.middle);
  out.means = frame.means;
  FringeStretch const stretch(records, span.from, split, frame);
  std::size_t const parameters = 2 * settings.paths.size() + free_parameters(settings, settings.paths.size()).size();
  if (stretch.degrees() < 4 * double(parameters))
    throw InputError(fmt::format("{:.0f} independent data for {} parameters", stretch.degrees(), parameters),
                     "give a longer stretch or a wider band, or fix some of them");
  check_work(stretch, settings, out.trials);
  FringeProblem problem{stretch, settings, {}, stretch.psd(stretch.target())};
  for (FringePath const& p : settings.paths) problem.responses.push_back(stretch.response(p.phase, p.amplitude));
  RefinedFit const fit = fit_all(problem);
  report_parameters(out, problem, fit);
  report_significance(out, problem, fit);
  double const fastest = fastest_motion(records, fit.place.ratio);
  for (FringeShape const& s : fit.place.shapes)
    out.highest_fringe = std::max(out.highest_fringe, 2 * std::fabs(s.multiplicity) * fastest / settings.wavelength);
  if (double(span.to - split) / records.target.rate * (settings.high - settings.low) > 10)
    out.test = out_of_sample(problem, fit, FringeStretch(records, split, span.to, frame));
  if (settings.clock > 0) out.clock = clock_check(problem, fit, out);
  out.verdict = verdict_of(out, settings.false_alarm);
  return out;
}

// The fitted noise as a series.

namespace {

using Field = std::vector<std::complex<double>>;

struct Span {
  double start = 0;  // GPS s
  std::size_t first = 0, count = 0;
};

Span span_of(FringeRecords const& r, FringeFit const& fit) {
  double delay = 0;
  for (FittedPath const& p : fit.paths) delay = std::max(delay, std::fabs(p.delay.value));
  SampleSpan const span = covered(r, delay);
  return {r.target.time(span.from), span.from, span.to - span.from};
}

// exp(i(phi + theta)) of one path, times sqrt(f_r).
void add_field(Field& field, FringeRecords const& r, FringeFit const& fit, FittedPath const& p, Span const& span,
               double wavelength) {
  std::vector<double> u(span.count, 0.0);
  for (std::size_t w = 0; w < r.witnesses.size(); ++w) {
    auto const x = interpolated(r.witnesses[w], span.start - p.delay.value, r.target.rate, span.count);
    for (std::size_t i = 0; i < span.count; ++i) u[i] += (w ? -fit.ratio.value : 1) * (x[i] - fit.means[w]);
  }
  for (std::size_t i = 0; i < span.count; ++i) {
    double const t = span.start - fit.middle + double(i) / r.target.rate;
    double const phase = p.phase.value + 4 * pi * p.multiplicity.value * u[i] / wavelength + p.drift.value * t;
    SinCos const turn = sincos_turn(phase / (2 * pi));
    field[i] += p.amplitude.value * std::complex<double>(turn.cos, turn.sin);
  }
}

double mask(double hz, double low, double high) {
  double const inside = std::min(hz - low, high - hz) / (0.05 * (high - low));
  return inside <= 0 ? 0 : inside >= 1 ? 1 : 0.5 - 0.5 * std::cos(pi * inside);
}

}  // namespace

FringeModel fringe_model(FringeRecords const& r, FringeFitSettings const& s, FringeFit const& fit) {
  Span const span = span_of(r, fit);
  // Room behind the end, so that the filter does not wrap into the beginning.
  std::size_t const n = std::bit_ceil(span.count + std::size_t(2 * r.target.rate));
  Field sum(n), lines, series;
  Fourier fourier;
  for (std::size_t p = 0; p < fit.paths.size(); ++p) {
    Field field(n);
    add_field(field, r, fit, fit.paths[p], span, s.wavelength);
    fourier.forward(field, lines);
    for (std::size_t k = 1; k < n / 2; ++k) {
      double const hz = double(k) * r.target.rate / double(n), m = mask(hz, s.low, s.high);
      if (m == 0) continue;
      std::complex<double> const above = lines[k], below = std::conj(lines[n - k]);
      std::complex<double> const real = 0.5 * (above + below),
                                 imaginary = std::complex<double>(0, -0.5) * (above - below);
      FringePath const& path = s.paths[p];
      std::complex<double> const phase = path.phase ? std::conj(path.phase(hz)) : 1;
      std::complex<double> const amplitude = path.amplitude ? std::conj(path.amplitude(hz)) : 0;
      sum[k] += m * (phase * imaginary + amplitude * real);
    }
  }
  fourier.inverse(sum, series);
  FringeModel out{span.first, {}};
  for (std::size_t i = 0; i < span.count; ++i) out.values.push_back(2 * series[i].real());
  return out;
}

// Test of the fit on the unused part of the record, and the outcome (docs/theory/fit.md).

namespace {

constexpr double sure = 3;  // standard deviations by which a correct fit would be confirmed

std::vector<double> psd_at(FringeProblem const& fitted, std::vector<double> const& hz) {
  std::vector<double> const& known = fitted.stretch.hz();
  std::vector<double> out;
  for (double const f : hz) {
    auto const next = std::lower_bound(known.begin(), known.end(), f) - known.begin();
    out.push_back(fitted.psd[std::size_t(std::min(next, std::ptrdiff_t(known.size()) - 1))]);
  }
  return out;
}

// Columns B with B B^T = J C J^T: effect of the errors of the fit on the model in the rest.
Eigen::MatrixXd spread_of_model(Eigen::MatrixXd const& slope, Eigen::MatrixXd const& covariance) {
  Eigen::VectorXd const sigma = covariance.diagonal().cwiseSqrt();
  Eigen::MatrixXd const correlation =
      sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  return slope * sigma.asDiagonal() * Eigen::MatrixXd(correlation.llt().matrixL());
}

// ln of N(h; m, 1 + B B^T) over N(h; 0, 1), by the small matrix 1 + B^T B.
void weigh(OutOfSample& out, Eigen::VectorXd const& h, Eigen::VectorXd const& m, Eigen::MatrixXd const& b) {
  Eigen::MatrixXd const own = b.transpose() * b;
  Eigen::LLT<Eigen::MatrixXd> const llt(Eigen::MatrixXd::Identity(own.rows(), own.cols()) + own);
  double const ln_det = 2 * llt.matrixLLT().diagonal().array().log().sum();
  Eigen::VectorXd const rest = b.transpose() * (h - m);
  double const square = m.squaredNorm(), of_fit = (b.transpose() * m).squaredNorm();
  out.ln_odds = (h.squaredNorm() - (h - m).squaredNorm() + rest.dot(llt.solve(rest)) - ln_det) / 2;
  out.ln_odds_expected = {(square + own.trace() - ln_det) / 2, std::sqrt(square + of_fit)};
  out.scale = {h.dot(m) / square, std::sqrt(square + of_fit) / square};
}

bool ends_a_range(FringeFit const& fit) {
  return fit.ratio.at_end || std::any_of(fit.paths.begin(), fit.paths.end(), [](FittedPath const& p) {
           return p.multiplicity.at_end || p.delay.at_end || p.drift.at_end;
         });
}

}  // namespace

OutOfSample out_of_sample(FringeProblem const& fitted, RefinedFit const& fit, FringeStretch const& rest) {
  FringeFitSettings settings = fitted.settings;
  settings.method = FitMethod::frequency;
  FringeProblem problem{rest, settings, {}, psd_at(fitted, rest.hz())};
  for (FringePath const& p : settings.paths) problem.responses.push_back(rest.response(p.phase, p.amplitude));
  Eigen::VectorXd const h = problem.features(rest.target());
  Eigen::VectorXd const m = problem.features(problem.model(fit.place, fit.fit.linear));
  OutOfSample out;
  out.seconds = rest.duration();
  out.without = h.squaredNorm();
  out.with = (h - m).squaredNorm();
  out.degrees = rest.degrees();
  weigh(out, h, m, spread_of_model(jacobian(problem, fit.place, fit.fit.linear), fit.covariance));
  out.reduction = {1 - out.with / out.without, 2 * m.norm() / out.without};
  return out;
}

FitOutcome verdict_of(FringeFit const& fit, double false_alarm) {
  if (fit.clock.doubtful) return FitOutcome::clock;
  if (fit.ln_false_alarm >= std::log(false_alarm)) return FitOutcome::none;
  if (ends_a_range(fit)) return FitOutcome::at_end;
  if (fit.test.seconds == 0) return FitOutcome::untested;
  double const needed = -std::log(false_alarm);
  if (fit.test.ln_odds >= needed) return FitOutcome::found;
  Fitted const& expected = fit.test.ln_odds_expected;
  return expected.value - sure * expected.sigma < needed ? FitOutcome::untested : FitOutcome::not_general;
}

TimeSeries as_strain(TimeSeries x) {
  auto const unit = parse_unit(x.unit);
  if (!unit || unit->dimension != dim::plain)
    throw InputError(fmt::format("--target: '{}' is in '{}', not a plain number", x.name, x.unit),
                     "give the unit with --target-unit");
  for (double& v : x.samples) v = to_si(v, *unit);
  x.unit = "1";
  return x;
}

namespace {

// Number of integrations to m or rad.
int integrations_of(TimeSeries const& x, bool& rotation, std::string const& option) {
  for (bool const angle : {false, true})
    if (auto const times = integrations_to(angle ? dim::angle : dim::length, x.unit)) {
      rotation = angle;
      return *times;
    }
  throw InputError(
      fmt::format("{}: '{}' is in '{}', which is not a unit of motion", option, x.name, x.unit),
      fmt::format("give m or rad, or one of them per s or s^2; set the unit with {}-unit, of counts the calibration: "
                  "what one is: \"2e-6 m/s^2\"",
                  option));
}

// Half the range of x_1 - ratio x_2.
double half_range(FringeRecords const& r, double ratio) {
  double low = infinity, high = -infinity;
  TimeSeries const& x = r.witnesses[0];
  bool const two = r.witnesses.size() > 1;
  std::vector<double> second;
  if (two) second = interpolated(r.witnesses[1], x.start, x.rate, x.samples.size());
  for (std::size_t i = 0; i < x.samples.size(); ++i) {
    double const u = x.samples[i] - (two ? ratio * second[i] : 0);
    low = std::min(low, u);
    high = std::max(high, u);
  }
  return (high - low) / 2;
}

double correlation_of(FringeFit const& fit, std::string const& a, std::string const& b) {
  auto const at = [&](std::string const& name) {
    return std::size_t(std::find(fit.names.begin(), fit.names.end(), name) - fit.names.begin());
  };
  std::size_t const n = fit.names.size();
  return at(a) < n && at(b) < n ? fit.correlation[at(a) * n + at(b)] : 0;
}

}  // namespace

void add_witness(FringeRecords& records, TimeSeries x, std::optional<double> corner, std::string const& option) {
  double unseen = 0;
  bool rotation = false;
  int const times = integrations_of(x, rotation, option);
  if (times == 0) {
    if (corner)
      throw InputError(fmt::format("--corner: '{}' is in {} and is not integrated", x.name, x.unit),
                       "remove the option");
    auto const unit = parse_unit(x.unit);
    for (double& v : x.samples) v = to_si(v, *unit);
  } else {
    if (!corner)
      throw InputError(
          fmt::format("{}: '{}' is in {} and needs a high pass for its integration", option, x.name, x.unit),
          "write --corner \"0.05 Hz\", below all motion that causes fringes");
    unseen = rms_below(x, times, *corner);
    x = settled(integrated(x, times, *corner), *corner);
  }
  x.unit = rotation ? "rad" : "m";
  records.witnesses.push_back(std::move(x));
  records.unseen.push_back(unseen);
}

bool is_rotation(FringeRecords const& r) { return r.witnesses.front().unit == "rad"; }
Dimension multiplicity_dimension(FringeRecords const& r) { return is_rotation(r) ? dim::length : dim::plain; }
std::string multiplicity_unit(FringeRecords const& r) { return is_rotation(r) ? "m" : ""; }

SearchRange usual_multiplicity(FringeRecords const& r, FringeFitSettings const& s) {
  double const single = 2 * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  double const most = 0.99 * r.target.rate / (2.2 * single);
  return {0.5, most > 1 ? std::min(6.0, most) : 6.0};
}

Fitted effective_peak(FringeRecords const& records, FringeFit const& fit, std::size_t path) {
  Fitted const w = fit.paths[path].multiplicity, ratio = fit.ratio;
  double const half = half_range(records, ratio.value);
  double const step = 1e-3 * std::max(1.0, std::fabs(ratio.value));
  double const of_ratio =
      (half_range(records, ratio.value + step) - half_range(records, ratio.value - step)) / (2 * step);
  double const from_w = half * w.sigma * (w.value < 0 ? -1 : 1),
               from_ratio = std::fabs(w.value) * of_ratio * ratio.sigma;
  double const both = 2 * correlation_of(fit, fmt::format("multiplicity {}", path + 1), "ratio") * from_w * from_ratio;
  return {std::fabs(w.value) * half, std::sqrt(std::max(0.0, from_w * from_w + from_ratio * from_ratio + both))};
}

double unseen_phase(FringeRecords const& records, FringeFit const& fit, double wavelength, std::size_t path) {
  double const first = records.unseen[0], second = records.unseen.size() > 1 ? fit.ratio.value * records.unseen[1] : 0;
  return 4 * pi / wavelength * std::fabs(fit.paths[path].multiplicity.value) * std::hypot(first, second);
}

}  // namespace straytrace::analysis
