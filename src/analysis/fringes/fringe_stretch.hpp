// SPDX-License-Identifier: BSD-3-Clause
// A stretch of h(t) and of the simultaneous motion, on the lines of one Fourier transform inside a band
// (requirements R6.06, R6.07).
#pragma once

#include <Eigen/Core>

#include <complex>
#include <functional>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"

namespace straytrace::analysis {

// Strain per Im s or Re s of a stray field, convention exp(-2 pi i f t) (docs/theory/interferometer.md).
using StrainResponse = std::function<std::complex<double>(double hz)>;

// theta(t) = W (4 pi/lambda) u(t - delay) + drift (t - middle), u = x_1 - ratio x_2.
struct FringeShape {
  double multiplicity = 1;  // W, in units of 2k: bounces, or a factor on the motion
  double delay = 0;         // s
  double drift = 0;         // rad/s
};

struct FringeRecords {
  TimeSeries target;                  // h, or another signal with fringes
  std::vector<TimeSeries> witnesses;  // x_1 and, where two bodies move, x_2; m
  std::vector<double> unseen = {};    // m rms right below the high pass of an integrated one; NaN: unknown
};

// Settings common to all stretches of one fit.
struct FringeFrame {
  double low = 0, high = 0;   // Hz, the band
  double wavelength = 0;      // m
  double middle = 0;          // GPS s, where a drift is zero
  double highest_fringe = 0;  // Hz, largest |d theta/dt|/2pi of any shape evaluated
  double longest_delay = 0;   // s, either sign
  std::vector<double> means;  // m, of the witnesses, which are subtracted
};

// Complex lines of a transform, one for each frequency in the band.
using FringeLines = Eigen::VectorXcd;

// Both columns of a path: h = Re and Im of the field times (cos phi, sin phi) sqrt(f_r):
//   T_ph * sin(phi + theta) + T_am * cos(phi + theta) = cos phi [T_ph sin + T_am cos] + sin phi [T_ph cos - T_am sin].
struct FringeColumns {
  FringeLines cosine, sine;
};

class FringeStretch {
 public:
  // `from`, `to`: samples of the target; a few may be left out at the end, for lengths that transform well.
  FringeStretch(FringeRecords const&, std::size_t from, std::size_t to, FringeFrame const&);

  std::vector<double> const& hz() const { return hz_; }
  FringeLines const& target() const { return target_; }
  double duration() const { return duration_; }  // s
  std::size_t model_samples() const { return samples_; }

  // Responses at hz(), once for each path.
  struct Response {
    Eigen::VectorXcd phase, amplitude;
  };
  Response response(StrainResponse const& phase, StrainResponse const& amplitude) const;
  // delay = 0 in the transform, turned on the lines instead, is faster and good while the delay is short against the
  // taper (1/20 of the stretch): see delayed().
  FringeColumns columns(Response const&, FringeShape const&, double ratio) const;
  FringeColumns delayed(FringeColumns const&, double seconds) const;

  // One-sided PSD on hz() from lines, mean over the 65 lines around each.
  std::vector<double> psd(FringeLines const&) const;
  // Lines as real numbers of unit variance, independent, in noise of this PSD (on hz()): their sum of squares is chi^2.
  Eigen::VectorXd whitened(FringeLines const&, std::vector<double> const& psd) const;
  // The same in the time domain: whitened, band-passed samples of the untapered middle.
  Eigen::VectorXd whitened_samples(FringeLines const&, std::vector<double> const& psd) const;
  double degrees() const;  // of chi^2 of pure noise

  double span(double ratio) const;  // m, largest less smallest u

 private:
  std::vector<double> motion(double ratio, double delay) const;

  FringeRecords const& records_;
  FringeFrame const& frame_;
  double start_ = 0, duration_ = 0, rate_ = 0;  // GPS s, s, Hz of the model
  std::size_t samples_ = 0, first_line_ = 0;
  double weight_ = 0, independent_ = 0;  // mean square of the taper; share of its lines that are independent
  std::vector<double> hz_, taper_;
  std::vector<std::vector<double>> witness_;  // without delay, at the model's samples
  FringeLines target_;
};

// Largest |du/dt| of u = x_1 - ratio x_2 between samples, m/s.
double fastest_motion(FringeRecords const&, double ratio);

}  // namespace straytrace::analysis
