// SPDX-License-Identifier: BSD-3-Clause
// Refractive indices of common glasses and crystals, with the sources of the numbers.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

struct MediumPreset {
  std::string_view name;
  double longest = 0, shortest = 0;  // m, range of vacuum wavelengths
  double temperature = 0;            // K
  double constant = 1;               // n^2 - constant = sum of strength lambda^2/(lambda^2 - resonance), lambda in um
  double strength[3] = {}, resonance[3] = {};
  std::string_view source;
};

std::span<MediumPreset const> medium_presets();
// Index at a vacuum wavelength [m]; empty outside the range of the preset.
std::optional<double> index_of(MediumPreset const&, double wavelength);

}  // namespace straytrace
