// SPDX-License-Identifier: BSD-3-Clause
// Noise of a read-out of a network: the vacuum and the stated noises of lasers, displacements and forces.
#pragma once

#include <string>
#include <vector>

#include "ifo/network_model.hpp"

namespace straytrace::ifo {

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
