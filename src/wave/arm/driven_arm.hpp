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

struct DrivenArm {
  std::array<MirrorCoating, 2> coatings;
  double free_spectral_range = 0;       // Hz
  double entered = 0;                   // power of the input within the first mirror
  std::vector<double> input_orders;     // its shares in the modes of each order of the mirrors alone; empty: the mode
                                        // of the cavity is the input
  std::vector<DrivenPowers> detunings;  // in the order given
  double error = 0;                     // of the field, at the worst of them, at most
  int round_trips = 0;
  std::vector<std::string> warnings;
};

struct DrivenArmOptions {
  int threads = 0;                       // 0: all
  std::shared_ptr<WaveDevice> device{};  // none: the host
  int highest_order = 2;
  std::function<void(std::string const& what)> progress;
};
// `detunings` in free spectral ranges from the resonance of the mode.
DrivenArm drive_arm(WaveSettings const&, ArmWaves const&, std::array<MirrorCoating, 2> const&,
                    std::vector<double> const& detunings, DrivenArmOptions const& = {});

}  // namespace straytrace::wave
