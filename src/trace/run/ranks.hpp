// SPDX-License-Identifier: BSD-3-Clause
// A trace by several processes: rank 0 schedules blocks and adds their sums, the other ranks run them. The bits do not
// depend on which rank runs a block, because sums meet on the nodes of the tree over block numbers (trace/result.hpp).
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "trace/run/runner.hpp"
#include "trace/run/trace.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::trace {

// Messages between the ranks of a job: whole byte strings that arrive in the order sent. Used by one thread.
class Transport {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };
  virtual ~Transport() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  virtual void send(int to, std::string const& bytes) = 0;
  virtual std::optional<Message> receive() = 0;  // the next message, if any; does not block
  // A rank with work has been silent too long: rank 0 gives its blocks to others, and the job ends without it.
  virtual void lost(int rank) = 0;
};

// Common to all ranks of a job. Sums are sent as `pack` encodes them.
struct Ranks {
  Transport& transport;
  std::string identity;  // model, seed and program, which decide the bits; equal on all ranks
  std::function<std::string(SumTree const&)> pack;
  std::function<SumTree(std::string const&)> unpack;
  double patience = 60;   // s; a rank with work that is silent for longer is lost
  std::string data = {};  // that rank 0 has computed and gives to ranks that ask for it
};

void stop_workers(Transport&);  // from rank 0 to all others: the job is over

// The other ranks, as seen by rank 0.
class RankScheduler final : public RemoteWorkers {
 public:
  explicit RankScheduler(Ranks const& ranks) : ranks_(ranks), members_(std::size_t(ranks.transport.size())) {}
  ~RankScheduler() override { stop_workers(ranks_.transport); }
  RankScheduler(RankScheduler const&) = delete;
  RankScheduler& operator=(RankScheduler const&) = delete;

  // Receives sums and sends blocks; with `stop` requests the sums done so far instead. Throws InputError if a rank has
  // another model or program, NumericalError if one has failed.
  void serve(BlockQueue&, bool stop, std::function<void(SumTree)> const& add) override;
  bool idle() const override;
  // Scores replayed by all ranks that have come and by this one, which replays its share by `here`, and that of a rank
  // that falls silent or fails. While no rank has blocks to run.
  std::vector<ReplayedScore> replay(std::span<ScoreAddress const> scores, ReplayScores const& here);

 private:
  struct Member {
    bool come = false, ready = false;     // ready: for blocks
    bool halted = false, silent = false;  // halted: must stop; silent: did not answer in time, and has not since
    std::deque<BlockRange> orders;        // the first one in progress
    double started = 0, heard = 0;        // s, of a steady clock: the first of its orders, its last message
    double blocks_per_s = 0;
    std::vector<ReplayedScore> replayed;
  };
  void add_sums(Member&, BlockQueue&, SumTree, std::function<void(SumTree)> const& add);
  void take(Transport::Message const&, BlockQueue&, std::function<void(SumTree)> const& add);
  void welcome(int rank, std::string const& word, std::string const& identity);
  void failed(int rank, std::string const& what);
  void give_up(int rank, BlockQueue&);
  std::vector<int> helpers() const;  // ranks that can replay scores
  void listen();                     // while they do
  bool await_scores(int rank, std::size_t count);
  void stop();

  Ranks const& ranks_;
  double stopped_at_ = not_a_number;  // s
  double served_at_ = 0;              // s
  std::uint64_t round_ = 0;           // of replays
  bool replaying_ = false;
  std::vector<Member> members_;
};

// What rank 0 has as Ranks::data, once it traces; none: the job has ended before.
std::optional<std::string> data_of_rank_0(Ranks const&);
// The work of ranks from 1 on, until rank 0 stops them. `settings.threads`: of this rank.
void work_for_rank_0(SteeredWorld const&, TraceSettings const&, Backend const&, Ranks const&);
// Reports to rank 0 that this rank cannot work.
void report_failure(Transport&, std::string const& what);

}  // namespace straytrace::trace
