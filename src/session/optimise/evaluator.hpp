// SPDX-License-Identifier: BSD-3-Clause
// Candidates of a scene: what is known of one without a trace, then its noise, traced once per model.
#pragma once

#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "noise/noise.hpp"
#include "results/results.hpp"
#include "session/optimise/order.hpp"
#include "session/optimise/search.hpp"
#include "session/scan/scan_points.hpp"

namespace straytrace::session {

// Whether a curve lies below a line in all bins at once (docs/theory/optimisation.md, eq. O.2).

// Factor on the standard errors with which all of these bins are upper limits at once. `deviations`: of each bin by
// each replica, [replica][bin]. Of one bin the quantile of Student's t; of more the distribution of the largest of the
// correlated errors, from a fixed set of Gaussian multipliers.
double factor_of_all(std::vector<std::vector<double>> const& deviations, double confidence);

struct LineVerdict {
  double excess = not_a_number;                 // logarithm of the largest upper limit over the line: met at 0 or below
  WithError ratio{not_a_number, not_a_number};  // of the curve to the line in that bin, with its standard error
  double hz = not_a_number, factor = not_a_number;
  std::vector<double> deviations{};  // of the logarithm of the curve there, by replica
};
// Of the total, in which the observed power of unresolved routes counts tenfold. `line`: ASD per bin, NaN: not
// compared. Without a bin the excess is NaN.
LineVerdict compared(NoiseBudget const&, std::vector<double> const& line, double confidence);

// A candidate as the table of results lists it.
struct Outcome {
  std::vector<std::string> settings;  // "rim=0.3495 m"
  double objective = not_a_number;    // the cost; of the least noise the largest ratio to the line
  std::vector<double> excess;         // of the relations, then of the noise limits
  std::vector<LineVerdict> limits;    // of the noise limits; of the least noise the line is the last
  ScanPoint point;                    // as traced; without histories where it was not
  bool traced = false;
  std::string problem;  // of the scene with these settings; empty: none

  double worst() const;                 // largest excess
  LineVerdict const* deciding() const;  // of the limits, or the line where there is none
  bool met() const { return worst() <= 0; }
};

class Evaluator {
 public:
  Evaluator(ScanOptions options, OptimiseOrder const& order);

  // Of the values of the varied parameters, in SI; of a list the number of the value.
  std::vector<std::string> settings_of(std::vector<double> const& values) const;
  // Before any trace, all that makes the search impossible: throws InputError.
  void check(std::vector<double> const& start) const;
  std::vector<double> own_values() const;                 // of the scene, inside the ranges
  double price(std::vector<double> const& values) const;  // NaN where the scene is impossible
  // None when stopped. Each set of settings is evaluated once at each level, with `histories(level)`.
  std::optional<std::size_t> evaluate(std::vector<double> const& values, int level = 0);
  std::uint64_t histories(int level) const { return first_histories_ << (2 * level); }
  Outcome const& outcome(std::size_t number) const { return outcomes_.at(number); }
  std::vector<Outcome> const& outcomes() const { return outcomes_; }
  // The same settings with another seed and number of histories; incomplete when stopped.
  Outcome traced_anew(Outcome const&, std::uint64_t seed, std::uint64_t histories) const;
  std::string const& line() const { return line_; }

 private:
  struct Known {
    double price = not_a_number;
    std::vector<double> excess;
    std::string problem;
  };
  Known known(std::vector<std::string> const& settings) const;
  void judge(Outcome&, Model const&, TracedLight const&, NoiseBudget const&) const;
  void measure(Outcome&, Scanner&) const;
  Scanner& scanner(int level);

  ScanOptions options_;
  OptimiseOrder const& order_;
  Scanner scanner_;
  std::map<int, Scanner> finer_;  // by level above 0, each with a folder of its own
  std::uint64_t first_histories_;
  std::string line_;
  std::vector<Outcome> outcomes_;
  std::map<std::pair<int, std::vector<std::string>>, std::size_t> numbers_;  // by level and settings
  mutable std::map<std::vector<std::string>, Known> known_;
};

}  // namespace straytrace::session
