// SPDX-License-Identifier: BSD-3-Clause
// Independent inputs of the motion grouped by the shape of the spectra that they give to phases: the phase of a path
// then depends on its phase sensitivities through one number per class.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// The phase of a path has the PSD sum over classes of kappa * reference; for a tone its square peak amplitude is
// z^2 = kappa (docs/theory/spectra.md, eq. 1.10, 7.11), for a drift the square of its rate [rad^2/s^2].
//
// Where one input reaches bodies through transfer functions H_k, with sums of phase sensitivity times gain a_k,
//
//   |sum_k a_k H_k|^2 = sum_k a_k (sum_l a_l) |H_k|^2 - sum_{k<l} a_k a_l |H_k - H_l|^2
//
// so the classes are |H_k|^2 S and |H_k - H_l|^2 S: a kappa may be negative, their sum is not, and common motion of the
// bodies (sum_l a_l = 0) cancels without a difference of large numbers.
struct MotionClass {
  using Transfer = std::shared_ptr<TransferFunction const>;  // none: 1
  struct Member {
    std::size_t input;
    double scale;                      // its PSD over the reference
    Transfer first = {}, second = {};  // |H|^2 of one, or of the difference of two
    bool difference = false;
  };

  Spectrum reference;         // m^2/Hz
  double tone_frequency = 0;  // Hz; > 0: a tone
  std::vector<Member> members;
  bool drift = false;

  bool gaussian() const { return !drift && !(tone_frequency > 0); }
  // Mean-square phase per unit of kappa; a drift is no motion about a mean.
  double variance() const { return drift ? 0 : tone_frequency > 0 ? 0.5 : reference.total(); }
};

std::vector<MotionClass> group_by_shape(MotionSet const&);

// One number per class. Equal phase sensitivities of two bodies on one input cancel or add here, before anything is
// squared.
std::vector<double> kappa_of(MotionSet const&, std::vector<MotionClass> const&, std::span<PhaseSensitivity const>);

// The same of a path, with the levers of its amplitude: in the mean over the static phase, s (1 + a) has, to first
// order in a, the spectrum of a path that an independent phase of the same PSD as a moves too (eq. N.27).
std::vector<double> kappa_of(MotionSet const&, std::vector<MotionClass> const&, PathRecord const&);

// Of one class, from second moments of phase sensitivities: the sum over paths of coupling times kappa, as
// contributions of the replicas. Unknown where larger terms cancel down to rounding, as in the common motion of
// bodies.
struct KappaSum {
  std::array<double, replica_count> of = {};
  bool known = false;
};
std::vector<KappaSum> kappa_sums(MotionSet const&, std::vector<MotionClass> const&,
                                 std::span<PhaseSensitivityProduct const>);

// Paths as directions in the space of the independent inputs of the motion.

// A column is an input through one transfer function; the two quadratures of a tone are separate columns.
class MotionDirections {
 public:
  explicit MotionDirections(MotionSet const& motion);

  std::size_t inputs() const { return motion_.inputs.size(); }
  std::size_t input(std::size_t column) const { return columns_[column].input; }
  // d(phase)/d(column), rad/m; columns that do not move these phase sensitivities are left out, the others ascend.
  using Gains = std::vector<std::pair<std::size_t, double>>;
  Gains of(std::span<PhaseSensitivity const>) const;
  // The gain of each column to its input, in the root of its power in the bin (`everywhere`: at all frequencies).
  std::vector<std::complex<double>> to_inputs(FrequencyGrid const&, std::size_t bin, bool everywhere) const;
  bool tone(std::size_t column) const { return motion_.inputs[input(column)].tone_frequency > 0; }
  bool drifts(std::size_t column) const { return motion_.inputs[input(column)].drift; }

 private:
  struct Column {
    std::size_t input;
    TransferFunction const* transfer;
    bool imaginary;
  };
  struct Entry {  // one gain of a column's input to a body
    std::size_t column, gain;
    int axis;
    double value;
  };
  void add_columns(std::size_t input);
  double root_power(std::size_t input, double low, double high, bool everywhere) const;

  MotionSet const& motion_;
  std::vector<Column> columns_;
  std::vector<std::vector<Entry>> of_body_;
};

// Motion of one coordinate of one body: the phase with a phase sensitivity of 1 on it alone.
struct CoordinateMotion {
  std::string body, axis, unit;         // unit: m or rad
  double rms = 0, rate = 0, drift = 0;  // m, m/s, m/s (rad); random motion and tones
  std::vector<double> above = {};       // rms above each of the frequencies
  std::vector<double> kappa = {};       // of each class

  bool moves() const { return rms > 0 || drift != 0; }
  double asd(std::vector<MotionClass> const&, double hz) const;  // without tones and drifts
};
// Of all coordinates that move. `above`: frequencies [Hz].
std::vector<CoordinateMotion> coordinate_motions(MotionSet const&, std::vector<MotionClass> const&,
                                                 std::span<double const> above);

}  // namespace straytrace::noise
