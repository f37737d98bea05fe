// SPDX-License-Identifier: BSD-3-Clause
// One coupling class turned into the spectrum of Im s at its port, with the replicas that give its error.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "motion/motion.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "noise/interpolate/strength_sample.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {
// Correction of the noise of a route by second moments of the phase sensitivities, which all paths contribute to
// (docs/theory/errors.md, Second moments of the phase sensitivities).

// PSD of a route to first order in the motion, per bin: from the second moments over from the kept paths. The part of
// the PSD that is first order is multiplied by it. Both per unit of coupling, of all histories and without one replica.
class FirstOrderRatio {
 public:
  // `first`: number of the first record of the class among `paths`.
  FirstOrderRatio(PhaseSpectra const&, MotionSet const&, CouplingTable const&, CouplingClass const&,
                  Strengths const& paths, std::size_t first);

  bool known() const { return known_; }  // false: there are no second moments, or too few replicas
  static constexpr int all = -1;
  std::vector<double> operator()(int moments_without, int paths_without) const;  // a replica, or `all`

 private:
  using OfClasses = std::vector<double>;
  struct Means {
    OfClasses all;
    std::array<OfClasses, replica_count> without;
    OfClasses const& operator()(int replica) const { return replica < 0 ? all : without[std::size_t(replica)]; }
  };
  void take_paths(CouplingClass const&, Strengths const&, std::size_t first, std::uint64_t block_size);

  bool known_ = false;
  std::vector<OfClasses> weight_;  // per bin
  std::vector<bool> class_known_;  // of the second moments
  Means moments_, paths_;
};

using Bins = std::vector<double>;

// Parts of the Monte-Carlo error of a curve: all of it, and the error if only the power of the routes, only the second
// moments of their phase sensitivities or only their kept paths were uncertain.
enum class ErrorPart : std::uint8_t { all, power, phase_sensitivities, paths };
constexpr std::size_t error_parts = 4;
using Replicas = std::array<Bins, replica_count>;  // without one replica each; empty where one has no histories

// PSD of Im s [1/Hz] per bin: all histories, and all but those of one replica.
struct RouteSpectrum {
  Bins psd;
  Bins linear;  // part of psd, as in PhaseSpectrum
  std::array<Replicas, error_parts> without;
  Bins drawn;  // variance of psd by drawn paths, SpectrumInterpolator::add_variance; empty where all are computed
  bool exact = false;                     // of a deterministic class: no replica changes it, so `without` is empty
  double mean_square_phase = 0;           // rad^2, mean over the paths, weighted by power
  double mean_square_phase_of_noise = 0;  // the same by noise: power times phase^2, bounded where fringes wrap
  // Kept paths, counted as equal ones, that carry the power and that carry the noise: (sum x)^2 / sum x^2. A row of
  // bright static light with a few faint moving paths has a precise power and an imprecise noise.
  double paths_of_power = 0, paths_of_noise = 0;
  bool rests_on_few() const { return paths_of_noise > 0 && paths_of_noise < std::min(30.0, 0.3 * paths_of_power); }
};

// psd = mean * sum over records of (their share) * (their spectrum), its first-order part times `ratio`; each class
// mean, the shares of its records and the ratio are computed again without each replica. `first`: number of its first
// record among the paths of `nodes`.
RouteSpectrum route_spectrum(CouplingTable const&, CouplingClass const&, std::size_t first,
                             SpectrumInterpolator const& nodes, std::span<double const> mean_square_phase,
                             FirstOrderRatio const& ratio);

// Replica of a history: its block modulo their number.
std::size_t replica_of(std::uint64_t history, std::uint64_t block_size);

// PSDs of the draws of a class of kind wave, each as if it were the mean, with percentiles 5 and 95 per bin and the
// standard error of their mean; its records have the number of their draw as history. Empty for other classes and with
// one draw.
struct DrawBand {
  std::vector<Bins> psd;
  Bins low, high, error;
};
DrawBand draw_band(CouplingClass const&, std::size_t first, SpectrumInterpolator const&);

// Standard error of the coupling of a route over random mirrors (kind halo), relative, that of its PSD as well: no
// history lowers it. 0: the route has none, or it is not known.
double mirror_error(ClassKind, Estimate const& coupling);

// Squared standard error of a mean from its delete-one values; NaN with fewer than two.
double jackknife_variance(std::span<double const> without);

// The note about drawn paths that represent all.

struct DrawnError {
  double share = 0;  // standard error over the ASD of the total
  std::size_t bin = 0;
};

// The number of drawn paths, their contribution to the error of h, and the reason: the spot check with the largest
// deviation, its route and the motion that moves its path most. Paths are the records of the table in its order;
// nodes.sampled() must hold.
std::string sharing_note(CouplingTable const&, MotionSet const&, PhaseSpectra const&, Strengths const&,
                         SpectrumInterpolator const&, DrawnError const&);

// A coherent family turned into the spectrum of Im s at its port (docs/theory/ghosts.md, eq. 10.5).

// PSD of a class whose records add as fields, their common phase averaged: own terms and cross terms. Exact, without
// replicas. `mean_square_phase`: of its records, rad^2. The two states of polarisation add in power, as their shares
// do.
RouteSpectrum family_spectrum(PhaseSpectra const&, MotionSet const&, CouplingClass const&,
                              std::span<double const> mean_square_phase);

}  // namespace straytrace::noise
