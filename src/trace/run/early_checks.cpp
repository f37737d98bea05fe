// SPDX-License-Identifier: BSD-3-Clause
#include "trace/run/early_checks.hpp"

#include <algorithm>

#include "trace/run/ranks.hpp"

namespace straytrace {
namespace {

constexpr std::uint64_t last_look = 181;  // blocks of a run that is looked at early

}  // namespace

TraceResult trace_to_rule(World& world, TraceSettings settings, Backend const& backend) {
  std::uint64_t const proper = world.block_size;
  bool const begins = settings.resume.nodes().empty();
  double const before = settings.seconds_before;
  auto const told = settings.progress;
  if (told)
    settings.progress = [&](TraceProgress p) {
      p.seconds += settings.seconds_before - before;
      p.wanted_histories = std::max(p.wanted_histories, settings.histories);
      told(p);
    };
  for (std::uint64_t size = 8 * smallest_block; begins && settings.error && size < proper; size *= 8) {
    world.block_size = size;
    TraceSettings early = settings;
    early.histories = last_look * size;
    early.give_up = true;
    early.ranks = nullptr;
    double error = not_a_number;
    std::uint64_t histories = 0;
    early.error = [&](CouplingTable const& table) {
      histories = table.histories;
      return error = settings.error(table);
    };
    TraceResult result = trace(world, early, backend);
    if (result.stopped != Stopped::by_histories) {
      if (settings.ranks) stop_workers(settings.ranks->transport);
      return result;
    }
    settings.error_before = error;
    settings.histories_before = histories;
    settings.max_seconds -= result.seconds - settings.seconds_before;
    settings.seconds_before = result.seconds;
  }
  world.block_size = proper;
  return trace(world, settings, backend);
}

}  // namespace straytrace
