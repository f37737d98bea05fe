// SPDX-License-Identifier: BSD-3-Clause
// A message is a line of words, followed by sums. To rank 0: "ask" (for data), "hello" (ready for work), "here" (still
// running), "sums", "failed". From rank 0: "data", "do FIRST END", "halt" (end the blocks in progress), "home" (the job
// is over).
#include "trace/run/ranks.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <sstream>
#include <thread>

#include "base/errors.hpp"

namespace straytrace::trace {
namespace {

// A rank gets blocks for this time, so that messages cost little and the loss of a rank costs little; near the end it
// gets a share of the remaining blocks, so that all ranks end together.
constexpr double seconds_of_work = 10, share_of_rest = 0.7;
constexpr double seconds_of_patience = 20;     // for the blocks in progress of a rank that must stop
constexpr double signs_of_life = 10;           // messages within the patience of rank 0
constexpr std::size_t longest_failure = 2000;  // bytes; short messages do not wait for their receiver

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Order {
  std::string word, rest;
};
Order order_in(std::string const& bytes) {
  std::size_t const end = std::min(bytes.find('\n'), bytes.size());
  return {bytes.substr(0, end), end < bytes.size() ? bytes.substr(end + 1) : ""};
}

}  // namespace

void stop_workers(Transport& transport) {
  for (int rank = 1; rank < transport.size(); ++rank) transport.send(rank, "home");
}

bool RankScheduler::idle() const {
  return std::ranges::none_of(members_, [](Member const& m) { return m.busy.has_value(); });
}

void RankScheduler::take(Transport::Message const& message, BlockQueue& block_queue,
                         std::function<void(SumTree)> const& add) {
  Member& member = members_[std::size_t(message.from)];
  auto const [word, rest] = order_in(message.bytes);
  member.heard = now();
  if (word == "here") return;
  if (word == "failed") throw NumericalError(fmt::format("rank {} has failed: {}", message.from, rest));
  if (word == "ask" || word == "hello") {
    if (rest != ranks_.identity)
      throw InputError(fmt::format("rank {} and rank 0 differ in model or version of straytrace", message.from),
                       "start all ranks with the same program and files, on a shared file system");
    if (word == "ask") return ranks_.transport.send(message.from, "data\n" + ranks_.data);
    member.ready = true;
    return;
  }
  if (!member.busy) {  // lost: others have its blocks
    member.ready = true;
    return;
  }
  SumTree done = ranks_.unpack(rest);
  std::vector<BlockRange> const left = done.missing(*member.busy);
  double blocks = double(member.busy->size());
  for (BlockRange const& range : left) {  // stopped by another cause
    block_queue.give_back(range);
    blocks -= double(range.size());
    member.ready = false;
  }
  member.blocks_per_s = blocks / std::max(now() - member.started, 1e-3);
  member.busy.reset();
  add(std::move(done));
}

void RankScheduler::give_up(int rank, BlockQueue& block_queue) {
  Member& member = members_[std::size_t(rank)];
  block_queue.give_back(*member.busy);
  member.busy.reset();
  member.ready = false;
  ranks_.transport.lost(rank);
}

// Ranks that do not answer are lost; their blocks stay missing.
void RankScheduler::stop() {
  if (std::isnan(stopped_at_)) stopped_at_ = now();
  bool const too_late = now() - stopped_at_ > seconds_of_patience;
  for (int rank = 1; rank < int(members_.size()); ++rank) {
    Member& m = members_[std::size_t(rank)];
    if (m.busy && !m.halted) ranks_.transport.send(rank, "halt");
    m.halted = true;
    if (too_late) m.busy.reset();
  }
}

void RankScheduler::serve(BlockQueue& block_queue, bool stop, std::function<void(SumTree)> const& add) {
  while (auto const message = ranks_.transport.receive()) take(*message, block_queue, add);
  if (stop) return this->stop();
  for (int rank = 1; rank < int(members_.size()); ++rank) {
    Member& m = members_[std::size_t(rank)];
    if (m.busy && now() - m.heard > ranks_.patience) give_up(rank, block_queue);
    if (!m.ready || m.busy) continue;
    double const rest = share_of_rest * double(block_queue.left()) / double(members_.size());
    m.busy = block_queue.take(std::uint64_t(std::max(std::min(rest, seconds_of_work * m.blocks_per_s), 1.0)));
    if (!m.busy) continue;
    m.started = m.heard = now();
    ranks_.transport.send(rank, fmt::format("do {} {}", m.busy->first, m.busy->end));
  }
}

namespace {

// Listens to rank 0 while its blocks are run.
class Listener final : public RemoteWorkers {
 public:
  Listener(Ranks const& ranks, std::atomic<bool>& halt, std::atomic<bool> const* stop)
      : transport_(ranks.transport), between_signs_(ranks.patience / signs_of_life), halt_(halt), stop_(stop) {}
  void serve(BlockQueue&, bool, std::function<void(SumTree)> const&) override {
    if (stop_ && *stop_) halt_ = true;
    if (now() - last_sign_ > between_signs_) {
      transport_.send(0, "here");
      last_sign_ = now();
    }
    while (auto const message = transport_.receive()) {
      halt_ = true;
      if (message->bytes == "home") job_over = true;
    }
  }
  bool idle() const override { return true; }
  bool job_over = false;

 private:
  Transport& transport_;
  double between_signs_, last_sign_ = now();  // s
  std::atomic<bool>& halt_;
  std::atomic<bool> const* stop_;
};

}  // namespace

std::optional<std::string> data_of_rank_0(Ranks const& ranks) {
  ranks.transport.send(0, "ask\n" + ranks.identity);
  for (;;) {
    auto const message = ranks.transport.receive();
    if (!message) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    auto [word, rest] = order_in(message->bytes);
    if (word == "home") return {};
    if (word == "data") return std::move(rest);
  }
}

void work_for_rank_0(SteeredWorld const& world, TraceSettings const& settings, Backend const& backend,
                     Ranks const& ranks) {
  ranks.transport.send(0, "hello\n" + ranks.identity);
  for (;;) {
    auto const message = ranks.transport.receive();
    if (!message) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    std::istringstream words(message->bytes);
    std::string word;
    BlockRange range;
    words >> word >> range.first >> range.end;
    if (word == "home") return;
    if (word != "do") continue;  // "halt" after the blocks were done
    std::atomic<bool> halt = false;
    TraceSettings mine;
    mine.seed = settings.seed;
    mine.threads = settings.threads;
    mine.stop = &halt;
    Listener listener(ranks, halt, settings.stop);
    Runner runner(world, mine, backend, {});
    runner.run(range, &listener);
    if (listener.job_over) return;
    ranks.transport.send(0, "sums\n" + ranks.pack(runner.tree()));
  }
}

void report_failure(Transport& transport, std::string const& what) {
  transport.send(0, "failed\n" + what.substr(0, longest_failure));
}

}  // namespace straytrace::trace
