// SPDX-License-Identifier: BSD-3-Clause
// Quantum noise of a Michelson interferometer with arm cavities, power and signal recycling: from the network of its
// mirrors (ifo/linear_response.hpp), all losses, radiation pressure, optical springs and squeezing in.
#pragma once

#include <span>
#include <vector>

#include "noise/fundamental/detector.hpp"

namespace straytrace {

// Strain PSD, 1/Hz, one-sided.
std::vector<double> quantum_psd(Detector const&, std::span<double const> hz);
std::vector<double> shot_psd(Detector const&, std::span<double const> hz);  // mirrors held: no radiation pressure

}  // namespace straytrace
