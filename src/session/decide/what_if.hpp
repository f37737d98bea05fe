// SPDX-License-Identifier: BSD-3-Clause
// Noise of a run with other inputs, without tracing, where its coupling table gives the exact answer
// (docs/theory/decisions.md).
#pragma once

#include <string>
#include <vector>

#include "noise/bands/elasticity.hpp"
#include "session/open_run.hpp"

namespace straytrace::session {

struct WhatIf {
  ProjectionModel model;                // with the changes of motion and interferometer
  CouplingTable light;                  // with those of the scatter
  std::vector<std::string> statements;  // each change in words
  std::string warning;                  // of light whose scatters are not counted; empty: it is below 1e-3 of the noise
};

// `settings`, any number together:
//   MATERIAL=x2, MATERIAL=black      the whole BRDF times a factor, or none
//   MATERIAL.tis=2e-4                the share that it scatters at normal incidence
//   BODY.motion=x2                   all motion of a body
//   PLACE=VALUE, PLACE=x2            a value of the scene by its place, "materials.steel.scatter.brdf" or any keys of
//   it
//                                    that name one value, "steel.brdf"
// Takes the model of the run. Throws one InputError with all problems: unknown names, changes of the light that need a
// trace, BSDFs above 1.
WhatIf what_if(OpenRun&, std::vector<std::string> const& settings);

// A value of the scene that a number describes.
struct SceneValue {
  std::string place;                 // "interferometer.mirror_mass"
  std::string written;               // as in the file
  std::optional<Quantity> quantity;  // where it was read as a number
  bool given = true;                 // false: its default
  bool whole = false;
};
// Scalars of the model that are given, and those of the tables `bodies` and `interferometer` that have defaults.
std::vector<SceneValue> scene_values(Scene const&);

// "place=value" with its value times a factor.
std::string times(SceneValue const&, double factor);
// Whether a place lies in a table that the projection alone reads.
bool of_projection(std::string const& place);

}  // namespace straytrace::session
