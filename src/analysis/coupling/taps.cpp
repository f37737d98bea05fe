// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/taps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/coupling/coupling.hpp"
#include "analysis/coupling/lines.hpp"
#include "base/files/read_write.hpp"
#include "io/delimited_text.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {
namespace {

// Periodograms of one stretch.
struct Stretch {
  std::vector<double> hz;
  std::vector<std::vector<double>> segments;  // [segment][bin]
  std::vector<double> mean;
  double averages = 0;
};

Stretch stretch_of(TimeSeries const& series, GpsSpan span, WelchSettings const& s) {
  TimeSeries const part = cut(series, span);
  Segments segments(part.samples, part.rate, s);
  Stretch out{{}, {}, std::vector<double>(segments.lines()), segments.effective()};
  for (std::size_t k = 0; k < segments.lines(); ++k) out.hz.push_back(segments.hz(k));
  for (std::size_t i = 0; i < segments.count(); ++i) {
    Complexes const& lines = segments.transform(part.samples, i);
    std::vector<double> power;
    for (std::size_t k = 0; k < lines.size(); ++k) power.push_back(std::norm(lines[k]) * segments.density(k));
    for (std::size_t k = 0; k < power.size(); ++k) out.mean[k] += power[k] / double(segments.count());
    out.segments.push_back(std::move(power));
  }
  return out;
}

struct Visit {  // one stretch of taps
  TapPlace const* place;
  Stretch force, target;
  std::vector<Stretch> local;
};

struct Quiet {
  Stretch force, target;
  std::vector<Stretch> local;
};

// Logarithms of target over force at one bin: of the ASDs, and after subtraction of the quiet levels.
struct LogRatio {
  double value, excess, sigma;  // sigma: standard error of both from the spread of the segments
  double force;                 // logarithm of the force without its quiet level, as an ASD
};

LogRatio log_ratio(Visit const& v, Quiet const& q, std::size_t k) {
  double const n = double(v.force.segments.size());
  std::vector<double> left;
  double mean = 0;
  for (std::size_t i = 0; i + 1 < v.force.segments.size(); ++i) {  // neighbours share impulses
    auto const without = [&](Stretch const& s) { return n * s.mean[k] - s.segments[i][k] - s.segments[i + 1][k]; };
    left.push_back(std::log(without(v.target) / without(v.force)) / 2);
    mean += left.back();
  }
  double const groups = double(left.size());
  double sum = 0;
  for (double const l : left) sum += squared(l - mean / groups);
  double const y = v.target.mean[k] - q.target.mean[k], x = v.force.mean[k] - q.force.mean[k];
  return {std::log(v.target.mean[k] / v.force.mean[k]) / 2, std::log(y / x) / 2,
          std::sqrt((n - 2) / (2 * groups) * sum), std::log(x) / 2};
}

bool rose(Stretch const& loud, Stretch const& still, std::size_t k, double by) {
  return still.mean[k] > 0 && loud.mean[k] >= squared(std::max(by, 1.0)) * still.mean[k] &&
         loud.mean[k] > still.mean[k];
}

bool passes(Visit const& v, Quiet const& q, std::size_t k, TapThresholds const& t) {
  return rose(v.target, q.target, k, t.target) && rose(v.force, q.force, k, t.force) &&
         excess_significance({v.target.mean[k], v.target.averages}, {q.target.mean[k], q.target.averages}) >=
             t.significance;
}

void add_local(TapAnswer& a, Visit const& v, Quiet const& q, std::size_t k, std::vector<TimeSeries> const& names) {
  for (std::size_t i = 0; i < v.local.size(); ++i) {
    double const ratio = std::sqrt(v.local[i].mean[k] / q.local[i].mean[k]);
    if (!(ratio > a.local_ratio)) continue;
    a.local_ratio = ratio;
    a.local = names[i].name;
  }
}

struct Slope {
  double value = 0, sigma = 0;  // dy/dx; from the errors stated
};
// NaN or infinite when all x are equal.
Slope weighted_slope(std::span<double const> x, std::span<double const> y, std::span<double const> sigma) {
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double const w = 1 / (sigma[i] * sigma[i]);
    s += w;
    sx += w * x[i];
    sy += w * y[i];
    sxx += w * x[i] * x[i];
    sxy += w * x[i] * y[i];
  }
  double const d = s * sxx - sx * sx;
  return {(s * sxy - sx * sy) / d, std::sqrt(s / d)};
}

struct Answered {
  TapAnswer answer;
  double log_sigma = 0;  // of the coupling, without the error common to all places
};

Answered answer(std::vector<Visit const*> const& visits, Quiet const& q, std::size_t k, TapThresholds const& t,
                std::vector<TimeSeries> const& names) {
  Answered out;
  TapAnswer& a = out.answer;
  a.place = visits.front()->place->name;
  a.repeats = int(visits.size());
  std::vector<double> force, excess, ratio, sigma;
  for (Visit const* v : visits) {
    LogRatio const r = log_ratio(*v, q, k);
    force.push_back(r.force);
    excess.push_back(r.excess);
    ratio.push_back(r.value);
    sigma.push_back(std::max(r.sigma, 1e-12));
    double const target = std::sqrt(v->target.mean[k] / q.target.mean[k]);
    if (target > a.target_ratio) {
      a.target_ratio = target;
      a.force_ratio = std::sqrt(v->force.mean[k] / q.force.mean[k]);
      a.significance =
          excess_significance({v->target.mean[k], v->target.averages}, {q.target.mean[k], q.target.averages});
    }
    add_local(a, *v, q, k, names);
  }
  WeightedMean const coupling = weighted_mean(excess, sigma), plain = weighted_mean(ratio, sigma);
  double const quiet = std::sqrt(q.force.mean[k] / q.target.mean[k]);
  out.log_sigma = coupling.sigma;
  a.coupling = std::exp(coupling.value);
  a.coupling_sigma = a.coupling * coupling.sigma;
  a.ratio = std::exp(plain.value) * quiet;
  a.sigma = a.ratio * std::sqrt(squared(plain.sigma) + 0.25 / q.force.averages + 0.25 / q.target.averages);
  if (visits.size() > 1) {
    auto const [slope, slope_sigma] = weighted_slope(force, excess, sigma);
    a.slope = 1 + slope;
    a.slope_sigma = slope_sigma;
    a.not_linear = std::fabs(slope) > t.not_linear * slope_sigma;
  }
  return out;
}

// Of places without a response: the lowest limit of the visits whose force rose.
std::vector<TapLimit> limits_at(std::vector<Visit> const& visits, Quiet const& q, std::size_t k, TapThresholds const& t,
                                std::set<std::string> const& answered) {
  constexpr double confidence = 0.95;
  std::map<std::string, std::vector<Visit const*>> silent;
  for (Visit const& v : visits)
    if (!answered.contains(v.place->name) && rose(v.force, q.force, k, t.force)) silent[v.place->name].push_back(&v);
  std::vector<TapLimit> out;
  for (auto const& [place, its] : silent) {
    double lowest = infinity;
    for (Visit const* v : its)
      lowest = std::min(lowest, coupling_limit({v->force.mean[k], v->target.mean[k], 0, v->target.averages},
                                               {q.force.mean[k], q.target.mean[k], 0, q.target.averages},
                                               each_of(its.size(), confidence)));
    if (std::isfinite(lowest)) out.push_back({place, lowest});
  }
  return out;
}

// The largest ratio of the target over all visits that pass, per bin; 0: none does.
std::vector<double> strongest(std::vector<Visit> const& visits, Quiet const& q, TapThresholds const& t) {
  std::vector<double> best(q.target.mean.size());
  for (std::size_t k = 1; k < best.size(); ++k)
    for (Visit const& v : visits)
      if (passes(v, q, k, t)) best[k] = std::max(best[k], v.target.mean[k] / q.target.mean[k]);
  return best;
}

Quiet quiet_of(TapSeries const& s, GpsSpan span, WelchSettings const& w) {
  Quiet q{stretch_of(s.force, span, w), stretch_of(s.target, span, w), {}};
  for (TimeSeries const& l : s.local) q.local.push_back(stretch_of(l, span, w));
  return q;
}

std::vector<Visit> visits_of(TapSeries const& s, std::span<TapPlace const> places, WelchSettings const& w) {
  std::vector<Visit> out;
  std::vector<Problem> problems;
  for (TapPlace const& p : places) {
    GpsSpan const span{p.start, p.start + p.duration};
    double const segments =
        (p.duration * s.target.rate - double(w.segment)) / (double(w.segment) * (1 - w.overlap)) + 1;
    if (span.from < s.target.start || span.to > s.target.end() + 1e-6)
      problems.push_back(
          {p.at,
           fmt::format("'{}' from {} to {} is outside the data, which run from {} to {}", p.name, gps_text(span.from),
                       gps_text(span.to), gps_text(s.target.start), gps_text(s.target.end())),
           "correct its start and duration, or read data that contain it"});
    else if (segments < fewest_tap_segments)
      problems.push_back({p.at,
                          fmt::format("'{}' at {} lasts {} s, which is fewer than six segments", p.name,
                                      gps_text(p.start), p.duration),
                          "choose a shorter --segment"});
    else {
      out.push_back({&p, stretch_of(s.force, span, w), stretch_of(s.target, span, w), {}});
      for (TimeSeries const& l : s.local) out.back().local.push_back(stretch_of(l, span, w));
    }
  }
  if (!problems.empty()) throw errors_in(places.front().file, std::move(problems));
  return out;
}

}  // namespace

std::vector<TapPeak> tap_peaks(TapSeries const& s, std::span<TapPlace const> places, GpsSpan quiet_span,
                               WelchSettings const& w, TapThresholds const& t) {
  std::vector<Visit> const visits = visits_of(s, places, w);
  Quiet const quiet = quiet_of(s, quiet_span, w);
  std::vector<double> const best = strongest(visits, quiet, t);
  std::vector<TapPeak> peaks;
  for (std::size_t k = 2; k + 2 < best.size(); ++k) {
    if (best[k] == 0 || best[k] < std::max(best[k - 1], best[k - 2]) || best[k] <= std::max(best[k + 1], best[k + 2]))
      continue;
    std::map<std::string, std::vector<Visit const*>> by_place;
    for (Visit const& v : visits)
      if (passes(v, quiet, k, t)) by_place[v.place->name].push_back(&v);
    std::vector<Answered> all;
    for (auto const& [name, its] : by_place) all.push_back(answer(its, quiet, k, t, s.local));
    std::stable_sort(all.begin(), all.end(),
                     [](Answered const& a, Answered const& b) { return a.answer.ratio > b.answer.ratio; });
    TapPeak peak;
    peak.hz = quiet.target.hz[k];
    std::set<std::string> answered;
    for (Answered const& a : all) answered.insert(a.answer.place);
    peak.limits = limits_at(visits, quiet, k, t, answered);
    for (Answered& a : all) peak.places.push_back(std::move(a.answer));
    if (all.size() > 1)
      peak.lead =
          std::log(peak.places[0].coupling / peak.places[1].coupling) / std::hypot(all[0].log_sigma, all[1].log_sigma);
    peaks.push_back(std::move(peak));
  }
  return peaks;
}

namespace {

class ListReader {
 public:
  std::vector<TapPlace> read(std::string_view csv, std::string const& file) {
    static constexpr std::string_view numeric[] = {"start", "duration"};
    table_ = parse_csv_table(csv, Comments::whole_lines, "place,start,duration", problems_, numeric);
    if (!table_.columns.empty() && header_fits())
      for (CsvTable::Row const& row : table_.rows) take(row, file);
    if (problems_.empty()) return std::move(places_);
    std::ranges::stable_sort(problems_, {}, [](Problem const& p) { return p.place.line; });
    throw errors_in(file, std::move(problems_));
  }

 private:
  bool header_fits() {
    bool sound = true;
    for (char const* name : {"place", "start", "duration"}) {
      if (table_.find(name) >= 0) continue;
      sound = false;
      complain(problems_, {"", table_.columns[0].line, 1}, fmt::format("no column '{}'", name),
               "the first line names the columns: place, start, duration, strength");
    }
    for (CsvTable::Column const& c : table_.columns) {
      if (c.unit.dimension == dim::plain || c.unit.dimension == dim::time) continue;
      sound = false;
      complain(problems_, {c.name, c.line, c.at}, fmt::format("column '{}' is in {}, not in s", c.name, c.written_unit),
               "start is GPS time in s, duration in s");
    }
    return sound;
  }

  TextCell cell(CsvTable::Row const& row, std::string_view name) const {
    int const at = table_.find(name);
    return at < 0 ? TextCell() : row.cells[std::size_t(at)];
  }
  double number(CsvTable::Row const& row, std::string_view name) const {
    return row.values[std::size_t(table_.find(name))];
  }

  void take(CsvTable::Row const& row, std::string const& file) {
    TextCell const start = cell(row, "start");
    TapPlace p{std::string(cell(row, "place").text),
               number(row, "start"),
               number(row, "duration"),
               std::string(cell(row, "strength").text),
               file,
               {0, start.line, start.column}};
    if (p.name.empty()) complain(problems_, cell(row, "place"), "a place without a name", "write it in column 'place'");
    if (p.duration <= 0)
      complain(problems_, cell(row, "duration"), fmt::format("a duration of {} s", p.duration),
               "taps of about 20 s are usual");
    places_.push_back(std::move(p));
  }

  CsvTable table_;
  std::vector<Problem> problems_;
  std::vector<TapPlace> places_;
};

}  // namespace

std::vector<TapPlace> parse_tap_list(std::string_view csv, std::string const& file) {
  return ListReader().read(csv, file);
}

}  // namespace straytrace::analysis
