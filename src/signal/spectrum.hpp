// SPDX-License-Identifier: BSD-3-Clause
// One-sided power spectral densities as functions of frequency with EXACT integrals over bins, so that rms values
// survive any choice of grid (physics.md 0.4).
#pragma once

#include <memory>
#include <vector>

namespace straytrace {

// One-sided PSD [x^2/Hz]: a table interpolated in log-log (a power law between knots, integrated in closed form),
// zero outside its range. Value semantics; sums are exact.
class Spectrum {
 public:
  Spectrum() = default;                                       // zero everywhere
  Spectrum(std::vector<double> hz, std::vector<double> psd);  // strictly increasing hz > 0; psd >= 0

  double at(double hz) const;                        // x^2/Hz
  double power(double low_hz, double high_hz) const; // integral over the band, x^2
  double total() const;                              // variance, x^2
  double lowest() const;                             // Hz; first and last knot
  double highest() const;
  // Integral of (2 pi f)^2 S over [0, high_hz]: variance of the rate, (x/s)^2.
  double rate_power(double high_hz) const;
  Spectrum scaled(double factor) const;              // PSD times factor
  std::vector<double> const& hz() const { return hz_; }
  std::vector<double> const& psd() const { return psd_; }
  friend Spectrum operator+(Spectrum const&, Spectrum const&);

 private:
  std::vector<double> hz_, psd_;
};

}  // namespace straytrace
