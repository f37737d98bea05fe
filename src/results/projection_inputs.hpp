// SPDX-License-Identifier: BSD-3-Clause
// Inputs of the projection of noise from the traced model, besides the coupling table. With it in the run file, no
// surface and no search structure is built again (docs/develop/architecture.md, Walk: one displacement).
#pragma once

#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "noise/bands/input_band.hpp"

namespace straytrace::results {

struct ProjectionInputs {
  std::vector<std::string> bodies;  // names; BodyId = position. Elastic modes follow the bodies
  std::vector<bool> meets_light;    // by body: it, or the body of the mode, has surfaces
  double wavelength = 0;            // m
  std::vector<TracedPort> ports;    // in the order of PortId
  std::vector<DrawnOptic> optics;   // that the interferometer may name; of a run: that it names
  std::vector<MaterialSpread> materials;
  std::vector<double> scattered;  // by material: share of the light at normal incidence, to both sides together
  // Lines of the reports: assumptions and results of building the model; light that is not counted, and sources of
  // materials without status.
  std::vector<std::string> notes, limits;
  std::string warnings, warnings_json;  // of the scene: as text; for editors, JSON lists
};

}  // namespace straytrace::results
