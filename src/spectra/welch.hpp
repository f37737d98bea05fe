// SPDX-License-Identifier: BSD-3-Clause
// Power spectral densities of time series by averaged periodograms (Welch 1967; R2.15).
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/fourier.hpp"
#include "spectra/series.hpp"

namespace straytrace::spectra {

// Windows of spectral estimates.

// Periodic: they repeat after the segment, as scipy.signal.get_window gives them.
enum class Window : std::uint8_t { rectangular, hann, hamming, blackman, blackman_harris, flat_top, tukey, kaiser };

// `parameter`: tapered share of a Tukey window, beta of a Kaiser window; others have none.
std::vector<double> window_weights(Window, double parameter, std::size_t samples);

struct NamedWindow {
  Window window = Window::hann;
  double parameter = 0;
};
// "hann", "tukey(0.25)", "kaiser(14)"; Tukey alone is 0.5. Throws InputError with the known names.
NamedWindow parse_window(std::string const&);
std::string window_text(NamedWindow);

enum class Average : std::uint8_t { mean, median };
enum class Detrend : std::uint8_t { none, constant, linear };  // removed from each segment

struct WelchSettings {
  std::size_t segment = 0;  // samples; the frequencies are multiples of sample rate/segment
  double overlap = 0.5;     // of neighbours, share of a segment
  Window window = Window::hann;
  double window_parameter = 0;  // of Tukey and Kaiser windows
  Detrend detrend = Detrend::constant;
  // The median ignores single loud segments; its bias for Gaussian noise is removed, but it is too high for
  // deterministic lines by up to 1/ln 2 and misses signals that last less than half of the record.
  Average average = Average::mean;
};

struct WelchSpectrum {
  std::vector<double> hz;         // from 0 to half the sample rate
  std::vector<double> psd;        // one-sided, x^2/Hz: twice the two-sided one, except at 0 and at half the sample rate
  std::vector<double> sigma;      // one standard error for Gaussian noise that is flat across the window; x^2/Hz
  std::size_t segments = 0;       // averaged
  double effective_averages = 0;  // independent ones: overlapping segments share samples, and a median uses less
  double noise_bandwidth = 0;     // ENBW, Hz: a line of amplitude a has the PSD a^2/(2 ENBW)

  // Whether the line has no counterpart at a negative frequency: half the degrees of freedom.
  bool is_real_line(std::size_t k) const { return k == 0 || (even && k + 1 == hz.size()); }
  bool even = true;  // samples of a segment
};

// Over the segments that fit, and hold no NaN; samples in order, sample rate in Hz. Throws InputError for a segment
// below two samples or longer than the series, an overlap outside [0, 1), a sample rate that is not positive.
WelchSpectrum welch(std::span<double const> samples, double sample_rate, WelchSettings const&);

// Interval that holds the true PSD with this probability: nu S/chi^2_nu, nu = 2 effective averages (1 at real lines).
struct Interval {
  std::vector<double> low, high;
};
Interval confidence(WelchSpectrum const&, double probability = 0.95);

// Median over mean of n independent periodograms of Gaussian noise, 1 for n = 1, ln 2 for many.
double median_bias(std::size_t n);

// rms of a record within a band of frequencies.

struct BandPower {
  double power = 0, sigma = 0;  // integral of the PSD over the band, x^2; one standard error for Gaussian noise
  double rms() const { return std::sqrt(power); }
  double rms_sigma() const { return power > 0 ? sigma / (2 * rms()) : 0; }
};
// Each line represents half a step on either side; the lines at 0 and at half the rate represent one side, with all
// their power: over the whole band this is the sum of the lines, the mean square of the windowed record (Parseval).
// `settings`: those of the spectrum; the window correlates neighbouring lines.
BandPower band_power(WelchSpectrum const&, WelchSettings const& settings, double low_hz, double high_hz);

// rms of the band-passed record in strides of `stride_s`; time at their middle. One sigma for Gaussian noise that is
// flat in the band: 1/(2 sqrt(bandwidth stride)) of it.
struct RmsTrend {
  std::vector<double> time, rms, sigma;
};
RmsTrend rms_trend(TimeSeries const&, double low_hz, double high_hz, double stride_s);
double rms(std::span<double const> samples);  // about zero

// Windowed transforms of overlapping segments, from which all averaged spectra are made.

class Segments {
 public:
  // Throws InputError as welch() does.
  Segments(std::size_t samples, double rate, WelchSettings const&);
  // In each stretch without NaN, from its first sample on. InputError where no stretch is as long as a segment.
  Segments(std::span<double const> samples, double rate, WelchSettings const&);

  std::size_t count() const { return begins_.size(); }
  std::size_t lines() const { return settings_.segment / 2 + 1; }
  double hz(std::size_t line) const { return double(line) * rate_ / double(settings_.segment); }
  std::size_t begin(std::size_t segment) const { return begins_[segment]; }
  double noise_bandwidth() const { return rate_ * square_ / (sum_ * sum_); }
  // |X|^2 times this is a one-sided PSD: 1/(rate sum w^2), twice that for each frequency with a negative counterpart.
  double density(std::size_t line) const;
  bool is_real_line(std::size_t line) const { return line == 0 || 2 * line == settings_.segment; }
  // Independent segments that average as well as these: neighbours share samples (Welch 1967).
  double effective() const;
  // Lines of a segment, detrended and windowed; valid until the next call.
  Complexes const& transform(std::span<double const> samples, std::size_t segment);

 private:
  void add_stretch(std::size_t from, std::size_t to);

  WelchSettings settings_;
  double rate_, sum_ = 0, square_ = 0;
  std::size_t step_;
  std::vector<std::size_t> begins_, stretches_;  // samples; segments of each stretch
  std::vector<double> weights_, part_;
  Fourier fourier_;
};

// Cross spectra, coherence and transfer functions of two records (Bendat and Piersol, Random Data; R6.05).

// One-sided averages over segments of an input x and an output y. Phases are those of instruments, exp(+2 pi i f t):
// an output with a delay of tau has cross = x^2 exp(-2 pi i f tau) (scipy.signal.csd(x, y)).
struct CrossSpectra {
  std::vector<double> hz;
  std::vector<double> input, output;        // S_xx, x^2/Hz; S_yy, y^2/Hz
  std::vector<std::complex<double>> cross;  // S_xy = <conj(X) Y>, x y/Hz
  std::size_t segments = 0;
  double effective_averages = 0;  // independent ones
  double noise_bandwidth = 0;     // ENBW, Hz
};

// Mean over the segments; settings.average must be the mean, since a median of complex numbers does not estimate their
// mean. Throws InputError as welch() does, and when the records differ in length.
CrossSpectra cross_spectra(std::span<double const> x, std::span<double const> y, double sample_rate,
                           WelchSettings const&);
// Over the common stretch, at the lower of the two rates (aligned()).
CrossSpectra cross_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const&);

// |S_xy|^2/(S_xx S_yy), 0 to 1; NaN where one of the two is zero. Of independent records its mean is 1/averages.
std::vector<double> coherence(CrossSpectra const&);
// Coherence that independent Gaussian records exceed with this probability: 1 - p^(1/(n - 1)). 1 for n <= 1.
double coherence_level(double effective_averages, double probability = 0.05);
// Radius, over |H|, of the circle around an estimate of H that holds the truth: r^2 = (p^(-1/(n - 1)) - 1) (1 - c)/c,
// p = 1 - probability (Bendat and Piersol, Random Data, with the quantile of F of 2 and 2 n - 2 degrees of freedom).
// Below 1 just where c is above coherence_level(n, p).
double confidence_radius(double coherence, double effective_averages, double probability = 0.95);
// Interval of the coherence: atanh of its root has variance 1/(2 (n - 1)). 0 to 1 where n <= 1.
Interval coherence_interval(std::span<double const> coherence, double effective_averages, double probability = 0.95);

// y = H x. Errors are one sigma, of the estimate from a finite number of averages: |H| and phase (rad) have the
// relative error sqrt((1 - c)/(2 c n)), c the coherence. Where it is not below 1 the phase is unknown, and sigma has
// its maximum.
struct TransferEstimate {
  std::vector<double> hz;
  std::vector<std::complex<double>> value;  // y/x
  std::vector<double> modulus_sigma;        // y/x
  std::vector<double> phase_sigma;          // rad, at most pi/sqrt(3): that of any phase
  std::vector<double> coherence;
  double effective_averages = 0;
};
TransferEstimate h1(CrossSpectra const&);  // S_xy/S_xx: right when noise is in y only, too small by noise in x
TransferEstimate h2(CrossSpectra const&);  // S_yy/S_yx: right when noise is in x only, too large by noise in y

// Spectra that change with time.

struct Spectrogram {
  std::vector<double> time;   // GPS s, middle of each stride
  std::vector<double> hz;     // rising
  std::vector<double> value;  // value[stride * lines + line]
  double at(std::size_t stride, std::size_t line) const { return value[stride * hz.size() + line]; }
};

// One-sided ASD of each stride by welch() within it; strides do not overlap, and the remainder is dropped.
// Throws InputError for strides shorter than a segment or longer than the record.
Spectrogram spectrogram(TimeSeries const&, double stride_s, WelchSettings const&);
// The same of Hann segments of one stride each, half overlapping, without the line at zero. Throws InputError for
// strides of fewer than 8 samples or longer than the record.
Spectrogram overlapping_spectrogram(TimeSeries const&, double stride_s);
// Each line divided by its median over time: 1 is the usual level.
Spectrogram normalised(Spectrogram);

// Constant-Q tiles (Chatterji et al. 2004): the whitened record seen through windows (1 - x^2)^2 of frequency, x =
// (f - f_0)/(sqrt(11) f_0/Q). The energy of each row is divided by its median/ln 2: in stationary Gaussian noise a tile
// exceeds e with probability exp(-e). Cells hold the largest energy within their time.
struct QSettings {
  double q = 12;
  double low_hz = 10, high_hz = 100;
  double mismatch = 0.2;      // largest loss of energy between neighbouring rows
  std::size_t columns = 500;  // cells in time; fewer where no tile is that short
};
// Of a whitened record. Throws InputError for a band outside the record's or for a record that is too short.
Spectrogram q_transform(TimeSeries const& white, QSettings const&);

}  // namespace straytrace::spectra
