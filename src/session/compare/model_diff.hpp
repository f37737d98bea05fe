// SPDX-License-Identifier: BSD-3-Clause
// Physical differences between two models: values in SI with defaults, placed shapes, contents of data files. Order,
// comments, names of parameters and spelling of units are ignored.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "results/pygwinc/pygwinc_ifo.hpp"
#include "results/results.hpp"
#include "scene/model_tree.hpp"
#include "session/model.hpp"

namespace straytrace::session {

struct Difference {
  std::string section;        // "materials", "scene", ...
  std::string name, key;      // "baffles/cone", "shape.cone.inner_radius"
  std::string before, after;  // empty: missing
  std::size_t instances = 1;  // of a repeated entry
  std::optional<Quantity> was{}, is{};
};

// By section, in the order of the language. Both scenes have been read by all rooms.
std::vector<Difference> differences(Scene const& before, Scene const& after);
// Parameters with different values, those of only one model last; section "params".
std::vector<Difference> parameter_differences(Scene const& before, Scene const& after);
// In words: parameters first, then differences; changes of one key by many instances in one line. None without a
// difference of the models.
struct DifferenceLine {
  std::string section, what, change;  // "scene", "baffles/cone shape.cone.inner_radius", "49.5 cm -> 48 cm"
};
std::vector<DifferenceLine> difference_lines(std::vector<Difference> const& parameters, std::vector<Difference> const&);
std::string difference_text(std::vector<DifferenceLine> const&);
// Two runs of the same texts have the same model: it need not be built.
bool same_texts(RunContent const&, RunContent const&);
// "noise with the motion of the scene -> storm.yaml"; empty: of the same.
std::string motion_difference(RunContent const& before, RunContent const& after);

// A design curve holds for one detector: what makes its stray light is compared with the interferometer of a scene.

struct OtherDetector {
  std::string what, suggestion;  // for a warning
};
// Of a built-in curve, where arm length (1 %), arm power, mirror mass, finesse or gain (10 %) of the interferometer are
// not those of the detector that the curve is of (data/detectors); of several detectors the one most alike counts.
std::optional<OtherDetector> other_detector(std::string const& curve, Interferometer const&);

// Of the light of a run, where the same numbers of its interferometer are not those of the detector whose budget it
// stands in. `detector`: as it was named.
std::optional<OtherDetector> other_detector(IfoFile const& budget, std::string const& detector, std::string const& run,
                                            Interferometer const&);

// Warns at `place` for each of the curves that the model is compared with.
void warn_of_other_detector(ProjectionModel const&, Node const& place);

// A value of two runs, its change and its ratio, with their errors (docs/theory/errors.md, Comparison of runs).

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
