// SPDX-License-Identifier: BSD-3-Clause
#include "wave/lines/line_kernels.hpp"

#include <array>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "base/math/simd.hpp"

namespace straytrace::wave {
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
