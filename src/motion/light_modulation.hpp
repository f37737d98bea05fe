// SPDX-License-Identifier: BSD-3-Clause
// Tones on the light of beams (docs/theory/phase.md, eq. N.25).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/input/table.hpp"

namespace straytrace::motion {

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

}  // namespace straytrace::motion
