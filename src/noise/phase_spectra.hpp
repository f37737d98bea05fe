// SPDX-License-Identifier: BSD-3-Clause
// Spectrum of the stray field of a path, per unit of recoupled power, from its strength of phase modulation
// (physics.md 1.7 and section 7). Exact for stationary Gaussian motion and tones, from linear coupling to strong
// fringe wrapping, and over the full dynamic range of doubles.
#pragma once

#include <span>
#include <vector>

#include "noise/low_part.hpp"
#include "noise/motion_classes.hpp"
#include "noise/noise.hpp"
#include "noise/sidebands.hpp"

namespace straytrace {

// One-sided PSD of Im s, which is also that of Re s, mean over the static phase.
struct PhaseSpectrum {
  std::vector<double> psd;  // average over the bins of the grid, 1/Hz
  double constant = 0;      // power of the unmoved light, at f = 0
  double total = 0;         // integral over all frequencies plus `constant`; 1/2 by eq. 7.10
  double split = 0;         // Hz, f1 of eq. 7.14; 0: linear coupling, unless there are strong tones
};

class PhaseSpectra {
 public:
  // Phase power [rad^2] that counts as weak and is taken to first order: the relative error that this leaves. The same
  // for each tone.
  static constexpr double weak = 1e-4;

  PhaseSpectra(std::vector<MotionClass> classes, FrequencyGrid grid);

  // kappa: one number per class. The phase is split at a frequency f1 into a slow part, transformed exactly, and a
  // fast part of power below `weak`, which is convolved with it directly (eq. 7.14): no floor of the transform then
  // hides the motion of a quiet body. Throws NumericalError when power is not conserved within 1e-3 (eq. 7.10).
  PhaseSpectrum operator()(std::span<double const> kappa) const;

  std::vector<MotionClass> const& classes() const { return classes_; }
  FrequencyGrid const& grid() const { return grid_; }
  double mean_square_phase(std::span<double const> kappa) const;  // rad^2

  // Hz, spacing of the lines of the transform: 0.01 Hz, a tenth of the band's lower end, an eighth of its first bin or
  // half the lowest frequency of any motion (not below 2 mHz), whichever is least.
  double resolution() const { return resolution_; }

 private:
  struct Slow;
  std::size_t split(std::span<double const> kappa) const;  // edge of fine bins
  LowPart slow_part(Slow const&) const;
  Steps fast_part(std::span<double const> kappa, std::size_t from) const;
  // `unshifted`: exact power of the fast part in each bin.
  void modulate(LowPart const&, Steps const& fast, std::span<double const> unshifted,
                std::span<double> bin_power) const;

  std::vector<MotionClass> classes_;
  FrequencyGrid grid_;
  double resolution_ = 0;
  std::vector<double> fine_;                      // Hz, edges of logarithmic bins of 1.1 % over all spectra
  std::vector<std::vector<double>> fine_psd_;     // per class: average in each of them
  std::vector<std::vector<double>> power_above_;  // per class: integral from each edge upwards
};

}  // namespace straytrace
