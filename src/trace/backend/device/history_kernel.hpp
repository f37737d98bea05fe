// SPDX-License-Identifier: BSD-3-Clause
// What a device thread does: it takes a history, follows it step by step, and takes the next one as soon as it is over,
// so that threads which march together do the same work as long as there is any.
#pragma once

#include "trace/backend/device/device_tally.hpp"
#include "trace/backend/device/noinline.hpp"

namespace straytrace {

struct DeviceWalk {
  WorldView const* world;  // on the device
  std::uint64_t seed;
  BatchHistories number;
  std::uint32_t histories;
  std::uint32_t stride;  // histories are begun in the order 0, stride, 2 stride, ... modulo their number
  std::uint32_t* begun;  // how many
  TallyLists<Slab> slabs;
  CommonLists common;

  STRAY_HD void operator()(std::uint32_t worker) const {
    History history;
    DeviceTally tally(*world, seed, part_of(slabs, worker));
    std::uint32_t mine = no_history;
    for (;;) {
      bool under_way;
      if (mine == no_history) {
        std::uint32_t const ticket = taken_from(begun, 1);
        if (ticket >= histories) return;
        mine = std::uint32_t(std::uint64_t(ticket) * stride % histories);
        history.begin(number(mine));
        tally.begin(number(mine));
        under_way = emit(*world, seed, history.path, tally);
      } else {
        under_way = step(*world, seed, history, tally) || next_path(*world, seed, history, tally);
      }
      if (under_way) continue;
      common.land(mine, tally);
      mine = no_history;
    }
  }
};

}  // namespace straytrace
