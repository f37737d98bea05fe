// SPDX-License-Identifier: BSD-3-Clause
// Lengths of a dual-recycled interferometer and the degrees of freedom that light and loops see (R2.13).
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <array>
#include <cstdint>
#include <string_view>

namespace straytrace {

// Arms, short arms from the splitter, power- and signal-recycling mirror from the splitter.
enum class Length : std::uint8_t { arm_x, arm_y, short_x, short_y, recycling, signal };
// The sixth, the mean short arm with PRCL and SRCL held, moves every mirror but the splitter's alike: no light sees it.
enum class Freedom : std::uint8_t { darm, carm, mich, prcl, srcl, mean_short };
constexpr std::array<std::string_view, 6> freedom_names = {"DARM", "CARM", "MICH", "PRCL", "SRCL", "mean short arm"};

using LengthMatrix = Eigen::Matrix<double, 6, 6>;

// Rows: DARM = Lx - Ly, CARM = (Lx + Ly)/2, MICH = lx - ly, PRCL = lp + (lx + ly)/2, SRCL = ls + (lx + ly)/2 and
// (lx + ly)/2.
inline LengthMatrix freedoms_of_lengths() {
  LengthMatrix m;
  m << 1, -1, 0, 0, 0, 0,    //
      0.5, 0.5, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,     //
      0, 0, 0.5, 0.5, 1, 0,  //
      0, 0, 0.5, 0.5, 0, 1,  //
      0, 0, 0.5, 0.5, 0, 0;
  return m;
}
inline LengthMatrix lengths_of_freedoms() { return freedoms_of_lengths().inverse(); }

}  // namespace straytrace
