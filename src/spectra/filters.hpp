// SPDX-License-Identifier: BSD-3-Clause
// Linear systems: transfer functions by frequency, and filters of records.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "base/namespaces.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"
#include "spectra/welch.hpp"

namespace straytrace::spectra {

// Filters of records. All but the causal ones have zero phase: they shift nothing in time.

// Linear systems in the frequency domain: zeros, poles and a gain, or a table. Convention exp(-2 pi i f t): a low pass
// with its pole at p is 1/(1 - i f/p).

class TransferFunction {
 public:
  TransferFunction() = default;  // zero
  // `gain` at f = 0; zeros and poles in Hz, positive: stable. A zero or pole at 0 is a factor f / (1 Hz), turned by
  // -90 degrees: then `gain` is that of the other factors.
  TransferFunction(std::vector<double> zeros, std::vector<double> poles, double gain)
      : zeros_(std::move(zeros)), poles_(std::move(poles)), gain_(gain) {}
  // Samples at rising frequencies. Between them the logarithm of the modulus and the phase, unwrapped, are linear in
  // log f; frequencies outside are an error that names `name`.
  TransferFunction(std::string name, std::vector<double> hz, std::vector<std::complex<double>> values);
  // From the motion of the support to that of a mass on a spring, x = f / hz: damped against inertial space, 1/(1 - x^2
  // - i x/Q), or against the support, (1 - i x/Q)/(1 - x^2 - i x/Q) (docs/theory/environment.md, eq. 11.2),
  // or to its motion relative to the support, x^2/(1 - x^2 - i x/Q).
  enum class Response : std::uint8_t { inertial, support, relative };
  static TransferFunction oscillator(double hz, double quality, Response);
  static TransferFunction product(TransferFunction const&, TransferFunction const&);

  std::complex<double> operator()(double hz) const;
  bool operator==(TransferFunction const&) const = default;
  TransferFunction delayed(double seconds) const;  // its output so much later: exp(2 pi i f t), exact
  double delay() const { return delay_; }          // s, sum of these
  TransferFunction holding_ends() const;           // tables keep their first and last value beyond their ends
  Band range() const;                              // Hz, range of validity: 0 to infinity without tables
  std::vector<double> features() const;            // corner frequencies, Hz, not sorted; samples of tables

 private:
  struct Oscillator {
    bool operator==(Oscillator const&) const = default;

    double hz, quality;
    Response response;
  };
  struct Table {
    std::complex<double> operator()(double hz) const;
    bool operator==(Table const&) const = default;

    std::string name;
    std::vector<double> hz, log_modulus, phase;
    bool holds = false;
  };

  std::vector<double> zeros_, poles_;
  double gain_ = 0, delay_ = 0;
  std::vector<Oscillator> oscillators_;
  std::vector<Table> tables_;
};

// Suppression of a disturbance inside a loop with open-loop gain G: 1/(1 + G).
inline std::complex<double> suppression(std::complex<double> open_loop_gain) { return 1.0 / (1.0 + open_loop_gain); }

// {gain: 100, zeros: [10 Hz], poles: [..]} or {file: FILE, columns: [Hz, re, im]}. Columns may also be [Hz, dB, deg];
// files hold phases for exp(+2 pi i f t), the convention of instruments and FINESSE, and must cover the band, if one is
// given.
TransferFunction read_transfer_function(Node const&, std::optional<Band> const&);
// Whether `columns` of the table names decibels and degrees.
bool read_columns_are_decibels(Node const& table);
TransferFunction read_response_file(Node const& file, bool decibels, std::optional<Band> const&);

// Every factor-th sample from `first` on, after a low pass of zero phase: a windowed sinc (Kaiser, 80 dB) that passes
// up to 0.8 of the new Nyquist frequency and stops at it. Odd reflection continues the record beyond its ends.
TimeSeries decimated(TimeSeries const&, std::size_t factor, std::size_t first = 0);

// Band edges in Hz, 0 <= low < high <= half the rate; low = 0: low pass, high = half the rate: high pass. Butterworth
// of the order, run forwards and backwards (scipy sosfiltfilt with its default padding): the square of its response, no
// phase.
TimeSeries band_passed(TimeSeries const&, double low_hz, double high_hz, int order = 4);
// Second-order notch of this width at -3 dB, forwards and backwards (scipy iirnotch, filtfilt).
TimeSeries notched(TimeSeries const&, double hz, double quality = 30);

// Recursive filters as second-order sections (conventions of scipy.signal), for this module only.

// (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2)
struct Section {
  std::array<double, 3> b{1, 0, 0};
  std::array<double, 2> a{0, 0};
};

// Butterworth by the bilinear transform; edges as shares of half the sample rate, 0 <= low < high <= 1. low = 0: low
// pass, high = 1: high pass, otherwise a band pass of twice the order. Throws InputError for an order outside 1 to 12.
std::vector<Section> butterworth(int order, double low, double high);
// Unit gain except at `share` of half the sample rate, with width share/quality at -3 dB.
Section notch(double share, double quality);

std::vector<double> once(std::vector<Section> const&, std::vector<double> x);  // causal, from rest
// Forwards and backwards, the record continued by odd reflection and the filter settled on its ends
// (scipy.signal.sosfiltfilt). Throws InputError for a record that is too short.
std::vector<double> both_ways(std::vector<Section> const&, std::vector<double> const& x);

// Whitening.

// Divided, line by line and without phase, by its own ASD (Welch, straight between its lines) and by sqrt(2/rate): for
// stationary Gaussian noise the result has variance 1 and one-sided PSD 2/rate at all frequencies; no unit. Frequencies
// below the first line of the ASD are removed. Both ends fade to zero over half a segment.
TimeSeries whitened(TimeSeries const&, WelchSettings const&);

}  // namespace straytrace::spectra
