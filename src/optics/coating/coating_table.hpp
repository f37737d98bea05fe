// SPDX-License-Identifier: BSD-3-Clause
// Makes coatings out of rows of numbers; coatings that come with the program.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "base/memory/storage.hpp"
#include "optics/coating/coating.hpp"

namespace straytrace {

struct CoatingRow {
  double angle = 0;  // rad, of incidence
  double reflect_s = 0, reflect_p = 0, transmit_s = 0, transmit_p = 0;
  double scatter = 0;

  double absorb_s() const { return 1 - reflect_s - transmit_s - scatter; }
  double absorb_p() const { return 1 - reflect_p - transmit_p - scatter; }
};

// Rows by rising angle, two or more, each with shares that sum to at most 1.
Coating make_coating(std::span<CoatingRow const>, bool scatters, Storage&);

struct CoatingPreset {
  std::string_view name, source;
  std::vector<CoatingRow> rows;
};
std::span<CoatingPreset const> coating_presets();

}  // namespace straytrace
