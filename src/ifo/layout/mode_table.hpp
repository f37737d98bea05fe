// SPDX-License-Identifier: BSD-3-Clause
// What the light of a network consists of, and whether its modes suffice (docs/theory/interferometer.md, eq. N.6 to
// N.10).
#pragma once

#include <string>
#include <vector>

#include "ifo/mode_bases.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

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

}  // namespace straytrace::ifo
