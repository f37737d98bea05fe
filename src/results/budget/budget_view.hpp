// SPDX-License-Identifier: BSD-3-Clause
// A noise budget from detectors, run files and budgets of pygwinc, as text, columns, JSON and HDF5.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/constants.hpp"
#include "noise/fundamental/budget.hpp"
#include "noise/noise.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"

namespace straytrace::results {

// Noises of a budget that come from files: strain ASD on the frequencies of each file.

// An ASD curve that is evaluated where needed; `sigma` may be empty. Of a run `hz` are the centres of its bins:
// the first and the last value hold out to the ends of its band.
struct Sampled {
  std::vector<double> hz, asd, sigma;
  double low = infinity, high = -infinity;  // Hz, the band; without one that of `hz`
  FrequencyGrid bins{};                     // of a run: averages over bins, read as its tables read them
  std::vector<double> on(std::vector<double> const& at, std::vector<double> const& values) const;
};
// Two columns, or the one of a table that has one of the names; throws InputError.
Sampled two_columns(std::string const& file, std::string const& what, std::span<std::string_view const> names);
Sampled total_of_budget_file(std::string const& file);  // throws InputError

// Source of the stray light of an entry.
struct RunAbout {
  std::string path;                                     // as it was named
  std::string entry, file, title, model_hash, created;  // file: with the folder it stands in
  std::string content;                                  // data_hash: equal for equal results
  std::uint64_t seed = 0, histories = 0;
};

// An entry with its parts, before it is put on frequencies.
struct NoiseSource {
  BudgetEntry entry;
  Sampled curve;
  std::vector<NoiseSource> parts;
  std::string file;                   // as it was named
  RunAbout run;                       // of a run file
  std::vector<std::string> models{};  // hashes of the scenes whose stray light is in it
  BudgetBands bands{};                // on the frequencies of the curve
  std::vector<std::string> warnings{};
  std::vector<bool> bound_bins{};  // of a run: bins in which it is an upper bound
  std::vector<double> borders{};   // Hz, of a run: of bins that hold a line, of the total or of a route
  BudgetEntry on(std::vector<double> const& at) const;
};

bool holds_fundamental(NoiseSource const&);  // by its name: of a budget file

enum class InputKind { detector, run, budget };
InputKind kind_of_input(std::string const& file);  // by its content; throws InputError for any other file

NoiseSource stray_light(std::string const& run_file);                // total, and the routes that are resolved
std::vector<NoiseSource> noises_of_budget(std::string const& file);  // every noise of a budget of pygwinc

// Noise that a sum would count twice: a sentence for each pair of inputs, with the remedy. `fundamental`: names of the
// noises of the detector `detector`.
std::vector<InputError> repeats(std::vector<NoiseSource> const&, std::vector<std::string> const& fundamental,
                                std::string const& detector);
// Equal names get the folder or the file behind them, equal titles as well.
void name_apart(std::vector<NoiseSource>&);

// A budget on one set of frequencies.
struct BudgetOn {
  NoiseTable table;
  std::vector<DesignCurve> curves;  // ratios refer to the first one
  std::vector<DesignCurve> lines;   // curves that are not separate noises: shot noise alone, quantum limit, requirement
  std::vector<double> metres;       // change of the difference of the arms per strain; empty without a detector
};

struct BudgetView {
  std::string title, version, commit;  // of the program
  std::vector<std::string> inputs;
  std::optional<IfoFile> ifo;
  std::string detector;  // as it was named
  std::vector<RunAbout> runs;
  std::vector<std::string> models;  // hashes of the scenes whose stray light is in it
  BudgetOn grid, at;                // for curves and pictures; for the table
  double margin = 0.1;
  std::vector<std::string> left_out, warnings;
};

std::string budget_text(BudgetView const&);     // as text
std::string budget_columns(BudgetView const&);  // text file with one column per noise
nlohmann::ordered_json budget_json(BudgetView const&);
std::string budget_pygwinc(BudgetView const&);  // bytes of an HDF5 file

struct BudgetRequest {
  std::vector<std::string> inputs, overrides, compare;
  std::vector<double> at, band;  // Hz; `band`: its two ends, or empty
  double margin = 0.1;
  std::size_t points = 0;  // 0: those of the first run or budget, 300 without one
};
BudgetView gather_budget(BudgetRequest const&);  // throws InputError

}  // namespace straytrace::results
