// SPDX-License-Identifier: BSD-3-Clause
// The field that the input beam of a scene builds up in its cavity, at a list of detunings (docs/theory/wave.md,
// eq. W.50 to W.52).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "wave/arm/arm_waves.hpp"
#include "wave/modes/driven.hpp"

namespace straytrace::wave {

struct DriveOptions {
  int threads = 0;                       // 0: all
  std::shared_ptr<WaveDevice> device{};  // none: the host
  int highest_order = 2;
  std::function<void(std::string const& what)> progress;
};
DrivenOptions solve_options(DriveOptions const&);
// `coatings` of both mirrors; `detunings` in free spectral ranges from the resonance of the mode.
DrivenScan drive_arm(WaveSettings const&, ArmWaves const&, std::vector<MirrorCoating> const& coatings,
                     std::vector<double> const& detunings, DriveOptions const& = {});

}  // namespace straytrace::wave
