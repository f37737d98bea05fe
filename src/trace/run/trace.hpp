// SPDX-License-Identifier: BSD-3-Clause
// Front door of the trace: world -> coupling table.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "trace/backend/backend.hpp"
#include "trace/result.hpp"
#include "world/model/world.hpp"

namespace straytrace {

struct Ranks;

struct TraceProgress {
  std::uint64_t histories = 0, wanted_histories = 0;  // wanted: of the present goal
  double seconds = 0, histories_per_s = 0, rays_per_s = 0;
  double error = 0, wanted_error = 0;  // of the stop rule at the last look; NaN before the first
  std::uint64_t error_histories = 0;   // at that look
};

struct TraceSettings {
  std::uint64_t seed = 1;
  std::uint64_t histories = 0;  // upper limit, rounded up to whole blocks of World::block_size
  Slice slice;                  // of its blocks
  unsigned threads = 0;         // 0: all cores
  double max_seconds = infinity;
  // Stop rule: relative error of what the user wants, from the table so far; unused when empty. The run stops when it
  // is below `wanted_error` at two consecutive looks (block counts 32, 45, 64, 91 ...), never at a good-looking moment.
  std::function<double(CouplingTable const&)> error;
  double wanted_error = 0;
  bool give_up = false;                // when a look says that `histories` are too few for the rule
  double error_before = not_a_number;  // for the progress until the first look: seen at
  std::uint64_t histories_before = 0;  // so many histories of a run given up
  std::string stop_rule;               // in words, kept with the result
  std::uint32_t good_checks = 0;       // looks in a row at which the same rule held before a resumed run was stopped
  std::function<void(TraceProgress const&)> progress;
  std::atomic<bool> const* stop = nullptr;  // finish the blocks under way and return
  // A result of what is done so far, from time to time: what follows goes on from it to the same bits.
  std::function<void(TraceResult const&)> checkpoint;
  double checkpoint_seconds = infinity;
  Ranks const* ranks = nullptr;  // this process is rank 0 of several (trace/run/ranks.hpp)
  SumTree resume;                // blocks done before; what is missing between them is done first
  double seconds_before = 0;     // that they took
  // Deterministic classes, computed without the walk (trace/deterministic/deterministic_classes.hpp); they enter the
  // table, also that of `error`.
  std::vector<CouplingClass> beside;
};

TraceResult trace(World const&, TraceSettings const&, Backend const&);

// The result that these sums make: energy balance checked, records replayed; nothing is traced. Of the settings: seed
// and beside.
TraceResult result_of(World const&, TraceSettings const&, SumTree);

// Block counts at which stop rules are looked at: 32, 45, 64, 91, ...
std::uint64_t next_look(std::uint64_t blocks);

}  // namespace straytrace
