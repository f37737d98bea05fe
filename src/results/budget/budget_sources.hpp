// SPDX-License-Identifier: BSD-3-Clause
// Noises of a budget that come from files: strain ASD on the frequencies of each file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/constants.hpp"
#include "noise/fundamental/budget.hpp"
#include "noise/noise.hpp"

namespace straytrace::results {

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

}  // namespace straytrace::results
