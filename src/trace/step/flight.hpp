// SPDX-License-Identifier: BSD-3-Clause
// Many histories in flight, each depth first. Their rays are searched together, so that memory accesses overlap. Each
// history has its own tally, and tallies are passed on in the order of histories: sums depend neither on the order of
// completion nor on the number in flight (docs/develop/architecture.md).
#pragma once

#include <vector>

#include "trace/step/step.hpp"

namespace straytrace::trace {

template <class Tally>
class Flight {
 public:
  static constexpr std::uint32_t in_flight = 16;  // paths
  static constexpr std::uint64_t kept_apart =
      32;  // tallies, few for the cache: a history far ahead of the oldest waits

  // Room for the paths, 0.4 MB: a thread keeps it from block to block.
  static std::vector<History> room() { return std::vector<History>(in_flight); }

  // The view and the room must live as long as this.
  Flight(WorldView const& world, std::uint64_t seed, std::vector<History>& room)
      : world_(world), seed_(seed), tallies_(kept_apart, {Tally(world, seed)}) {
    for (std::uint32_t i = 0; i < in_flight; ++i) flying_[i] = &room[i];
  }

  // Histories [first, last), each handed to land(tally) in order.
  template <class Land>
  void run(std::uint64_t first, std::uint64_t last, Land const& land) {
    next_ = oldest_ = first;
    while (oldest_ < last) {
      while (count_ < in_flight && next_ < last && next_ - oldest_ < kept_apart) start();
      search();
      for (std::uint32_t i = count_; i-- > 0;)
        if (!advances(i)) std::swap(flying_[i], flying_[--count_]);
      for (; oldest_ < next_ && slot(oldest_).over; ++oldest_) land(slot(oldest_).tally);
    }
  }

 private:
  struct Slot {
    Tally tally;
    bool over = false;
  };
  Slot& slot(std::uint64_t history) { return tallies_[history % kept_apart]; }

  void start() {
    std::uint64_t const number = next_++;
    History& history = *flying_[count_];
    Slot& mine = slot(number);
    history.begin(number);
    mine.tally.begin(number);
    mine.over = !begin(world_, seed_, history, mine.tally);
    if (!mine.over) ++count_;
  }
  void search() {
    RayQuery rays[in_flight];
    for (std::uint32_t i = 0; i < count_; ++i) rays[i] = {flying_[i]->path.ray, flying_[i]->path.from};
    world_.closest_together(rays, hits_, count_);
  }
  bool advances(std::uint32_t i) {
    History& history = *flying_[i];
    Slot& mine = slot(history.path.history);
    mine.over = !step(world_, seed_, history, hits_[i], mine.tally) && !next_path(world_, seed_, history, mine.tally);
    return !mine.over;
  }

  WorldView const& world_;
  std::uint64_t seed_, next_ = 0, oldest_ = 0;
  std::vector<Slot> tallies_;
  History* flying_[in_flight];
  Hit hits_[in_flight];
  std::uint32_t count_ = 0;
};

}  // namespace straytrace::trace
