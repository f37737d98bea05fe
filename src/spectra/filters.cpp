// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/filters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::spectra {
namespace {

using C = std::complex<double>;
constexpr double rounding = 1e-9;  // relative: allows for the rounding of printed frequencies

bool covers(std::vector<double> const& samples, double hz) {
  return hz >= samples.front() * (1 - rounding) && hz <= samples.back() * (1 + rounding);
}

}  // namespace

TransferFunction::TransferFunction(std::string name, std::vector<double> hz, std::vector<C> values) : gain_(1) {
  Table t{std::move(name), std::move(hz), {}, {}};
  for (C const& v : values) {
    t.log_modulus.push_back(std::log(std::abs(v)));
    double const turn = t.phase.empty() ? 0 : std::remainder(std::arg(v) - t.phase.back(), 2 * pi);
    t.phase.push_back(t.phase.empty() ? std::arg(v) : t.phase.back() + turn);
  }
  tables_.push_back(std::move(t));
}

TransferFunction TransferFunction::oscillator(double hz, double quality, Response response) {
  TransferFunction t({}, {}, 1);
  t.oscillators_.push_back({hz, quality, response});
  return t;
}

TransferFunction TransferFunction::product(TransferFunction const& a, TransferFunction const& b) {
  TransferFunction both = a;
  auto const append = [](auto& to, auto const& more) { to.insert(to.end(), more.begin(), more.end()); };
  append(both.zeros_, b.zeros_);
  append(both.poles_, b.poles_);
  append(both.oscillators_, b.oscillators_);
  append(both.tables_, b.tables_);
  both.gain_ *= b.gain_;
  both.delay_ += b.delay_;
  return both;
}

C TransferFunction::operator()(double hz) const {
  C value = gain_;
  C const s{0, -hz};
  for (double const z : zeros_) value *= z == 0 ? s : 1.0 + s / z;
  for (double const p : poles_) value /= p == 0 ? s : 1.0 + s / p;
  for (Oscillator const& o : oscillators_) {
    double const x = hz / o.hz;
    C const drag{0, -x / o.quality};
    C const above = o.response == Response::support ? 1.0 + drag : o.response == Response::relative ? x * x : 1;
    value *= above / (1 - x * x + drag);
  }
  for (Table const& t : tables_) value *= t(hz);
  if (delay_ != 0) value *= std::polar(1.0, 2 * pi * hz * delay_);
  return value;
}

C TransferFunction::Table::operator()(double f) const {
  if (!covers(hz, f) && !holds)
    throw InputError(
        fmt::format("'{}' covers {:g} Hz to {:g} Hz, not the requested {:g} Hz", name, hz.front(), hz.back(), f),
        "give a file that covers the band, or choose 'band' in 'noise' inside it");
  if (holds) f = std::clamp(f, hz.front(), hz.back());
  auto const above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(hz, f) - hz.begin(), 1, std::ssize(hz) - 1);
  auto const b = std::size_t(above), a = b - 1;
  double const share = log_share(f, hz[a], hz[b]);
  return std::polar(std::exp(std::lerp(log_modulus[a], log_modulus[b], share)), std::lerp(phase[a], phase[b], share));
}

TransferFunction TransferFunction::delayed(double seconds) const {
  TransferFunction t = *this;
  t.delay_ += seconds;
  return t;
}

TransferFunction TransferFunction::holding_ends() const {
  TransferFunction t = *this;
  for (Table& table : t.tables_) table.holds = true;
  return t;
}

Band TransferFunction::range() const {
  Band range{0, infinity};
  for (Table const& t : tables_)
    if (!t.holds) range = {std::max(range.low, t.hz.front()), std::min(range.high, t.hz.back())};
  return range;
}

std::vector<double> TransferFunction::features() const {
  std::vector<double> hz = zeros_;
  hz.insert(hz.end(), poles_.begin(), poles_.end());
  for (Oscillator const& o : oscillators_) hz.push_back(o.hz);
  for (Table const& t : tables_) hz.insert(hz.end(), t.hz.begin(), t.hz.end());
  return hz;
}

TransferFunction read_response_file(Node const& file, bool decibels, std::optional<Band> const& band) {
  auto const table = read_numbers(file, 3,
                                  decibels ? "write frequency in Hz, modulus in dB, phase in degrees"
                                           : "write frequency in Hz, real part, imaginary part");
  if (!table) return {};
  std::string const& name = file.text();
  std::vector<double> hz;
  std::vector<C> values;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    double const f = table->column[0][i], a = table->column[1][i], b = table->column[2][i];
    C const value = decibels ? std::polar(std::pow(10, a / 20), -b * pi / 180) : C(a, -b);
    if (!(f > (hz.empty() ? 0 : hz.back())) || value == 0.0) {
      file.file_problem(name, table->line[i], 1,
                        value == 0.0 ? "a response of zero has no logarithm" : "frequencies must be positive and rise",
                        value == 0.0 ? "remove the line" : "sort the lines by frequency, each one once");
      return {};
    }
    hz.push_back(f);
    values.push_back(value);
  }
  if (hz.size() < 2) {
    file.file_problem(name, 0, 0, "a response needs at least two frequencies", "give more lines: Hz and two numbers");
    return {};
  }
  if (band && (!covers(hz, band->low) || !covers(hz, band->high)))
    file.problem(fmt::format("'{}' covers {:g} Hz to {:g} Hz, and the band of the noise needs {:.4g} Hz to {:.4g} Hz",
                             name, hz.front(), hz.back(), band->low, band->high),
                 "give a file that covers the band, or choose 'band' in 'noise' inside it");
  return {name, std::move(hz), std::move(values)};
}

bool read_columns_are_decibels(Node const& table) {
  std::string columns;
  for (Node const& word : table.list("columns")) columns += word.text() + " ";
  if (columns == "Hz dB deg ") return true;
  if (columns != "Hz re im ")
    (table.has("columns") ? table["columns"] : table)
        .problem("name the columns of the file", "write 'columns: [Hz, re, im]' or 'columns: [Hz, dB, deg]'");
  return false;
}

TransferFunction read_transfer_function(Node const& table, std::optional<Band> const& band) {
  if (table.kind() != Node::Kind::table) {
    table.problem("a transfer function is a table", "write {gain: 1000, poles: [10 Hz]} or {file: loop.txt}");
    return {};
  }
  if (Node const file = table["file"]) {
    bool const decibels = read_columns_are_decibels(table);
    table.refuse_unknown("a transfer function");
    return read_response_file(file, decibels, band);
  }
  std::vector<double> roots[2];
  for (int i : {0, 1})
    if (Node const list = table[i == 0 ? "zeros" : "poles"])
      for (Node const& root : list.as_list()) roots[i].push_back(root.as_number(dim::frequency, 0));
  double const gain = table.number("gain", dim::plain);
  table.refuse_unknown("a transfer function");
  return {roots[0], roots[1], gain};
}

namespace {

constexpr double attenuation = 80;  // dB, of the anti-alias filter
constexpr double passed = 0.8;      // of the new Nyquist frequency

// Half of a symmetric low pass with unit gain at 0, from its centre on; `edge`: share of half the old rate where it is
// 6 dB down, `width` of the transition likewise (Kaiser 1974).
std::vector<double> low_pass(double edge, double width) {
  auto const half = std::size_t(std::ceil((attenuation - 7.95) / (2.285 * pi * width) / 2));
  double const beta = 0.1102 * (attenuation - 8.7), top = std::cyl_bessel_i(0, beta);
  std::vector<double> taps;
  double sum = 0;
  for (std::size_t i = 0; i <= half; ++i) {
    double const x = double(i), share = x / double(half + 1);
    double const sinc = i == 0 ? edge : std::sin(pi * edge * x) / (pi * x);
    taps.push_back(sinc * std::cyl_bessel_i(0, beta * std::sqrt(1 - share * share)) / top);
    sum += (i == 0 ? 1 : 2) * taps.back();
  }
  for (double& t : taps) t /= sum;
  return taps;
}

// Odd reflection continues the record beyond its ends without a step of value or slope.
double reflected(std::vector<double> const& x, std::ptrdiff_t i) {
  auto const last = std::ptrdiff_t(x.size()) - 1;
  if (i < 0) return 2 * x.front() - x[std::size_t(std::min(-i, last))];
  if (i > last) return 2 * x.back() - x[std::size_t(std::max<std::ptrdiff_t>(2 * last - i, 0))];
  return x[std::size_t(i)];
}

}  // namespace

TimeSeries decimated(TimeSeries const& s, std::size_t factor, std::size_t first) {
  if (factor == 0 || first >= s.samples.size())
    throw InputError(fmt::format("'{}' cannot be decimated by {}", s.name, factor), "the factor is at least 1");
  TimeSeries out{s.name, s.unit, s.time(first), s.rate / double(factor), {}};
  std::vector<double> const taps =
      factor == 1 ? std::vector<double>{1} : low_pass((1 + passed) / 2 / double(factor), (1 - passed) / double(factor));
  for (std::size_t i = first; i < s.samples.size(); i += factor) {
    double sum = taps[0] * s.samples[i];
    for (std::size_t j = 1; j < taps.size(); ++j) {
      auto const at = std::ptrdiff_t(i), step = std::ptrdiff_t(j);
      sum += taps[j] * (reflected(s.samples, at - step) + reflected(s.samples, at + step));
    }
    out.samples.push_back(sum);
  }
  return out;
}

TimeSeries band_passed(TimeSeries const& s, double low_hz, double high_hz, int order) {
  double const nyquist = s.rate / 2;
  if (!(low_hz >= 0 && low_hz < high_hz && high_hz <= nyquist))
    throw InputError(fmt::format("a band of {:g} Hz to {:g} Hz for '{}'", low_hz, high_hz, s.name),
                     fmt::format("choose it between 0 and {:g} Hz, half the sample rate", nyquist));
  if (low_hz == 0 && high_hz == nyquist) return s;
  TimeSeries out = s;
  out.samples = both_ways(butterworth(order, low_hz / nyquist, high_hz / nyquist), s.samples);
  return out;
}

TimeSeries notched(TimeSeries const& s, double hz, double quality) {
  if (!(hz > 0 && hz < s.rate / 2 && quality > 0))
    throw InputError(fmt::format("a notch at {:g} Hz with Q {:g} for '{}'", hz, quality, s.name),
                     fmt::format("choose it between 0 and {:g} Hz, half the sample rate", s.rate / 2));
  TimeSeries out = s;
  out.samples = both_ways({notch(2 * hz / s.rate, quality)}, s.samples);
  return out;
}

namespace {

using C = std::complex<double>;

// Poles of the analog filter with edges `low`, `high` in rad/s; one of each conjugate pair, or both of a real pair.
std::vector<C> analog_poles(int order, double low, double high, bool band) {
  std::vector<C> poles;
  for (int k = 0; k < order; ++k) {
    C const p = std::polar(1.0, pi / 2 + pi * (2 * k + 1) / (2.0 * order));  // low pass with edge 1
    if (!band) {
      poles.push_back(low > 0 ? low / p : high * p);
      continue;
    }
    C const middle = p * (high - low) / 2.0, split = std::sqrt(middle * middle - low * high);
    poles.push_back(middle + split);
    poles.push_back(middle - split);
  }
  return poles;
}

C digital(C analog) { return (1.0 + analog / 2.0) / (1.0 - analog / 2.0); }

// One section for each conjugate pair, one for two real poles or one that is left.
std::vector<Section> paired(std::vector<C> const& poles) {
  std::vector<Section> sections;
  std::vector<double> real;
  for (C const& z : poles) {
    if (std::abs(z.imag()) < 1e-12 * std::abs(z))
      real.push_back(z.real());
    else if (z.imag() > 0)
      sections.push_back({{1, 0, 0}, {-2 * z.real(), std::norm(z)}});
  }
  for (std::size_t i = 0; i < real.size(); i += 2)
    if (i + 1 < real.size())
      sections.push_back({{1, 0, 0}, {-real[i] - real[i + 1], real[i] * real[i + 1]}});
    else
      sections.push_back({{1, 0, 0}, {-real[i], 0}});
  return sections;
}

double gain_at(std::vector<Section> const& sections, C z) {
  C h = 1;
  for (Section const& s : sections)
    h *= (s.b[0] + s.b[1] / z + s.b[2] / (z * z)) / (1.0 + s.a[0] / z + s.a[1] / (z * z));
  return std::abs(h);
}

// State after an endless input of 1 (transposed direct form II).
std::array<double, 2> settled(Section const& s) {
  double const out = (s.b[0] + s.b[1] + s.b[2]) / (1 + s.a[0] + s.a[1]);
  double const second = s.b[2] - s.a[1] * out;
  return {s.b[1] - s.a[0] * out + second, second};
}

void run(Section const& s, std::vector<double>& x, std::array<double, 2> state) {
  for (double& v : x) {
    double const y = s.b[0] * v + state[0];
    state[0] = s.b[1] * v - s.a[0] * y + state[1];
    state[1] = s.b[2] * v - s.a[1] * y;
    v = y;
  }
}

// From the steady state of a constant input equal to the first sample.
void run_settled(std::vector<Section> const& sections, std::vector<double>& x) {
  double held = x.front();
  for (Section const& s : sections) {
    std::array<double, 2> state = settled(s);
    for (double& v : state) v *= held;
    held *= (s.b[0] + s.b[1] + s.b[2]) / (1 + s.a[0] + s.a[1]);
    run(s, x, state);
  }
}

std::size_t padding(std::vector<Section> const& sections) {
  auto const count = [&](auto const& is_zero) { return std::size_t(std::ranges::count_if(sections, is_zero)); };
  std::size_t const no_b = count([](Section const& s) { return s.b[2] == 0; });
  std::size_t const no_a = count([](Section const& s) { return s.a[1] == 0; });
  return 3 * (2 * sections.size() + 1 - std::min(no_a, no_b));
}

}  // namespace

std::vector<Section> butterworth(int order, double low, double high) {
  if (order < 1 || order > 12) throw InputError(fmt::format("a filter of order {}", order), "choose from 1 to 12");
  bool const low_pass = low <= 0, high_pass = high >= 1, band = !low_pass && !high_pass;
  double const w_low = low_pass ? 0 : 2 * std::tan(pi * low / 2), w_high = high_pass ? 0 : 2 * std::tan(pi * high / 2);
  std::vector<C> poles = analog_poles(order, w_low, w_high, band);
  std::transform(poles.begin(), poles.end(), poles.begin(), digital);
  std::vector<Section> sections = paired(poles);
  for (Section& s : sections) {
    bool const first_order = s.a[1] == 0;
    double const sign = low_pass ? 1 : -1;  // zeros at -1, at 1, or at both
    s.b = first_order ? std::array{1.0, sign, 0.0} : band ? std::array{1.0, 0.0, -1.0} : std::array{1.0, 2 * sign, 1.0};
  }
  C const middle = low_pass ? C(1) : high_pass ? C(-1) : digital(C(0, std::sqrt(w_low * w_high)));
  double const share = std::pow(gain_at(sections, middle), -1.0 / double(sections.size()));
  for (Section& s : sections)
    for (double& b : s.b) b *= share;
  return sections;
}

Section notch(double share, double quality) {
  double const w = pi * share, beta = std::tan(w / quality / 2), gain = 1 / (1 + beta);
  return {{gain, -2 * gain * std::cos(w), gain}, {-2 * gain * std::cos(w), 2 * gain - 1}};
}

std::vector<double> once(std::vector<Section> const& sections, std::vector<double> x) {
  for (Section const& s : sections) run(s, x, {0, 0});
  return x;
}

std::vector<double> both_ways(std::vector<Section> const& sections, std::vector<double> const& x) {
  std::size_t const pad = padding(sections), n = x.size();
  if (n <= pad)
    throw InputError(fmt::format("{} samples are too few for a filter that needs {}", n, pad + 1),
                     "choose a longer span");
  std::vector<double> y;
  for (std::size_t i = pad; i > 0; --i) y.push_back(2 * x.front() - x[i]);
  y.insert(y.end(), x.begin(), x.end());
  for (std::size_t i = 1; i <= pad; ++i) y.push_back(2 * x.back() - x[n - 1 - i]);
  for (int way = 0; way < 2; ++way) {
    run_settled(sections, y);
    std::ranges::reverse(y);
  }
  return {y.begin() + std::ptrdiff_t(pad), y.end() - std::ptrdiff_t(pad)};
}

namespace {

// Removes the mean and tapers both ends to zero over this many samples: a step there would hide weak lines.
std::vector<double> faded(std::vector<double> x, std::size_t length) {
  double const mean = std::accumulate(x.begin(), x.end(), 0.0) / double(x.size());
  for (double& v : x) v -= mean;
  for (std::size_t i = 0; i < std::min(length, x.size() / 2); ++i) {
    double const share = std::pow(std::sin(pi / 2 * (double(i) + 0.5) / double(length)), 2);
    x[i] *= share;
    x[x.size() - 1 - i] *= share;
  }
  return x;
}

}  // namespace

TimeSeries whitened(TimeSeries const& s, WelchSettings const& settings) {
  WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
  double const step = spectrum.hz[1];
  if (std::any_of(spectrum.psd.begin() + 1, spectrum.psd.end(), [](double p) { return !(p > 0); }))
    throw InputError(fmt::format("'{}' has no power at some frequencies, so it cannot be whitened", s.name),
                     "choose a stretch with signal");
  TimeSeries out = s;
  out.unit = "1";
  out.samples = filtered(faded(s.samples, settings.segment / 2), 0, [&](double cycles) -> std::complex<double> {
    double const f = cycles * s.rate, line = f / step;
    if (line < 1) return 0;
    auto const k = std::min(std::size_t(line), spectrum.psd.size() - 2);
    bool const doubled = spectrum.is_real_line(k + 1);  // the last line is not; its neighbour below is
    double const last = spectrum.psd[k + 1] * (doubled ? 2 : 1);
    double const asd = std::lerp(std::sqrt(spectrum.psd[k]), std::sqrt(last), std::min(1.0, line - double(k)));
    return std::sqrt(2 / s.rate) / asd;
  });
  return out;
}

}  // namespace straytrace::spectra
