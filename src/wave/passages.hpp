// SPDX-License-Identifier: BSD-3-Clause
// A field on its way through the legs and planes of a cavity.
#pragma once

#include <functional>
#include <vector>

#include "wave/field.hpp"
#include "wave/lines/line_tables.hpp"

namespace straytrace {
class ThreadTeam;
}

namespace straytrace::wave {

// A leg, and the plane at its end with the rows about the axis beyond which nothing passes.
struct Passage {
  LegTables leg;
  int columns = 0;  // of the spectrum that the leg lets through
  PlaneFactor plane;
  int rows = 0;
};
inline int blocks_of(Passage const& p) { return 2 * ((p.columns / 2 + block_lines - 1) / block_lines); }
inline RowRange rows_of(Passage const& p, int points) { return {points / 2 - p.rows / 2, points / 2 + p.rows / 2}; }
// Who looks at the fields that arrive at planes, and where; empty: everywhere.
struct Watch {
  std::function<void(std::size_t passage, Field const& arriving)> seen;
  std::function<bool(std::size_t passage)> looks;
  bool at(std::size_t passage) const { return seen && (!looks || looks(passage)); }
};
inline std::size_t size_of(BlockedField const& f) {
  return std::size_t(f.blocks) * std::size_t(f.rows) * 2 * block_lines;
}

// From spectrum to spectrum. Each leg reads and writes the field twice: all columns there, through the leg and back,
// then all rows back, through the plane and there. Rows and columns that hold nothing are left out, but where somebody
// looks, all rows come to the plane. The same bits for any number of threads, any processor, and whoever looks.
class Passages {
 public:
  Passages(LineTables const&, Grid const&, std::vector<Passage>, int threads);

  // Columns beyond those of the first leg count as zero, and become zero.
  void run(Field& spectrum, Watch const& = {}) const;

 private:
  void take(Field const& spectrum, BlockedField const&) const;
  void put(BlockedField const&, Field& spectrum) const;
  void columns(ThreadTeam&, Passage const&, BlockedField const& from, BlockedField const& to, RowRange given,
               RowRange wanted) const;
  void rows(ThreadTeam&, Passage const&, Passage const& next, BlockedField const&, Field* seen) const;

  LineTables const& tables_;
  Grid grid_;
  std::vector<Passage> passages_;
  unsigned threads_;
  int blocks_ = 0, rows_ = 0;
};

}  // namespace straytrace::wave
