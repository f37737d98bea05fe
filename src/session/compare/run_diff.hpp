// SPDX-License-Identifier: BSD-3-Clause
// Differences between the results of two runs, with their significance.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::session {

// A value of both runs, and the change in standard errors; NaN where there is no answer.
struct Change {
  std::string what, id;  // "30 to 100 Hz", or a route and its hash
  WithError before, after;
  double error = 0;    // of the change: of independent runs both together; of the same histories see run_differences
  bool bound = false;  // one of them is a lower bound, or a hint
  // Of a route that only one of the runs lists: the row of the other that may hold it, "other > ITM". It is compared
  // there, together with all such routes.
  std::string within{};
  double held = 0;                           // of the same histories: error of the spectra, 5e-4 of each value
  bool has_before = true, has_after = true;  // whether that run has this route
  bool too_small() const;                    // to count as a change
  double sigmas() const;                     // NaN: no answer
};

struct RunDifference {
  std::vector<Change> bands;  // rms strain of the total in the band, from 1/sqrt(Hz) over all its bins [1]
  // The same over the common band, by largest change of power; matched by id, rows `other` by port and C_rev. These
  // hold routes without a row: a route that only one run lists is in that row of the other, and added to both.
  std::vector<Change> routes;
  double low = 0, high = 0;  // Hz, the common band
  bool common = false;       // same model, seed and number of histories: other motion or responses
};

// Runs of the same histories (other motion or responses) share the light: the power of route j is C_j times a factor
// that the motion sets, and both have the relative error r_j of C_j. The change of a total, h = sqrt(sum of P_j), then
// has the variance sum of ((P_j'/2h' - P_j/2h) r_j)^2.
RunDifference run_differences(RunFile const& before, RunFile const& after);
std::string run_difference_text(RunDifference const&);
nlohmann::ordered_json run_difference_json(RunDifference const&);

}  // namespace straytrace::session
