// SPDX-License-Identifier: BSD-3-Clause
// What differs between the results of two runs, with its significance.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "report/report.hpp"

namespace straytrace {

// A value of both runs; `sigmas` of the change in standard errors: of both together where the runs are independent,
// of their difference where both come from the same histories, since these err alike. NaN where there is no answer.
struct Change {
  std::string what, id;  // "30 to 100 Hz", or a route and its hash
  WithError before, after;
  bool bound = false;   // one of them is a lower bound
  bool common = false;  // same histories
  double sigmas() const;
};

struct RunDifference {
  std::vector<Change> bands;   // rms strain of the total in the band, from 1/sqrt(Hz) over all its bins [1]
  std::vector<Change> routes;  // the same over the common band, by largest change of power; matched by id
  double low = 0, high = 0;    // Hz, the common band
  bool common = false;         // same model, seed and number of histories: other motion or responses
};

RunDifference run_differences(RunFile const& before, RunFile const& after);
std::string run_difference_text(RunDifference const&);
nlohmann::ordered_json run_difference_json(RunDifference const&);

}  // namespace straytrace
