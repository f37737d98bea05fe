// SPDX-License-Identifier: BSD-3-Clause
#include "cli/time/time_results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/words.hpp"
#include "cli/data_options.hpp"
#include "motion/axis_motion.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::cli {
namespace {

constexpr double level_hz[] = {10, 30, 100}, delay_hz = 100;
constexpr double level_width = 0.1;  // of the frequency, on both sides

// Mean PSD of the chosen routes between two frequencies, by the spectra of the motion. Bands wider than a bin take the
// power of the bins; narrower ones a power law between their centres, level in the outer halves of the band.
class ExactSpectrum {
 public:
  explicit ExactSpectrum(TimeInputs const& in) : grid_(in.exact.grid) {
    std::vector<double> hz = {grid_.edges.front()}, psd;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      hz.push_back(grid_.centre(i));
      psd.push_back(0);
      for (std::uint32_t r : in.routes) psd.back() += in.exact.routes[r].psd(i);
    }
    bins_ = psd;
    hz.push_back(grid_.edges.back());
    psd.push_back(psd.back());
    psd.insert(psd.begin(), psd.front());
    between_ = Spectrum(std::move(hz), std::move(psd));
  }
  double mean(double low, double high) const {  // not a number outside of the band of the noise
    if (low < grid_.edges.front() || high > grid_.edges.back()) return not_a_number;
    double power = 0, widest = 0;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      double const width = std::min(high, grid_.edges[i + 1]) - std::max(low, grid_.edges[i]);
      if (width <= 0) continue;
      power += width * bins_[i];
      widest = std::max(widest, grid_.edges[i + 1] - grid_.edges[i]);
    }
    return (high - low < widest ? between_.power(low, high) : power) / (high - low);
  }

 private:
  FrequencyGrid grid_;
  std::vector<double> bins_;
  Spectrum between_;
};

double percentile(std::vector<double> sorted, double below) {
  if (sorted.size() < 5) return not_a_number;
  double const place = below * double(sorted.size() - 1);
  auto const i = std::min(std::size_t(place), sorted.size() - 2);
  return std::sqrt(sorted[i] + (place - double(i)) * (sorted[i + 1] - sorted[i]));
}

// Standard error of the mean: scatter of the realisations, or of the segments of the only one.
double relative_error(std::vector<double> const& values, double mean, WelchSpectrum const& w, std::size_t lines) {
  if (values.size() < 2) return 1 / std::sqrt(w.effective_averages * std::max(1.0, double(lines) / 1.5));
  double square = 0;
  for (double v : values) square += (v - mean) * (v - mean);
  return std::sqrt(square / double(values.size() * (values.size() - 1))) / mean;
}

BandLevel level(ExactSpectrum const& exact, Realisations const& all, std::size_t from, std::size_t to) {
  BandLevel b;
  double const half = all.hz()[1] / 2;
  b.low = all.hz()[from] - half;
  b.high = all.hz()[to] + half;
  b.hz = (b.low + b.high) / 2;
  std::vector<double> values = all.band(from, to);
  double mean = 0;
  for (double v : values) mean += v / double(values.size());
  b.asd = std::sqrt(mean);
  b.sigma = mean > 0 ? b.asd * relative_error(values, mean, all.last(), to - from + 1) / 2 : 0;
  std::sort(values.begin(), values.end());
  b.below = percentile(values, 0.05);
  b.median = percentile(values, 0.5);
  b.above = percentile(values, 0.95);
  b.exact = std::sqrt(exact.mean(b.low, b.high));
  return b;
}

BandLevel nothing(double hz) {
  return {hz, hz, hz, not_a_number, not_a_number, not_a_number, not_a_number, not_a_number, not_a_number};
}

// Second-order effects (eq. 2.6) neglected for this route if the largest translation of a body on each path were
// transverse to its mean leg; mean over the paths by power.
double second_order_of(TimeInputs const& in, StrayLight const& light) {
  CouplingClass const& c = in.coupling().classes[light.moving.route];
  double const legs = c.steps.size() > 2 ? double(c.steps.size() - 1) : 1;
  std::map<std::uint32_t, double> largest;  // m, by body
  for (MovingCoordinate const& m : light.motion.coordinates)
    for (double x : m.position)
      if (!is_rotation(m.axis)) largest[m.body.value] = std::max(largest[m.body.value], std::fabs(x));
  double phase = 0, power = 0;
  for (PathRecord const& record : c.records) {
    if (!(record.path_length > 0)) continue;
    double motion = 0;
    for (PhaseSensitivity const& phase_sensitivity : record.phase_sensitivities)
      if (auto const at = largest.find(phase_sensitivity.body.value); at != largest.end())
        motion = std::max(motion, at->second);
    phase += record.weight * second_order_phase(motion, record.path_length / legs, in.coupling().wavelength);
    power += record.weight;
  }
  return power > 0 ? phase / power : 0;
}

// Uncertainty of h at 100 Hz by the delays, relative to the noise of one body. `retarded`: half of the path is the
// mean delay of a body on a path and its reverse, of others it may be the whole or nothing
// (docs/theory/time_domain.md).
double delay_error_of(TimeInputs const& in, bool retarded) {
  double largest = 0;
  for (std::uint32_t const r : in.routes) {
    CouplingClass const& c = in.coupling().classes[r];
    bool const with_reverse = c.kind == ClassKind::ghost || c.reverse > 1;
    for (PathRecord const& record : c.records) {
      double const half = pi * delay_cycles(delay_hz, std::max(0.0, record.path_length));
      largest = std::max(largest, !retarded ? 2 * half : with_reverse ? half * half : half);
    }
  }
  return largest;
}

std::string level_text(BandLevel const& b, std::size_t realisations) {
  if (!std::isfinite(b.asd)) return fmt::format("h({:g} Hz): outside the band of the run or of the record", b.hz);
  std::string text = fmt::format("h({:g} Hz) = {} /sqrt(Hz)", b.hz, with_error(b.asd, b.sigma));
  if (std::isfinite(b.below))
    text += fmt::format(", {:.3g} to {:.3g} in 90 % of {} realisations", b.below, b.above, realisations);
  else if (realisations == 1)
    text += " in this realisation";
  return text + (std::isfinite(b.exact) ? fmt::format("; mean by spectra {:.4g}", b.exact) : "");
}

}  // namespace

void Realisations::add(WelchSpectrum const& w) {
  psd_.push_back(w.psd);
  last_ = w;
}

std::vector<double> Realisations::band(std::size_t from, std::size_t to) const {
  std::vector<double> out;
  for (std::vector<double> const& psd : psd_) {
    double sum = 0;
    for (std::size_t k = from; k <= to; ++k) sum += psd[k];
    out.push_back(sum / double(to - from + 1));
  }
  return out;
}

ProjectResult project_result(TimeInputs const& in, TimeDomainSettings const& s, StrayLight const& light,
                             Realisations const& all) {
  ProjectResult r;
  r.times = light.times;
  r.seed = s.paths.seed;
  r.realisations = all.size();
  r.routes = in.routes.size();
  r.paths = light.paths;
  r.rms_phase = light.moving.rms_phase;
  r.rms_phase_route = light.moving_route;
  r.rule = light.rule;
  r.fastest = light.fastest;
  r.fastest_route = light.fastest_route;
  r.delay = light.longest_delay;
  r.second_order = second_order_of(in, light);
  r.retarded = s.delay == Delay::half_path;
  r.delay_error = delay_error_of(in, r.retarded);
  r.band_low = s.band_low;
  r.band_high = std::min(s.band_high, light.times.rate / 2);
  for (MotionInput const& input : in.model.motion.inputs) r.recorded |= input.recorded && !input.gains.empty();
  double const spacing = all.hz()[1];
  ExactSpectrum const exact(in);
  for (double hz : level_hz) {
    auto const from = std::size_t(std::ceil(hz * (1 - level_width) / spacing)),
               to = std::size_t(std::floor(hz * (1 + level_width) / spacing));
    bool const resolved = from >= 1 && to >= from && to < all.hz().size() && hz * (1 - level_width) > r.band_low &&
                          hz * (1 + level_width) < r.band_high;
    r.levels.push_back(resolved ? level(exact, all, from, to) : nothing(hz));
    r.levels.back().hz = hz;
  }
  for (std::size_t k = 1; k + 1 < all.hz().size(); ++k)
    if (all.hz()[k] > r.band_low && all.hz()[k] < r.band_high) r.spectrum.push_back(level(exact, all, k, k));
  WelchSpectrum const& w = all.last();
  r.welch =
      fmt::format("Welch: {:g} s, {}, ENBW {:.4g} Hz", 1 / spacing, counted(w.segments, "segment"), w.noise_bandwidth);
  return r;
}

std::string project_text(ProjectResult const& r) {
  std::string text =
      fmt::format("{:g} s at {:g} Hz from GPS {}, seed {}: {}, {}\n", r.times.duration(), r.times.rate,
                  gps_text(r.times.start), r.seed, counted(r.routes, "route"), counted(r.paths, "field"));
  text += fmt::format("phase: {:.4g} rad rms of {}, the route with the largest moving power\n", r.rms_phase,
                      r.rms_phase_route);
  text += fmt::format("fastest fringe {:.4g} Hz at GPS {:.2f}: {}\n", r.fastest.hz, r.fastest.time, r.fastest_route);
  text +=
      fmt::format("rate: above {:.5g} Hz needed (eq. 7.13: twice the fringe frequency plus a margin of {:.4g} Hz)\n",
                  r.rule.least(), r.rule.margin);
  text += fmt::format("neglected (eq. 2.6): second order about {:.2g} rad, tilt of the rays, ", r.second_order);
  if (r.retarded)
    text += fmt::format("deviations of the delays from half of a path: up to {:.1g} of h at 100 Hz\n", r.delay_error);
  else
    text += fmt::format("delays up to {:.2g} ms: up to {:.1g} of h at 100 Hz where bodies interfere\n", 1e3 * r.delay,
                        r.delay_error);
  text += fmt::format("h(t) covers {:g} to {:g} Hz; {}\n", r.band_low, r.band_high, r.welch);
  for (BandLevel const& b : r.levels) text += level_text(b, r.realisations) + "\n";
  if (r.recorded) text += "mean by spectra: as if the recorded motion were stationary and Gaussian\n";
  text.pop_back();
  return text;
}

std::string project_json(ProjectResult const& r) {
  auto const number = [](double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(); };
  nlohmann::ordered_json j = {{"gps", r.times.start},
                              {"duration", r.times.duration()},
                              {"rate", r.times.rate},
                              {"least_rate", r.rule.least()},
                              {"seed", r.seed},
                              {"realisations", r.realisations},
                              {"routes", r.routes},
                              {"fields", r.paths},
                              {"rms_phase", r.rms_phase},
                              {"rms_phase_route", r.rms_phase_route},
                              {"largest_fringe_frequency", r.fastest.hz},
                              {"largest_fringe_gps", r.fastest.time},
                              {"largest_fringe_route", r.fastest_route},
                              {"second_order_phase", r.second_order},
                              {"longest_delay", r.delay},
                              {"retarded", r.retarded},
                              {"delay_error_100Hz", r.delay_error},
                              {"band", {r.band_low, r.band_high}}};
  for (BandLevel const& b : r.levels)
    j["strain"].push_back({{"frequency", b.hz},
                           {"low", b.low},
                           {"high", b.high},
                           {"asd", number(b.asd)},
                           {"sigma", number(b.sigma)},
                           {"percentile_5", number(b.below)},
                           {"percentile_50", number(b.median)},
                           {"percentile_95", number(b.above)},
                           {"mean_by_spectra", number(b.exact)}});
  return j.dump(2);
}

namespace {

bool is_hdf5(std::string const& file) { return file.ends_with(".hdf5") || file.ends_with(".h5"); }

// Records of one clock: HDF5 with all, other formats as columns.
void write_series(std::string const& file, std::vector<TimeSeries> const& series, std::string const& title) {
  if (is_hdf5(file)) {
    write_file(file, series_hdf5(series));
    return;
  }
  CurveSheet sheet;
  sheet.title = title;
  sheet.x = {"gps", "s", {}};
  sheet.log_x = sheet.log_y = false;
  for (std::size_t i = 0; i < series.front().samples.size(); ++i) sheet.x.values.push_back(series.front().time(i));
  for (TimeSeries const& s : series) sheet.y.push_back({s.name, s.unit, s.samples});
  write_curves({file}, sheet);
}

// h, and the stray field at each port.
std::vector<TimeSeries> strain_channels(TimeInputs const& in, StrayLight const& light) {
  std::vector<TimeSeries> all = {strain_series(light)};
  for (PortField const& f : light.fields)
    for (bool const phase : {true, false}) {
      TimeSeries s{fmt::format("{} {}", in.coupling().ports[f.port.value], phase ? "Im s" : "Re s"),
                   "1",
                   light.times.start,
                   light.times.rate,
                   {}};
      for (std::complex<double> const x : f.field) s.samples.push_back(phase ? x.imag() : x.real());
      all.push_back(std::move(s));
    }
  return all;
}

std::vector<std::string> notes_of(ProjectResult const& r) {
  return {fmt::format("{:g} s at {:g} Hz from GPS {}, seed {}, {}, {}, {}", r.times.duration(), r.times.rate,
                      gps_text(r.times.start), r.seed, counted(r.realisations, "realisation"),
                      counted(r.routes, "route"), counted(r.paths, "field")),
          r.welch};
}

void write_spectrum(std::string const& file, ProjectResult const& r) {
  CurveSheet sheet;
  sheet.title = "strain of stray light from its time series";
  sheet.notes = notes_of(r);
  std::string const unit = "1/sqrt(Hz)";
  sheet.x = {"frequency", "Hz", {}};
  sheet.y = {{"h_mean", unit, {}}, {"sigma", unit, {}, "hidden"}, {"mean_by_spectra", unit, {}}};
  if (r.realisations >= 5)
    for (char const* name : {"percentile_5", "percentile_50", "percentile_95"})
      sheet.y.push_back({name, unit, {}, name[11] == '0' ? "line" : name[11] == '9' ? "band-high" : "band-low"});
  for (BandLevel const& b : r.spectrum) {
    sheet.x.values.push_back(b.hz);
    double const values[] = {b.asd, b.sigma, b.exact, b.below, b.median, b.above};
    for (std::size_t i = 0; i < sheet.y.size(); ++i) sheet.y[i].values.push_back(values[i]);
  }
  write_curves({file}, sheet);
}

}  // namespace

TimeSeries strain_series(StrayLight const& light) { return {"h", "1", light.times.start, light.times.rate, light.h}; }

std::vector<TimeSeries> motion_channels(MotionSeries const& motion, MotionSet const& set) {
  std::vector<TimeSeries> all;
  for (MovingCoordinate const& c : motion.coordinates)
    all.push_back({fmt::format("{} {}", set.bodies[c.body.value], axis_names[c.axis]),
                   is_rotation(c.axis) ? "rad" : "m", motion.times.start, motion.times.rate, c.position});
  return all;
}

MapSheet spectrogram_of(TimeSeries const& series, double stride, double low, double high) {
  auto const n = std::size_t(std::lround(stride * series.rate)), step = std::max<std::size_t>(1, n / 2);
  if (n < 8 || n > series.samples.size())
    throw InputError(fmt::format("--stride: {:g} s hold {} samples of {}", stride, n, series.samples.size()),
                     fmt::format("choose between {:.3g} s and {:g} s", 8 / series.rate, series.duration()));
  MapSheet map;
  map.title = fmt::format("spectrogram of {}", series.name);
  map.unit = asd_unit(series.unit);
  map.notes = {fmt::format("Hann segments of {:g} s, half overlapping; ASD, one-sided", stride)};
  WelchSettings settings;
  settings.segment = n;
  for (std::size_t from = 0; from + n <= series.samples.size(); from += step) {
    WelchSpectrum const w = welch(std::span(series.samples).subspan(from, n), series.rate, settings);
    map.time.push_back(series.time(from) + stride / 2);
    for (std::size_t k = 1; k < w.psd.size(); ++k) {
      if (w.hz[k] < low || w.hz[k] > high) continue;
      if (from == 0) map.frequency.push_back(w.hz[k]);
      map.value.push_back(std::sqrt(w.psd[k]));
    }
  }
  return map;
}

void check_time_files(TimeFiles const& f) {
  for (auto const& [option, file] :
       {std::pair{"-o", f.strain}, {"--asd", f.asd}, {"--spectrogram", f.spectrogram}, {"--save-motion", f.motion}})
    if (!file.empty()) check_curve_ending(file, option);
}

std::vector<std::string> write_time_files(TimeFiles const& f, TimeInputs const& in, StrayLight const& light,
                                          ProjectResult const& r) {
  std::vector<std::string> written;
  auto const wanted = [&](std::string const& file) {
    if (!file.empty()) written.push_back(file);
    return !file.empty();
  };
  if (wanted(f.strain))
    write_series(f.strain, is_hdf5(f.strain) ? strain_channels(in, light) : std::vector{strain_series(light)},
                 "strain of stray light");
  if (wanted(f.motion)) write_series(f.motion, motion_channels(light.motion, in.model.motion), "motion of the bodies");
  if (wanted(f.asd)) write_spectrum(f.asd, r);
  if (wanted(f.spectrogram)) {
    double const stride = f.stride.empty() ? std::min(0.5, r.times.duration() / 4)
                                           : option_quantity(f.stride, dim::time, "--stride", "0.5 s");
    write_map({f.spectrogram}, spectrogram_of(strain_series(light), stride, r.band_low, r.band_high));
  }
  return written;
}

}  // namespace straytrace::cli
