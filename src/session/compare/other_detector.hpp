// SPDX-License-Identifier: BSD-3-Clause
// A design curve holds for one detector: what makes its stray light is compared with the interferometer of a scene.
#pragma once

#include <optional>
#include <string>

#include "results/pygwinc/pygwinc_ifo.hpp"
#include "session/model.hpp"

namespace straytrace {

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
void warn_of_other_detector(Model const&, Node const& place);

}  // namespace straytrace
