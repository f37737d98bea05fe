// SPDX-License-Identifier: BSD-3-Clause
// The command `optimise`: the search over the candidates of a scene, the best ones traced anew, and their report
// (docs/theory/optimisation.md).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "report/html/page_json.hpp"
#include "results/text/columns.hpp"
#include "session/optimise/evaluator.hpp"

namespace straytrace::session {

struct OptimiseOptions : ScanOptions {
  OrderWords words;
  bool pareto = false;
  double tolerance = 0.01;           // of the ranges
  std::size_t most = 60;             // candidates of one search
  std::uint64_t most_histories = 0;  // of a candidate, where the error hides the predicted gain; 0: as the first
};

// A candidate traced with a seed that the search has not seen.
struct Finalist {
  std::size_t number = 0;  // among the outcomes
  Outcome fresh;
  enum class Verdict { met, missed, undecided } verdict = Verdict::undecided;
};

struct OptimiseReport {
  std::string model, line;
  OptimiseOrder order;
  std::uint64_t seed = 0;
  std::vector<Outcome> outcomes;   // the first: the values of the scene, as near as the ranges allow
  std::vector<std::string> ended;  // how each search ended
  // By outcome, of the best ones of searches: what the limits cost, as of SearchResult; the relations first.
  std::map<std::size_t, std::vector<WithError>> multipliers;
  std::vector<Finalist> finalists;
  std::optional<std::size_t> chosen;  // among the finalists
  std::size_t closest = 0;            // outcome, where no finalist is chosen
  bool complete = true;

  // Whether no other outcome is both cheaper and quieter.
  bool on_front(std::size_t outcome) const;
};

// Parts of the text and the page: what was varied and spent; what was gained and what binds, a line each; the
// candidates, and those traced anew.
std::string range_text(VariedParameter const&);
std::string spent_text(OptimiseReport const&);
std::string optimise_verdict(OptimiseReport const&);
Columns candidates_table(OptimiseReport const&);
Columns finalists_table(OptimiseReport const&);

std::string optimise_text(OptimiseReport const&);
std::string optimise_page(OptimiseReport const&, Picture const&);  // HTML; it loads nothing
std::string optimise_json(OptimiseReport const&);
std::string optimise_csv(OptimiseReport const&);  // the candidates, all digits

// Exit code: done, unmet or checkpointed.
int optimise(OptimiseOptions const&);

}  // namespace straytrace::session
