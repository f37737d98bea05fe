// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/fringes/fringe_fit.hpp"
#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "spectra/fourier.hpp"
#include "spectra/series.hpp"

namespace straytrace::analysis {
namespace {

constexpr double taper_share = 0.05;  // of the stretch, at either end

double taper(double turn) {
  double const edge = std::min(turn, 1 - turn) / taper_share;
  return edge >= 1 ? 1 : 0.5 - 0.5 * std::cos(pi * edge);
}

std::size_t smooth_below(std::size_t n) {
  while (n > 1 && !has_fast_transform(n)) --n;
  return n;
}

// The coarsest sampling of the model whose aliases stay outside the band.
std::size_t decimation(double rate, FringeFrame const& frame) {
  double const needed = std::max(2.2 * frame.high, 1.1 * frame.highest_fringe + frame.high + 20);
  auto factor = std::size_t(std::max(1.0, std::floor(rate / needed)));
  return smooth_below(factor);
}

// Less the straight line of least squares, under the taper.
std::vector<std::complex<double>> prepared(double const* x, std::size_t n) {
  double mean = 0, slope = 0, square = 0;
  for (std::size_t i = 0; i < n; ++i) mean += x[i] / double(n);
  for (std::size_t i = 0; i < n; ++i) {
    double const t = double(i) - 0.5 * double(n - 1);
    slope += t * (x[i] - mean);
    square += t * t;
  }
  slope /= square;
  std::vector<std::complex<double>> out(n);
  for (std::size_t i = 0; i < n; ++i)
    out[i] = taper(double(i) / double(n)) * (x[i] - mean - slope * (double(i) - 0.5 * double(n - 1)));
  return out;
}

std::vector<std::complex<double>> transform(std::vector<std::complex<double>> const& x) {
  thread_local Fourier fourier;
  std::vector<std::complex<double>> lines;
  fourier.forward(x, lines);
  return lines;
}

}  // namespace

double fastest_motion(FringeRecords const& records, double ratio) {
  double fastest = 0;
  for (std::size_t w = 0; w < records.witnesses.size(); ++w) {
    TimeSeries const& x = records.witnesses[w];
    double own = 0;
    for (std::size_t i = 1; i < x.samples.size(); ++i)
      own = std::max(own, std::fabs(x.samples[i] - x.samples[i - 1]) * x.rate);
    fastest += own * (w ? std::fabs(ratio) : 1);
  }
  return fastest;
}

FringeStretch::FringeStretch(FringeRecords const& records, std::size_t from, std::size_t to, FringeFrame const& frame)
    : records_(records), frame_(frame) {
  TimeSeries const& h = records.target;
  std::size_t const factor = decimation(h.rate, frame);
  samples_ = smooth_below((to - from) / factor);
  rate_ = h.rate / double(factor);
  start_ = h.time(from);
  duration_ = double(samples_) / rate_;
  first_line_ = std::size_t(std::ceil(frame.low * duration_));
  auto const end = std::min(std::size_t(std::floor(frame.high * duration_)), samples_ / 2 - 1);
  for (std::size_t k = first_line_; k <= end; ++k) hz_.push_back(double(k) / duration_);
  if (hz_.size() < 8)
    throw InputError(fmt::format("{:.3g} s hold {} lines between {:g} and {:g} Hz, too few to fit", duration_,
                                 hz_.size(), frame.low, frame.high),
                     "give a longer stretch or a wider band");
  double fourth = 0;
  for (std::size_t i = 0; i < samples_; ++i) {
    taper_.push_back(taper(double(i) / double(samples_)));
    weight_ += taper_[i] * taper_[i] / double(samples_);
    fourth += std::pow(taper_[i], 4) / double(samples_);
  }
  independent_ = weight_ * weight_ / fourth;
  auto const lines = transform(prepared(h.samples.data() + from, samples_ * factor));
  target_.resize(Eigen::Index(hz_.size()));
  for (std::size_t k = 0; k < hz_.size(); ++k) target_[Eigen::Index(k)] = lines[first_line_ + k] / double(factor);
  for (std::size_t w = 0; w < records.witnesses.size(); ++w) {
    witness_.push_back(interpolated(records.witnesses[w], start_, rate_, samples_));
    for (double& x : witness_.back()) x -= frame.means[w];
  }
}

FringeStretch::Response FringeStretch::response(StrainResponse const& phase, StrainResponse const& amplitude) const {
  // The transforms here run with exp(+2 pi i f t), responses with exp(-2 pi i f t).
  Response out{Eigen::VectorXcd::Ones(target_.size()), Eigen::VectorXcd::Zero(target_.size())};
  for (std::size_t k = 0; k < hz_.size(); ++k) {
    if (phase) out.phase[Eigen::Index(k)] = std::conj(phase(hz_[k]));
    if (amplitude) out.amplitude[Eigen::Index(k)] = std::conj(amplitude(hz_[k]));
  }
  return out;
}

std::vector<double> FringeStretch::motion(double ratio, double delay) const {
  std::vector<double> u(samples_, 0.0);
  for (std::size_t w = 0; w < witness_.size(); ++w) {
    double const factor = w ? -ratio : 1;
    if (delay == 0) {
      for (std::size_t i = 0; i < samples_; ++i) u[i] += factor * witness_[w][i];
    } else {
      auto const x = interpolated(records_.witnesses[w], start_ - delay, rate_, samples_);
      for (std::size_t i = 0; i < samples_; ++i) u[i] += factor * (x[i] - frame_.means[w]);
    }
  }
  return u;
}

double FringeStretch::span(double ratio) const {
  auto const u = motion(ratio, 0);
  auto const [low, high] = std::minmax_element(u.begin(), u.end());
  return *high - *low;
}

FringeColumns FringeStretch::columns(Response const& response, FringeShape const& shape, double ratio) const {
  std::vector<double> const u = motion(ratio, shape.delay);
  std::vector<std::complex<double>> field(samples_);
  double const per_metre = 2 * shape.multiplicity / frame_.wavelength, per_second = shape.drift / (2 * pi);
  for (std::size_t i = 0; i < samples_; ++i) {
    SinCos const turn = sincos_turn(per_metre * u[i] + per_second * (start_ - frame_.middle + double(i) / rate_));
    field[i] = {taper_[i] * turn.cos, taper_[i] * turn.sin};
  }
  auto const lines = transform(field);
  FringeColumns out{FringeLines(target_.size()), FringeLines(target_.size())};
  for (std::size_t k = 0; k < hz_.size(); ++k) {
    std::complex<double> const above = lines[first_line_ + k], below = std::conj(lines[samples_ - first_line_ - k]);
    std::complex<double> const cosine = 0.5 * (above + below);
    std::complex<double> const sine = std::complex<double>(0, -0.5) * (above - below);
    auto const i = Eigen::Index(k);
    out.cosine[i] = response.phase[i] * sine + response.amplitude[i] * cosine;
    out.sine[i] = response.phase[i] * cosine - response.amplitude[i] * sine;
  }
  return out;
}

FringeColumns FringeStretch::delayed(FringeColumns const& columns, double seconds) const {
  FringeColumns out = columns;
  for (std::size_t k = 0; k < hz_.size(); ++k) {
    std::complex<double> const turn = std::polar(1.0, -2 * pi * hz_[k] * seconds);
    out.cosine[Eigen::Index(k)] *= turn;
    out.sine[Eigen::Index(k)] *= turn;
  }
  return out;
}

std::vector<double> FringeStretch::psd(FringeLines const& lines) const {
  auto const n = std::ptrdiff_t(hz_.size()), around = std::ptrdiff_t(32);
  std::vector<double> sum(std::size_t(n) + 1, 0.0), out;
  for (std::ptrdiff_t k = 0; k < n; ++k) sum[std::size_t(k) + 1] = sum[std::size_t(k)] + std::norm(lines[k]);
  double const scale = 2 / (rate_ * double(samples_) * weight_);
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    // At the ends of the band the window moves inwards and keeps its width.
    std::ptrdiff_t const width = std::min(2 * around + 1, n);
    std::ptrdiff_t const low = std::clamp<std::ptrdiff_t>(k - around, 0, n - width);
    out.push_back(scale * (sum[std::size_t(low + width)] - sum[std::size_t(low)]) / double(width));
  }
  return out;
}

double FringeStretch::degrees() const { return 2 * independent_ * double(hz_.size()); }

Eigen::VectorXd FringeStretch::whitened(FringeLines const& lines, std::vector<double> const& psd) const {
  auto const n = Eigen::Index(hz_.size());
  Eigen::VectorXd out(2 * n);
  // E|X|^2 = S rate N <taper^2>/2, half of it in each of the two parts.
  double const scale = independent_ * 4 / (rate_ * double(samples_) * weight_);
  for (Eigen::Index k = 0; k < n; ++k) {
    double const w = std::sqrt(scale / psd[std::size_t(k)]);
    out[2 * k] = w * lines[k].real();
    out[2 * k + 1] = w * lines[k].imag();
  }
  return out;
}

Eigen::VectorXd FringeStretch::whitened_samples(FringeLines const& lines, std::vector<double> const& psd) const {
  std::vector<std::complex<double>> spectrum(samples_), series;
  double const edge = 0.1 * (frame_.high - frame_.low), scale = 2 / (rate_ * double(samples_));
  for (std::size_t k = 0; k < hz_.size(); ++k) {
    double const inside = std::min(hz_[k] - frame_.low, frame_.high - hz_[k]) / edge;
    double const mask = inside >= 1 ? 1 : 0.5 - 0.5 * std::cos(pi * inside);
    // Of noise in the untapered middle: E|v|^2 = 1 over a whole stretch of it.
    spectrum[first_line_ + k] = mask * std::sqrt(scale / psd[k]) * lines[Eigen::Index(k)];
  }
  thread_local Fourier fourier;
  fourier.inverse(spectrum, series);  // with 1/N
  auto const skip = std::size_t(std::ceil(taper_share * double(samples_)));
  Eigen::VectorXd out(Eigen::Index(samples_ - 2 * skip));
  // y = 2/sqrt(N) Re sum v e^(i w t): its sum of squares is 2 sum |v|^2.
  for (std::size_t i = skip; i < samples_ - skip; ++i)
    out[Eigen::Index(i - skip)] = 2 * std::sqrt(double(samples_)) * series[i].real();
  return out;
}

}  // namespace straytrace::analysis
