// SPDX-License-Identifier: BSD-3-Clause
// A network at its operating point: powers and resonators, modes, and its noise budget.
#pragma once

#include <string>
#include <vector>

#include "ifo/mode_bases.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

// The steady light of a network: powers, resonators, and where the light of the lasers goes.

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

// What the light of a network consists of, and whether its modes suffice (docs/theory/interferometer.md, eq. N.6 to
// N.10).

struct BeamModes {
  std::string port;             // that the light leaves
  double power = 0;             // W, all carriers
  std::array<double, 2> w{};    // m, of the basis there along x and y
  std::vector<double> share{};  // of the power, by order n + m
};
struct Resonance {
  std::string cavity, start;  // start: the port that its first beam leaves
  bool stable = false, basis = false;
  CavityMode mode{};
};
// Whether powers change with the order.
struct Truncation {
  int order = 0, lower = 0;
  std::string beam{};  // whose power changes most from `lower` to `order`
  double change = 0;   // of it, relative
  double missing = 0;  // W that the modes do not take: emitted less all that leaves or is lost
  double emitted = 0;  // W
  bool converged() const { return change <= most_change && missing <= most_change * emitted; }
  static constexpr double most_change = 1e-3;
  static constexpr double least_power = 1e-9;  // of the largest: darker beams do not count
};
struct ModeTable {
  std::vector<BeamModes> beams{};
  std::vector<Resonance> resonances{};
  std::vector<BasisMismatch> mismatches{};
  Truncation truncation{};
};
// ModeError of a network in plane waves.
ModeTable mode_table(NetworkModel const&);

// Noise of a read-out of a network: the vacuum and the stated noises of lasers, displacements and forces.

// One-sided PSD of a read-out from the vacuum, squared units per Hz. Of a demodulated signal it includes the vacuum at
// frequencies one demodulation away from a carrier where no carrier is: at the detector that is the vacuum itself,
// whatever the network (docs/theory/interferometer.md, eq. N.32).
double vacuum_noise(Network const&, SteadyField const&, Readout const&, double hz);
// The share of two read-outs in common that comes from the vacuum where no carrier is: one-sided cross spectrum. Of
// signals demodulated at one frequency from one beam, with the cosine of the angle between their phases; else 0.
double vacuum_beside_carriers(Network const&, SteadyField const&, Readout const&, Readout const&);

struct ReadoutNoise {
  std::vector<double> hz;
  std::vector<std::string> names{};        // "vacuum", then the causes
  std::vector<std::vector<double>> asd{};  // by name; unit of the read-out per sqrt(Hz); NaN outside a file
  std::vector<double> total{};             // root of the sum of squares; NaN where a part is
};
// `referred`: a degree of freedom whose displacement would make the same signal; then in m/sqrt(Hz).
ReadoutNoise noise_of(NetworkModel const&, NamedReadout const&, NamedFreedom const* referred,
                      std::vector<double> const& hz);

}  // namespace straytrace::ifo
