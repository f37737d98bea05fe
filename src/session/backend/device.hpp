// SPDX-License-Identifier: BSD-3-Clause
// Which machine computes: the option --backend of commands that can use a device.
#pragma once

#include <string>

#include "noise/time_domain/phase_sum.hpp"

namespace straytrace {

// Sums of moving phases on this backend. Throws InputError for a name that is none and where there is no device.
DirectSum phase_summer(std::string const& backend);

// "cuda: NVIDIA H100, 80 GB", or why there is none; for --version.
std::string devices_text();

}  // namespace straytrace
