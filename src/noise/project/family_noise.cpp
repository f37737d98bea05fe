// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/family_noise.hpp"

#include <algorithm>

#include "noise/wrapped/phase_pairs.hpp"

namespace straytrace {

RouteSpectrum family_spectrum(PhaseSpectra const& spectra, MotionSet const& motion, CouplingClass const& c,
                              std::span<double const> mean_square_phase) {
  std::vector<PhasePair> pairs;
  for (std::size_t const state : {0, 1}) {
    std::vector<CoherentPath> paths;
    for (PathRecord const& r : c.records)
      if (std::norm(r.field[state]) > 0) paths.push_back({r.field[state], r.phase_sensitivities});
    for (PhasePair& p : coherent_family(motion, spectra.classes(), paths)) pairs.push_back(std::move(p));
  }
  PairSpectrum sum = pair_spectrum(spectra, pairs);
  RouteSpectrum route;
  route.exact = true;
  route.psd = std::move(sum.psd);
  route.linear = std::move(sum.linear);
  for (double& x : route.psd) x = std::max(0.0, x);  // rounding, where fields cancel
  double power = 0;
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    route.mean_square_phase += c.records[i].weight * mean_square_phase[i];
    power += c.records[i].weight;
  }
  if (power > 0) route.mean_square_phase /= power;
  return route;
}

}  // namespace straytrace
