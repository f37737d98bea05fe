// SPDX-License-Identifier: BSD-3-Clause
// The steady light of a network: powers, resonators, and where the light of the lasers goes.
#pragma once

#include <string>
#include <vector>

#include "ifo/cavities.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

struct PortPower {
  std::string port;
  double in = 0, out = 0;  // W that enters and leaves the component there
  bool open = false;       // without a space
  double fundamental = 0;  // W of mode 00 that leaves
};
struct CavityPower {
  NetworkCavity cavity;  // round trip: with modes, of the mode of the resonator that is nearest to 00
  double power = 0;      // W of all carriers, at the first of its beams
  double gain = 0;       // over the power of the lasers
};
struct EnergyRow {
  enum class Kind : std::uint8_t { emitted, leaving, absorbed, lost };
  Kind kind;
  std::string name;  // of a component, or of an open port
  double power = 0;  // W
};
struct ReadoutValue {
  std::string name, beam;
  double value = 0;  // W; sqrt(W) of a homodyne detector; not a number: rounding
};
struct OperatingPoint {
  std::vector<double> carriers;  // Hz from the laser
  std::vector<PortPower> ports{};
  std::vector<CavityPower> cavities{};
  std::vector<EnergyRow> energy{};
  std::vector<ReadoutValue> readouts{};
  double emitted = 0, missing = 0;  // W; missing: emitted less all others, the error of the solution and of the modes
  bool modes = false;               // not plane waves
};
OperatingPoint operating_point(NetworkModel const&);

}  // namespace straytrace::ifo
