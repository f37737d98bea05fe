// SPDX-License-Identifier: BSD-3-Clause
#include "wave/lines/line_kernels.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <iterator>
#include <new>
#include <utility>

#include "base/errors.hpp"
#include "base/math/functions.hpp"
#include "base/math/simd.hpp"

namespace straytrace::wave {
namespace {

// In the order of the radices; a factor 16 is 4 by 4, not 8 by 2.
std::vector<int> kinds_of(int points) {
  std::vector<int> kinds;
  int rest = points;
  for (int kind = 0; kind < int(std::size(LinePlan::radices)); ++kind)
    for (int const radix = LinePlan::radices[kind]; rest % radix == 0 && !(radix == 8 && rest == 16); rest /= radix)
      kinds.push_back(kind);
  if (rest != 1) throw InputError(fmt::format("a grid of {} points has a prime factor above 5", points));
  return kinds;
}

}  // namespace

LineTables::LineTables(int points) : position_(std::size_t(points)) {
  std::vector<int> const kinds = kinds_of(points);
  int part = points;
  for (int const kind : kinds) {
    int const radix = LinePlan::radices[kind];
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
    for (int const kind : kinds) {
      int const radix = LinePlan::radices[kind];
      stride /= radix;
      position_[std::size_t(f)] += rest % radix * stride;
      rest /= radix;
    }
  }
  plan_.points = points;
  plan_.steps = int(kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    plan_.kind[i] = kinds[i];
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

namespace {

// The instruction set by pragma: the compiler divides vectors into those of the processor before it inlines.
namespace portable {
#define STRAY_LANES 2
#include "wave/lines/butterflies.hpp"
#include "wave/lines/line_kernels_body.hpp"
#undef STRAY_LANES
constexpr LineKernels kernels{"portable", forward, inverse, leg, leg_row, plane, sample};
}  // namespace portable

#if STRAY_VECTORS && defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#define STRAY_LANES 4
#include "wave/lines/butterflies.hpp"
#include "wave/lines/line_kernels_body.hpp"
#undef STRAY_LANES
constexpr LineKernels kernels{"avx2", forward, inverse, leg, leg_row, plane, sample};
}  // namespace avx2
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512vl,avx512dq")
namespace avx512 {
#define STRAY_LANES 8
#include "wave/lines/butterflies.hpp"
#include "wave/lines/line_kernels_body.hpp"
#undef STRAY_LANES
constexpr LineKernels kernels{"avx512", forward, inverse, leg, leg_row, plane, sample};
}  // namespace avx512
#pragma GCC pop_options
#endif

LineKernels const* choose() {
  if (char const* const wanted = std::getenv("STRAYTRACE_ISA"))
    if (LineKernels const* const found = find_line_kernels(wanted)) return found;
  for (std::string_view const name : {"avx512", "avx2"})
    if (LineKernels const* const found = find_line_kernels(name)) return found;
  return &portable::kernels;
}

}  // namespace

LineKernels const* find_line_kernels(std::string_view name) {
  if (name == "portable") return &portable::kernels;
#if STRAY_VECTORS && defined(__x86_64__)
  __builtin_cpu_init();
  if (name == "avx2" && __builtin_cpu_supports("avx2")) return &avx2::kernels;
  if (name == "avx512" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq"))
    return &avx512::kernels;
#endif
  return nullptr;
}

LineKernels const* line_kernels = choose();

}  // namespace straytrace::wave
