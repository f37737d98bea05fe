// SPDX-License-Identifier: BSD-3-Clause
// Modulation of the light of beams as motion (docs/theory/phase.md, eq. N.25).
#pragma once

#include <optional>
#include <vector>

#include "motion/motion.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Adds the phase of each modulated beam to the bodies: rotations [rad] m cos a and m sin a about x and y, a = 2 pi f t
// + start, with the phase sensitivities cos 2 pi f tau and sin 2 pi f tau of a path that leaves this beam the time tau
// before it rejoins, less 1 and 0 where this beam is the local field too. Of one beam the index is then
// 2 m |sin pi f tau|. Afterwards motion.light holds tones of the amplitude alone; a second call adds nothing.
void add_phase_modulation(CouplingTable&, MotionSet&);

// The same without a change of the arguments, which it refers to where no light is modulated in phase.
class ModulatedLight {
 public:
  ModulatedLight(CouplingTable const&, MotionSet const&);
  CouplingTable const& table() const { return table_ ? *table_ : given_table_; }
  MotionSet const& motion() const { return motion_ ? *motion_ : given_motion_; }

 private:
  CouplingTable const& given_table_;
  MotionSet const& given_motion_;
  std::optional<CouplingTable> table_;
  std::optional<MotionSet> motion_;
};

// The beam that the light of a path leaves.
std::uint32_t source_beam(LightModulation const&, std::uint32_t beam, PortId);

// Sidebands of the amplitude of light, s_j (m/2) exp(+-i a): with random static phases each is a path of its own that
// drifts by f turns per second. They are classes behind those of the table.
struct AmplitudeSidebands {
  CouplingTable table;
  MotionSet motion;
  std::vector<std::optional<std::size_t>> of;  // of each class of the given table; nothing: its light is not modulated
};
AmplitudeSidebands amplitude_sidebands(CouplingTable const&, MotionSet const&);

}  // namespace straytrace::noise
