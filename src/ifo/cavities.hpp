// SPDX-License-Identifier: BSD-3-Clause
// Resonators of a network: closed ways of light with at most two reflections at normal incidence.
#pragma once

#include <string>
#include <vector>

#include "ifo/network.hpp"

namespace straytrace::ifo {

struct NetworkCavity {
  std::string name{};                  // components in the order in which light meets them first: "PRM-BS-ITMx"
  std::vector<std::uint32_t> beams{};  // ports that light leaves on a round trip
  double length = 0;                   // m, of a round trip
  double round_trip = 0;               // amplitude that is left of the carrier after one, without other light
  double phase = 0;                    // rad, of the carrier after one; 0: resonant. Both in plane waves
  double free_spectral_range() const;  // Hz; infinite without length
  double finesse() const;              // eq. 6.5
  double pole() const;                 // Hz, eq. 6.5: half width at half power
};

// Those of at most 24 spaces with a finesse of at least 1, shortest ways first. Either direction of a ring counts once.
// The search ends after 200000 steps: in a network of very many loops there may be more.
std::vector<NetworkCavity> cavities_of(Network const&);

}  // namespace straytrace::ifo
