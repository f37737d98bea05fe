// SPDX-License-Identifier: BSD-3-Clause
// The trace: world -> coupling table.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "trace/backend/backend.hpp"
#include "trace/result.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {

struct Ranks;

struct TraceProgress {
  std::uint64_t histories = 0, wanted_histories = 0;  // wanted: until the next check
  double seconds = 0, histories_per_s = 0, rays_per_s = 0;
  double error = 0, wanted_error = 0;  // of the stop rule at the last check; NaN before the first
  std::uint64_t error_histories = 0;   // at that check
};

struct TraceSettings {
  std::uint64_t seed = 1;
  std::uint64_t histories = 0;  // upper limit, rounded up to whole blocks of World::block_size
  Slice slice;                  // of its blocks
  unsigned threads = 0;         // 0: all cores
  double max_seconds = infinity;
  // Stop rule: relative error of the requested quantity, from the table so far; unused when empty. The run stops when
  // it is below `wanted_error` at two consecutive checks (block counts 32, 45, 64, 91 ...), never at a favourable
  // moment.
  std::function<double(CouplingTable const&)> error;
  double wanted_error = 0;
  bool give_up = false;                // stop when a check shows that `histories` are too few for the rule
  double error_before = not_a_number;  // for the progress until the first check: the error after
  std::uint64_t histories_before = 0;  // `histories_before` histories of a run given up
  std::string stop_rule;               // in words, kept with the result
  std::uint32_t good_checks = 0;       // consecutive checks passed before a resumed run was stopped
  std::function<void(TraceProgress const&)> progress;
  std::atomic<bool> const* stop = nullptr;  // finish the blocks in progress and return
  // Receives the result so far from time to time; a run resumed from it ends with the same bits.
  std::function<void(TraceResult const&)> checkpoint;
  double checkpoint_seconds = infinity;
  Ranks const* ranks = nullptr;  // this process is rank 0 of several (trace/run/ranks.hpp)
  SumTree resume;                // blocks done before; gaps between them are filled first
  double seconds_before = 0;     // that they took
  // Deterministic classes, computed without the walk (deterministic_class()); part of the table, also of that for
  // `error`.
  std::vector<CouplingClass> deterministic;
};

TraceResult run_trace(SteeredWorld const&, TraceSettings const&, Backend const&);

// The result of these sums, with the energy balance checked and the records replayed; traces nothing. Uses only `seed`,
// `threads` and `deterministic` of the settings.
TraceResult result_of(SteeredWorld const&, TraceSettings const&, SumTree);

// Block counts at which stop rules are checked: 32, 45, 64, 91, ...
std::uint64_t next_check(std::uint64_t blocks);

// Traces until the stop rule of `settings` holds or its histories are done. So that a loose rule needs few histories,
// it first checks runs of 2048 to 11584 histories, then of 16384 to 92672, in the small blocks that straytrace run
// --histories uses for them; each ends as soon as its last check cannot pass. The full run follows. The result is that
// of a run of so many histories, so it remains a function of their number; its table holds the block size. Only the
// full run uses `settings.ranks`.
TraceResult trace_to_rule(SteeredWorld, TraceSettings settings, Backend const&);

}  // namespace straytrace::trace
