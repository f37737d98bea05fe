// SPDX-License-Identifier: BSD-3-Clause
// Noise budgets and design curves (docs/theory/sensitivity.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/namespaces.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace straytrace::noise {

// Noise budgets: the sum, and which noises are small enough (docs/theory/sensitivity.md, R2.22, R2.23).

// Uncertainties of stray light besides its Monte-Carlo error, 1/sqrt(Hz); empty where not computed.
struct BudgetBands {
  std::vector<double> input_low, input_high;               // range allowed by the stated inputs
  std::vector<double> speckle_05, speckle_50, speckle_95;  // percentiles of one realisation of the static phases
};
// A band and the name of its columns in files.
struct BudgetBandColumn {
  char const* name;
  std::vector<double> BudgetBands::*curve;
};
constexpr BudgetBandColumn budget_band_columns[] = {{"input_low", &BudgetBands::input_low},
                                                    {"input_high", &BudgetBands::input_high},
                                                    {"speckle_05", &BudgetBands::speckle_05},
                                                    {"speckle_50", &BudgetBands::speckle_50},
                                                    {"speckle_95", &BudgetBands::speckle_95}};

// ASD of strain, 1/sqrt(Hz), on the frequencies of the budget; NaN where the noise is not known.
struct BudgetEntry {
  enum class Kind { fundamental, technical, stray_light };
  std::string name, words;
  Kind kind = Kind::fundamental;
  std::vector<double> asd;
  std::vector<double> sigma;  // one standard error, Monte Carlo; empty: none
  std::string note;           // not visible in the numbers: a lower bound
  std::vector<BudgetEntry> parts;
  BudgetBands bands{};
  std::vector<bool> at_most{};  // where the ASD is an upper bound; empty: nowhere
  bool incomplete = false;      // routes are unresolved: where `at_most`, the ASD is no bound at all
  bool inputs_stated = false;   // an input states its uncertainty: the input band is wider than the mean
};

struct NoiseTable {
  std::vector<double> hz;
  std::vector<BudgetEntry> entries;
  // Root of the sum of the squares of all known noises, at every frequency; NaN where none is known.
  std::vector<double> total() const;
  // One standard error of the total: entries are independent of each other. Empty when no entry has one.
  std::vector<double> total_sigma() const;
  // The total with every entry at the low or the high end of its input band, since equal materials are in all runs;
  // empty when no entry states inputs.
  std::vector<double> total_at(std::vector<double> BudgetBands::*end) const;
  // Above it an entry is not small compared to the reference: margin times reference.
  static bool exceeds(double asd, double reference, double margin) { return asd > margin * reference; }
};

// The noises whose parameters the detector states, and the names of the others with the parameters that they need.
struct FundamentalEntries {
  std::vector<BudgetEntry> entries;
  std::vector<std::string> left_out;
};
FundamentalEntries fundamental_entries(Detector const&, std::span<double const> hz);

// Requirement of LIGO on stray light (G0900670): a tenth of the thermal noise of suspensions and test masses; strain
// ASD, empty when one of them is not known.
std::vector<double> thermal_requirement(NoiseTable const&);

// Built-in design sensitivities (docs/theory/sensitivity.md). The name states the source: curves of one detector differ
// by factors.

// "adv-lal", "kagra-lal" (formulas), "et-d-points" (seven points), and the tables of data/curves: "et-d",
// "aligo-gwinc", "aplus-gwinc", "ce1-gwinc", "ce2-silica-gwinc".
std::span<std::string const> built_in_designs();

// Budgets (data/detectors) of the detectors that the curve is of, whose numbers it depends on; of xylophones each.
// Empty for a name that is not built in.
std::vector<std::string> detectors_of_design(std::string_view name);

// Strain ASD in 1/sqrt(Hz); NaN outside the range of a table and for an unknown name.
double design_asd(std::string_view name, double hz);

}  // namespace straytrace::noise
