// SPDX-License-Identifier: BSD-3-Clause
#include "commission/fringe_fit.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/message.hpp"
#include "commission/fringe_clock.hpp"
#include "commission/fringe_search.hpp"

namespace straytrace {
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
  throw InputError(fmt::format("error: the records do not overlap: {}\n  give records of the same time", spans));
}

void check_samples(TimeSeries const& x) {
  auto const bad = std::find_if(x.samples.begin(), x.samples.end(), [](double v) { return !std::isfinite(v); });
  if (bad != x.samples.end())
    throw InputError(fmt::format("error: '{}' has no number at GPS {:.4f}\n  choose a span without gaps", x.name,
                                 x.time(std::size_t(bad - x.samples.begin()))));
  auto const [low, high] = std::minmax_element(x.samples.begin(), x.samples.end());
  if (x.samples.empty() || *low == *high)
    throw InputError(fmt::format(
        "error: '{}' has one value all the time, so nothing can be fitted\n  give a record that is alive", x.name));
}

void check(FringeRecords const& r, FringeFitSettings const& s) {
  if (r.witnesses.empty() || r.witnesses.size() > 2)
    throw InputError("error: a fit needs one witness of the motion, or two\n  name them");
  double const most = r.target.rate / 2;
  if (!(s.low > 0 && s.high > s.low && s.high < most))
    throw InputError(
        fmt::format("error: the band {:g} to {:g} Hz is not inside 0 to {:g} Hz, half the sample rate of "
                    "'{}'\n  choose a band inside",
                    s.low, s.high, most, r.target.name));
  check_samples(r.target);
  for (TimeSeries const& x : r.witnesses) check_samples(x);
}

// The highest frequency that any shape in the ranges makes; refused where the target cannot hold it.
double highest_fringe(FringeRecords const& r, FringeFitSettings const& s) {
  double highest = 0;
  double const fastest = fastest_motion(r, furthest(s.ratio));
  for (FringePath const& p : s.paths) {
    double const f = 2 * furthest(p.multiplicity) * fastest / s.wavelength + furthest(p.drift) / (2 * pi);
    highest = std::max(highest, f);
    if (2 * margin * f >= r.target.rate)
      throw InputError(fmt::format(
          "error: '{}' is sampled at {:g} Hz; fringes up to {:.4g} Hz ({} at multiplicity {:g}) need more than {:.0f} "
          "Hz (eq. 7.13)\n  give a record of that rate, a witness without fast noise, or a smaller multiplicity",
          r.target.name, r.target.rate, f, p.name, furthest(p.multiplicity), std::ceil(2 * margin * f)));
  }
  return highest;
}

// The witnesses on the span, with what interpolation and delays reach for.
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
    throw InputError(fmt::format(
        "error: the search would take {:.3g} transforms of {} samples\n  narrow the ranges of multiplicity, drift and "
        "ratio, or give a shorter stretch",
        trials, stretch.model_samples()));
}

// What one path takes from chi^2, the others adjusting their amplitudes.
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
    // Of pure noise of the very spectrum: the mask at the ends of the band and the missing tapers.
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
    throw InputError(
        fmt::format("error: {:.0f} independent data for {} parameters\n  give a longer stretch or a wider "
                    "band, or fix some of them",
                    stretch.degrees(), parameters));
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

}  // namespace straytrace
