// SPDX-License-Identifier: BSD-3-Clause
// Numbers that are dealt to the histories of a block (docs/theory/sampling.md, Strata).
#pragma once

#include <bit>
#include <cstdint>

#include "base/math/rng.hpp"

namespace straytrace {

// What is dealt, each on two axes, the second choice on one. A sub-path starts on those of the connections to its goal;
// the second choice and direction are those at the first vertex behind the source.
enum class Dealt : std::uint32_t { direction, source, end, end_direction, second_direction, second_choice };

// The first binary digits of the first numbers of each history: those of a net of Sobol' (direction numbers of S. Joe
// and F. Y. Kuo, SIAM J. Sci. Comput. 30 (2008) 2635), shifted by random digits that the histories of a block share. On
// each axis every history of a block has a cell of (0, 1) of its own, and consecutive histories fill any few axes
// evenly. The numbers of one history on different axes are independent and uniform, as the shifts of the axes are.
class Strata {
 public:
  STRAY_HD Strata() {}  // of a history whose numbers are not dealt
  // `block_size`: a power of 2. Of more than 4096 histories several share a cell.
  STRAY_HD Strata(std::uint64_t seed, std::uint64_t history, std::uint64_t block_size)
      : place_(static_cast<std::uint32_t>(history % block_size)),
        digits_(static_cast<std::uint32_t>(std::countr_zero(block_size | std::uint64_t{1} << most_digits))) {
    place_ &= (1u << digits_) - 1;
    Rng shared(seed, history - history % block_size, 0xffffffffu, Stream::strata);
    for (std::uint64_t& s : shift_) s = digits_of(shared.uniform());
  }

  // u, v: uniform in (0, 1) and of this history. They keep the digits behind those that are dealt.
  STRAY_HD void deal(Dealt what, double& u, double& v) const {
    auto const axis = 2 * static_cast<std::uint32_t>(what);
    u = dealt(axis, u);
    v = dealt(axis + 1, v);
  }
  STRAY_HD double deal(Dealt what, double u) const { return dealt(2 * static_cast<std::uint32_t>(what), u); }

 private:
  static constexpr std::uint32_t axes = 11, most_digits = 12;
  STRAY_HD double dealt(std::uint32_t axis, double random) const {
    std::uint64_t const shift = shift_[axis / 4] >> 12 * (axis % 4), cell = (net(axis) ^ shift) & ((1u << digits_) - 1);
    return (double(std::int64_t(cell << (52 - digits_) | digits_of(random) >> digits_)) + 0.5) * 0x1.0p-52;
  }

  STRAY_HD static std::uint64_t digits_of(double x) { return static_cast<std::uint64_t>(x * 0x1.0p52); }
  STRAY_HD std::uint32_t net(std::uint32_t axis) const {
    constexpr std::uint16_t columns[axes][most_digits] = {
        {2048, 1024, 512, 256, 128, 64, 32, 16, 8, 4, 2, 1},
        {2048, 3072, 2560, 3840, 2176, 3264, 2720, 4080, 2056, 3084, 2570, 3855},
        {2048, 3072, 1536, 2304, 3712, 1472, 2272, 3152, 1672, 2508, 3814, 1369},
        {2048, 3072, 512, 1280, 3968, 1856, 2592, 2352, 3464, 596, 1438, 3693},
        {2048, 1024, 512, 2816, 3968, 3520, 1952, 2512, 1448, 764, 2582, 3851},
        {2048, 1024, 1536, 768, 3200, 576, 1376, 4016, 3592, 1796, 2694, 323},
        {2048, 3072, 2560, 3328, 1408, 2368, 992, 3632, 3048, 572, 482, 3889},
        {2048, 1024, 2560, 1280, 2176, 576, 288, 720, 1896, 2532, 130, 1601},
        {2048, 1024, 2560, 1280, 640, 3392, 1696, 1808, 904, 1412, 3746, 785},
        {2048, 1024, 3584, 2816, 2432, 2368, 2208, 1456, 824, 3484, 1826, 1009},
        {2048, 1024, 2560, 256, 128, 1728, 2528, 560, 1400, 2780, 2042, 2333}};
    std::uint32_t x = 0;
    for (std::uint32_t k = 0; k < most_digits; ++k) x ^= columns[axis][k] & (0u - (place_ >> k & 1));
    return x >> (most_digits - digits_);
  }

  std::uint32_t place_ = 0, digits_ = 0;
  std::uint64_t shift_[3] = {};
};

}  // namespace straytrace
