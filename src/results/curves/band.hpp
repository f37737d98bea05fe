// SPDX-License-Identifier: BSD-3-Clause
// Reading values off noise curves, and the table of inputs that are not exactly known.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "results/results.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {

// Reading values off noise curves.

// The table of inputs that are not exactly known: the one list of its columns behind text, JSON and pages.

struct SourceRow {
  InputSource const& source;
  std::string status;  // of its material, or "assumed"; empty: not known
};

std::vector<SourceRow> source_rows(NoiseBands const&, ProjectionInputs const* = nullptr);
TableWriter<SourceRow> const& source_table();

constexpr double wrapped_from = 1;  // rad rms; above, fringes wrap (docs/theory/spectra.md, eq. 1.11)

// {low, high}, or the whole grid when high <= low.
std::pair<double, double> band_of(FrequencyGrid const&, double low, double high);
// Origin of the noise of a route over the band: "linear" where motion of the same frequency causes most of it,
// "wrapped" where fringes wrap, "linear > 13 Hz" and "linear < 5 Hz" with one change, "mixed" with more. Without shares
// per frequency by the rms phase alone; "-" where nothing moves.
std::string regime(NoiseTrace const&, FrequencyGrid const&, double low, double high);
// The bins between whose centres a curve is read: `low` and the one above it, with the logarithmic share x of the
// latter. x = 0: the bin alone, next to a line or a zero. Outside the grid `low` is its size.
struct BetweenBins {
  std::size_t low;
  double x;
};
BetweenBins between_bins(std::vector<double> const& curve, FrequencyGrid const&, double hz);
// Between the centres of bins linear in log-log; next to a line or a zero the average of the bin; NaN outside the
// grid.
WithError strain_at(NoiseTrace const&, FrequencyGrid const&, double hz);
// The line in the bin that holds hz, if there is one: a bin above twice either neighbour.
BinLine line_at(NoiseTrace const&, FrequencyGrid const&, double hz);
// A sentence and a line break for each frequency of the table that lies in a bin with a line.
std::string lines_text(PathTable const&);
// Whether a value is an upper bound: it may be less by more than its error, and than 0.05 %, since upper bounds make
// this share of its square.
bool at_most(double value, double sigma, double bound_share);
bool at_most(NoiseTrace const&, std::size_t bin);
std::size_t bound_bins(NoiseBudget const&);  // of the total, where it is that
// Of a band or other curve on the bins, as strain_at().
double band_at(std::vector<double> const& curve, FrequencyGrid const&, double hz);
// Input and speckle bands at some frequencies, and where they come from; empty where they were not made.
std::string band_text(NoiseBudget const&, std::vector<double> const& frequencies);
// Sources of the Monte-Carlo error, in per cent of h; empty where they are unknown.
std::string error_table(NoiseBudget const&, std::vector<double> const& frequencies);
std::string band_summary(NoiseBudget const&, std::vector<double> const& frequencies);  // two lines of it
// The curves of bands by the names that run files, CSV and pages give them.
struct BandCurve {
  char const* name;
  std::vector<double> NoiseBands::*member;
};
inline constexpr BandCurve band_curves[] = {
    {"input_low", &NoiseBands::input_low},   {"input_high", &NoiseBands::input_high},
    {"speckle_05", &NoiseBands::speckle_05}, {"speckle_50", &NoiseBands::speckle_50},
    {"speckle_95", &NoiseBands::speckle_95}, {"coherent", &NoiseBands::coherent}};
// Integral of the PSD over the bins whose centres lie in the band, strain^2; errors of bins add (they are correlated).
WithError band_power(NoiseTrace const&, FrequencyGrid const&, double low, double high);

}  // namespace straytrace::results
