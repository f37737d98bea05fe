// SPDX-License-Identifier: BSD-3-Clause
// A round trip on a machine with memory, copies, transforms and elementwise work: that of a GPU, or in tests the host.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/memory/host_device.hpp"
#include "wave/lines/line_kernels.hpp"
#include "wave/wave_device.hpp"

namespace straytrace::wave::device {

// What legs and planes do to each element of a field, for the host and for devices (docs/theory/wave.md, eq. W.1, W.3,
// W.4, W.7).

struct Value {  // as std::complex<double> in memory
  double re, im;
};
STRAY_HD Value times(Value const& a, double re, double im) { return {a.re * re - a.im * im, a.re * im + a.im * re}; }

STRAY_HD int frequency_number(int i, int points) { return i < points / 2 ? i : i - points; }

// The factor of a leg at row frequency n and column frequency m, with the operations of LineKernels::leg_row.
STRAY_HD Value leg_factor(LegTables const& leg, int points, int n, int m) {
  double const x = m * leg.angle_step, y = n * leg.angle_step, angle_squared = x * x + y * y;
  if (angle_squared >= leg.cut_squared) return {0, 0};
  int const column = 2 * (m < 0 ? m + points : m), row = 2 * (n < 0 ? n + points : n);
  Value factor = times({leg.scale * leg.paraxial[column], leg.scale * leg.paraxial[column + 1]}, leg.paraxial[row],
                       leg.paraxial[row + 1]);
  if (leg.quartic > 0) {
    double const phase = leg.quartic * angle_squared * angle_squared;
    factor = times(factor, 1 - phase * phase / 2, -phase);
  }
  if (angle_squared <= leg.keep_squared) return factor;
  double at = (angle_squared - leg.keep_squared) * leg.taper_scale;
  at = at < 0 ? 0 : at > leg.taper_steps ? leg.taper_steps : at;
  int const i = int(at);
  double const limit = leg.taper[i] + (at - i) * (leg.taper[i + 1] - leg.taper[i]);
  return {factor.re * limit, factor.im * limit};
}

// Each of these works on element i of an N x N field; calls may run in any order, also at once.

// A spectrum through a leg that lets `columns` columns about frequency zero through.
struct LegWork {
  Value* spectrum;
  LegTables leg;
  int points, columns;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const n = frequency_number(int(i / std::uint32_t(points)), points),
              m = frequency_number(int(i % std::uint32_t(points)), points);
    if (m < -columns / 2 || m >= columns / 2) {
      spectrum[i] = {0, 0};
      return;
    }
    Value const factor = leg_factor(leg, points, n, m);
    spectrum[i] = times(spectrum[i], factor.re, factor.im);
  }
};

// The columns of a spectrum that a leg would not let through become zero.
struct BandWork {
  Value* spectrum;
  int points, columns;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const m = frequency_number(int(i % std::uint32_t(points)), points);
    if (m < -columns / 2 || m >= columns / 2) spectrum[i] = {0, 0};
  }
};

// A field through a plane, of which nothing passes outside `rows`.
struct PlaneWork {
  Value* field;
  PlaneFactor factor;
  int points;
  RowRange rows;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const row = int(i / std::uint32_t(points));
    if (row < rows.first || row >= rows.last)
      field[i] = {0, 0};
    else if (factor.im)
      field[i] = times(field[i], factor.re[i], factor.im[i]);
    else
      field[i] = {field[i].re * factor.re[i], field[i].im * factor.re[i]};
  }
};

inline std::string gigabytes(std::size_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f GB", 1e-9 * double(bytes));
  return text;
}

// The field stays on the machine from the first leg to the last; it comes to the host where somebody looks. Machine(N):
//   Memory           owns numbers of the machine; Memory(count), double* get()
//   work_bytes()     beside the field, of the transforms
//   free_bytes()
//   begin()          once all memory is known to fit
//   put(to, from, n), get(to, from, n)      numbers to the machine and back
//   transform(values, forward)              N x N, in place, without 1/N^2
//   each(count, work)                       work(i) for all i
template <class Machine>
class TripBody final : public DeviceTrip {
 public:
  TripBody(Grid const& grid, std::vector<LegAndPlane> legs)
      : grid_(grid), legs_(std::move(legs)), machine_(grid.points) {
    if (grid.size() > std::numeric_limits<std::uint32_t>::max())
      throw std::runtime_error("a grid of " + std::to_string(grid.points) + " points per side is too large");
    for (LegAndPlane& p : legs_) {
      p.leg.scale = 1 / (double(grid.points) * grid.points);  // of the transforms there and back
      places_.push_back(places_of(p));
    }
    refuse_what_does_not_fit();
    machine_.begin();
    field_ = typename Machine::Memory(2 * grid.size());
    for (Table& table : tables_) table.memory = typename Machine::Memory(table.count);
    take_tables();
  }

  void take_tables() override {
    for (Table const& table : tables_) machine_.put(table.memory.get(), table.host, table.count);
  }

  void run(Field& spectrum, Watch const& watch) override {
    if (!(spectrum.grid == grid_)) throw std::runtime_error("a field of another grid");
    auto* const host = reinterpret_cast<double*>(spectrum.values.data());
    Field arriving(watch.seen ? grid_ : Grid{});
    machine_.put(field_.get(), host, 2 * grid_.size());
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      LegAndPlane const here = on_machine(i);
      machine_.each(grid_.size(), LegWork{values(), here.leg, grid_.points, here.columns});
      machine_.transform(field_.get(), false);
      if (watch.at(i)) {
        machine_.get(reinterpret_cast<double*>(arriving.values.data()), field_.get(), 2 * grid_.size());
        watch.seen(i, arriving);
      }
      machine_.each(grid_.size(), PlaneWork{values(), here.plane, grid_.points, rows_of(here, grid_.points)});
      machine_.transform(field_.get(), true);
    }
    machine_.each(grid_.size(), BandWork{values(), grid_.points, legs_.front().columns});
    machine_.get(host, field_.get(), 2 * grid_.size());
  }

 private:
  struct Table {
    double const* host;
    std::size_t count;
    typename Machine::Memory memory{};
  };
  // Numbers of tables; `im` only of a plane with imaginary parts.
  struct Places {
    std::size_t paraxial, taper, re, im;
  };

  Value* values() const { return reinterpret_cast<Value*>(field_.get()); }

  // Tables that several legs share are on the machine once.
  std::size_t table_of(double const* host, std::size_t count) {
    auto const known = std::find_if(tables_.begin(), tables_.end(), [&](Table const& t) { return t.host == host; });
    if (known != tables_.end()) return std::size_t(known - tables_.begin());
    tables_.push_back({host, count});
    return tables_.size() - 1;
  }
  Places places_of(LegAndPlane const& p) {
    Places at{};
    at.paraxial = table_of(p.leg.paraxial, 2 * std::size_t(grid_.points));
    at.taper = table_of(p.leg.taper, std::size_t(p.leg.taper_steps) + 2);
    at.re = table_of(p.plane.re, grid_.size());
    if (p.plane.im) at.im = table_of(p.plane.im, grid_.size());
    return at;
  }
  LegAndPlane on_machine(std::size_t i) const {
    LegAndPlane p = legs_[i];
    Places const& at = places_[i];
    p.leg.paraxial = tables_[at.paraxial].memory.get();
    p.leg.taper = tables_[at.taper].memory.get();
    p.plane.re = tables_[at.re].memory.get();
    if (p.plane.im) p.plane.im = tables_[at.im].memory.get();
    return p;
  }

  void refuse_what_does_not_fit() const {
    std::size_t needed = machine_.work_bytes() + sizeof(Value) * grid_.size();
    for (Table const& table : tables_) needed += sizeof(double) * table.count;
    if (std::size_t const free = machine_.free_bytes(); needed > free)
      throw std::runtime_error("a field of " + std::to_string(grid_.points) + " points per side needs " +
                               gigabytes(needed) + " of memory of the device, of which " + gigabytes(free) +
                               " are free");
  }

  Grid grid_;
  std::vector<LegAndPlane> legs_;
  Machine machine_;
  std::vector<Table> tables_;
  std::vector<Places> places_;
  typename Machine::Memory field_{};
};

}  // namespace straytrace::wave::device
