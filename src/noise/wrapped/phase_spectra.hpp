// SPDX-License-Identifier: BSD-3-Clause
// Spectrum of the stray field of a path, per unit of recoupled power, from its strength of phase modulation
// (docs/theory/spectra.md). Exact for stationary Gaussian motion, tones and drift, from linear coupling to strong
// fringe wrapping, and over the full dynamic range of doubles.
#pragma once

#include <complex>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "noise/classes/motion_classes.hpp"
#include "noise/noise.hpp"
#include "noise/wrapped/wrapped_spectrum.hpp"

namespace straytrace::noise {
// Autocovariances of the classes of motion, shared by all paths of about the same fringe rate.

// R(tau) = sum over classes of kappa_c r_c(tau), of the Gaussian motion below a frequency. Quantities used by many
// paths are cached: power on the lines of the transform, and r_c; of more than `few` classes at once R is transformed
// itself. Not for several threads at once.
class ClassCovariances {
 public:
  Covariance sum(std::span<MotionClass const>, std::span<double const> kappa, double highest_hz, LagGrid const&);

 private:
  static constexpr std::size_t few = 3;
  using Band = std::vector<Covariance>;  // per class, empty where not needed so far
  Covariance const& of_class(Band&, std::span<MotionClass const>, std::size_t c, double highest_hz, LagGrid const&);
  std::vector<double> const& line_powers(MotionClass const&, std::size_t c, double spacing, std::size_t count);
  std::vector<double> lines(std::span<MotionClass const>, std::span<double const> kappa, double highest_hz,
                            double spacing);

  double spacing_ = 0;
  std::vector<std::vector<double>> power_;                // per class, at k > 0 from (k - 1/2) to (k + 1/2) spacing
  std::map<std::pair<double, std::size_t>, Band> bands_;  // by highest frequency and samples
  std::size_t kept_ = 0;                                  // numbers in them
};

// One-sided PSD of Im s, which is also that of Re s, mean over the static phase. PSDs are averages over the bins of the
// grid, 1/Hz.
struct PhaseSpectrum {
  std::vector<double> psd;
  // Of it: first order in the motion of the bin, on a field that slower motion may wrap. Under a drift the motion that
  // it moves into the bin.
  std::vector<double> linear;
  // Sidebands that a weak class adds, per unit of its kappa; empty where not requested. They are taken from the rest:
  // psd becomes psd (1 - kappa variance) + kappa response, first order in this class.
  std::vector<std::vector<double>> response;
  double constant = 0;  // power of the unmoved light, at f = 0
  double total = 0;     // integral over all frequencies plus `constant`; 1/2 by eq. 7.10
  double split = 0;     // Hz, f1 of eq. 7.14; 0: linear coupling, unless there are strong tones
};

// Keeps tables between calls: not for several threads at once.
class PhaseSpectra {
 public:
  // Phase power [rad^2] that counts as weak and is taken to first order: the relative error that this leaves. The same
  // for each tone.
  static constexpr double weak = 1e-4;
  // Largest departure from eq. 7.10 that is accepted.
  static constexpr double conserved = 1e-6;

  PhaseSpectra(std::vector<MotionClass> classes, FrequencyGrid grid);

  // kappa: one number per class. The phase is split at a frequency f1 into a slow part, transformed exactly, and a
  // fast part of power below `weak`, which is convolved with it directly (eq. 7.14): the floor of the transform then
  // does not hide the motion of a quiet body. Throws NumericalError when power is not conserved (eq. 7.10).
  PhaseSpectrum operator()(std::span<double const> kappa) const;

  // Whether this kappa of a class must stay in the exponent. All others are linear, except drifts slower than half the
  // resolution, which are static phases.
  bool is_strong(std::size_t c, double kappa) const;
  // The same spectrum of strong classes alone (kappa of the others is zero), with the responses of weak ones.
  PhaseSpectrum strong(std::span<double const> kappa, std::vector<bool> const& responses) const;

  double split_hz(std::span<double const> kappa) const;   // f1 of eq. 7.14
  Steps fast_steps(std::size_t c, double from_hz) const;  // reference of a class above such a split

  std::vector<MotionClass> const& classes() const { return classes_; }
  // PSD of a bin [1/Hz] to first order in weak motion, per unit of kappa (eq. 7.9); none of a drift.
  double first_order_weight(std::size_t c, std::size_t bin) const;
  double variance(std::size_t c) const { return variance_[c]; }  // of a class, kept because every path needs it
  FrequencyGrid const& grid() const { return grid_; }
  // Mean of power(low, high) over the bands that drifts of the phase shift into one of them [Hz]: each drift f_d shifts
  // half of the power at f + f_d and half of that at |f - f_d| (C(tau) cos(2 pi f_d tau),
  // docs/theory/path_integral.md).
  double moved_by_drifts(std::span<double const> kappa, double low, double high,
                         std::function<double(double, double)> const& power) const;
  // rad^2; a drift counts as pi^2/3, the variance of a phase that is anywhere.
  double mean_square_phase(std::span<double const> kappa) const;

  // Hz, spacing of the lines of the transform: 0.01 Hz, a tenth of the band's lower end, an eighth of its first bin or
  // half the frequency below which a thousandth of any motion's power lies (not below 2 mHz), whichever is least.
  double resolution() const { return resolution_; }

 private:
  std::size_t split(std::span<double const> kappa) const;  // edge of fine bins
  WrappedSpectrum slow_part(SlowPhase const&, std::span<double const> kappa) const;
  Steps fast_part(std::span<double const> kappa, std::size_t from) const;
  void add_tone(WrappedSpectrum const&, double hz, double mean_square, std::span<double> bin_power) const;
  std::vector<double> response(WrappedSpectrum const&, std::size_t c, double kept) const;
  std::vector<double> first_order(std::span<double const> kappa, std::span<double const> psd) const;
  template <class In, class Above>
  double first_order_power(std::span<double const> kappa, double low, double high, In in, Above above) const;

  std::vector<MotionClass> classes_;
  std::vector<double> variance_;
  FrequencyGrid grid_;
  double resolution_ = 0;
  std::vector<double> fine_;                      // Hz, edges of logarithmic bins of 1.1 % over all spectra
  std::vector<std::vector<double>> fine_psd_;     // per class: average in each of them
  std::vector<std::vector<double>> power_above_;  // per class: integral from each edge upwards
  std::vector<std::vector<double>> grid_power_;   // per class: in each bin of the grid
  std::vector<std::vector<double>> above_grid_;   // per class: integral from the upper edge of each bin upwards
  mutable ClassCovariances covariances_;
};

// Fields whose static phases are known: coherent families (docs/theory/ghosts.md, eq. 10.5).

// One term weight * exp(-(own R(0) - cross R(tau))) of a correlation, summed over the classes in the exponent; a tone
// is a factor J_0(sqrt(2 own - 2 cross cos(2 pi f tau))), a drift that both paths share a factor cos(sqrt(own) tau).
// own = cross = kappa is a single path (eq. 1.11). PSDs of motion come in through kappa, so that part of a
// cross-covariance that is odd in tau is left out. It is zero unless two paths see one input through transfers of
// different phase.
struct PhasePair {
  double weight = 1;
  std::vector<double> own, cross;  // per class; |cross| <= own
};

// Averages over the bins of the grid of the one-sided PSD, 1/Hz; single terms may be negative. Zero: below what a
// transform resolves.
struct PairSpectrum {
  std::vector<double> psd;
  std::vector<double> linear;  // of it: first order in the motion of the bin, as in PhaseSpectrum; between 0 and psd
  double constant =
      0;  // power at f = 0; with all psd the sum of the weights over two, times one less cross/own at tau = 0
};
// Slow motion by one transform, weak fast motion to first order (eq. 7.14). Of two paths that drift apart the term is
// left out: the mean of its phase over a long time is zero.
PairSpectrum pair_spectrum(PhaseSpectra const&, std::span<PhasePair const>);

// A specular path: its field, root of its recoupled power times exp(i phase), and its phase sensitivities.
struct CoherentPath {
  std::complex<double> field;
  std::vector<PhaseSensitivity> phase_sensitivities;
};
// Fields added, the common phase averaged. At most `most_coherent` paths.
constexpr std::size_t most_coherent = 64;
std::vector<PhasePair> coherent_family(MotionSet const&, std::vector<MotionClass> const&,
                                       std::span<CoherentPath const>);

}  // namespace straytrace::noise
