// SPDX-License-Identifier: BSD-3-Clause
#include "motion/series_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "io/observatory_data.hpp"
#include "motion/axis_motion.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/fourier.hpp"
#include "spectra/welch.hpp"

namespace straytrace::motion {
namespace {

constexpr double longest_segment = 128;  // s, unless it is stated or the high pass needs more
constexpr double lines_below = 4;        // of the periodogram that must lie below the high pass

double high_passed(double hz, double corner) {
  double const x = std::pow(hz / corner, 4);
  return corner > 0 ? (std::isfinite(x) ? x / (1 + x) : 1) : 1;
}

// Amplitude of the displacement over that of the reading, for exp(+2 pi i f t).
std::complex<double> conversion(Calibration const& c, double hz, double corner) {
  std::complex<double> value = c.factor * high_passed(hz, corner);
  if (c.response) value *= std::conj((*c.response)(std::max({hz, c.response->range().low, corner})));
  return value / std::pow(std::complex<double>(0, 2 * pi * hz), c.derivatives);
}

std::vector<double> without_line(std::vector<double> x) {
  double const n = static_cast<double>(x.size()), middle = (n - 1) / 2;
  double mean = 0, slope = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean += x[i] / n;
    slope += x[i] * (static_cast<double>(i) - middle);
  }
  slope *= 12 / (n * (n * n - 1));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= mean + slope * (static_cast<double>(i) - middle);
  return x;
}

// `margin` samples on both sides, reflected through the end points and faded out to zero.
std::vector<double> continued(std::vector<double> const& x, std::size_t margin) {
  std::vector<double> out(x.size() + 2 * margin);
  std::copy(x.begin(), x.end(), out.begin() + std::ptrdiff_t(margin));
  for (std::size_t i = 1; i <= margin; ++i) {
    double const fade = 0.5 + 0.5 * std::cos(pi * double(i) / double(margin + 1));
    out[margin - i] = fade * (2 * x.front() - x[i]);
    out[margin + x.size() - 1 + i] = fade * (2 * x.back() - x[x.size() - 1 - i]);
  }
  return out;
}

// Steps of constant density between edges, from lines of the same spacing: no power is lost between them.
Spectrum as_steps(std::vector<double> const& density, double spacing, std::size_t first) {
  constexpr double widest = 1e-3, edge = 1e-9;
  std::vector<double> hz, psd;
  for (std::size_t k = first; k < density.size();) {
    auto const joined = std::max<std::size_t>(1, std::size_t(widest * double(k)));
    std::size_t const end = std::min(density.size(), k + joined);
    double power = 0;
    for (std::size_t i = k; i < end; ++i) power += density[i];
    hz.insert(hz.end(), {(double(k) - 0.5) * spacing * (1 + edge), (double(end) - 0.5) * spacing});
    psd.insert(psd.end(), 2, power / double(end - k));
    k = end;
  }
  return Spectrum(std::move(hz), std::move(psd));
}

// Empty and a problem when the record is too short for it.
std::optional<double> read_segment(Node const& spec, double duration, double highpass) {
  double const usual =
                   std::min(duration, std::max(std::min(duration / 8, longest_segment), 2 * lines_below / highpass)),
               segment =
                   spec.number("segment", dim::time, highpass > 0 ? usual : std::min(duration / 8, longest_segment));
  if (!std::isfinite(segment)) return {};
  if (segment > duration) {
    spec["segment"].problem(fmt::format("the record lasts {:.6g} s", duration), "write a shorter segment");
    return {};
  }
  if (highpass > 0 && highpass * segment < lines_below) {
    spec.problem(fmt::format("a high pass at {:g} Hz needs segments of {:.3g} s; the record allows {:.3g} s", highpass,
                             lines_below / highpass, segment),
                 "write a higher 'highpass', a longer 'segment', or give a longer record");
    return {};
  }
  return segment;
}

// Messages of the command line, with its options replaced by keys of the scene.
std::string in_words_of_scene(std::string text, std::string const& file) {
  std::pair<std::string, std::string> const words[] = {
      {"--unit ", "unit: "}, {"--unit", "'unit'"}, {"--gps ", "span: "}, {file + "::", "channel: "}};
  for (auto const& [from, to] : words)
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

// Reports the errors of reading a record at their places: those of a line in the file itself.
void pass_on(InputError const& e, Node const& file, Node const& otherwise_at) {
  std::string const& name = file.text();
  for (Problem const& p : e.problems) {
    std::string const what = in_words_of_scene(p.what, name), remedy = p.suggestion.empty()
                                                                           ? "give a record of samples"
                                                                           : in_words_of_scene(p.suggestion, name);
    if (p.place.line > 0)
      file.file_problem(name, p.place.line, std::max(1U, p.place.column), what, remedy);
    else
      otherwise_at.problem(e.files.empty() ? what : fmt::format("'{}': {}", name, what), remedy);
  }
}

std::optional<GpsSpan> read_span(Node const& spec) try {
  return spec.has("span") ? parse_gps(spec.word("span")) : GpsSpan{};
} catch (InputError const& e) {
  pass_on(e, spec["series"], spec["span"]);
  return {};
}

// The stretch of `span` in which the flag of `segments` is active.
std::optional<GpsSpan> read_stretch(Node const& spec) {
  auto const span = read_span(spec);
  if (!span || !spec.has("segments")) return span;
  Node const file = spec["segments"];
  std::string const name = file.as_word(), text = file.data_file(name);
  if (text.empty() && !file.document()->optional_file(file, name)) return {};  // reported by data_file()
  try {
    refuse_binary(text, name);
    return only_stretch(parse_segments(text, name), *span);
  } catch (InputError const& e) {
    pass_on(e, file, file);
    return {};
  }
}

std::optional<TimeSeries> read_series(Node const& spec) {
  Node const file = spec["series"];
  std::string name = file.as_word();
  SeriesRequest request{spec.has("channel") ? spec.word("channel") : "", spec.has("unit") ? spec.word("unit") : "", {}};
  auto const span = read_stretch(spec);
  if (name.empty() || !span) return {};
  request.span = *span;
  if (is_observatory_data(name)) name = kept_name({name, request.channel, span->from, span->to});
  std::string const bytes = file.data_file(name);
  if (bytes.empty() && !file.document()->optional_file(file, name)) return {};  // reported by data_file()
  try {
    return parse_series(bytes, name, request);
  } catch (InputError const& e) {
    pass_on(e, file, file);
    return {};
  }
}

}  // namespace

TimeSeries as_displacement(TimeSeries const& readings, Calibration const& c, double highpass) {
  TimeSeries out = readings;
  if (c.derivatives == 0 && !c.response && highpass == 0) {
    for (double& x : out.samples) x *= c.factor;
    return out;
  }
  std::vector<double> const x = without_line(readings.samples);
  double const settle = highpass > 0 ? 3 / highpass : readings.duration() / 10;
  auto const margin = std::min(x.size() - 1, static_cast<std::size_t>(settle * readings.rate));
  std::vector<double> wide = continued(x, margin);
  std::size_t const count = good_length(wide.size());
  wide.resize(count);
  Fourier fourier;
  Complexes lines = fourier.forward(wide);
  for (std::size_t k = 0; k < lines.size(); ++k)
    lines[k] *= k == 0 && highpass > 0 ? 0 : conversion(c, double(k) * readings.rate / double(count), highpass);
  wide = fourier.inverse(lines, count);
  std::copy_n(wide.begin() + std::ptrdiff_t(margin), x.size(), out.samples.begin());
  return out;
}

Spectrum displacement_spectrum(TimeSeries const& readings, Calibration const& c, double highpass, double segment) {
  auto const samples =
      std::clamp<std::size_t>(std::size_t(std::lround(segment * readings.rate)), 4, readings.samples.size());
  WelchSettings settings;
  settings.segment = samples;
  settings.detrend = Detrend::linear;
  WelchSpectrum const w = welch(readings.samples, readings.rate, settings);
  std::vector<double> density = w.psd;
  for (std::size_t k = 1; k < density.size(); ++k) density[k] *= std::norm(conversion(c, w.hz[k], highpass));
  return as_steps(density, readings.rate / double(samples), 1);
}

std::optional<RecordedMotion> read_recorded(Node const& spec, bool rotation) {
  double const highpass = spec.number("highpass", dim::frequency, 0, 0);
  auto series = read_series(spec);
  if (!series) return {};
  Node const unit_at = spec.has("unit") ? spec["unit"] : spec["series"];
  auto const unit = parse_unit(series->unit);
  auto const calibration = read_calibration(spec, unit.value_or(Quantity{}), series->unit, false, rotation, unit_at);
  if (!calibration || !std::isfinite(highpass)) return {};
  if (calibration->derivatives > 0 && highpass == 0) {
    spec.problem("velocity and acceleration are integrated, and motion slower than the record grows without limit",
                 "add 'highpass: 0.05 Hz'; slower motion is removed");
    return {};
  }
  if (series->samples.size() < 32) {
    spec["series"].problem("the record has fewer than 32 samples", "give a longer one");
    return {};
  }
  if (highpass >= series->rate / 2) {
    spec["highpass"].problem(fmt::format("a high pass at {:g} Hz removes all of a record of {:g} samples per second",
                                         highpass, series->rate),
                             "write for example 0.05 Hz; slower motion is removed");
    return {};
  }
  auto const segment = read_segment(spec, series->duration(), highpass);
  double const lowest = std::max(highpass, segment ? 1 / *segment : 0);
  if (!segment || !covers(calibration->response, lowest, series->rate / 2, spec["calibration"])) return {};
  TimeSeries displacement = as_displacement(*series, *calibration, highpass);
  displacement.unit = rotation ? "rad" : "m";
  return RecordedMotion{std::make_shared<TimeSeries const>(std::move(displacement)),
                        displacement_spectrum(*series, *calibration, highpass, *segment)};
}

RecordedMotion channel_motion(TimeSeries const& series, bool rotation, double corner) {
  std::optional<int> const times = integrations_to(rotation ? dim::angle : dim::length, series.unit);
  if (!times)
    throw InputError(fmt::format("--channel: '{}' is in '{}', which is not a unit of {}", series.name, series.unit,
                                 rotation ? "angle" : "displacement, velocity or acceleration"),
                     fmt::format("write its unit: --unit {}", rotation ? "urad" : "um/s^2"));
  Calibration c;
  c.derivatives = *times;
  if (c.derivatives > 0 && corner <= 0)
    throw InputError(fmt::format("--channel: '{}' is in {} and must be integrated, which amplifies slow errors",
                                 series.name, series.unit),
                     "write --corner 0.05Hz; slower motion is removed");
  if (series.samples.size() < 32)
    throw InputError(fmt::format("--channel: '{}' has fewer than 32 samples", series.name), "choose a longer stretch");
  c.factor = parse_unit(series.unit)->si;
  TimeSeries displacement = as_displacement(series, c, corner);
  if (c.derivatives > 0) displacement = settled(displacement, corner);
  displacement.unit = rotation ? "rad" : "m";
  double const segment =
      std::max(std::min(series.duration() / 8, 128.0), std::min(series.duration(), 8 / std::max(corner, 1e-9)));
  return {std::make_shared<TimeSeries const>(std::move(displacement)),
          displacement_spectrum(series, c, corner, corner > 0 ? segment : std::min(series.duration() / 8, 128.0))};
}

void replace_coordinate(MotionSet& motion, BodyId body, int axis, RecordedMotion const& record) {
  for (MotionInput& input : motion.inputs)
    std::erase_if(input.gains, [&](Gain const& g) { return g.body == body && g.axis == axis; });
  MotionInput input;
  input.name = fmt::format("{} {}", motion.bodies[body.value], axis_names[axis]);
  input.recorded = record.displacement;
  input.spectrum = record.spectrum;
  input.gains = {{body, axis, 1, {}}};
  motion.inputs.push_back(std::move(input));
}

}  // namespace straytrace::motion
