// SPDX-License-Identifier: BSD-3-Clause
// Stop rules that few histories meet are met by few: looks before blocks of the usual size could be looked at.
#pragma once

#include "trace/run/trace.hpp"

namespace straytrace {

// Traces until the stop rule of `settings` holds, or its histories are done. At first, runs of 2048 to 11584 histories,
// then of 16384 to 92672 are looked at as straytrace run --histories makes them, in their small blocks; each is given
// up as soon as its last look is not within reach. Then the run proper. What meets the rule is the run of that many
// histories, so the result stays a function of their number. The world is left with the block size of the result.
// `ranks`: of settings, engaged for the run proper alone.
TraceResult trace_to_rule(World&, TraceSettings settings, Backend const&);

}  // namespace straytrace
