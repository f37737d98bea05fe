// SPDX-License-Identifier: BSD-3-Clause
#include "wave/lines/line_tables.hpp"

#include <new>

#include "base/math/functions.hpp"

namespace straytrace::wave {
namespace {

// Largest radix first; a factor 16 is 4 by 4, not 8 by 2.
std::vector<int> radices_of(int points) {
  std::vector<int> radices;
  while (points % 8 == 0 && points != 16) {
    radices.push_back(8);
    points /= 8;
  }
  for (int const radix : {4, 5, 3, 2})
    while (points % radix == 0) {
      radices.push_back(radix);
      points /= radix;
    }
  return radices;
}

}  // namespace

LineTables::LineTables(int points) : position_(std::size_t(points)) {
  std::vector<int> const radices = radices_of(points);
  int part = points;
  for (int const radix : radices) {
    std::vector<double>& table = twiddles_.emplace_back();
    for (int j = 0; j < part / radix; ++j)
      for (int q = 1; q < radix; ++q) {
        SinCos const at = sincos_turn(double(j) * q / part);
        table.insert(table.end(), {at.cos, at.sin});
      }
    part /= radix;
  }
  for (int f = 0; f < points; ++f) {
    int rest = f, stride = points;
    for (int const radix : radices) {
      stride /= radix;
      position_[std::size_t(f)] += rest % radix * stride;
      rest /= radix;
    }
  }
  plan_.points = points;
  plan_.steps = int(radices.size());
  for (std::size_t i = 0; i < radices.size(); ++i) {
    plan_.radix[i] = radices[i];
    plan_.twiddles[i] = twiddles_[i].data();
  }
  plan_.position = position_.data();
}

LineTables::Work LineTables::take() const {
  {
    std::lock_guard const lock(mutex_);
    if (!idle_.empty()) {
      Work one = std::move(idle_.back());
      idle_.pop_back();
      return one;
    }
  }
  std::size_t const bytes = sizeof(double) * 2 * block_lines * position_.size();
  return Work(static_cast<double*>(::operator new[](bytes, std::align_val_t{64})));
}

}  // namespace straytrace::wave
