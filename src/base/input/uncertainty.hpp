// SPDX-License-Identifier: BSD-3-Clause
// How well an input is known: `uncertainty: 30 %` or `uncertainty: factor 1.5`.
#pragma once

#include "base/input/table.hpp"

namespace straytrace {

// One standard deviation of the logarithm as a factor from 1 on: 1.3 for 30 %, the value lies between 1/1.3 and 1.3
// times what is stated. `fallback` where nothing is written, and with a problem where it is not understood: a share is
// at most 100 %, so that 30 without the sign is not taken for a factor of 31.
double read_uncertainty(Node const& value, double fallback = 1);

// How far a number can be trusted: the key `status` of a table, empty without it. One of measured, published (a paper
// or public code), required (a specification), derived (computed from others), estimate, assumed (no public number).
std::string read_status(Node const& table);

}  // namespace straytrace
