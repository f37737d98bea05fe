// SPDX-License-Identifier: BSD-3-Clause
#include "cli/fit/fit_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "results/results.hpp"

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

double option_share(std::string const& text, std::string const& option, std::string const& example) {
  double const share = option_quantity(text, dim::plain, option, example);
  if (share > 0 && share <= 1) return share;
  throw InputError(fmt::format("{}: '{}' is not between 0 and 1", option, text),
                   fmt::format("write {} \"{}\"", option, example));
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
  double const gain = o.gain.empty() ? 0 : positive_quantity(o.gain, dim::plain, "--gain-per-field", "1.1e-16");
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
  command.add_option("--target", o.target,
                     "record with the noise: FILE or FILE::CHANNEL; h(t) before noise subtraction");
  command.add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  command.add_option("--witness", o.witness, "record of the motion, FILE or FILE::CHANNEL: m or rad, or per s or s^2");
  command.add_option("--witness2", o.witness2, "motion of a second body: the fit uses x_1 - ratio x_2");
  command.add_option("--witness-unit", o.witness_unit,
                     "unit, where the file has none: um; of counts the calibration: \"2e-6 m/s^2\"");
  command.add_option("--witness2-unit", o.witness2_unit, "the same for the second witness");
  command.add_option("--corner", o.corner, "high pass of an integrated witness: \"0.05 Hz\"");
  command.add_option("--ratio", o.ratio, "of the second witness: 1 (default), a range 0.5..1.5, or free: 0..2");
  add_gps_options(command, o.data.gps, o.data.segments, "all common data");
  command.add_option("--wavelength", o.wavelength, "wavelength of the light; default: that of the run, else 1064 nm");
  add_band_option(command, o.data, "band searched for fringes: \"20 Hz..80 Hz\"");
  add_output_options(command, o.data);
}

}  // namespace straytrace::cli
