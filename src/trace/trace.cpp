// SPDX-License-Identifier: BSD-3-Clause
#include "trace/trace.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "base/message.hpp"
#include "trace/beside.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Workers take blocks from a counter and add them to the tree, whose bits do not depend on the order.
class Runner {
 public:
  Runner(World const& world, TraceSettings const& settings, Backend const& backend)
      : world_(world), settings_(settings), backend_(backend), tree_(settings.resume), start_(Clock::now()) {
    BlockSums const before = tree_.total();
    blocks_ = before.blocks;
    rays_ = 0;
    if (unsigned const n = settings.threads; n > 0) threads_ = n;
  }

  // Runs blocks up to number `end`; false when stopped before.
  bool run_to(std::uint64_t end) {
    first_of_session_ = std::min(first_of_session_, blocks_);
    next_ = blocks_;
    end_ = end;
    unsigned working = threads_;
    std::exception_ptr failure;
    {
      std::vector<std::jthread> workers;
      for (unsigned i = 0; i < threads_; ++i)
        workers.emplace_back([&] {
          try {
            work();
          } catch (...) {
            std::scoped_lock const lock(mutex_);
            failure = std::current_exception();
            next_ = end_;
          }
          std::scoped_lock const lock(mutex_);
          --working;
          wake_.notify_all();
        });
      std::unique_lock lock(mutex_);
      while (!wake_.wait_for(lock, std::chrono::milliseconds(500), [&] { return working == 0; })) {
        lock.unlock();
        report();
        lock.lock();
      }
    }
    if (failure) std::rethrow_exception(failure);
    report();
    return blocks_ >= end;
  }

  bool interrupted() const { return settings_.stop && settings_.stop->load(); }
  bool out_of_time() const { return seconds_since(start_) > settings_.max_seconds; }
  std::uint64_t blocks() const { return blocks_; }
  SumTree const& tree() const { return tree_; }
  double seconds() const { return seconds_since(start_); }

  double error = not_a_number;

 private:
  void work() {
    while (!interrupted() && !out_of_time()) {
      std::uint64_t const block = next_.fetch_add(1);
      if (block >= end_) return;
      BlockSums sums = backend_.run_block(world_, settings_.seed, block);
      std::scoped_lock const lock(mutex_);
      ++blocks_;
      rays_ += sums.rays;
      tree_.add(0, block, std::move(sums));
    }
  }
  void report() {
    if (!settings_.progress) return;
    TraceProgress p;
    {
      std::scoped_lock const lock(mutex_);
      p.histories = blocks_ * block_size;
      p.seconds = seconds_since(start_);
      p.histories_per_s = double((blocks_ - first_of_session_) * block_size) / p.seconds;
      p.rays_per_s = double(rays_) / p.seconds;
    }
    p.wanted_histories = (settings_.histories + block_size - 1) / block_size * block_size;
    p.error = error;
    p.wanted_error = settings_.wanted_error;
    settings_.progress(p);
  }

  World const& world_;
  TraceSettings const& settings_;
  Backend const& backend_;
  SumTree tree_;
  Clock::time_point start_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::atomic<std::uint64_t> next_{0};
  std::uint64_t end_ = 0, blocks_ = 0, first_of_session_ = ~0ull, rays_ = 0;
  unsigned threads_ = std::max(1u, std::thread::hardware_concurrency());
};

// Error of the mean of a column that is zero on average. Events may be so rare that few or none were drawn, and then
// the spread of what was drawn says nothing. Of wins of a roulette the odds are known. In `sampling` they are
// directions that the law draws where the targets were expected to (strata leave no other spread there): none of mu
// expected ones is drawn with the chance exp(-mu), which for mu = 15 is that of five standard errors, and each moves
// the total of a history by no more than from one end of what was drawn to the other (errors.md, The books).
double spread_of(Fate fate, Estimate const& e, BlockSums const& total) {
  constexpr double unseen = 15.0 / 5;  // standard errors
  double const n = double(total.histories);
  if (fate == Fate::window) return std::max(e.std_error, std::sqrt(total.window_variance) / n);
  return e.std_error + unseen * 2 * total.ledger[int(fate)].largest / n;
}

void check_books(BlockSums const& total) {
  if (total.lost > 0) throw NumericalError(std::to_string(total.lost) + " paths were lost (NaN or no surface side)");
  double sum = 0;
  for (Moments const& column : total.ledger) sum += column.sum;
  for (Fate fate : {Fate::window, Fate::sampling}) {  // zero on average (estimators.md 4)
    Estimate const e = estimate(total.ledger[static_cast<int>(fate)], total.histories, total.blocks);
    double const rounding = 1e-12 * total.emitted.sum / double(total.histories);
    bool const sound = total.blocks >= 32 && e.scored >= 100 && e.variance_of_variance < 0.1;
    if (sound && std::fabs(e.mean) > 5 * spread_of(fate, e, total) + rounding)
      throw NumericalError(std::string("the mean of the column '") + name_of(fate) +
                           "' of the books lies more than five standard errors from zero");
  }
  if (std::fabs(sum - total.emitted.sum) > 1e-9 * total.emitted.sum)
    throw NumericalError("the books of the light do not close: fates sum to " +
                         std::to_string(sum / total.emitted.sum) + " of what was emitted");
}

}  // namespace

std::uint64_t next_look(std::uint64_t blocks) {
  for (int i = 0;; ++i) {
    auto const count = std::uint64_t(std::lround(64 * std::pow(2.0, 0.5 * i)));
    if (count > blocks) return count;
  }
}

TraceResult trace(World const& world, TraceSettings const& settings, Backend const& backend) {
  Runner runner(world, settings, backend);
  TraceResult result;
  std::uint64_t const limit = (settings.histories + block_size - 1) / block_size;
  auto const coupling_table = [&](BlockSums const& total) {
    CouplingTable table = make_coupling_table(world, total, settings.seed);
    add_beside(table, settings.beside);
    return table;
  };
  std::uint32_t& good_looks = result.good_looks;
  good_looks = settings.good_looks;
  result.stop_rule = settings.stop_rule;
  while (runner.blocks() < limit) {
    if (good_looks >= 2) break;
    std::uint64_t const look = settings.error ? std::min(next_look(runner.blocks()), limit) : limit;
    if (!runner.run_to(look)) {
      result.stopped = runner.interrupted() ? Stopped::by_signal : Stopped::by_time;
      break;
    }
    if (!settings.error) continue;
    runner.error = settings.error(coupling_table(runner.tree().total()));
    good_looks = runner.error < settings.wanted_error ? good_looks + 1 : 0;
  }
  if (good_looks >= 2) result.stopped = Stopped::by_error;
  result.tree = runner.tree();
  result.total = result.tree.total();
  check_books(result.total);
  result.coupling = coupling_table(result.total);
  result.warnings = result.coupling.warnings;
  if (result.total.histories > 0 && !(result.total.emitted.sum > 0))
    result.warnings.emplace_back(
        "no light was emitted: what the beams light scatters nothing, or they miss it; all results are zero");
  result.seconds = settings.seconds_before + runner.seconds();
  return result;
}

}  // namespace straytrace
