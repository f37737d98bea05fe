// SPDX-License-Identifier: BSD-3-Clause
// A message is a line of words, followed by bytes. To rank 0: "ask" (for data), "hello" (ready for work), "here" (still
// running), "sums FIRST END" (the answer to each "do"), "scores ROUND" (the answers to "replay", one after the other),
// "failed". From rank 0: "data", "do FIRST END" (one after the other), "replay ROUND", "halt" (end the blocks in
// progress, start no more), "home" (the job is over).
#include "trace/run/ranks.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <sstream>
#include <string_view>
#include <thread>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"

namespace straytrace::trace {
namespace {

// A rank has the next order before it has done the last one, so that it never waits. An order is for this time, so that
// messages cost little and the loss of a rank costs little; near the end it is a share of the remaining blocks, so that
// all ranks end together.
constexpr std::size_t most_orders = 2;
constexpr double seconds_of_work = 10, share_of_rest = 0.5;
constexpr double seconds_of_patience = 20;     // for a rank that must stop, or replays scores
constexpr double seconds_of_absence = 5;       // of rank 0, which writes a checkpoint or was stopped
constexpr double signs_of_life = 10;           // messages within the patience of rank 0
constexpr std::size_t longest_failure = 2000;  // bytes
constexpr std::size_t scores_of_message = 4096;
constexpr std::chrono::microseconds between_looks{200};  // for messages: they move while both ranks look for them

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Words {
  std::string word, rest;
  BlockRange blocks;
};
Words words_of(std::string const& bytes) {
  std::size_t const end = std::min(bytes.find('\n'), bytes.size());
  Words words;
  words.rest = end < bytes.size() ? bytes.substr(end + 1) : "";
  std::istringstream(bytes.substr(0, end)) >> words.word >> words.blocks.first >> words.blocks.end;
  return words;
}

std::string bytes_of(std::vector<ScoreAddress> const& scores) {
  Packer out;
  out.add(scores);
  return out.take();
}
std::vector<ScoreAddress> addresses_in(std::string_view bytes) { return Unpacker(bytes).values<ScoreAddress>(); }

std::string bytes_of(std::vector<ReplayedScore> const& scores) {
  Packer out;
  out.count(scores.size());
  for (ReplayedScore const& score : scores) {
    out.value(score.source);
    out.value(score.goal);
    out.value(score.path_length);
    out.add(score.phase_sensitivities);
  }
  return out.take();
}
void add_scores(std::vector<ReplayedScore>& scores, std::string_view bytes) {
  Unpacker in(bytes);
  for (auto left = in.count(); left > 0; --left) {
    ReplayedScore& score = scores.emplace_back();
    score.source = in.value<std::uint32_t>();
    score.goal = in.value<std::uint32_t>();
    score.path_length = in.value<double>();
    score.phase_sensitivities = in.values<PhaseSensitivity>();
  }
}

std::vector<ReplayedScore> replayed_while(ReplayScores const& replay, std::span<ScoreAddress const> scores,
                                          std::function<void()> const& listen) {
  auto done = std::async(std::launch::async, replay, scores);
  while (done.wait_for(between_looks) != std::future_status::ready) listen();
  return done.get();
}

// Every `parts`th, from `first` on: each part has scores of all routes, and takes as long as any other.
std::vector<ScoreAddress> part_of(std::span<ScoreAddress const> scores, std::size_t first, std::size_t parts) {
  std::vector<ScoreAddress> part;
  for (std::size_t i = first; i < scores.size(); i += parts) part.push_back(scores[i]);
  return part;
}

}  // namespace

void stop_workers(Transport& transport) {
  for (int rank = 1; rank < transport.size(); ++rank) transport.send(rank, "home");
}

bool RankScheduler::idle() const {
  return std::ranges::none_of(members_, [](Member const& m) { return !m.orders.empty(); });
}

void RankScheduler::take(Transport::Message const& message, BlockQueue& block_queue,
                         std::function<void(SumTree)> const& add) {
  Member& member = members_[std::size_t(message.from)];
  auto const [word, rest, blocks] = words_of(message.bytes);
  member.heard = now();
  member.silent = false;
  if (word == "here") return;
  if (word == "scores") {
    if (blocks.first == round_) add_scores(member.replayed, rest);
    return;
  }
  if (word == "failed") return failed(message.from, rest);
  if (word == "ask" || word == "hello") return welcome(message.from, word, rest);
  if (member.orders.empty() || member.orders.front() != blocks) {  // lost: others have them
    member.ready = true;
    return;
  }
  add_sums(member, block_queue, ranks_.unpack(rest), add);
}

void RankScheduler::welcome(int rank, std::string const& word, std::string const& identity) {
  if (identity != ranks_.identity) {
    if (replaying_) return;  // too late to do harm
    throw InputError(fmt::format("rank {} and rank 0 differ in model or version of straytrace", rank),
                     "start all ranks with the same program and files, on a shared file system");
  }
  if (word == "ask") return ranks_.transport.send(rank, "data\n" + ranks_.data);
  Member& member = members_[std::size_t(rank)];
  member.come = member.ready = true;
}

// The sums are complete where only replays are left: others do them.
void RankScheduler::failed(int rank, std::string const& what) {
  if (!replaying_) throw NumericalError(fmt::format("rank {} has failed: {}", rank, what));
  Member& member = members_[std::size_t(rank)];
  member.come = member.ready = false;
  ranks_.transport.lost(rank);
}

void RankScheduler::add_sums(Member& member, BlockQueue& block_queue, SumTree done,
                             std::function<void(SumTree)> const& add) {
  BlockRange const order = member.orders.front();
  member.orders.pop_front();
  double blocks = double(order.size());
  for (BlockRange const& range : done.missing(order)) {  // stopped by another cause
    block_queue.give_back(range);
    blocks -= double(range.size());
    member.ready = false;
  }
  member.blocks_per_s = blocks / std::max(now() - member.started, 1e-3);
  member.started = now();
  add(std::move(done));
}

void RankScheduler::give_up(int rank, BlockQueue& block_queue) {
  Member& member = members_[std::size_t(rank)];
  for (BlockRange const& order : member.orders) block_queue.give_back(order);
  member.orders.clear();
  member.ready = false;
  member.silent = true;
  ranks_.transport.lost(rank);
}

// Ranks that do not answer are lost; their blocks stay missing.
void RankScheduler::stop() {
  if (std::isnan(stopped_at_)) stopped_at_ = now();
  bool const too_late = now() - stopped_at_ > seconds_of_patience;
  for (int rank = 1; rank < int(members_.size()); ++rank) {
    Member& m = members_[std::size_t(rank)];
    if (!m.orders.empty() && !m.halted) ranks_.transport.send(rank, "halt");
    m.halted = true;
    if (!too_late || m.orders.empty()) continue;
    m.orders.clear();
    m.ready = false;
    m.silent = true;
  }
}

void RankScheduler::serve(BlockQueue& block_queue, bool stop, std::function<void(SumTree)> const& add) {
  if (now() - served_at_ > seconds_of_absence)  // nobody could be heard
    for (Member& m : members_) m.heard = now();
  served_at_ = now();
  while (auto const message = ranks_.transport.receive()) take(*message, block_queue, add);
  if (stop) return this->stop();
  for (int rank = 1; rank < int(members_.size()); ++rank) {
    Member& m = members_[std::size_t(rank)];
    if (!m.orders.empty() && now() - m.heard > ranks_.patience) give_up(rank, block_queue);
    while (m.ready && m.orders.size() < most_orders) {
      double const rest = share_of_rest * double(block_queue.left()) / double(members_.size());
      auto const order = block_queue.take_node(std::uint64_t(std::min(rest, seconds_of_work * m.blocks_per_s)));
      if (!order) break;
      m.heard = now();
      if (m.orders.empty()) m.started = m.heard;
      m.orders.push_back(*order);
      ranks_.transport.send(rank, fmt::format("do {} {}", order->first, order->end));
    }
  }
}

std::vector<int> RankScheduler::helpers() const {
  std::vector<int> ranks;
  for (int rank = 1; rank < int(members_.size()); ++rank)
    if (Member const& m = members_[std::size_t(rank)]; m.come && !m.silent && m.orders.empty()) ranks.push_back(rank);
  return ranks;
}

void RankScheduler::listen() {
  BlockQueue none(std::vector<BlockRange>{});
  while (auto const message = ranks_.transport.receive()) take(*message, none, [](SumTree const&) {});
}

// Ranks that are silent together are waited for once.
bool RankScheduler::await_scores(int rank, std::size_t count) {
  Member& m = members_[std::size_t(rank)];
  double const patience = std::min(ranks_.patience, seconds_of_patience);
  for (listen(); m.come && m.replayed.size() < count && now() - m.heard <= patience; listen())
    std::this_thread::sleep_for(between_looks);
  m.silent = m.replayed.size() < count;
  return !m.silent;
}

std::vector<ReplayedScore> RankScheduler::replay(std::span<ScoreAddress const> scores, ReplayScores const& here) {
  std::vector<int> const ranks = scores.size() < scores_of_message ? std::vector<int>() : helpers();
  std::size_t const parts = ranks.size() + 1;
  ++round_;
  replaying_ = true;
  for (std::size_t i = 1; i < parts; ++i) {
    Member& m = members_[std::size_t(ranks[i - 1])];
    m.replayed.clear();
    m.heard = now();
    ranks_.transport.send(ranks[i - 1], fmt::format("replay {}\n", round_) + bytes_of(part_of(scores, i, parts)));
  }
  std::vector<ReplayedScore> all(scores.size());
  for (std::size_t i = 0; i < parts; ++i) {
    std::vector<ScoreAddress> const part = part_of(scores, i, parts);
    bool const answered = i > 0 && await_scores(ranks[i - 1], part.size());
    std::vector<ReplayedScore> replayed = answered ? std::move(members_[std::size_t(ranks[i - 1])].replayed)
                                                   : replayed_while(here, part, [&] { listen(); });
    for (std::size_t k = 0; k < replayed.size(); ++k) all[i + k * parts] = std::move(replayed[k]);
  }
  replaying_ = false;
  return all;
}

namespace {

// What a rank receives from rank 0, also while its blocks are run.
class Listener final : public RemoteWorkers {
 public:
  Listener(Ranks const& ranks, std::atomic<bool> const* stop)
      : transport_(ranks.transport), between_signs_(ranks.patience / signs_of_life), stop_(stop) {}
  void listen() {
    if (stop_ && *stop_) halt = true;
    while (auto const message = transport_.receive()) {
      auto const [word, rest, blocks] = words_of(message->bytes);
      if (word == "do") orders.push_back(blocks);
      if (word == "replay") replays.emplace_back(blocks.first, addresses_in(rest));
      if (word == "halt" || word == "home") halt = true;
      if (word == "home") job_over = true;
    }
  }
  void serve(BlockQueue&, bool, std::function<void(SumTree)> const&) override {
    listen();
    if (now() - last_sign_ < between_signs_) return;
    transport_.send(0, "here");
    last_sign_ = now();
  }
  bool idle() const override { return true; }

  std::deque<BlockRange> orders;
  std::deque<std::pair<std::uint64_t, std::vector<ScoreAddress>>> replays;  // by round
  std::atomic<bool> halt = false;
  bool job_over = false;

 private:
  Transport& transport_;
  double between_signs_, last_sign_ = now();  // s
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
    auto [word, rest, blocks] = words_of(message->bytes);
    if (word == "home") return {};
    if (word == "data") return std::move(rest);
  }
}

namespace {

void replay_for_rank_0(SteeredWorld const& world, TraceSettings const& settings, Listener& listener,
                       Transport& transport) {
  ReplayScores const replay = [&](std::span<ScoreAddress const> scores) {
    return replay_scores(world, settings.seed, scores, settings.threads);
  };
  for (; !listener.replays.empty(); listener.replays.pop_front()) {
    auto const& [round, scores] = listener.replays.front();
    for (std::size_t at = 0; at < scores.size() && !listener.job_over; at += scores_of_message) {
      auto const some = std::span(scores).subspan(at, std::min(scores_of_message, scores.size() - at));
      transport.send(
          0, fmt::format("scores {}\n", round) + bytes_of(replayed_while(replay, some, [&] { listener.listen(); })));
    }
  }
}

}  // namespace

void work_for_rank_0(SteeredWorld const& world, TraceSettings const& settings, Backend const& backend,
                     Ranks const& ranks) {
  ranks.transport.send(0, "hello\n" + ranks.identity);
  Listener listener(ranks, settings.stop);
  TraceSettings mine;
  mine.seed = settings.seed;
  mine.threads = settings.threads;
  mine.stop = &listener.halt;
  for (listener.listen(); !listener.job_over; listener.listen()) {
    replay_for_rank_0(world, mine, listener, ranks.transport);
    if (listener.orders.empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    BlockRange const order = listener.orders.front();
    listener.orders.pop_front();
    Runner runner(world, mine, backend, {});
    runner.run(order, &listener);
    if (!listener.job_over)
      ranks.transport.send(0, fmt::format("sums {} {}\n", order.first, order.end) + ranks.pack(runner.tree()));
  }
}

void report_failure(Transport& transport, std::string const& what) {
  transport.send(0, "failed\n" + what.substr(0, longest_failure));
}

}  // namespace straytrace::trace
