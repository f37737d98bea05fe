// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "noise/noise.hpp"

namespace straytrace {

constexpr double lowest_hz = 1e-9, highest_hz = 1e12;  // of the band; the grid stays finite

double FrequencyGrid::centre(std::size_t i) const { return std::sqrt(edges[i] * edges[i + 1]); }

FrequencyGrid logarithmic_grid(double low_hz, double high_hz, double points_per_decade) {
  double const n = std::max(1.0, std::round(points_per_decade * std::log10(high_hz / low_hz)));
  FrequencyGrid grid;
  for (double i = 0; i < n; ++i) grid.edges.push_back(low_hz * std::pow(high_hz / low_hz, i / n));
  grid.edges.push_back(high_hz);
  return grid;
}

NoiseSettings read_noise_settings(Node const& table) {
  double low = 3, high = 1000, density = 60;
  NoiseSettings settings;
  if (table) {
    if (Node const band = table["band"]) {
      std::vector<double> const ends = band.as_numbers(dim::frequency, 2);
      low = ends[0];
      high = ends[1];
      if (low <= 0 || high <= low)
        band.problem("the band must go from a low to a higher frequency above zero", "write '[3 Hz, 1 kHz]'");
      else if (low < lowest_hz || high > highest_hz)
        band.problem("the band goes beyond 1 nHz to 1 THz", "write '[3 Hz, 1 kHz]'");
    }
    density = table.number("points_per_decade", dim::plain, density, 1, 1000);
    settings.margin = table.number("margin", dim::plain, settings.margin, 1e-6, 1e6);
    for (Node const& name : table.list("compare")) settings.compare.push_back(name.as_word());
    table.refuse_unknown("'noise'");
  }
  bool const usable = low >= lowest_hz && low < high && high <= highest_hz && std::isfinite(density);
  settings.grid = usable ? logarithmic_grid(low, high, density) : logarithmic_grid(3, 1000, 60);
  return settings;
}

}  // namespace straytrace
