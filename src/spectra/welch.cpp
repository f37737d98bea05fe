// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/welch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "spectra/filters.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::spectra {
namespace {

std::vector<double> mean_periodogram(std::span<double const> samples, Segments& segments) {
  std::vector<double> sum(segments.lines(), 0);
  for (std::size_t s = 0; s < segments.count(); ++s) {
    Complexes const& lines = segments.transform(samples, s);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::norm(lines[k]);
  }
  for (double& v : sum) v /= double(segments.count());
  return sum;
}

std::vector<double> median_periodogram(std::span<double const> samples, Segments& segments) {
  std::size_t const n = segments.count();
  std::vector<std::vector<double>> all(segments.lines(), std::vector<double>(n));
  for (std::size_t s = 0; s < n; ++s) {
    Complexes const& lines = segments.transform(samples, s);
    for (std::size_t k = 0; k < all.size(); ++k) all[k][s] = std::norm(lines[k]);
  }
  std::vector<double> median;
  for (std::vector<double>& values : all) {
    std::ranges::sort(values);
    median.push_back((values[n / 2] + values[(n - 1) / 2]) / 2 / median_bias(n));
  }
  return median;
}

// Variance of the mean over that of the median, both relative, of n independent periodograms. The order statistics of
// exponential variables are sums of independent ones with means 1/n, 1/(n-1), ... (Renyi).
double median_efficiency(std::size_t n) {
  std::size_t const low = (n + 1) / 2;  // the lower of the two in the middle
  double mean = 0, variance = 0;
  for (std::size_t i = 0; i < low; ++i) {
    double const step = 1 / double(n - i);
    mean += step;
    variance += step * step;
  }
  if (n % 2 == 0) {
    double const half = 0.5 / double(n - low);
    mean += half;
    variance += half * half;
  }
  return mean * mean / (double(n) * variance);
}

}  // namespace

double median_bias(std::size_t n) {  // scipy.signal.welch has the same; exact for even n too
  double bias = 1;
  for (std::size_t i = 2; i <= n - 1; i += 2) bias += 1 / double(i + 1) - 1 / double(i);
  return bias;
}

WelchSpectrum welch(std::span<double const> samples, double rate, WelchSettings const& s) {
  Segments segments(samples, rate, s);
  bool const median = s.average == Average::median;
  WelchSpectrum out;
  out.even = s.segment % 2 == 0;
  out.segments = segments.count();
  out.noise_bandwidth = segments.noise_bandwidth();
  out.effective_averages = segments.effective() * (median ? median_efficiency(segments.count()) : 1);
  out.psd = median ? median_periodogram(samples, segments) : mean_periodogram(samples, segments);
  for (std::size_t k = 0; k < out.psd.size(); ++k) {
    out.hz.push_back(segments.hz(k));
    out.psd[k] *= segments.density(k);
    out.sigma.push_back(out.psd[k] * std::sqrt((segments.is_real_line(k) ? 2 : 1) / out.effective_averages));
  }
  return out;
}

Interval confidence(WelchSpectrum const& s, double probability) {
  if (!(probability > 0 && probability < 1))
    throw InputError(fmt::format("a confidence of {:g} is not between 0 and 1", probability), "write for example 0.95");
  Interval out;
  double low[2], high[2];
  for (int real = 0; real < 2; ++real) {
    double const freedom = (real != 0 ? 1 : 2) * s.effective_averages;
    low[real] = freedom / chi_squared_quantile(freedom, (1 + probability) / 2);
    high[real] = freedom / chi_squared_quantile(freedom, (1 - probability) / 2);
  }
  for (std::size_t k = 0; k < s.psd.size(); ++k) {
    int const real = s.is_real_line(k) ? 1 : 0;
    out.low.push_back(s.psd[k] * low[real]);
    out.high.push_back(s.psd[k] * high[real]);
  }
  return out;
}

BandPower band_power(WelchSpectrum const& s, WelchSettings const& settings, double low, double high) {
  double const step = s.hz[1] - s.hz[0];
  if (!(low < high && high > 0 && low <= s.hz.back()))
    throw InputError(
        fmt::format("a band of {:g} Hz to {:g} Hz, where the spectrum has 0 to {:g} Hz", low, high, s.hz.back()),
        "choose it inside");
  BandPower out;
  double variance = 0;
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const from = std::max(0.0, s.hz[k] - step / 2),
                 to = s.is_real_line(k) && k > 0 ? s.hz[k] : s.hz[k] + step / 2;
    double const share = std::max(0.0, std::min(to, high) - std::max(from, low)) / (to - from);
    out.power += share * step * s.psd[k];
    variance += std::pow(share * step * s.sigma[k], 2);
  }
  double fourth = 0, second = 0;
  for (double const w : window_weights(settings.window, settings.window_parameter, settings.segment)) {
    second += w * w;
    fourth += w * w * w * w;
  }
  // Sum of the squared correlations between lines: the transform of w^2, by Parseval.
  double const shared = double(settings.segment) * fourth / (second * second);
  out.sigma = std::sqrt(variance * shared);
  return out;
}

double rms(std::span<double const> samples) {
  double sum = 0;
  for (double const x : samples) sum += x * x / double(samples.size());
  return std::sqrt(sum);
}

RmsTrend rms_trend(TimeSeries const& s, double low, double high, double stride) {
  auto const step = std::size_t(std::max(0.0, std::round(stride * s.rate)));
  if (step < 2 || step > s.samples.size())
    throw InputError(
        fmt::format("strides of {:g} s for '{}' of {:g} s at {:g} Hz", stride, s.name, s.duration(), s.rate),
        "choose between two samples and the length of the record");
  TimeSeries const band = band_passed(s, low, high);
  RmsTrend out;
  for (std::size_t i = 0; i + step <= band.samples.size(); i += step) {
    out.time.push_back(s.time(i) + double(step) / s.rate / 2);
    out.rms.push_back(rms(std::span(band.samples).subspan(i, step)));
    out.sigma.push_back(out.rms.back() / (2 * std::sqrt((high - low) * double(step) / s.rate)));
  }
  return out;
}

namespace {

void check(std::size_t samples, double rate, WelchSettings const& s) {
  if (s.segment < 2 || s.segment > samples)
    throw InputError(fmt::format("a segment of {} samples does not fit a series of {}", s.segment, samples),
                     fmt::format("choose between 2 and {}", samples));
  if (!(s.overlap >= 0 && s.overlap < 1))
    throw InputError(fmt::format("an overlap of {:g} is not a fraction", s.overlap), "choose from 0 to below 1");
  if (!(rate > 0 && rate < infinity))
    throw InputError(fmt::format("a sample rate of {:g} Hz", rate), "give a positive rate");
}

// Takes the mean, or the straight line of least squares, from the samples.
void remove_trend(std::vector<double>& x, Detrend detrend) {
  if (detrend == Detrend::none) return;
  double const n = double(x.size()), centre = (n - 1) / 2;
  double mean = 0, slope = 0;
  for (double const v : x) mean += v / n;
  for (std::size_t i = 0; detrend == Detrend::linear && i < x.size(); ++i)
    slope += (double(i) - centre) * (x[i] - mean);
  slope *= 12 / (n * (n * n - 1));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= mean + slope * (double(i) - centre);
}

}  // namespace

Segments::Segments(std::size_t samples, double rate, WelchSettings const& s) : settings_(s), rate_(rate) {
  check(samples, rate, s);
  // Whole samples of overlap, rounded down as int(share * segment) elsewhere.
  step_ = s.segment - std::size_t(std::floor(s.overlap * double(s.segment) + 1e-9));
  add_stretch(0, samples);
  weights_ = window_weights(s.window, s.window_parameter, s.segment);
  for (double const w : weights_) {
    sum_ += w;
    square_ += w * w;
  }
}

Segments::Segments(std::span<double const> samples, double rate, WelchSettings const& s)
    : Segments(samples.size(), rate, s) {
  begins_.clear();
  stretches_.clear();
  for (std::size_t from = 0, to = 0; from < samples.size(); from = to + 1) {
    for (to = from; to < samples.size() && !std::isnan(samples[to]);) ++to;
    add_stretch(from, to);
  }
  if (begins_.empty())
    throw InputError(
        fmt::format("no stretch without a gap is as long as a segment of {:g} s", double(s.segment) / rate),
        "choose a shorter segment, or other data");
}

void Segments::add_stretch(std::size_t from, std::size_t to) {
  std::size_t const before = begins_.size();
  for (std::size_t at = from; at + settings_.segment <= to; at += step_) begins_.push_back(at);
  if (begins_.size() > before) stretches_.push_back(begins_.size() - before);
}

double Segments::density(std::size_t line) const { return (is_real_line(line) ? 1 : 2) / (rate_ * square_); }

double Segments::effective() const {
  double sum = 1;
  double const all = double(count());
  std::size_t const longest = *std::ranges::max_element(stretches_);
  for (std::size_t m = 1; m < longest && m * step_ < weights_.size(); ++m) {
    double shared = 0;
    for (std::size_t i = m * step_; i < weights_.size(); ++i) shared += weights_[i] * weights_[i - m * step_];
    double apart = 0;  // segments without one m steps before
    for (std::size_t const n : stretches_) apart += double(std::min(m, n));
    sum += 2 * (1 - apart / all) * std::pow(shared / square_, 2);
  }
  return all / sum;
}

Complexes const& Segments::transform(std::span<double const> samples, std::size_t segment) {
  auto const from = samples.begin() + std::ptrdiff_t(begin(segment));
  part_.assign(from, from + std::ptrdiff_t(settings_.segment));
  remove_trend(part_, settings_.detrend);
  for (std::size_t i = 0; i < part_.size(); ++i) part_[i] *= weights_[i];
  return fourier_.forward(part_);
}

CrossSpectra cross_spectra(std::span<double const> x, std::span<double const> y, double rate, WelchSettings const& s) {
  if (x.size() != y.size())
    throw InputError(fmt::format("records of {} and {} samples", x.size(), y.size()), "cut both to the same stretch");
  if (s.average != Average::mean) throw InputError("cross spectra are averaged by their mean", "write --average mean");
  std::vector<double> of_both(x.begin(), x.end());  // NaN where either is
  for (std::size_t i = 0; i < y.size(); ++i)
    if (std::isnan(y[i])) of_both[i] = y[i];
  Segments of_x(of_both, rate, s), of_y(of_both, rate, s);
  CrossSpectra out;
  out.segments = of_x.count();
  out.effective_averages = of_x.effective();
  out.noise_bandwidth = of_x.noise_bandwidth();
  std::size_t const lines = of_x.lines();
  out.input.assign(lines, 0);
  out.output.assign(lines, 0);
  out.cross.assign(lines, 0);
  for (std::size_t i = 0; i < out.segments; ++i) {
    Complexes const &a = of_x.transform(x, i), &b = of_y.transform(y, i);
    for (std::size_t k = 0; k < lines; ++k) {
      out.input[k] += std::norm(a[k]);
      out.output[k] += std::norm(b[k]);
      out.cross[k] += std::conj(a[k]) * b[k];
    }
  }
  for (std::size_t k = 0; k < lines; ++k) {
    double const scale = of_x.density(k) / double(out.segments);
    out.hz.push_back(of_x.hz(k));
    out.input[k] *= scale;
    out.output[k] *= scale;
    out.cross[k] *= scale;
  }
  return out;
}

CrossSpectra cross_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const& s) {
  std::vector<TimeSeries> const both = aligned({x, y});
  return cross_spectra(both[0].samples, both[1].samples, both[0].rate, s);
}

std::vector<double> coherence(CrossSpectra const& s) {
  std::vector<double> c;
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    double const powers = s.input[k] * s.output[k];
    c.push_back(powers > 0 ? std::min(1.0, std::norm(s.cross[k]) / powers) : not_a_number);
  }
  return c;
}

double coherence_level(double n, double probability) {
  if (!(probability > 0 && probability < 1))
    throw InputError(fmt::format("a significance of {:g} is not between 0 and 1", probability),
                     "write for example 0.05");
  return n > 1 ? 1 - std::pow(probability, 1 / (n - 1)) : 1;
}

double confidence_radius(double c, double n, double probability) {
  if (!(n > 1 && c > 0)) return infinity;
  return std::sqrt((std::pow(1 - probability, -1 / (n - 1)) - 1) * std::max(0.0, 1 - c) / c);
}

Interval coherence_interval(std::span<double const> c, double n, double probability) {
  Interval out;
  double const z = n > 1 ? normal_quantile((1 + probability) / 2) / std::sqrt(2 * (n - 1)) : infinity;
  for (double const value : c) {
    double const w = std::atanh(std::min(std::sqrt(value), 1 - 1e-15));
    out.low.push_back(std::pow(std::tanh(std::max(0.0, w - z)), 2));
    out.high.push_back(std::pow(std::tanh(w + z), 2));
  }
  return out;
}

namespace {

TransferEstimate estimate(CrossSpectra const& s, bool first) {
  TransferEstimate t{s.hz, {}, {}, {}, coherence(s), s.effective_averages};
  for (std::size_t k = 0; k < s.hz.size(); ++k) {
    std::complex<double> const h = first ? s.cross[k] / s.input[k] : s.output[k] / std::conj(s.cross[k]);
    double const c = t.coherence[k], relative = std::sqrt((1 - c) / (2 * c * s.effective_averages));
    t.value.push_back(h);
    t.modulus_sigma.push_back(std::abs(h) * relative);
    t.phase_sigma.push_back(std::isnan(relative) ? relative : std::min(relative, pi / std::sqrt(3.0)));
  }
  return t;
}

}  // namespace

TransferEstimate h1(CrossSpectra const& s) { return estimate(s, true); }
TransferEstimate h2(CrossSpectra const& s) { return estimate(s, false); }

namespace {

struct Known {
  std::string_view name;
  Window window;
};
constexpr std::array known{Known{"hann", Window::hann},         Known{"hamming", Window::hamming},
                           Known{"blackman", Window::blackman}, Known{"blackmanharris", Window::blackman_harris},
                           Known{"flattop", Window::flat_top},  Known{"tukey", Window::tukey},
                           Known{"kaiser", Window::kaiser},     Known{"rectangular", Window::rectangular}};

// sum of (-1)^j a_j cos(2 pi j turn)
double cosines(std::span<double const> a, double turn) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (j % 2 == 0 ? 1 : -1) * a[j] * std::cos(2 * pi * double(j) * turn);
  return sum;
}

constexpr std::array hann{0.5, 0.5}, hamming{0.54, 0.46};
constexpr std::array blackman{0.42, 0.5, 0.08};
constexpr std::array blackman_harris{0.35875, 0.48829, 0.14128, 0.01168};  // Harris 1978, -92 dB
constexpr std::array flat_top{0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368};

double tukey(double share, double turn) {
  double const edge = std::min(turn, 1 - turn);
  return share > 0 && edge < share / 2 ? 0.5 - 0.5 * std::cos(2 * pi * edge / share) : 1;
}

double weight(Window window, double parameter, double turn) {  // turn: place in the segment, 0 to 1
  switch (window) {
    case Window::rectangular:
      return 1;
    case Window::hann:
      return cosines(hann, turn);
    case Window::hamming:
      return cosines(hamming, turn);
    case Window::blackman:
      return cosines(blackman, turn);
    case Window::blackman_harris:
      return cosines(blackman_harris, turn);
    case Window::flat_top:
      return cosines(flat_top, turn);
    case Window::tukey:
      return tukey(parameter, turn);
    case Window::kaiser:
      return std::cyl_bessel_i(0, parameter * std::sqrt(4 * turn * (1 - turn))) / std::cyl_bessel_i(0, parameter);
  }
  return not_a_number;
}

[[noreturn]] void refuse(std::string const& text, std::string const& suggestion) {
  throw InputError(fmt::format("'{}' is not a window", text), suggestion);
}

double parameter_of(Window window, std::string const& text, std::string const& inside) {
  double value = 0;
  auto const [end, code] = std::from_chars(inside.data(), inside.data() + inside.size(), value);
  bool const number = code == std::errc() && end == inside.data() + inside.size();
  if (window == Window::tukey && !(number && value >= 0 && value <= 1))
    refuse(text, "the tapered share is from 0 to 1: tukey(0.25)");
  if (window == Window::kaiser && !(number && value >= 0 && value <= 100))
    refuse(text, "beta is from 0 to 100: kaiser(14)");
  return value;
}

}  // namespace

std::vector<double> window_weights(Window window, double parameter, std::size_t samples) {
  std::vector<double> w(samples);
  for (std::size_t i = 0; i < samples; ++i) w[i] = weight(window, parameter, double(i) / double(samples));
  return w;
}

NamedWindow parse_window(std::string const& text) {
  auto const bracket = text.find('(');
  std::string const name = text.substr(0, bracket);
  std::vector<std::string> names;
  for (Known const& k : known) {
    names.emplace_back(k.name);
    if (name != k.name) continue;
    bool const takes = k.window == Window::tukey || k.window == Window::kaiser;
    if (bracket == text.npos && k.window == Window::kaiser) refuse(text, "it needs its beta: kaiser(14)");
    if (bracket == text.npos) return {k.window, k.window == Window::tukey ? 0.5 : 0};
    if (!takes || text.back() != ')') refuse(text, fmt::format("write {}", takes ? name + "(0.25)" : name));
    return {k.window, parameter_of(k.window, text, text.substr(bracket + 1, text.size() - bracket - 2))};
  }
  refuse(text, did_you_mean(name, names, fmt::format("there are {}", fmt::join(names, ", "))));
}

std::string window_text(NamedWindow w) {
  for (Known const& k : known)
    if (k.window == w.window) {
      bool const takes = k.window == Window::tukey || k.window == Window::kaiser;
      return takes ? fmt::format("{}({:g})", k.name, w.parameter) : std::string(k.name);
    }
  return "";
}

namespace {

double median(std::vector<double> v) {
  auto const middle = v.begin() + std::ptrdiff_t(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  if (v.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(v.begin(), middle)) / 2;
}

// Centres of rows such that a line between two of them loses no more than `mismatch` (Chatterji et al. 2004, eq. 14).
std::vector<double> rows(QSettings const& s) {
  double const length = std::log(s.high_hz / s.low_hz) * std::sqrt(2 + s.q * s.q) / 2;
  auto const count = std::size_t(std::max(1.0, std::ceil(length / (2 * std::sqrt(s.mismatch / 3)))));
  std::vector<double> hz;
  for (std::size_t i = 0; i < count; ++i)
    hz.push_back(s.low_hz * std::pow(s.high_hz / s.low_hz, (double(i) + 0.5) / double(count)));
  return hz;
}

void check(TimeSeries const& s, QSettings const& q) {
  if (!(q.q >= 3.4 && q.q < 1000))  // below sqrt(11) the window would reach zero frequency
    throw InputError(fmt::format("a Q of {:g}", q.q), "choose from 3.4 to 1000");
  double const reach = 1 + std::sqrt(11) / q.q;
  if (!(q.low_hz > 0 && q.low_hz < q.high_hz && q.high_hz * reach <= s.rate / 2))
    throw InputError(fmt::format("a Q transform from {:g} Hz to {:g} Hz of a record sampled at {:g} Hz", q.low_hz,
                                 q.high_hz, s.rate),
                     fmt::format("with Q {:g} the band must be between 0 and {:.4g} Hz", q.q, s.rate / 2 / reach));
  if (s.duration() * q.low_hz < 2 * q.q)
    throw InputError(fmt::format("{:g} s are too short for Q {:g} at {:g} Hz", s.duration(), q.q, q.low_hz),
                     "choose a longer span, a smaller Q or a higher band");
}

// Energy of one row at `count` times over the record.
std::vector<double> energies(Complexes const& lines, double duration, double hz, double q, std::size_t count) {
  double const half = std::sqrt(11) * hz / q;
  auto const from = std::ptrdiff_t(std::ceil((hz - half) * duration)),
             to = std::ptrdiff_t(std::floor((hz + half) * duration));
  Complexes shifted(count, 0), tiles;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(from, 0); k <= to && k < std::ptrdiff_t(lines.size()); ++k) {
    double const x = (double(k) / duration - hz) / half;
    shifted[std::size_t(k - from) % count] = lines[std::size_t(k)] * std::pow(1 - x * x, 2);
  }
  Fourier().inverse(shifted, tiles);
  std::vector<double> energy;
  for (auto const& t : tiles) energy.push_back(std::norm(t));
  double const usual = median(energy) / std::log(2);
  for (double& e : energy) e /= usual;
  return energy;
}

}  // namespace

Spectrogram spectrogram(TimeSeries const& s, double stride, WelchSettings const& settings) {
  auto const step = std::size_t(std::max(0.0, std::round(stride * s.rate)));
  if (step < settings.segment || step > s.samples.size())
    throw InputError(fmt::format("strides of {:g} s do not match segments of {:g} s and a record of {:g} s", stride,
                                 double(settings.segment) / s.rate, s.duration()),
                     "a stride must hold at least one segment and fit into the record");
  Spectrogram out;
  for (std::size_t i = 0; i + step <= s.samples.size(); i += step) {
    WelchSpectrum const part = welch(std::span(s.samples).subspan(i, step), s.rate, settings);
    out.hz = part.hz;
    out.time.push_back(s.time(i) + double(step) / s.rate / 2);
    for (double const p : part.psd) out.value.push_back(std::sqrt(p));
  }
  return out;
}

Spectrogram overlapping_spectrogram(TimeSeries const& series, double stride) {
  auto const n = std::size_t(std::lround(stride * series.rate)), step = std::max<std::size_t>(1, n / 2);
  if (n < 8 || n > series.samples.size())
    throw InputError(fmt::format("--stride: {:g} s hold {} samples of {}", stride, n, series.samples.size()),
                     fmt::format("choose between {:.3g} s and {:g} s", 8 / series.rate, series.duration()));
  Spectrogram out;
  WelchSettings settings;
  settings.segment = n;
  for (std::size_t from = 0; from + n <= series.samples.size(); from += step) {
    WelchSpectrum const w = welch(std::span(series.samples).subspan(from, n), series.rate, settings);
    out.time.push_back(series.time(from) + stride / 2);
    if (from == 0) out.hz.assign(w.hz.begin() + 1, w.hz.end());
    for (std::size_t k = 1; k < w.psd.size(); ++k) out.value.push_back(std::sqrt(w.psd[k]));
  }
  return out;
}

Spectrogram normalised(Spectrogram s) {
  std::size_t const lines = s.hz.size();
  for (std::size_t k = 0; k < lines; ++k) {
    std::vector<double> over_time;
    for (std::size_t i = 0; i < s.time.size(); ++i) over_time.push_back(s.at(i, k));
    double const usual = median(over_time);
    for (std::size_t i = 0; i < s.time.size(); ++i) s.value[i * lines + k] /= usual;
  }
  return s;
}

Spectrogram q_transform(TimeSeries const& s, QSettings const& q) {
  check(s, q);
  std::vector<double> padded = s.samples;  // to a good length: the few samples more are left out of the picture
  padded.resize(good_length(padded.size()), 0);
  double const duration = double(padded.size()) / s.rate;
  Fourier fourier;
  Complexes const& lines = fourier.forward(padded);
  double const widest = 2 * std::sqrt(11) * q.high_hz / q.q * duration;
  std::size_t const fine = good_length(std::max<std::size_t>(std::size_t(widest) + 2, 64));
  Spectrogram out;
  out.hz = rows(q);
  auto const cells = std::size_t(std::min(double(q.columns), double(fine) * s.duration() / duration));
  for (std::size_t i = 0; i < cells; ++i)
    out.time.push_back(s.start + (double(i) + 0.5) / double(cells) * s.duration());
  out.value.assign(cells * out.hz.size(), 0);
  for (std::size_t row = 0; row < out.hz.size(); ++row) {
    std::vector<double> const energy = energies(lines, duration, out.hz[row], q.q, fine);
    for (std::size_t j = 0; j < fine; ++j) {
      double const time = double(j) / double(fine) * duration;
      auto const cell = std::size_t(time / s.duration() * double(cells));
      if (cell >= cells) continue;
      double& largest = out.value[cell * out.hz.size() + row];
      largest = std::max(largest, energy[j]);
    }
  }
  return out;
}

}  // namespace straytrace::spectra
