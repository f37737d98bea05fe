// SPDX-License-Identifier: BSD-3-Clause
#include "noise/cells.hpp"

#include <cmath>
#include <map>

#include "noise/phase_spectra.hpp"

namespace straytrace {
namespace {

using Strengths = std::vector<std::vector<std::vector<double>>>;  // kappa per coupling class, record, motion class
using Address = std::vector<int>;                                 // of a cell: rounded logarithm per motion class

constexpr int none = -2000000, weak_origin = -1000000;

Address address_of(std::vector<double> const& kappa, std::vector<MotionClass> const& classes, double step) {
  double const weak = PhaseSpectra::weak / static_cast<double>(classes.size());
  Address a;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    bool const is_weak = kappa[c] * classes[c].variance() < weak;
    double const position = std::log(kappa[c]) / (is_weak ? 2 * step : step);
    a.push_back(kappa[c] == 0 ? none : static_cast<int>(std::floor(position)) + (is_weak ? weak_origin : 0));
  }
  return a;
}

// Stops early when there are more than `most` cells.
Cells sorted_into_cells(CouplingTable const& table, Strengths const& kappa, std::vector<MotionClass> const& classes,
                        double step, std::size_t most) {
  Cells cells{{}, std::vector<std::vector<std::uint32_t>>(kappa.size()), step};
  std::map<Address, std::uint32_t> index;
  std::vector<double> weight;
  for (std::size_t r = 0; r < kappa.size(); ++r) {
    for (std::size_t i = 0; i < kappa[r].size() && weight.size() <= most; ++i) {
      std::vector<double> const& k = kappa[r][i];
      auto const [hit, fresh] =
          index.try_emplace(address_of(k, classes, step), static_cast<std::uint32_t>(weight.size()));
      std::uint32_t const cell = hit->second;
      if (fresh) {
        weight.push_back(0);
        cells.kappa.emplace_back(classes.size());
      }
      double const w = table.classes[r].records[i].weight;
      cells.of[r].push_back(cell);
      weight[cell] += w;
      for (std::size_t c = 0; c < classes.size() && weight[cell] > 0; ++c)
        cells.kappa[cell][c] += (k[c] - cells.kappa[cell][c]) * w / weight[cell];
    }
  }
  return cells;
}

}  // namespace

Cells make_cells(CouplingTable const& table, MotionSet const& motion, std::vector<MotionClass> const& classes,
                 double step, std::size_t most) {
  Strengths kappa(table.classes.size());
  for (std::size_t r = 0; r < table.classes.size(); ++r)
    for (PathRecord const& record : table.classes[r].records)
      kappa[r].push_back(kappa_of(motion, classes, record.levers));
  while (true) {
    Cells cells = sorted_into_cells(table, kappa, classes, step, most);
    if (cells.kappa.size() <= most) return cells;
    step *= 1.5;
  }
}

}  // namespace straytrace
