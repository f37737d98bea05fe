// SPDX-License-Identifier: BSD-3-Clause
#include "app/fit_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"

namespace straytrace {
namespace {

// In SI units, or refused: `wanted` is what it must be.
TimeSeries in_si(TimeSeries x, Dimension wanted, std::string const& option, std::string const& unit_option) {
  auto const unit = parse_unit(x.unit);
  if (!unit || unit->dimension != wanted)
    throw InputError(fmt::format(
        "error: {}: '{}' is in '{}', not {}\n  {}", option, x.name, x.unit, described(wanted),
        wanted == dim::length ? "integrate accelerations to displacement first, or say the unit with " + unit_option
                              : "say the unit with " + unit_option));
  for (double& v : x.samples) v = to_si(v, *unit);
  x.unit = wanted == dim::length ? "m" : "1";
  return x;
}

bool is_free(FitOptions const& o, char const* name) {
  return std::find(o.free.begin(), o.free.end(), name) != o.free.end();
}

// An option, the default range of --free, or a fixed value.
SearchRange range_or(FitOptions const& o, std::string const& text, Dimension dimension, char const* name,
                     std::string const& example, SearchRange when_free, double fixed) {
  if (!text.empty()) return option_range(text, dimension, fmt::format("--{}", name), example);
  return is_free(o, name) ? when_free : SearchRange{fixed, fixed};
}

// 0.5 to 6, as far as the sample rate holds the fringes (eq. 7.13); the upper end is said with the result.
SearchRange default_multiplicity(FringeRecords const& r, FringeFitSettings const& s) {
  double const single = 2 * fastest_motion(r, std::max(std::fabs(s.ratio.low), std::fabs(s.ratio.high))) / s.wavelength;
  double const most = 0.99 * r.target.rate / (2.2 * single);
  return {0.5, most > 1 ? std::min(6.0, most) : 6.0};
}

SearchRange multiplicity_of(FitOptions const& o, RoutePrediction const* route, SearchRange otherwise) {
  Dimension const plain = dim::plain;
  if (route) {
    double const w = route->multiplicity, wide = std::max(0.3 * std::fabs(w), 2 * route->spread);
    return range_or(o, o.multiplicity, plain, "multiplicity", "0.5..6", {w - wide, w + wide}, w);
  }
  return o.multiplicity.empty() ? otherwise : option_range(o.multiplicity, plain, "--multiplicity", "0.5..6");
}

double option_share(std::string const& text, std::string const& option, std::string const& example) {
  double const share = option_quantity(text, dim::plain, option, example);
  if (share > 0 && share <= 1) return share;
  throw InputError(
      fmt::format("error: {}: '{}' is not above 0 and up to 1\n  write {} \"{}\"", option, text, option, example));
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
  throw InputError(fmt::format("error: {}: '{}' does not rise\n  write {} \"{}\"", option, text, option, example));
}

double wavelength_of(FitOptions const& o) {
  double const run = o.run.empty() ? 0 : wavelength_of_run(o);
  if (o.wavelength.empty()) return run > 0 ? run : 1064e-9;
  double const said = option_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  if (!(said > 0)) throw InputError("error: --wavelength: it is positive\n  write --wavelength \"1064 nm\"");
  if (run > 0 && std::fabs(said / run - 1) > 1e-9)
    throw InputError(fmt::format("error: --wavelength: the run has {:g} nm\n  leave the option out", run * 1e9));
  return said;
}

FringeRecords records_of(FitOptions const& o) {
  if (o.target.empty() || o.witness.empty())
    throw InputError(
        "error: a fit needs --target, the record with the noise, and --witness, the motion\n  write --target "
        "h.hdf5::CHANNEL --witness x.hdf5::CHANNEL");
  GpsSpan const span = span_of(o.data);
  FringeRecords records;
  records.target = series_argument(o.target, o.target_unit, span);
  if (!o.run.empty() || !o.gain.empty())
    records.target = in_si(records.target, dim::plain, "--target", "--target-unit");
  // Beyond the span of the target witnesses are welcome: delays reach there.
  records.witnesses.push_back(
      in_si(series_argument(o.witness, o.witness_unit, span), dim::length, "--witness", "--witness-unit"));
  if (!o.witness2.empty())
    records.witnesses.push_back(
        in_si(series_argument(o.witness2, o.witness_unit, span), dim::length, "--witness2", "--witness-unit"));
  if (o.witness2.empty() && (!o.ratio.empty() || is_free(o, "ratio")))
    throw InputError("error: --ratio: there is no second witness\n  name it with --witness2");
  return records;
}

FitGround ground_of(FitOptions const& o, FringeRecords const& records) {
  if (o.data.band.empty()) throw InputError("error: --band is missing\n  write --band \"20 Hz..80 Hz\"");
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
  SearchRange const delay = range_or(o, o.delay, dim::time, "delay", "-20 ms..20 ms", {-0.01, 0.01}, 0);
  SearchRange const drift = range_or(o, o.drift, turning, "drift", "-1 rad/s..1 rad/s", {-1, 1}, 0);
  double const gain = o.gain.empty() ? 0 : option_quantity(o.gain, dim::plain, "--gain-per-field", "1.1e-16");
  for (std::size_t i = 0; i < std::max<std::size_t>(routes.size(), routes.empty() ? o.paths : 0); ++i) {
    RoutePrediction const* const route = routes.empty() ? nullptr : &routes[i];
    FringePath path{route ? fmt::format("path {}", route->rank) : fmt::format("path {}", i + 1),
                    multiplicity_of(o, route, default_multiplicity(records, s)),
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
  command.add_option("--target-unit", o.target_unit, "where the file does not say it: 1 for strain");
  command.add_option("--witness", o.witness, "record of the motion, FILE or FILE::CHANNEL, a displacement");
  command.add_option("--witness2", o.witness2, "motion of a second body: the fit takes x_1 - ratio x_2");
  command.add_option("--witness-unit", o.witness_unit, "where the file does not say it: um");
  command.add_option("--ratio", o.ratio, "of the second witness: 1 (default), a range 0.5..1.5, or free: 0..2");
  command.add_option("--gps", o.data.gps, "stretch A..B in GPS seconds or UTC; default: all that they share");
  command.add_option("--wavelength", o.wavelength, "of the light; default: that of the run, else 1064 nm");
  add_band_option(command, o.data, "where the fringes are searched: \"20 Hz..80 Hz\"");
  add_output_options(command, o.data);
}

}  // namespace straytrace
