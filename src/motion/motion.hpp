// SPDX-License-Identifier: BSD-3-Clause
// Motion of bodies: independent inputs (ground axes, own noise of each body, tones) times gains per body and
// coordinate, so that correlations between bodies are always included (docs/develop/architecture.md).
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "base/memory/ids.hpp"
#include "motion/motion_files.hpp"
#include "spectra/filters.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {

// Tones on the light of beams (docs/theory/phase.md, eq. N.25).

// The field of a beam is (1 + amplitude cos a) exp(i phase cos a), a = 2 pi frequency t + start, at its start and time
// t from the beginning of a record.
struct LightTone {
  std::uint32_t beam = 0;  // position in the table `beams`
  std::string name;        // of the beam
  double frequency = 0;    // Hz
  double amplitude = 0;    // peak, of the field, relative
  double phase = 0;        // rad, peak
  double start = 0;        // rad
};

constexpr std::uint32_t no_light = 0xffffffff;

struct LightModulation {
  std::vector<LightTone> tones;
  std::vector<std::uint32_t> port_beam;  // by PortId: the beam whose light is the local field
  // Bodies of a MotionSet from the first on, before the end, are phases of light, not bodies.
  std::uint32_t first_body = no_light, end_body = no_light;
  bool is_light(std::uint32_t body) const { return body >= first_body && body < end_body; }
};

// The keys `modulation` of the table `beams`. Problems go to the document. `port_names`: in the order of PortId.
LightModulation read_modulation(Node const& beams, Node const& ports, std::vector<std::string> const& port_names);

// d(coordinate of body)/d(input). `value` is complex for tones, whose coordinates move as Im(value exp(+2 pi i f t)),
// real otherwise; `transfer` counts for exp(-2 pi i f t).
// axis: 0..2 translations x, y, z along the world axes; 3..5 rotations about them through the body's pivot.
struct Gain {
  BodyId body;
  int axis = 0;
  std::complex<double> value{1, 0};
  std::shared_ptr<TransferFunction const> transfer = {};  // times `value`; null: 1. For tones `value` includes it
};

// One independent source of motion: a one-sided displacement spectrum, stationary and Gaussian; a tone; or a drift.
struct MotionInput {
  std::string name;           // "ground z", "tube x", for messages
  Spectrum spectrum;          // m^2/Hz (rad^2/Hz for rotations); unused for a tone
  double tone_frequency = 0;  // Hz; > 0: deterministic sine of unit PEAK amplitude, gains carry the amplitudes
  std::vector<Gain> gains = {};
  bool drift = false;                               // constant velocity of 1 m/s (1 rad/s), gains carry the velocities
  std::shared_ptr<TimeSeries const> recorded = {};  // m or rad: measured; `spectrum` is then its averaged periodogram
  // One standard deviation of the ASD (of the amplitudes of a tone) as a factor >= 1: it lies between 1/uncertainty and
  // uncertainty times the stated value.
  double uncertainty = 1;
};

class MotionSet {
 public:
  std::vector<MotionInput> inputs;
  std::vector<std::string> bodies;  // names; BodyId = position
  std::vector<MotionFile> files;    // measured motion, one entry for each coordinate that it moves
  LightModulation light;            // of beams

  // |sum over bodies and axes of phase sensitivity times gain times transfer function|^2: factor from the PSD of input
  // i at a frequency to the PSD of the phase of a path (rad^2/m^2); for a tone, at any frequency, the square of its
  // phase amplitude z (docs/theory/spectra.md, eq. 7.2, 7.12), for a drift that of its phase rate [rad^2/s^2].
  double sensitivity(std::size_t i, std::span<PhaseSensitivity const> phase_sensitivities, double hz) const;
};

// Reads the table `bodies` of a scene. Every body that light can reach must have a motion ("still" must be stated;
// it is not a default). Problems go to the document. `bodies`: names in the order of BodyId; `placed`: whether surfaces
// belong to each (empty: to all). A body without surfaces that carries no body with surfaces is a warning. A body
// outside `bodies` of a `traced` run that carries none of them is a problem, since it has no phase sensitivities.
MotionSet read_motion(Node const& bodies_table, std::vector<std::string> const& bodies, bool traced = false,
                      std::vector<bool> const& placed = {});

// Names in the order of BodyId: the bodies of the table, then their elastic modes as "body/mode".
std::vector<std::string> bodies_and_modes(Node const& bodies_table);

}  // namespace straytrace::motion
