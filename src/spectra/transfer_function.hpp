// SPDX-License-Identifier: BSD-3-Clause
// Linear systems in the frequency domain: zeros, poles and a gain, or a table. Convention exp(-2 pi i f t): a low pass
// with its pole at p is 1/(1 - i f/p).
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::spectra {

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

}  // namespace straytrace::spectra
