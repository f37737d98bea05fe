// SPDX-License-Identifier: BSD-3-Clause
// Parameters of a scene from the power measured on photodiodes of its baffles (docs/reference/fit.md).
#pragma once

#include <string>
#include <vector>

#include "session/options.hpp"
#include "wave/diodes/diode_fit.hpp"

namespace straytrace::session {

// A parameter of the scene with the range that is searched, in its unit as written: "tilt=-1..1 urad".
struct FreeParameter {
  std::string name, unit;
  FitRange range;
};
FreeParameter free_parameter(std::string const& text);  // InputError names --free

struct BaffleFitRequest {
  SceneOptions scene;
  std::string measured;  // CSV: photodiode, power [W], error [W]
  std::vector<std::string> free;
  unsigned threads = 0;  // 0: all
};
struct BaffleFit {
  std::string beam;
  double arm_power = 0;  // W
  std::vector<FreeParameter> parameters;
  std::vector<std::string> diodes;  // as measured
  std::vector<double> measured, error;
  std::vector<double> speckle;  // share of the variance on each
  std::size_t left_out = 0;     // photodiodes of the scene without a measurement
  DiodeFit fit;
};
// Throws InputError with all problems of the request.
BaffleFit fit_baffle(BaffleFitRequest const&);

}  // namespace straytrace::session
