// SPDX-License-Identifier: BSD-3-Clause
// A trace by several processes: rank 0 hands out blocks and adds up, the others work for it. Which rank runs a block
// does not reach the bits, for sums meet on the nodes of the tree over block numbers (trace/result.hpp).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "trace/run/runner.hpp"
#include "trace/run/trace.hpp"

namespace straytrace {

// How the ranks of a job talk: whole messages of bytes, which arrive in the order they were sent. One thread uses it.
class Transport {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };
  virtual ~Transport() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  virtual void send(int to, std::string const& bytes) = 0;  // to rank 0 it may wait until it is received
  virtual std::optional<Message> receive() = 0;             // what has come; does not wait
  // Rank 0 has not heard of a rank that has work, and gives its blocks to others. The end of the job does not wait for
  // it.
  virtual void lost(int rank) = 0;
};

// Of all ranks of a job. Sums travel as `pack` makes them.
struct Ranks {
  Transport& transport;
  std::string identity;  // what decides the bits: model, seed, program; must be the same on all
  std::function<std::string(SumTree const&)> pack;
  std::function<SumTree(std::string const&)> unpack;
  double patience = 60;  // s; a rank with work that says nothing for so long is lost
};

void stop_workers(Transport&);  // from rank 0 to all others: there is no more to do

// The other ranks, as rank 0 sees them.
class RankScheduler final : public RemoteWorkers {
 public:
  explicit RankScheduler(Ranks const& ranks) : ranks_(ranks), members_(std::size_t(ranks.transport.size())) {}
  ~RankScheduler() override { stop_workers(ranks_.transport); }
  RankScheduler(RankScheduler const&) = delete;
  RankScheduler& operator=(RankScheduler const&) = delete;

  // Takes what has come and hands out more, unless `stop`: then asks for what there is. Throws InputError when a rank
  // has another model or program, NumericalError when one has failed.
  void serve(BlockQueue&, bool stop, std::function<void(SumTree)> const& add) override;
  bool idle() const override;

 private:
  struct Member {
    bool ready = false, halted = false;  // halted: was told to end
    std::optional<BlockRange> busy;
    double started = 0, heard = 0, blocks_per_s = 0;  // s, of a steady clock; heard: its last message
  };
  void take(Transport::Message const&, BlockQueue&, std::function<void(SumTree)> const& add);
  void give_up(int rank, BlockQueue&);
  void stop();

  Ranks const& ranks_;
  double stopped_at_ = not_a_number;  // s
  std::vector<Member> members_;
};

// What ranks from 1 on do, until rank 0 sends them home. `settings.threads` are those of this rank.
void work_for_rank_0(World const&, TraceSettings const&, Backend const&, Ranks const&);
// Tells rank 0 that this rank cannot work.
void report_failure(Transport&, std::string const& what);

}  // namespace straytrace
