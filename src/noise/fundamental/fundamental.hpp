// SPDX-License-Identifier: BSD-3-Clause
// The fundamental noises of a detector as a list of named functions (docs/theory/sensitivity.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "noise/fundamental/detector.hpp"

namespace straytrace::noise {

struct FundamentalNoise {
  std::string_view name;   // as in budget files: letters only
  std::string_view words;  // description
  std::string_view needs;  // parameters that the detector must state
  bool (*known)(Detector const&);
  std::vector<double> (*psd)(Detector const&, std::span<double const> hz);  // strain^2/Hz, one-sided
  std::span<FundamentalNoise const> parts = {};                             // whose PSDs sum to it; empty: no parts
};
std::span<FundamentalNoise const> fundamental_noises();

}  // namespace straytrace::noise
