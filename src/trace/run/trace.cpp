// SPDX-License-Identifier: BSD-3-Clause
#include "trace/run/trace.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "trace/deterministic/deterministic_classes.hpp"
#include "trace/run/ranks.hpp"
#include "trace/run/runner.hpp"
#include "trace/tally/block_sink.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace {
namespace {

// Error of the mean of a column that is zero on average. Events may be so rare that few or none were drawn, and then
// the spread of what was drawn says nothing. Of wins of a roulette the odds are known. In `sampling` they are
// directions that the law draws where the targets were expected to (strata leave no other spread there): none of mu
// expected ones is drawn with the chance exp(-mu), which for mu = 15 is that of five standard errors, and each moves
// the total of a history by no more than from one end of what was drawn to the other (docs/theory/errors.md).
double spread_of(BalanceTerm balance_term, Estimate const& e, BlockSums const& total) {
  constexpr double unseen = 15.0 / 5;  // standard errors
  double const n = double(total.histories);
  if (balance_term == BalanceTerm::roulette) return std::max(e.std_error, std::sqrt(total.window_variance) / n);
  return e.std_error + unseen * 2 * total.energy_balance[int(balance_term)].largest / n;
}

void check_energy_balance(BlockSums const& total) {
  if (total.lost > 0) throw NumericalError(std::to_string(total.lost) + " paths were lost (NaN or no surface side)");
  double sum = 0;
  for (Moments const& column : total.energy_balance) sum += column.sum;
  for (BalanceTerm balance_term :
       {BalanceTerm::roulette, BalanceTerm::sampling}) {  // zero on average (docs/theory/sampling.md)
    Estimate const e = estimate(total.energy_balance[static_cast<int>(balance_term)], total.histories, total.blocks);
    double const rounding = 1e-12 * total.emitted.sum / double(total.histories);
    bool const sound = total.blocks >= 32 && e.scored >= 100 && e.variance_of_variance < 0.1;
    if (sound && std::fabs(e.mean) > 5 * spread_of(balance_term, e, total) + rounding)
      throw NumericalError(std::string("the mean of the column '") + name_of(balance_term) +
                           "' of the energy balance lies more than five standard errors from zero");
  }
  if (std::fabs(sum - total.emitted.sum) > 1e-9 * total.emitted.sum)
    throw NumericalError("the energy balance does not close: its terms sum to " +
                         std::to_string(sum / total.emitted.sum) + " of what was emitted");
}

CouplingTable coupling_table(World const& world, TraceSettings const& settings, BlockSums const& total) {
  CouplingTable table = make_coupling_table(world, total, settings.seed);
  add_beside(table, settings.beside);
  return table;
}

// Past the last block that is done.
std::uint64_t end_of(SumTree const& tree) {
  auto const done = tree.done();
  return done.empty() ? 0 : done.back().end;
}

}  // namespace

std::uint64_t next_look(std::uint64_t blocks) {
  for (int i = 0;; ++i) {
    auto const count = std::uint64_t(std::lround(double(enough_blocks) * std::pow(2.0, 0.5 * i)));
    if (count > blocks) return count;
  }
}

TraceResult result_of(World const& world, TraceSettings const& settings, SumTree tree) {
  TraceResult result;
  result.total = tree.total();
  if (result.total.blocks == 0) {  // a slice may be empty: nothing on every group and receiver
    result.total = BlockSink(world.view(), world.groups().size(), 0).finish();
    result.total.blocks = 0;
  }
  result.tree = std::move(tree);
  check_energy_balance(result.total);
  result.coupling = coupling_table(world, settings, result.total);
  result.warnings = result.coupling.warnings;
  if (result.total.histories > 0 && !(result.total.emitted.sum > 0))
    result.warnings.emplace_back(
        "no light was emitted: what the beams light scatters nothing, or they miss it; all results are zero");
  result.slice = settings.slice;
  result.stop_rule = settings.stop_rule;
  result.good_checks = settings.good_checks;
  return result;
}

TraceResult trace(World const& world, TraceSettings const& settings, Backend const& backend) {
  Runner runner(world, settings, backend, settings.resume);
  std::optional<RankScheduler> scheduler;
  if (settings.ranks) scheduler.emplace(*settings.ranks);
  // Of a whole run that goes on from more than is asked for, all that is missing is done.
  std::uint64_t const asked = blocks_of(settings.histories, world.block_size),
                      all = settings.slice.whole() ? std::max(asked, end_of(settings.resume)) : asked;
  BlockRange const wanted = settings.slice.blocks(all);
  runner.wanted_blocks = wanted.size();
  std::uint32_t good_checks = settings.good_checks;
  Stopped stopped = Stopped::by_histories;
  auto const result = [&](SumTree tree) {
    TraceResult r = result_of(world, settings, std::move(tree));
    r.all_blocks = all;
    r.good_checks = good_checks;
    r.stopped = stopped;
    r.seconds = settings.seconds_before + runner.seconds();
    return r;
  };
  if (settings.checkpoint)
    runner.at_checkpoint = [&](SumTree tree) {
      TraceResult so_far = result(std::move(tree));
      so_far.stopped = Stopped::by_checkpoint;
      settings.checkpoint(so_far);
    };
  for (auto gaps = runner.tree().missing(wanted); !gaps.empty() && good_checks < 2;
       gaps = runner.tree().missing(wanted)) {
    std::uint64_t const look = std::max(next_look(gaps.front().first), end_of(runner.tree()));
    BlockRange const next{wanted.first, settings.error ? std::min(look, wanted.end) : wanted.end};
    bool const all_done = runner.run(next, scheduler ? &*scheduler : nullptr);
    if (!all_done && (runner.interrupted() || runner.out_of_time())) {
      stopped = runner.interrupted() ? Stopped::by_signal : Stopped::by_time;
      break;
    }
    if (!all_done || !settings.error) continue;  // a helper has left some of its blocks
    runner.saw(settings.error(coupling_table(world, settings, runner.tree().total())), next.end);
    good_checks = runner.error() < settings.wanted_error ? good_checks + 1 : 0;
    double const at_the_end = runner.error() * std::sqrt(double(next.end) / double(wanted.end));
    if (settings.give_up && !(at_the_end < settings.wanted_error)) break;
  }
  if (good_checks >= 2) stopped = Stopped::by_error;
  return result(runner.tree());
}

}  // namespace straytrace
