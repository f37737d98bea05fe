// SPDX-License-Identifier: BSD-3-Clause
// The kernel of a device thread.
#pragma once

#include "trace/backend/device/engine.hpp"
#include "trace/backend/device/noinline.hpp"

namespace straytrace::trace {

template <class T>
struct Slab {
  T* data = nullptr;
  std::uint32_t room = 0, count = 0;
  bool full = false;
  STRAY_HD void push_back(T const& x) {
    if (count < room)
      data[count++] = x;
    else
      full = true;
  }
  STRAY_HD void clear() {
    count = 0;
    full = false;
  }
  STRAY_HD T* begin() { return data; }
  STRAY_HD T* end() { return data + count; }
  STRAY_HD Slab part(std::uint32_t worker) const { return {data + std::size_t(worker) * room, room, 0, false}; }
};
using DeviceTally = BasicTally<Slab>;

// Slabs of all workers, one behind the other.
STRAY_HD TallyLists<Slab> part_of(TallyLists<Slab> const& all, std::uint32_t worker) {
  return {all.totals.part(worker), all.scores.part(worker), all.arrivals.part(worker), all.cells.part(worker)};
}

// Adds to a counter shared by all threads; returns the old value.
STRAY_HD std::uint32_t taken_from(std::uint32_t* counter, std::uint32_t count) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(counter, count);
#else
  return __atomic_fetch_add(counter, count, __ATOMIC_RELAXED);
#endif
}

// A common list. Places are handed out in any order; sorting by (history, place) afterwards restores the order.
template <class T>
struct CommonList {
  Recorded<T>* data = nullptr;
  std::uint32_t room = 0;
  std::uint32_t* count = nullptr;
  STRAY_HD std::uint32_t reserve(Slab<T> const& list) const { return taken_from(count, list.count); }
  STRAY_HD bool fits(std::uint32_t first, Slab<T> const& list) const {
    return first <= room && list.count <= room - first;
  }
  STRAY_HD void copy(std::uint32_t first, Slab<T> const& list, std::uint32_t history) const {
    for (std::uint32_t i = 0; i < list.count; ++i) data[first + i] = {history, i, list.data[i]};
  }
  STRAY_HD void leave_empty(std::uint32_t first, Slab<T> const& list) const {
    for (std::uint32_t i = 0; i < list.count && first + i < room; ++i) data[first + i].history = no_history;
  }
};

struct CommonLists {
  HistoryRecord* histories = nullptr;
  TallyLists<CommonList> lists;

  // All of a history or nothing.
  STRAY_HD void land(std::uint32_t history, DeviceTally const& tally) const {
    HistoryRecord record = record_of(tally);
    record.again = put(history, tally);
    histories[history] = record;
  }

 private:
  STRAY_HD static std::uint32_t bits(bool totals, bool scores, bool arrivals, bool cells) {
    return totals | scores << 1 | arrivals << 2 | cells << 3;
  }
  STRAY_HD std::uint32_t put(std::uint32_t history, DeviceTally const& t) const {
    std::uint32_t const full = bits(t.totals().full, t.scores().full, t.arrivals().full, t.cells().full);
    if (full) return full;
    std::uint32_t const totals = lists.totals.reserve(t.totals()), scores = lists.scores.reserve(t.scores()),
                        arrivals = lists.arrivals.reserve(t.arrivals()), cells = lists.cells.reserve(t.cells());
    std::uint32_t const late = bits(!lists.totals.fits(totals, t.totals()), !lists.scores.fits(scores, t.scores()),
                                    !lists.arrivals.fits(arrivals, t.arrivals()), !lists.cells.fits(cells, t.cells()));
    if (!late) {
      lists.totals.copy(totals, t.totals(), history);
      lists.scores.copy(scores, t.scores(), history);
      lists.arrivals.copy(arrivals, t.arrivals(), history);
      lists.cells.copy(cells, t.cells(), history);
    } else {
      lists.totals.leave_empty(totals, t.totals());
      lists.scores.leave_empty(scores, t.scores());
      lists.arrivals.leave_empty(arrivals, t.arrivals());
      lists.cells.leave_empty(cells, t.cells());
    }
    return late << shared_list;
  }
};

// A device thread takes a history, follows it step by step, and takes the next one as soon as it ends.
//
// The threads of a block wait for each other between the stages of a step: they then need the same instructions at the
// same time. Each going its own way, the threads of an H100 waited three quarters of their time for instructions, since
// the kernel is many times larger than the cache for them.

// Waits for all threads of the block; whether `flag` holds for any of them.
STRAY_HD bool any_of_block(bool flag) {
#if defined(__CUDA_ARCH__)
  return __syncthreads_or(flag);
#else
  return flag;
#endif
}

struct DeviceWalk {
  WorldView const* world;  // on the device
  std::uint64_t seed;
  BatchHistories number;
  std::uint32_t histories;
  std::uint32_t stride;   // histories are begun in the order 0, stride, 2 stride, ... modulo their number
  std::uint32_t* begun;   // how many
  std::uint32_t workers;  // slabs
  TallyLists<Slab> slabs;
  CommonLists common;

  // Of the slab of this worker. All threads of a block must call it.
  STRAY_HD void operator()(std::uint32_t worker) const {
    History history;
    DeviceTally tally(*world, seed, part_of(slabs, worker));
    std::uint32_t mine = no_history;
    bool more = worker < workers;
    for (;;) {
      bool const begins = more && mine == no_history;
      if (begins) mine = next_history();
      more = mine != no_history;
      if (!any_of_block(more)) return;
      Vertex vertex;
      Where at = more ? Where::in_flight : Where::nowhere;
      if (begins && more) {
        history.begin(number(mine));
        tally.begin(number(mine));
        at = start(*world, seed, history, vertex, tally);
      }
      any_of_block(more);
      Hit hit;
      bool const flies = at == Where::in_flight;
      if (flies) hit = world->closest(history.path.ray, history.path.from);
      any_of_block(more);
      if (flies) at = reach(*world, history, hit, vertex, tally) ? Where::at_vertex : Where::nowhere;
      any_of_block(more);
      if (at == Where::at_vertex) connect_all(*world, seed, history, vertex, tally);
      any_of_block(more);
      bool flies_on = at == Where::at_vertex && leave(*world, seed, history, vertex, tally);
      any_of_block(more);
      if (more && !flies_on) flies_on = next_path(*world, seed, history, tally);
      if (!more || flies_on) continue;
      common.land(mine, tally);
      mine = no_history;
    }
  }

 private:
  STRAY_HD std::uint32_t next_history() const {
    std::uint32_t const ticket = taken_from(begun, 1);
    return ticket < histories ? std::uint32_t(std::uint64_t(ticket) * stride % histories) : no_history;
  }
};

}  // namespace straytrace::trace
