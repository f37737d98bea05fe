// SPDX-License-Identifier: BSD-3-Clause
// Linear systems in the frequency domain: zeros, poles and a gain, or a table. Convention exp(-2 pi i f t): a low pass
// with its pole at p is 1/(1 - i f/p).
#pragma once

#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "base/table.hpp"
#include "signal/band.hpp"

namespace straytrace {

class TransferFunction {
 public:
  TransferFunction() = default;  // zero
  // `gain` at f = 0; zeros and poles in Hz, positive: stable. A zero or pole at 0 is a factor f / (1 Hz), turned by
  // -90 degrees: there `gain` is that of the rest.
  TransferFunction(std::vector<double> zeros, std::vector<double> poles, double gain)
      : zeros_(std::move(zeros)), poles_(std::move(poles)), gain_(gain) {}
  // Samples at rising frequencies. Between them the logarithm of the modulus and the phase, unwrapped, run straight
  // over log f; beyond them is an error, with `name`.
  TransferFunction(std::string name, std::vector<double> hz, std::vector<std::complex<double>> values);

  std::complex<double> operator()(double hz) const;

 private:
  std::complex<double> between(double hz) const;

  std::vector<double> zeros_, poles_;
  double gain_ = 0;
  std::string name_;
  std::vector<double> hz_, log_modulus_, phase_;
};

// What is left of a disturbance inside a loop with open-loop gain G: 1/(1 + G).
inline std::complex<double> suppression(std::complex<double> open_loop_gain) { return 1.0 / (1.0 + open_loop_gain); }

// {gain: 100, zeros: [10 Hz], poles: [..]} or {file: FILE, columns: [Hz, re, im]}. Columns may also be [Hz, dB, deg];
// files hold phases for exp(+2 pi i f t), as instruments and FINESSE give them, and must cover the band.
TransferFunction read_transfer_function(Node const&, Band const&);
// Whether `columns` of the table says decibels and degrees.
bool read_columns_are_decibels(Node const& table);
TransferFunction read_response_file(Node const& file, bool decibels, Band const&);

}  // namespace straytrace
