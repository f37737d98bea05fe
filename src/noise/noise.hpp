// SPDX-License-Identifier: BSD-3-Clause
// coupling table x motion x interferometer -> strain noise (docs/theory/spectra.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "motion/motion.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Logarithmic bins. Every PSD of the noise stage is the AVERAGE over its bin, so that power is conserved: the sum of
// PSD times bin width is the power in the band, lines included.
struct FrequencyGrid {
  std::vector<double> edges;  // Hz, size n + 1, strictly increasing
  std::size_t size() const { return edges.empty() ? 0 : edges.size() - 1; }
  double centre(std::size_t i) const;  // geometric mean of the edges
  double width(std::size_t i) const { return edges[i + 1] - edges[i]; }
  std::size_t bin_of(double hz) const;  // the bin that holds hz; size() outside the grid
};
FrequencyGrid logarithmic_grid(double low_hz, double high_hz, double points_per_decade);

// One curve: strain ASD, 1/sqrt(Hz), one-sided, mean over the static phases (speckle mean).
struct NoiseTrace {
  std::string name;           // route or "total"
  std::uint64_t hash = 0;     // route hash; 0 for totals
  std::vector<double> asd;    // 1/sqrt(Hz)
  std::vector<double> sigma;  // one standard error of asd, Monte Carlo only
  // Its parts: the error if only the power of the routes, only the second moments of their phase
  // sensitivities or only the spectra of the kept paths were uncertain. They are correlated: their squares do not sum
  // to its square. Empty when not known.
  std::vector<double> power_sigma, phase_sensitivities_sigma, paths_sigma;
  std::vector<double> phase_asd, amplitude_asd;  // the two quadratures alone (eq. 9.1 and 9.2)
  // Share of the PSD from motion of about this frequency to first order; the rest is fringe wrapping of slower motion.
  // NaN where there is no noise.
  std::vector<double> linear_share;
  // Of routes: the range allowed by stated brackets and uncertainties of materials and motion; empty when not computed.
  // NoiseBands holds that of the total.
  std::vector<double> input_low, input_high;
  // Of routes that are a mean over draws of mirrors and edges (kind wave): percentiles 5 and 95, and the
  // standard error of the mean; otherwise empty.
  std::vector<double> draws_low, draws_high, draws_sigma;
  std::vector<std::vector<double>> draws;  // asd of each draw, as if it were the mean
  // rad^2, mean over the paths by power, of a row `other` by noise: linear below 1e-2, fringe wrapping above 1.
  double mean_square_phase = 0;
  bool resolved = true;
  std::string why_not;
  bool faint = false;               // unresolved, but its observed part is below `faint_limit`
  bool upper_bound = false;         // of routes: computed as an upper bound (kind edge)
  std::vector<double> bound_share;  // of the total: share of the PSD that such routes make; empty: not computed
  // Of the total: PSD without the histories of one replica each, less what no history changes; empty: no such part.
  // Not in run files.
  std::vector<std::vector<double>> without;
  std::vector<double> hint_sigma;  // of the total: the part of `sigma` by unresolved routes; not in run files

  // strain^2/Hz, from the ASD stored in run files: a new budget and one read from a file agree to the last bit.
  double psd(std::size_t bin) const { return asd[bin] * asd[bin]; }
  double psd_sigma(std::size_t bin) const { return 2 * asd[bin] * sigma[bin]; }
};
// An unresolved route whose observed noise is below this share of the total PSD in every bin cannot change the total by
// 1 %, even if the trace missed ten times more.
constexpr double faint_limit = 1e-3;

struct DesignCurve {
  std::string name;         // "adv-lal" or file name; always printed with the curve
  std::vector<double> asd;  // on the grid's centres, 1/sqrt(Hz); NaN outside its range
};

// An uncertain input and its effect on the total (docs/theory/errors.md).
struct InputSource {
  std::string name;          // "material steel", "motion of tube"
  std::string statement;     // "bracket x 0.33 to 3.3 (assumed)", "one sigma: factor 1.3"
  double low = 1, high = 1;  // least and largest factor on the ASD of the total, over the band
  double share = 0;          // of the noise power of the band that arrives on routes it affects
};
// Uncertainties of the total besides its Monte-Carlo error; 1/sqrt(Hz), empty when not computed.
struct NoiseBands {
  std::vector<double> input_low, input_high;               // uncertainty of materials and motion
  std::vector<double> speckle_05, speckle_50, speckle_95;  // percentiles of one realisation of the static phases
  std::vector<double> coherent;                            // linear sum of the ASDs of all routes: upper bound
  std::vector<InputSource> sources;                        // those with a stated spread
  std::vector<std::string> taken_as_exact;                 // those without
  bool made() const { return !speckle_50.empty(); }
};

// Known phase of the stray field of every route that this body moves, against the main field, rad.
struct StaticPhase {
  std::string body;
  double phase = 0;
};

// Positions of a body along the beam, equally spaced over a quarter of the wavelength: static phases of k 180 deg /
// count. The phase of a route, and so its spectrum, repeats after that (docs/theory/spectra.md, eq. N.26).
struct ScannedPhase {
  std::string body;
  std::uint32_t count = 0;
  double phase(std::uint32_t k) const { return pi * k / count; }  // rad
};

struct NoiseSettings {
  FrequencyGrid grid;
  std::vector<StaticPhase> static_phases{};  // all others are random
  std::optional<ScannedPhase> scanned{};     // of one body; the budget is the mean over its positions
  bool delay = false;   // each hit acts as early as the light met it (docs/theory/time_domain.md, eq. N.29)
  double margin = 0.1;  // of the design curve (docs/theory/sensitivity.md)
  std::vector<std::string> compare;  // design curves by name or file
};

// Total with a body at one of its positions.
struct PositionCurve {
  double phase = 0;         // rad, of the stray field of the routes that it moves
  std::vector<double> asd;  // 1/sqrt(Hz)
};

struct NoiseBudget {
  FrequencyGrid grid;
  // All resolved classes, and the observed part of unresolved ones with an error as large as itself (the error of a
  // mean over one history). A lower bound when `unresolved` is not empty; NaN when no class is resolved.
  NoiseTrace total;
  std::vector<NoiseTrace> routes;       // one per coupling class, same order as the table
  std::vector<std::string> unresolved;  // names, with reason, of those that could matter
  std::vector<std::string> faint;       // names, with reason, of the faint ones
  double faint_share = 0;               // largest ratio, over bins, of the observed faint noise to the total
  double unresolved_hint = 0;           // largest ratio unresolved / total in PSD over the band, as a hint
  std::vector<DesignCurve> design;
  double margin = 0.1;
  double seconds = 0;
  NoiseBands bands;                      // of the total
  std::string scanned_body;              // empty: none
  std::vector<PositionCurve> positions;  // of it; the mean of their PSDs is that of the total
  // Where more histories do not lower the error; where drawn paths represent all (SpectrumInterpolator): their
  // contribution to the error, included in `sigma`.
  std::vector<std::string> warnings;
};

// Change of the ASD of the total by each replica, 1/sqrt(Hz), [replica][bin]. Their squares sum to that of its error
// from the paths found, and their products give the correlation of its bins (docs/theory/errors.md). Empty: no error.
std::vector<std::vector<double>> deviations(NoiseTrace const& total);

NoiseSettings read_noise_settings(Node const& table);  // table `noise`; absent keys have defaults
// Lowest and highest curve over the positions, per bin; empty without positions.
struct PositionBand {
  std::vector<double> low, high;  // 1/sqrt(Hz)
};
PositionBand position_band(NoiseBudget const&);

// Design curves: built-in fits (docs/theory/environment.md, eq. 12.1) or two-column text read through the table's
// document.
std::vector<DesignCurve> read_design_curves(Node const& noise_table, NoiseSettings const&);

// `upper_bound` of the routes and `bound_share` of the total, from the kinds of the classes.
void find_bounds(NoiseBudget&, CouplingTable const&);

// Throws NumericalError when a contribution is not finite.
NoiseBudget project_noise(CouplingTable const&, MotionSet const&, Interferometer const&, NoiseSettings const&);

}  // namespace straytrace::noise
