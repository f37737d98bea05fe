// SPDX-License-Identifier: BSD-3-Clause
// Spectrum of the stray field of a path, per unit of recoupled power, from its strength of phase modulation
// (docs/theory/spectra.md). Exact for stationary Gaussian motion, tones and drift, from linear coupling to strong
// fringe wrapping, and over the full dynamic range of doubles.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "base/errors.hpp"
#include "noise/classes/motion_classes.hpp"
#include "noise/noise.hpp"

namespace straytrace::noise {

// Spectrum of the slow, strong part of the phase of a path by one Fourier transform, exact for any strength.

// Phase modulation by a sine: peak z [rad] at a frequency [Hz].
struct PhaseTone {
  double frequency, peak;
};

// Everything is even in the lag and has the period 1/spacing: lags (n + 1/2)/(samples spacing), n < samples/2, hold
// everything.
struct LagGrid {
  double spacing;  // Hz, of the lines
  std::size_t samples;
  std::size_t size() const { return samples / 2; }
  // Turns of a tone, taken to the nearest line, at a lag; between 0 and 1.
  double turns(double hz, std::size_t n) const;
  std::size_t period(double hz) const;  // lags after which the turns of a tone repeat
};

// Autocovariance of a Gaussian phase, rad^2.
struct Covariance {
  double at_zero = 0;
  std::vector<double> at;  // the lags
  // R(0) - R(tau) at the first lags, to all digits: under strong motion only they count, and the difference of two
  // large numbers would lose theirs.
  std::vector<double> fall;
  double fall_at(std::size_t lag) const { return lag < fall.size() ? fall[lag] : at_zero - at[lag]; }
};
// `line_power`: rad^2 within half a spacing of k spacing; none at k = 0.
Covariance covariance(std::vector<double> line_power, LagGrid const&);

// The slow part of the phase: Gaussian, and tones.
struct SlowPhase {
  double highest = 0;      // Hz, beyond which there is no Gaussian power
  double fringe_rate = 0;  // Hz, rms of (dphi/dt)/2pi of the Gaussian part
  std::vector<PhaseTone> tones;
};

// Mean over phi_0 of the PSD of Im s, on lines k * spacing of width `spacing` (docs/theory/spectra.md, eq. 1.12 with
// C(0) = 1).
struct WrappedSpectrum {
  double spacing = 0;           // Hz
  std::vector<double> density;  // 1/Hz at k * spacing; zero where the transform shows only rounding
  double constant = 0;          // power of the unmoved light, at f = 0; constant + all density * spacing = 1/2
  std::size_t samples = 0;      // of the transform
};

// `resolution`: the spacing of lines is at most this [Hz]; coarser only when the fringe rate would need more than 2^20
// samples. `gaussian`: covariance of the Gaussian part. Throws NumericalError beyond 2^24.
WrappedSpectrum transform(SlowPhase const&, std::function<Covariance(LagGrid const&)> const& gaussian,
                          double resolution);

// The parts of it, for sums of several such exponentials.
LagGrid lags_for(SlowPhase const&, double resolution);
// Error of a correlation and its transform, in units of the last place: below it a line is only rounding. Of R, R(0)
// and its fall count.
double rounding_of(SlowPhase const&, std::vector<double> const& correlation, Covariance const& r, double constant);
// Transforms a correlation without its constant part; false when the sampling rate was too low.
bool transform_lags(std::vector<double> const& correlation, LagGrid const&, double rounding, WrappedSpectrum&);
NumericalError too_strong(SlowPhase const&, LagGrid const&);
constexpr std::size_t most_samples = std::size_t{1} << 24;
std::size_t more_samples(std::size_t n);  // twice as many, at most_samples at first

// Under a steady drift of the phase by `hz` turns per second, taken to the nearest line: C(tau) cos(2 pi hz tau). The
// unmoved light becomes a line. Throws NumericalError beyond 2^24 lines.
WrappedSpectrum drifting(WrappedSpectrum const&, double hz);

double total(WrappedSpectrum const&);  // its power, constant included: 1/2

// Sums of cosines on points half a step off the origin: an even record of 2m points from m numbers.

//   x_n = sum over k < m of a_k cos(pi k (n + 1/2) / m),   0 <= n < m
//
// Either way by one real transform of m numbers (J. Makhoul, IEEE Trans. ASSP 28 (1980) 27). m is a multiple of 4.
class CosineTransform {
 public:
  explicit CosineTransform(std::size_t m);
  ~CosineTransform();
  void values(std::vector<double> const& amplitudes, std::vector<double>& x) const;  // missing amplitudes are zero
  void amplitudes(std::vector<double> const& x, std::vector<double>& a) const;

  static CosineTransform const& of(std::size_t m);  // cached per thread: creating one takes longer than using it

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

// First-order effect of weak phase modulation on a field that already has a spectrum (docs/theory/spectra.md,
// eq. 7.14).

// Power concentrated at frequencies.
struct Kernel {
  std::vector<double> hz, power;
};

// One-sided PSD that is constant in bins; edges increase.
struct Steps {
  std::vector<double> edges, psd;
};

// Adds to `bin_power` the power that appears between each two edges when a line of power p at frequency g is modulated
// by S: 1/2 p [S(|f - g|) + S(f + g)]. No transform: relative precision is kept however small S is.
void add_sidebands(Kernel const&, Steps const&, std::span<double const> edges, std::span<double> bin_power);

// Power of a wrapped spectrum in each bin, its lines taken as wide as their spacing.
void add_lines(WrappedSpectrum const&, std::span<double const> edges, std::span<double> bin_power);

// add_sidebands() for a whole wrapped spectrum, its constant power included; `unshifted`: power of the modulation in
// each bin, exact where S is a coarser description of it.
void modulate(WrappedSpectrum const&, Steps const& fast, std::span<double const> unshifted,
              std::span<double const> edges, std::span<double> bin_power);

// A wrapped spectrum as a density that a line can shift.
Steps as_steps(WrappedSpectrum const&);

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
