// SPDX-License-Identifier: BSD-3-Clause
// Sections of a file in the layout of pygwinc's ifo.yaml.
#pragma once

#include "noise/fundamental/detector.hpp"
#include "report/pygwinc_tree.hpp"

namespace straytrace {

SuspensionChain read_suspension(IfoTree&, double arm_length);
SubstrateMaterial read_substrate(IfoTree&);
CoatingMaterial read_coating(IfoTree&, std::string const& which);  // "lown", "highn"
std::vector<GasSpecies> read_gas(IfoTree&);
Ground read_ground(IfoTree&);
std::optional<Squeezer> read_squeezer(IfoTree&);  // none: no squeezed light

}  // namespace straytrace
