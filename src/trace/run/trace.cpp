// SPDX-License-Identifier: BSD-3-Clause
#include "trace/run/trace.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "trace/run/ranks.hpp"
#include "trace/run/runner.hpp"
#include "trace/tally/block_sink.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::trace {

namespace {

// Error of the mean of a column that is zero on average. If its events are so rare that few or none were drawn, their
// spread is meaningless. For the roulette the odds are known. In `sampling` the rare events are directions that the
// BSDF model draws towards targets (strata leave no other spread): none of mu expected ones is drawn with the
// probability exp(-mu), which for mu = 15 is that of five standard errors, and each changes the total of a history by
// no more than the range of the totals drawn (docs/theory/errors.md).
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
      throw NumericalError(std::string("the mean of '") + name_of(balance_term) +
                           "' of the energy balance lies more than five standard errors from zero");
  }
  if (std::fabs(sum - total.emitted.sum) > 1e-9 * total.emitted.sum)
    throw NumericalError("the energy balance is violated: its terms sum to " + std::to_string(sum / total.emitted.sum) +
                         " of the emitted power");
}

// `ranks`: those that replay scores too; none has blocks to run.
CouplingTable coupling_table(SteeredWorld const& world, TraceSettings const& settings, BlockSums const& total,
                             RankScheduler* ranks) {
  ReplayScores const here = [&](std::span<ScoreAddress const> scores) {
    return replay_scores(world, settings.seed, scores, settings.threads);
  };
  ReplayScores const shared = [&](std::span<ScoreAddress const> scores) { return ranks->replay(scores, here); };
  CouplingTable table = make_coupling_table(world, total, settings.seed, settings.threads, ranks ? shared : here);
  add_deterministic(table, settings.deterministic);
  return table;
}

// Past the last block that is done.
std::uint64_t end_of(SumTree const& tree) {
  auto const done = tree.done();
  return done.empty() ? 0 : done.back().end;
}

TraceResult result_with(RankScheduler* ranks, SteeredWorld const& world, TraceSettings const& settings, SumTree tree) {
  TraceResult result;
  result.total = tree.total();
  if (result.total.blocks == 0) {  // a slice may be empty: zeros for every group and receiver
    result.total = BlockSink(world.view(), world->groups().size(), 0).finish();
    result.total.blocks = 0;
  }
  result.tree = std::move(tree);
  check_energy_balance(result.total);
  result.coupling = coupling_table(world, settings, result.total, ranks);
  result.warnings = result.coupling.warnings;
  if (result.total.histories > 0 && !(result.total.emitted.sum > 0))
    result.warnings.emplace_back(
        "no light was emitted: the surfaces in the beams do not scatter, or the beams miss them; all results are zero");
  result.slice = settings.slice;
  result.stop_rule = settings.stop_rule;
  result.good_checks = settings.good_checks;
  return result;
}

}  // namespace

std::uint64_t next_check(std::uint64_t blocks) {
  for (int i = 0;; ++i) {
    auto const count = std::uint64_t(std::lround(double(enough_blocks) * std::pow(2.0, 0.5 * i)));
    if (count > blocks) return count;
  }
}

TraceResult result_of(SteeredWorld const& world, TraceSettings const& settings, SumTree tree) {
  return result_with(nullptr, world, settings, std::move(tree));
}

TraceResult run_trace(SteeredWorld const& world, TraceSettings const& settings, Backend const& backend) {
  Runner runner(world, settings, backend, settings.resume);
  std::optional<RankScheduler> scheduler;
  if (settings.ranks) scheduler.emplace(*settings.ranks);
  RankScheduler* const ranks = scheduler ? &*scheduler : nullptr;
  // A whole run resumed from more blocks than requested completes all that are missing.
  std::uint64_t const asked = blocks_of(settings.histories, world.block_size),
                      all = settings.slice.whole() ? std::max(asked, end_of(settings.resume)) : asked;
  BlockRange const wanted = settings.slice.blocks(all);
  runner.wanted_blocks = wanted.size();
  std::uint32_t good_checks = settings.good_checks;
  Stopped stopped = Stopped::by_histories;
  auto const result = [&](SumTree tree, RankScheduler* helpers) {
    TraceResult r = result_with(helpers, world, settings, std::move(tree));
    r.all_blocks = all;
    r.good_checks = good_checks;
    r.stopped = stopped;
    r.seconds = settings.seconds_before + runner.seconds();
    return r;
  };
  if (settings.checkpoint)
    runner.at_checkpoint = [&](SumTree tree) {
      TraceResult so_far = result(std::move(tree), nullptr);
      so_far.stopped = Stopped::by_checkpoint;
      settings.checkpoint(so_far);
    };
  for (auto gaps = runner.tree().missing(wanted); !gaps.empty() && good_checks < 2;
       gaps = runner.tree().missing(wanted)) {
    std::uint64_t const check = std::max(next_check(gaps.front().first), end_of(runner.tree()));
    BlockRange const next{wanted.first, settings.error ? std::min(check, wanted.end) : wanted.end};
    bool const all_done = runner.run(next, ranks);
    if (!all_done && (runner.interrupted() || runner.out_of_time())) {
      stopped = runner.interrupted() ? Stopped::by_signal : Stopped::by_time;
      break;
    }
    if (!all_done || !settings.error) continue;  // a worker has left some of its blocks
    runner.set_error(settings.error(coupling_table(world, settings, runner.tree().total(), ranks)), next.end);
    good_checks = runner.error() < settings.wanted_error ? good_checks + 1 : 0;
    double const at_the_end = runner.error() * std::sqrt(double(next.end) / double(wanted.end));
    if (settings.give_up && !(at_the_end < settings.wanted_error)) break;
  }
  if (good_checks >= 2) stopped = Stopped::by_error;
  return result(runner.tree(), ranks);
}

namespace {

constexpr std::uint64_t last_check = 181;  // blocks of a run with early checks

}  // namespace

TraceResult trace_to_rule(SteeredWorld world, TraceSettings settings, Backend const& backend) {
  std::uint64_t const full_size = world.block_size;
  bool const begins = settings.resume.nodes().empty();
  double const before = settings.seconds_before;
  auto const report = settings.progress;
  if (report)
    settings.progress = [&](TraceProgress p) {
      p.seconds += settings.seconds_before - before;
      p.wanted_histories = std::max(p.wanted_histories, settings.histories);
      report(p);
    };
  for (std::uint64_t size = 8 * smallest_block; begins && settings.error && size < full_size; size *= 8) {
    world.block_size = size;
    TraceSettings early = settings;
    early.histories = last_check * size;
    early.give_up = true;
    early.ranks = nullptr;
    double error = not_a_number;
    std::uint64_t histories = 0;
    early.error = [&](CouplingTable const& table) {
      histories = table.histories;
      return error = settings.error(table);
    };
    TraceResult result = run_trace(world, early, backend);
    if (result.stopped != Stopped::by_histories) {
      if (settings.ranks) stop_workers(settings.ranks->transport);
      return result;
    }
    settings.error_before = error;
    settings.histories_before = histories;
    settings.max_seconds -= result.seconds - settings.seconds_before;
    settings.seconds_before = result.seconds;
  }
  world.block_size = full_size;
  return run_trace(world, settings, backend);
}

}  // namespace straytrace::trace
