// SPDX-License-Identifier: BSD-3-Clause
// Strengths of phase modulation of many paths.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace straytrace {

// One number kappa per path and class of motion, path by path.
struct Strengths {
  std::size_t classes = 0;
  std::vector<double> kappa;
  std::vector<double> weight;        // power of each path; empty: all equal
  std::vector<std::size_t> first{};  // path of each route, increasing; empty: one route
  std::span<double const> of(std::size_t path) const { return std::span(kappa).subspan(path * classes, classes); }
  std::size_t size() const { return classes ? kappa.size() / classes : weight.size(); }
  double weight_of(std::size_t path) const { return weight.empty() ? 1 : weight[path]; }
};

}  // namespace straytrace
