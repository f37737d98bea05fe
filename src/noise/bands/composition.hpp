// SPDX-License-Identifier: BSD-3-Clause
// How often the light of each route scatters on uncertain materials; of rows that sum routes, by the noise of each
// (docs/theory/errors.md, The input band).
#pragma once

#include <cmath>
#include <span>

#include "noise/noise.hpp"

namespace straytrace::noise {

// Uncertainty of a material, as ratios to the traced value, and the groups that have it.
struct MaterialSpread {
  std::string name, status;
  double low = 1, high = 1;  // bracket: a range
  double factor = 1;         // one standard deviation of the logarithm
  bool of_reflection = false;
  std::vector<GroupId> groups;
};

// Number of scatters of a route on the material (of reflections, for its reflectance).
int scatters_on(MaterialSpread const&, std::vector<PathStep> const& steps);

// Factor on the coupling of a class when the BRDF of the material is `ratio` times the traced value: ratio^scatters.
// Of a row that sums routes: the mean over its named routes by coupling; `ratio` when none has a name.
double coupling_factor(MaterialSpread const&, CouplingClass const&, double ratio);
// Whether that is also the factor on its noise. A row `other` names its largest routes by coupling, while fainter ones
// on moving surfaces may make its noise, and fields of ghosts do not add in power: it is known only where all routes
// scatter equally often on the material.
bool composition_known(MaterialSpread const&, CouplingClass const&);
// Share of the PSD from which rows of unknown composition leave the effect of a material on the total unknown.
constexpr double composition_limit = 0.1;

// Routes of a row that scatter equally often on each material.
struct RowPart {
  std::vector<int> scatters;   // by material
  double share = 1;            // of the PSD of the row, times
  std::vector<double> of_bin;  // this, per bin; empty: 1
  bool by_coupling = false;    // the share is that of the coupling of named routes
  double at(std::size_t bin) const { return share * (of_bin.empty() ? 1 : of_bin[bin]); }
};

// The parts of each route of a table. A row `other` is divided by the noise of its kept paths, whose routes are known
// since schema 2.1 of run files; paths of unknown routes, and rows of ghosts whose fields add, by coupling.
class Composition {
 public:
  Composition(CouplingTable const&, std::vector<MaterialSpread> materials, MotionSet const&, Interferometer const&,
              NoiseSettings const&);

  // The shares sum to 1 in each bin.
  std::vector<RowPart> const& parts(std::size_t route) const { return parts_[route]; }
  // Factor on the PSD of a route in a bin when the BRDF of each material is `ratio` times the traced value.
  double factor(std::size_t route, std::size_t bin, std::span<double const> ratio) const;
  // The same for one material alone.
  double factor(std::size_t route, std::size_t bin, std::size_t material, double ratio) const;
  // Share of the PSD of a route in a bin that scatters an unknown number of times on the material.
  double unknown(std::size_t route, std::size_t bin, std::size_t material) const;

 private:
  std::vector<MaterialSpread> materials_;
  std::vector<std::vector<RowPart>> parts_;  // by route
  std::vector<std::vector<bool>> known_;     // by route, then by material: composition_known()
};

}  // namespace straytrace::noise
