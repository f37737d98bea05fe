// SPDX-License-Identifier: BSD-3-Clause
// Coupling functions from injections (response of a target, strain, per unit of a witness, motion or sound, at each
// frequency, R6.01, R6.08), and their means over bands.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/constants.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {

// Coupling functions from injections: response of a target (strain) per unit of a witness (motion, sound) at each
// frequency (R6.01, R6.08).

enum class CouplingFlag : std::uint8_t {
  measured,          // witness and target rise: the factor and its error
  upper_limit,       // only the witness rises: the factor is an upper limit
  below_thresholds,  // the witness does not rise: no information
  no_data,
  not_linear  // most of the target's excess is not coherent with the witness: no factor is valid
};
// The flags of pemcoupling, "Real", "Upper Limit", "Thresholds not met", "No data"; and our "Fringe wrapped".
char const* name_of(CouplingFlag);

struct CouplingPoint {
  double hz = 0;
  double factor = not_a_number, sigma = not_a_number;  // target unit per witness unit; one standard error, NaN unknown
  double factor_counts = not_a_number;                 // the same per ADC count of the witness, where a file states it
  CouplingFlag flag = CouplingFlag::no_data;
  double witness_ratio = not_a_number, target_ratio = not_a_number;  // injection over quiet, of amplitudes (ASD)
  double significance = not_a_number;                                // of the excess of the target
  double coherence = not_a_number;                                   // in the injection

  bool has_factor() const { return flag == CouplingFlag::measured || flag == CouplingFlag::upper_limit; }
};

struct CouplingFunction {
  std::string witness, target;        // channels
  std::string witness_unit;           // "m", "m/s^2"
  std::string unit;                   // of the factor: "1/m"
  std::vector<CouplingPoint> points;  // frequencies increase
};

struct CouplingThresholds {
  double witness = 2, target = 2;  // ratio of ASDs, injection over quiet
  double significance = 3;         // of both excesses, standard deviations
  double confidence = 0.95;        // of upper limits
  double not_linear = 5;           // significance of the target's excess beyond the linear part that flags a point
  bool check_linear = true;        // false: several paths of one injection may reach the target
};

// Of factors: "1/m", "m/m", "1/(m/s^2)".
std::string coupling_unit(std::string const& target, std::string const& witness);

// |S_xy|^2/(S_xx S_yy) less the chance coherence of n averages of independent noise: (c - 1/n)/(1 - 1/n), not below 0.
double unbiased_coherence(double coherence, double averages);

// H = sqrt((y_inj - y_quiet)/(x_inj - x_quiet)), PSDs of target y and witness x: this also
// subtracts the coupling of the quiet witness into the quiet target, so H is right also where the injection is weak.
// Error: averages of all four spectra, less what witness and target share (coherence). Upper limit (C.4): the truth
// lies above it in 1 - `confidence` of all trials, or fewer where no coupling could be seen. Both spectra on one axis.
// Throws InputError when they are not.
std::vector<CouplingPoint> measure_coupling(CrossSpectra const& injection, CrossSpectra const& quiet,
                                            CouplingThresholds const&);

// PSDs of witness x and target y at one frequency; coherence less the chance coherence.
struct CouplingLevels {
  double x, y, coherence, averages;
};
// Largest H at `confidence` (C.4): where the upper end of Y_inj - Y_quiet - H^2 (X_inj - X_quiet), true levels, passes
// zero. Its ends are those of the single levels, added in quadrature less what witness and target share. A target below
// its quiet level counts as equal to it: a low noise fluctuation is no information.
double coupling_limit(CouplingLevels const& injection, CouplingLevels const& quiet, double confidence);

// Confidence of each of n limits such that the lowest holds at `confidence`.
inline double each_of(std::size_t n, double confidence) { return 1 - (1 - confidence) / double(n); }

// Several injections on one witness: measured points by their weighted mean, whose error grows by sqrt(chi^2/dof) where
// they disagree; otherwise the lowest limit, so each must have been taken with each_of(). Not linear in one: not
// linear. Throws InputError for other units or axes.
CouplingFunction combine(std::span<CouplingFunction const>);

inline double squared(double v) { return v * v; }

// Coupling functions as CSV of pemcoupling: frequency, factor, factor_counts, flag. Ours append further columns.

// The reader is tolerant: columns in any order, further columns, flags in any case, "Measured" for "Real", a header
// with a comma missing. The unit of the factor, the unit and names of channels come from our own columns; files of
// pemcoupling lack these, so `unit` ("m/m", "1/m", ...) and `witness_unit` must supply them. Throws InputError with
// file and line.
CouplingFunction parse_coupling(std::string_view csv, std::string const& file, std::string const& unit = "",
                                std::string const& witness_unit = "");

// Upper limits are in the column of factors with their flag; unknown values are empty.
std::string coupling_csv(CouplingFunction const&);

// A measured coupling times the quiet level of its witness (R6.08).

struct ProjectedPoint {
  double hz = 0;
  double asd = not_a_number, sigma = not_a_number;  // of the target; an upper limit has no error
  CouplingFlag flag = CouplingFlag::no_data;
};

struct ProjectedCoupling {
  std::string witness, target;
  std::vector<ProjectedPoint> points;
};

// ASD of the witness without an injection.
struct QuietWitness {
  std::string unit;  // "m": of the amplitude whose density this is
  std::vector<double> hz, asd, sigma;
};
// Without the line at zero; sigma_asd = sigma_psd/(2 asd).
QuietWitness level_of(WelchSpectrum const&, std::string const& unit);

// At each frequency of the witness: factor times level, errors in quadrature. Between two couplings of one kind the
// factor is interpolated in log-log; limits stay limits, and a value next to an unknown one is unknown. Frequencies
// outside the coupling have no data. Throws InputError when the units do not fit, and where the coupling is not linear:
// fringe wrapping is projected in the time domain.
ProjectedCoupling project_coupling(CouplingFunction const&, QuietWitness const&);

// Denominator of a unit of factors, "m" of "1/m", "m/s^2" of "1/(m/s^2)". Throws InputError unless it is that of the
// witness.
std::string unit_below(std::string const& coupling_unit, TimeSeries const& witness);
// Its numerator.
std::string unit_above(CouplingFunction const&);
// From the numerator of the unit of the coupling to the unit of the target; InputError when they are of different
// kinds.
void rescale(ProjectedCoupling&, CouplingFunction const&, TimeSeries const& target);

// Coupling of a whole band, from the total excess power in it (docs/theory/commissioning.md, eq. C.13).

// H^2 = (sum of y_inj - y_quiet)/(sum of x_inj - x_quiet) over the lines of low to high, Hz; PSDs of target y and
// witness x. Slow motion of the same surface spreads what fast small motion makes over neighbouring lines without
// changing its power, so H is the coupling of small motion where that of single lines is not.
struct BandCoupling {
  double factor = not_a_number,
         sigma = not_a_number;                 // target unit per witness unit; one standard error of the averages
  double witness_ratio = 0, target_ratio = 0;  // injection over quiet, of amplitudes in the whole band
  double share = not_a_number;  // of the power of the quiet target that the quiet witness explains, 1 for all
  bool rises_at_low = false, rises_at_high = false;  // the target rises at this end too: the band is too narrow
};

// `settings`: of both spectra; how much neighbouring lines share follows from the window. NaN factor where witness or
// target rise by less than three standard errors.
BandCoupling band_coupling(CrossSpectra const& injection, CrossSpectra const& quiet, double low, double high,
                           WelchSettings const& settings);

// Significance with which one averaged spectrum lies above another (R6.01). A PSD averaged over n independent
// segments of Gaussian noise is chi-square with 2 n degrees of freedom; the ratio of two of them follows Fisher's F.

struct AveragedPsd {
  double psd = 0;       // x^2/Hz
  double averages = 0;  // independent ones; infinity: known exactly
};

constexpr double largest_significance = 37;  // standard deviations; beyond, a double cannot hold the probability

// Standard deviations of a normal distribution with the same one-sided probability that noise of equal level shows
// such a ratio. Negative below the quiet level; at most `largest_significance`; NaN when a level is not positive.
double excess_significance(AveragedPsd const& loud, AveragedPsd const& quiet);
double sigmas_of_probability(double one_sided);     // 1.35e-3 -> 3
double probability_of_sigmas(double significance);  // 3 -> 1.35e-3

// Factor on an averaged PSD that bounds the true PSD with this probability: 2 n / quantile of chi-square.
double upper_factor(double averages, double confidence);

}  // namespace straytrace::analysis
