// SPDX-License-Identifier: BSD-3-Clause
// Quantum noise of a detector, from the network of its mirrors (ifo/dual_recycled.hpp): includes all losses, radiation
// pressure, optical springs and squeezing.
#pragma once

#include <span>
#include <vector>

#include "ifo/dual_recycled.hpp"
#include "noise/fundamental/detector.hpp"

namespace straytrace::noise {

// Loss of all mirrors of an arm counts at its end mirror; balanced homodyne read-out.
DualRecycledParameters dual_recycled(Detector const&);

// Strain PSD, 1/Hz, one-sided.
std::vector<double> quantum_psd(Detector const&, std::span<double const> hz);
std::vector<double> shot_psd(Detector const&, std::span<double const> hz);  // mirrors held: no radiation pressure
double quantum_limit(double length, double mass, double hz);                // strain ASD, eq. 12.5

}  // namespace straytrace::noise
