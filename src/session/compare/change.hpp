// SPDX-License-Identifier: BSD-3-Clause
// A value of two runs, its change and its ratio, with their errors (docs/theory/errors.md, Comparison of runs).
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>

#include "results/results.hpp"

namespace straytrace::session {

// What two runs have in common.
enum class Histories : std::uint8_t {
  other,       // nothing: independent
  same,        // seed and numbers of the histories, of different models: their replicas are paired
  same_light,  // and the model: other motion or responses
};
Histories common_histories(RunFile const& before, RunFile const& after);

// A power in a run with its deviation in each replica, in its own unit.
struct ReplicatedPower {
  double value = 0;
  ReplicaPattern off = {};  // by the light found: the squares add up to the variance of the light
  double rest = 0;          // variance that the light does not explain, such as that of phase sensitivities
  double unseen = 0;        // square of the largest contributions of one history: what none has shown may be as large
  void add(ReplicatedPower const&);
  void set_error(double sigma);  // of a sum whose error is known: `rest` is what its light leaves
};
// `sigma`: of `value`, which is proportional to the light of this class. `all_of_it`: all of the error goes with the
// light, as in projections of one run.
ReplicatedPower replicated(CouplingTable const&, CouplingClass const&, double value, double sigma, bool all_of_it);

struct ErrorOfChange {
  double change = 0;  // of after - before
  double ratio = 0;   // of after/before, relative
  bool paired = false;
};
// Of values that are these powers to the `exponent`: from paired replicas where the histories are the same, otherwise
// of independent runs.
ErrorOfChange error_of_change(WithError const& before, WithError const& after, ReplicatedPower const& power_before,
                              ReplicatedPower const& power_after, Histories, double exponent);

// A value of both runs, and the change in standard errors; NaN where there is no answer.
struct Change {
  std::string what, id;  // "30 to 100 Hz", or a route and its hash
  WithError before, after;
  ErrorOfChange error = {};
  bool bound = false;  // one of them is a lower bound, or a hint
  // Of a route that only one of the runs lists: the row of the other that may hold it, "other > ITM". It is compared
  // there, together with all such routes.
  std::string within = {};
  double held = 0;                           // of the same light: error of the spectra, 5e-4 of each value
  bool has_before = true, has_after = true;  // whether that run has this route
  char const* zero = "still";                // what a value of 0 means
  bool too_small() const;                    // to count as a change
  double sigmas() const;                     // NaN: no answer
  WithError ratio() const;                   // after over before; NaN: not defined, or compared elsewhere
};
constexpr double significant = 3;  // standard errors

std::string value_text(Change const&, bool after);  // "1.23e-24 ± 4e-26", "still", "none", "in 'other > ITM'"
std::string ratio_text(Change const&);              // "0.832(12)"; "-" where it is not defined
std::string verdict_text(Change const&);  // "+4.2 sigma, significant", "the same", "compared within 'other > ITM'"
// "grew", "fell", "new", "vanished", "the same", "no change resolved", "not resolved", "upper bound", "in 'other >
// ITM'".
std::string outcome_text(Change const&);
nlohmann::ordered_json change_json(Change const&);

}  // namespace straytrace::session
