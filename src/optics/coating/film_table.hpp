// SPDX-License-Identifier: BSD-3-Clause
// Tables that make a film cheap when the media on both sides are known.
#pragma once

#include "base/memory/storage.hpp"
#include "optics/coating/film.hpp"

namespace straytrace {

// Gives the film tables for these indices, as coarse as keeps every amplitude within `tolerance` (absolute) of the
// computed one. Returns the largest error found; infinity, and the film as it was, when 8192 steps do not suffice: a
// stack of very high finesse.
double tabulate(Film&, double front_index, double back_index, double tolerance, Storage&);

}  // namespace straytrace
