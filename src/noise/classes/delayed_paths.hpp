// SPDX-License-Identifier: BSD-3-Clause
// Motion that a path feels besides that of its bodies now: some time before it rejoins, and as modulation of its light.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// The motion of each body as the light felt it, some time before it rejoins (docs/theory/time_domain.md, eq. N.29).

// Equidistant delays from 0 to the longest, between which exp(i omega tau) is interpolated, for each omega up to a
// highest: a delay is a sum of weights of up to twelve of them.
class DelayLattice {
 public:
  static constexpr double accuracy = 1e-7;  // of exp(i omega tau), absolute
  static constexpr std::size_t most = 64;   // nodes
  // Throws InputError when more nodes are needed.
  DelayLattice(double longest, double highest_hz);

  std::size_t size() const { return nodes_; }
  double delay(std::size_t node) const { return nodes_ > 1 ? longest_ * double(node) / double(nodes_ - 1) : 0; }  // s
  using Weights = std::vector<std::pair<std::size_t, double>>;  // node, weight
  // For the part d of a phase sensitivity with this moment: all of it at moment/d; where that is no delay of the
  // lattice, because hits of different sign nearly cancel, the parts at 0 and at the longest that have this sum and
  // moment.
  Weights parts(double d, double moment) const;

 private:
  Weights at(double delay) const;
  double error(double highest_hz) const;

  double longest_;
  std::size_t nodes_ = 1;
};

// A coupling table and a motion in which delayed copies of the bodies follow the inputs as much later: projected like
// any others, they give eq. N.29. Bodies keep their numbers, and copies come after them; second moments of the phase
// sensitivities are those without delays. `highest_hz`: of the noise. Throws InputError where the table has no delays.
struct DelayedPaths {
  CouplingTable table;
  MotionSet motion;
};
DelayedPaths with_delays(CouplingTable const&, MotionSet const&, double highest_hz);

// What a budget without delays neglects (eq. 2.6), where it is largest: ASD of h with delays over that without, to
// first order in the motion of the frequency; slower motion that wraps the fringes is taken as it is. No frequency:
// nothing moves, or the table has no delays.
struct DelayEffect {
  double hz = 0, factor = 1;
  bool matters() const { return factor < 0.99 || factor > 1.01; }
};
DelayEffect delay_effect(CouplingTable const&, MotionSet const&, Interferometer const&, NoiseBudget const&);

// Modulation of the light of beams as motion (docs/theory/phase.md, eq. N.25).

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
