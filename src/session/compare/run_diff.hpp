// SPDX-License-Identifier: BSD-3-Clause
// Differences between the results of two runs, with their significance.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "results/results.hpp"
#include "session/compare/model_diff.hpp"

namespace straytrace::session {

struct RunDifference {
  std::vector<Change> bands;  // rms strain of the total in the band, from 1/sqrt(Hz) over all its bins [1]
  // The same over the common band, by largest change of power; matched by id, rows `other` by port and C_rev. These
  // hold routes without a row: a route that only one run lists is in that row of the other, and added to both.
  std::vector<Change> routes;
  Change whole;                   // the total over the common band
  std::vector<Change> receivers;  // power, by name
  bool in_watts = false;          // of receivers: both runs state the power of the main mode, else power over it
  double low = 0, high = 0;       // Hz, the common band
  Histories common = Histories::other;
};

// The change of a total or of a route with its error, from paired replicas where both runs have the same histories
// (docs/theory/errors.md, Comparison of runs). Throws InputError for runs that cannot be compared.
RunDifference run_differences(RunFile const& before, RunFile const& after);
// The total in each bin of `before`; outside the common band a Change without values.
std::vector<Change> changes_by_frequency(RunFile const& before, RunFile const& after);
char const* error_words(Histories);
std::string unit_of_receivers(RunDifference const&);
std::string run_difference_text(RunDifference const&);
nlohmann::ordered_json run_difference_json(RunDifference const&);

// Several runs in one HTML page, each compared with the first: `straytrace report A.h5 B.h5`.

// "before", "after" of before/run.h5 and after/run.h5, without the folders above them; names of two runs that are
// alike get their number.
std::vector<std::string> run_labels(std::vector<std::string> const& files);

// Reads all of them. Throws one InputError with the problems of all: at least two runs, each with noise in a band that
// overlaps that of the first.
std::vector<RunFile> read_compared(std::vector<std::string> const& files);

// `title`: empty for one of the labels.
std::string comparison_page(std::vector<RunFile> const&, std::vector<std::string> const& labels,
                            std::string const& title);

}  // namespace straytrace::session
