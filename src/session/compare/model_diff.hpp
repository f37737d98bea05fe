// SPDX-License-Identifier: BSD-3-Clause
// Physical differences between two models: values in SI with defaults, placed shapes, contents of data files. Order,
// comments, names of parameters and spelling of units are ignored.
#pragma once

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

}  // namespace straytrace::session
