// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/spectrogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::spectra {
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
