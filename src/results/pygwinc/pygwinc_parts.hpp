// SPDX-License-Identifier: BSD-3-Clause
// Sections of a file in the layout of pygwinc's ifo.yaml.
#pragma once

#include <string>
#include <string_view>

#include "noise/fundamental/detector.hpp"
#include "results/pygwinc/pygwinc_tree.hpp"

namespace straytrace {

SuspensionChain read_suspension(IfoTree&, double arm_length);
SubstrateMaterial read_substrate(IfoTree&);
CoatingMaterial read_coating(IfoTree&, std::string const& which);  // "lown", "highn"
std::vector<GasSpecies> read_gas(IfoTree&);
Ground read_ground(IfoTree&);
std::optional<Squeezer> read_squeezer(IfoTree&);  // none: no squeezed light

// What the numbers of an ifo.yaml may be, by the end of their path.

// Empty when the number may stand at this path ("Suspension.Stage.0.Mass"), otherwise what it must be.
std::string out_of_range(std::string_view path, double value);

}  // namespace straytrace
