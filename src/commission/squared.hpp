// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace straytrace {

inline double squared(double v) { return v * v; }

}  // namespace straytrace
