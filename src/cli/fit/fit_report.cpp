// SPDX-License-Identifier: BSD-3-Clause
#include "cli/fit/fit_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "results/results.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::cli {
namespace {

constexpr double clock_range = 0.25;  // s, to either side: unsynchronised clocks

bool is_free(FitOptions const& o, char const* name) {
  return std::find(o.free.begin(), o.free.end(), name) != o.free.end();
}

// An option, the default range of --free, or a fixed value.
SearchRange range_or(FitOptions const& o, std::string const& text, Dimension dimension, char const* name,
                     std::string const& example, SearchRange when_free, double fixed) {
  if (!text.empty()) return option_range(text, dimension, fmt::format("--{}", name), example);
  return is_free(o, name) ? when_free : SearchRange{fixed, fixed};
}

SearchRange multiplicity_of(FitOptions const& o, RoutePrediction const* route, FringeRecords const& records,
                            FringeFitSettings const& s) {
  Dimension const dimension = multiplicity_dimension(records);
  std::string const example = is_rotation(records) ? "1 mm..5 cm" : "0.5..6";
  if (route) {
    double const w = route->multiplicity, wide = std::max(0.3 * std::fabs(w), 2 * route->spread);
    return range_or(o, o.multiplicity, dimension, "multiplicity", example, {w - wide, w + wide}, w);
  }
  if (!o.multiplicity.empty()) return option_range(o.multiplicity, dimension, "--multiplicity", example);
  if (is_rotation(records))
    throw InputError("--multiplicity is missing: for an angle it is a lever arm, which has no default range",
                     "write --multiplicity \"1 mm..5 cm\", or give the run and --path");
  return usual_multiplicity(records, s);
}

// m: of the run, of --wavelength, or 1064 nm.
double wavelength_of(FitOptions const& o) {
  double const run = o.prediction.run.empty() ? 0 : read_run(o.prediction.run).trace.coupling.wavelength;
  if (o.wavelength.empty()) return run > 0 ? run : 1064e-9;
  double const said = positive_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  if (run > 0 && std::fabs(said / run - 1) > 1e-9)
    throw InputError(fmt::format("--wavelength: the run has {:g} nm", run * 1e9), "remove the option");
  return said;
}

}  // namespace

SearchRange option_range(std::string const& text, Dimension dimension, std::string const& option,
                         std::string const& example) {
  auto const mark = text.find("..");
  if (mark == text.npos) {
    double const value = option_quantity(text, dimension, option, example);
    return {value, value};
  }
  SearchRange const range{option_quantity(text.substr(0, mark), dimension, option, example),
                          option_quantity(text.substr(mark + 2), dimension, option, example)};
  if (range.high > range.low) return range;
  throw InputError(fmt::format("{}: '{}' does not rise", option, text),
                   fmt::format("write {} \"{}\"", option, example));
}

double option_share(std::string const& text, std::string const& option, std::string const& example) {
  double const share = option_quantity(text, dim::plain, option, example);
  if (share > 0 && share <= 1) return share;
  throw InputError(fmt::format("{}: '{}' is not between 0 and 1", option, text),
                   fmt::format("write {} \"{}\"", option, example));
}

CLI::Validator is_range(Dimension dimension, std::string const& option, std::string const& example) {
  return readable([=](std::string const& text) { option_range(text, dimension, option, example); });
}

double strain_per_field(std::string const& text) {
  return positive_quantity(text, dim::plain, "--gain-per-field", "1.1e-16");
}

FringeRecords records_of(FitOptions const& o) {
  if (o.target.empty() || o.witness.empty())
    throw InputError("a fit needs --target, the record with the noise, and --witness, the motion",
                     "write --target h.hdf5::CHANNEL --witness x.hdf5::CHANNEL");
  GpsSpan const span = span_of(o.data);
  FringeRecords records;
  records.target = series_argument(o.target, o.target_unit, span);
  if (!o.prediction.run.empty() || !o.gain.empty()) records.target = as_strain(std::move(records.target));
  std::optional<double> corner;
  if (!o.corner.empty()) corner = option_quantity(o.corner, dim::frequency, "--corner", "0.05 Hz");
  // Witnesses may extend beyond the span of the target, for delays.
  add_witness(records, series_argument(o.witness, o.witness_unit, span), corner, "--witness");
  if (!o.witness2.empty())
    add_witness(records, series_argument(o.witness2, o.witness2_unit, span), corner, "--witness2");
  if (records.witnesses.front().unit != records.witnesses.back().unit)
    throw InputError("--witness2: one witness is an angle and the other a displacement", "give two of one kind");
  if (o.witness2.empty() && (!o.ratio.empty() || is_free(o, "ratio")))
    throw InputError("--ratio: there is no second witness", "give it with --witness2");
  return records;
}

FitGround ground_of(FitOptions const& o, FringeRecords const& records) {
  if (o.data.band.empty()) throw InputError("--band is missing", "write --band \"20 Hz..80 Hz\"");
  FrequencyBand const band = band_of(o.data, {}, records.target.rate / 2);
  FitGround g{band.low, band.high, wavelength_of(o), {}};
  if (records.witnesses.size() < 2) return g;
  bool const free = o.ratio == "free" || (o.ratio.empty() && is_free(o, "ratio"));
  g.ratio = free              ? SearchRange{0, 2}
            : o.ratio.empty() ? SearchRange{1, 1}
                              : option_range(o.ratio, dim::plain, "--ratio", "0.5..1.5");
  return g;
}

FringeFitSettings settings_of(FitOptions const& o, FringeRecords const& records,
                              std::vector<RoutePrediction> const& routes) {
  FitGround const ground = ground_of(o, records);
  FringeFitSettings s;
  s.low = ground.low;
  s.high = ground.high;
  s.wavelength = ground.wavelength;
  s.ratio = ground.ratio;
  s.train = option_share(o.train, "--train", "70 %");
  s.false_alarm = option_share(o.false_alarm, "--false-alarm", "1e-3");
  s.method = o.method == "time" ? FitMethod::time : FitMethod::frequency;
  Dimension const turning = *times(dim::angle, dim::frequency);
  SearchRange const delay = range_or(o, o.delay, dim::time, "delay", "-20 ms..20 ms", {-clock_range, clock_range}, 0);
  // As far as a delay stays short against the taper of the stretch.
  if (!delay.free() && o.delay.empty()) s.clock = std::min(clock_range, s.train * records.target.duration() / 20);
  SearchRange const drift = range_or(o, o.drift, turning, "drift", "-1 rad/s..1 rad/s", {-1, 1}, 0);
  double const gain = o.gain.empty() ? 0 : strain_per_field(o.gain);
  for (std::size_t i = 0; i < std::max<std::size_t>(routes.size(), routes.empty() ? o.paths.value_or(1) : 0); ++i) {
    RoutePrediction const* const route = routes.empty() ? nullptr : &routes[i];
    FringePath path{route ? fmt::format("path {}", route->rank) : fmt::format("path {}", i + 1),
                    multiplicity_of(o, route, records, s),
                    delay,
                    drift,
                    {},
                    {}};
    if (route) {
      path.phase = route->phase;
      path.amplitude = route->amplitude;
    } else if (gain > 0) {
      path.phase = [gain](double) { return std::complex<double>(gain); };
    }
    s.paths.push_back(std::move(path));
  }
  return s;
}

void add_record_options(CLI::App& command, FitOptions& o) {
  command
      .add_option("--target", o.target, "record with the noise: FILE or FILE::CHANNEL; h(t) before noise subtraction")
      ->check(is_record("--target"));
  command.add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  command.add_option("--witness", o.witness, "record of the motion, FILE or FILE::CHANNEL: m or rad, or per s or s^2")
      ->check(is_record("--witness"));
  command.add_option("--witness2", o.witness2, "motion of a second body: the fit uses x_1 - ratio x_2")
      ->check(is_record("--witness2"));
  command.add_option("--witness-unit", o.witness_unit,
                     "unit, where the file has none: um; of counts the calibration: \"2e-6 m/s^2\"");
  command.add_option("--witness2-unit", o.witness2_unit, "the same for the second witness");
  command.add_option("--corner", o.corner, "high pass of an integrated witness: \"0.05 Hz\"")
      ->check(is_quantity(dim::frequency, "--corner", "0.05 Hz"));
  command.add_option("--ratio", o.ratio, "of the second witness: 1 (default), a range 0.5..1.5, or free: 0..2")
      ->check(readable([](std::string const& text) {
        if (text != "free") option_range(text, dim::plain, "--ratio", "0.5..1.5");
      }));
  add_gps_options(command, o.data.gps, o.data.segments, "all common data");
  command.add_option("--wavelength", o.wavelength, "wavelength of the light; default: that of the run, else 1064 nm")
      ->check(
          readable([](std::string const& text) { positive_quantity(text, dim::length, "--wavelength", "1064 nm"); }));
  add_band_option(command, o.data, "band searched for fringes: \"20 Hz..80 Hz\"");
  add_output_options(command, o.data);
}

namespace {

std::string value_text(Fitted const& f, char const* unit) {
  std::string const number = f.sigma > 0 ? with_error(f.value, f.sigma) : fmt::format("{:g} (fixed)", f.value);
  return fmt::format("{}{}{}", number, *unit ? " " : "", unit) + (f.at_end ? "  (at the end of its range)" : "");
}

// "1.2e-5"; never 0 or infinity where a double ends.
std::string chance_text(double ln) {
  double const ten = ln / std::log(10.0);
  return std::fabs(ten) > 300 ? fmt::format("1e{:.0f}", ten) : fmt::format("{:.2g}", std::exp(ln));
}

Fitted scaled(Fitted f, double factor) {
  f.value *= factor;
  f.sigma *= factor;
  return f;
}

std::string line(char const* name, std::string const& value) { return fmt::format("  {:<24}{}\n", name, value); }

std::string prediction_text(FittedPath const& p, RoutePrediction const& r) {
  AgainstPrediction const a = against(p, r);
  std::string out = line("route", fmt::format("{} (port {}, {} along {})", r.route, r.port, r.body, r.axis));
  out += line("predicted W", fmt::format("{:.4g}, spread over the paths {:.2g}", r.multiplicity, r.spread));
  if (std::isnan(r.coupling)) return out + line("predicted f_r", "unresolved in the run");
  out += line("predicted f_r", with_error(r.coupling, r.sigma) + (r.speckle ? " (mean over the speckle)" : ""));
  out += line("measured/predicted", with_error(a.ratio.value, a.ratio.sigma));
  if (r.speckle)
    out += line("", fmt::format("{} the range of one speckle, {:.3f} to {:.3f} (5 to 95 %, eq. 10.2)",
                                a.within ? "within" : "outside", a.low, a.high));
  return out;
}

// Printed where it is above 1 % of the amplitude.
std::string unseen_text(double phase) {
  if (std::isnan(phase)) return line("below --corner", "unknown: the record has fewer than six periods of half of it");
  double const low = -std::expm1(-phase * phase / 2);
  if (low < 0.01) return "";
  return line("below --corner",
              fmt::format("{:.2g} rad rms between half of it and it; if that is motion and not sensor noise, the "
                          "amplitude is {}: halve it",
                          phase, low > 0.5 ? "far too low" : fmt::format("low by {:.2g} %", 100 * low)));
}

std::string strength_text(FitAnswer const& a, FittedPath const& p) {
  double const f = p.amplitude.value;
  if (a.field) return with_error(f * f, 2 * f * p.amplitude.sigma);
  return value_text(p.amplitude, a.records.target.unit == "1" ? "" : a.records.target.unit.c_str());
}

std::string path_text(FitAnswer const& a, std::size_t i) {
  FittedPath const& p = a.fit.paths[i];
  bool const significant = p.ln_false_alarm < std::log(a.settings.false_alarm);
  std::string out = fmt::format("{}{}\n", p.name, significant ? "" : ": not significant");
  out += line(a.field ? "recoupled fraction f_r" : "amplitude G", strength_text(a, p));
  out += line("static phase", value_text(p.phase, "rad"));
  SearchRange const& searched = a.settings.paths[i].multiplicity;
  std::string const w_unit = multiplicity_unit(a.records);
  Fitted const peak = effective_peak(a.records, a.fit, i);
  out +=
      line("multiplicity W",
           value_text(p.multiplicity, w_unit.c_str()) +
               (searched.free() ? fmt::format(", searched from {:.3g} to {:.3g}", searched.low, searched.high) : ""));
  out += line("effective motion", fmt::format("{} um peak ({:.4g} um pp)",
                                              peak.sigma > 0 ? with_error(1e6 * peak.value, 1e6 * peak.sigma)
                                                             : fmt::format("{:.4g}", 1e6 * peak.value),
                                              2e6 * peak.value));
  out += unseen_text(unseen_phase(a.records, a.fit, a.settings.wavelength, i));
  if (p.delay.sigma > 0) out += line("delay", value_text(scaled(p.delay, 1e3), "ms"));
  if (p.drift.sigma > 0) out += line("drift of the phase", value_text(p.drift, "rad/s"));
  out += line("chi^2 gained",
              fmt::format("{:.1f}; probability in noise alone: {}", p.gain, chance_text(p.ln_false_alarm)));
  if (!a.routes.empty()) out += prediction_text(p, a.routes[i]);
  return out;
}

std::string test_text(FringeFit const& fit, double false_alarm) {
  OutOfSample const& t = fit.test;
  if (t.seconds == 0) return "out of sample: no test; the whole record was fitted\n";
  return fmt::format(
      "out of sample, {:.4g} s: chi^2 {:.1f} -> {:.1f} ({:.0f} expected); with the fit and its errors it is {} times "
      "as "
      "likely as without (found: {:g}, which noise alone reaches with a chance below {:g}); factor on the model {} "
      "(1: it generalises, 0: it was noise); power in the band falls by {} %\n",
      t.seconds, t.without, t.with, t.degrees, chance_text(t.ln_odds), 1 / false_alarm, false_alarm,
      with_error(t.scale.value, t.scale.sigma), with_error(100 * t.reduction.value, 100 * t.reduction.sigma));
}

std::string clock_text(FitAnswer const& a) {
  ClockCheck const& c = a.fit.clock;
  if (c.range == 0) return "";
  if (!c.better)
    return fmt::format(
        "clocks: no delay within {:g} ms fits better than none; a clock that is wrong by more was not searched for\n",
        1e3 * c.range);
  std::string out = fmt::format("{}: noise that comes {} behind the witness takes {:.1f} more from chi^2\n",
                                c.doubtful ? "clock?" : "clocks", value_text(scaled(c.delay, 1e3), "ms"), c.gain);
  for (std::size_t i = 0; i < c.paths.size(); ++i)
    out += fmt::format("  {}: {} {} with that delay, {} without; W {} and {}\n", c.paths[i].name, a.field ? "f_r" : "G",
                       strength_text(a, c.paths[i]), strength_text(a, a.fit.paths[i]),
                       value_text(c.paths[i].multiplicity, ""), value_text(a.fit.paths[i].multiplicity, ""));
  if (c.delay.at_end || std::fabs(c.delay.value) > 0.95 * c.range)
    out += fmt::format(
        "  this delay lies at the end of the {:g} ms searched to either side: the clock may be wrong by more; search "
        "further, as with --delay \"{:g} s..{:g} s\"\n",
        1e3 * c.range, -4 * c.range, 4 * c.range);
  return out + (c.doubtful ? "  write --free delay, or --delay \"0 ms\" where the clocks are one\n" : "");
}

std::string correlations_text(FringeFit const& fit) {
  std::string out;
  std::size_t const n = fit.names.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::fabs(fit.correlation[i * n + j]) > 0.5)
        out += fmt::format("{}{} and {} {:+.2f}", out.empty() ? "correlated: " : "; ", fit.names[j], fit.names[i],
                           fit.correlation[i * n + j]);
  return out.empty() ? out : out + "\n";
}

}  // namespace

std::string verdict_text(FitOutcome v) {
  switch (v) {
    case FitOutcome::none:
      return "no significant fringe noise";
    case FitOutcome::untested:
      return "significant, but the rest of the record is too short or too quiet to confirm it";
    case FitOutcome::not_general:
      return "significant, but the fit does not generalise: it fails on the rest of the record";
    case FitOutcome::clock:
      return "clock? another delay of the witness fits better and gives another amplitude";
    case FitOutcome::at_end:
      return "significant, but a parameter is at the end of its range: the best fit may be outside; widen the range";
    case FitOutcome::found:
      return "fringe noise found: the fit predicts the rest of the record";
  }
  return {};
}

std::string fit_text(FitAnswer const& a) {
  FringeFit const& fit = a.fit;
  std::string witness = a.records.witnesses[0].name;
  if (a.records.witnesses.size() > 1)
    witness += fmt::format(" - {} x {}", value_text(fit.ratio, ""), a.records.witnesses[1].name);
  std::string out =
      fmt::format("{} against {}, {:g} to {:g} Hz, {:g} nm, W in units of 4 pi/lambda\n", a.records.target.name,
                  witness, a.settings.low, a.settings.high, a.settings.wavelength * 1e9);
  out += fmt::format("fitted GPS {} to {}, tested to {}; phases at GPS {} and the mean of the motion\n",
                     gps_text(fit.start), gps_text(fit.split), gps_text(fit.end), gps_text(fit.middle));
  out += verdict_text(fit.verdict) + "\n";
  for (std::size_t i = 0; i < fit.paths.size(); ++i) out += path_text(a, i);
  out += fmt::format("fringes up to {:.1f} Hz\n", fit.highest_fringe);
  out += fmt::format("fitted: chi^2 {:.1f} -> {:.1f} ({:.0f} expected)\n", fit.without, fit.with, fit.degrees);
  return out + clock_text(a) + test_text(fit, a.settings.false_alarm) + correlations_text(fit);
}

TimeSeries subtracted(FitAnswer const& a, FringeModel const& model) {
  if (a.fit.verdict != FitOutcome::found)
    throw InputError(
        fmt::format("--subtract: {}; nothing was subtracted and no residual written", verdict_text(a.fit.verdict)),
        "remove the option, or fit another witness, band or stretch");
  TimeSeries rest = a.records.target;
  rest.name += "_RESIDUAL";
  for (std::size_t i = 0; i < model.values.size(); ++i) rest.samples[model.first + i] -= model.values[i];
  return rest;
}

CurveSheet fit_curves(FitAnswer const& a, FringeModel const& model) {
  TimeSeries const& h = a.records.target;
  std::size_t const n = model.values.size();
  TimeSeries part = h;
  part.start = h.time(model.first);
  part.samples = {h.samples.begin() + std::ptrdiff_t(model.first), h.samples.begin() + std::ptrdiff_t(model.first + n)};
  WelchSettings welch_settings;
  welch_settings.segment = std::size_t(std::lround(std::min(8.0, part.duration() / 8) * h.rate));
  WelchSpectrum const before = welch(part.samples, h.rate, welch_settings);
  CurveSheet sheet;
  sheet.title = fmt::format("{}: {}", h.name, verdict_text(a.fit.verdict));
  std::string const text = fit_text(a);
  for (std::size_t at = 0; at < text.size();) {
    auto const end = text.find('\n', at);
    sheet.notes.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  sheet.notes.push_back(welch_note(welch_settings, h.rate, before));
  sheet.x = {"frequency", "Hz", {}, "line"};
  std::vector<std::size_t> lines;
  for (std::size_t k = 1; k < before.hz.size(); ++k)
    if (before.hz[k] >= a.settings.low / 2 && before.hz[k] <= 2 * a.settings.high) {
      lines.push_back(k);
      sheet.x.values.push_back(before.hz[k]);
    }
  auto const add = [&](char const* name, WelchSpectrum const& w) {
    CurveColumn c{name, asd_unit(h.unit), {}, "line"};
    CurveColumn error{std::string(name) + "_sigma", c.unit, {}, "hidden"};
    for (std::size_t const k : lines) {
      c.values.push_back(std::sqrt(w.psd[k]));
      error.values.push_back(w.sigma[k] / (2 * std::sqrt(w.psd[k])));
    }
    sheet.y.push_back(c);
    sheet.y.push_back(error);
  };
  add("target", before);
  if (a.fit.verdict != FitOutcome::found) {
    sheet.notes.push_back("no residual: the fit does not allow a subtraction");
    return sheet;
  }
  add("fitted_noise", welch(model.values, h.rate, welch_settings));
  for (std::size_t i = 0; i < lines.size(); ++i)  // outside the band it is leakage of the window
    if (sheet.x.values[i] < a.settings.low || sheet.x.values[i] > a.settings.high)
      for (std::size_t c = sheet.y.size() - 2; c < sheet.y.size(); ++c) sheet.y[c].values[i] = not_a_number;
  for (std::size_t i = 0; i < n; ++i) part.samples[i] -= model.values[i];
  add("residual", welch(part.samples, h.rate, welch_settings));
  return sheet;
}

namespace {

nlohmann::json number(Fitted const& f) {
  return {{"value", f.value}, {"sigma", f.sigma}, {"free", f.sigma > 0}, {"at_end_of_range", f.at_end}};
}

nlohmann::json prediction_json(FittedPath const& p, RoutePrediction const& r) {
  AgainstPrediction const a = against(p, r);
  nlohmann::json j{{"rank", r.rank},
                   {"route", r.route},
                   {"port", r.port},
                   {"body", r.body},
                   {"axis", r.axis},
                   {"multiplicity", r.multiplicity},
                   {"multiplicity_spread", r.spread},
                   {"resolved", !std::isnan(r.coupling)}};
  if (std::isnan(r.coupling)) return j;
  j["recoupled_fraction"] = {{"value", r.coupling}, {"sigma", r.sigma}};
  j["measured_over_predicted"] = number(a.ratio);
  if (r.speckle) j["speckle"] = {{"low_5", a.low}, {"high_95", a.high}, {"within", a.within}};
  return j;
}

nlohmann::json path_json(FitAnswer const& a, std::size_t i) {
  FittedPath const& p = a.fit.paths[i];
  Fitted const peak = effective_peak(a.records, a.fit, i);
  nlohmann::json j{{"name", p.name},
                   {"static_phase_rad", number(p.phase)},
                   {"multiplicity", number(p.multiplicity)},
                   {"delay_s", number(p.delay)},
                   {"drift_rad_per_s", number(p.drift)},
                   {"effective_motion_peak_m", peak.value},
                   {"effective_motion_peak_sigma_m", peak.sigma},
                   {"unseen_phase_rad", unseen_phase(a.records, a.fit, a.settings.wavelength, i)},
                   {"chi2_gained", p.gain},
                   {"ln_false_alarm", p.ln_false_alarm}};
  if (a.field) {
    double const f = p.amplitude.value;
    j["recoupled_fraction"] = number({f * f, 2 * f * p.amplitude.sigma});
  } else {
    j["amplitude"] = number(p.amplitude);
  }
  if (!a.routes.empty()) j["prediction"] = prediction_json(p, a.routes[i]);
  return j;
}

nlohmann::json clock_json(FitAnswer const& a) {
  ClockCheck const& c = a.fit.clock;
  nlohmann::json j{{"range_s", c.range}, {"better", c.better}, {"doubtful", c.doubtful}};
  if (!c.better) return j;
  j["delay_s"] = number(c.delay);
  j["chi2_gained"] = c.gain;
  for (FittedPath const& p : c.paths)
    j["paths"].push_back({{"name", p.name},
                          {a.field ? "field" : "amplitude", number(p.amplitude)},
                          {"multiplicity", number(p.multiplicity)}});
  return j;
}

char const* verdict_word(FitOutcome v) {
  char const* const words[] = {"none", "untested", "not-general", "clock", "end-of-range", "found"};
  return words[std::size_t(v)];
}

}  // namespace

nlohmann::json fit_json(FitAnswer const& a) {
  FringeFit const& fit = a.fit;
  nlohmann::json paths = nlohmann::json::array();
  for (std::size_t i = 0; i < fit.paths.size(); ++i) paths.push_back(path_json(a, i));
  nlohmann::json out{{"verdict", verdict_word(fit.verdict)},
                     {"target", a.records.target.name},
                     {"target_unit", a.records.target.unit},
                     {"band_hz", {a.settings.low, a.settings.high}},
                     {"wavelength_m", a.settings.wavelength},
                     {"method", a.settings.method == FitMethod::time ? "time" : "frequency"},
                     {"gps", {{"start", fit.start}, {"split", fit.split}, {"end", fit.end}, {"middle", fit.middle}}},
                     {"paths", paths},
                     {"highest_fringe_hz", fit.highest_fringe},
                     {"chi2", {{"without", fit.without}, {"with", fit.with}, {"degrees", fit.degrees}}},
                     {"ln_false_alarm", fit.ln_false_alarm},
                     {"parameters", fit.names}};
  for (TimeSeries const& x : a.records.witnesses) out["witnesses"].push_back(x.name);
  if (a.records.witnesses.size() > 1) out["ratio"] = number(fit.ratio);
  std::size_t const n = fit.names.size();
  for (std::size_t i = 0; i < n; ++i)
    out["correlation"].push_back(std::vector<double>(fit.correlation.begin() + std::ptrdiff_t(i * n),
                                                     fit.correlation.begin() + std::ptrdiff_t((i + 1) * n)));
  if (fit.clock.range > 0) out["clock"] = clock_json(a);
  if (fit.test.seconds > 0)
    out["out_of_sample"] = {
        {"seconds", fit.test.seconds},
        {"chi2", {{"without", fit.test.without}, {"with", fit.test.with}, {"degrees", fit.test.degrees}}},
        {"ln_odds", fit.test.ln_odds},
        {"ln_odds_expected", number(fit.test.ln_odds_expected)},
        {"scale", number(fit.test.scale)},
        {"reduction", number(fit.test.reduction)}};
  return out;
}

}  // namespace straytrace::cli
