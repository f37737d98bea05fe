// SPDX-License-Identifier: BSD-3-Clause
#include "noise/wrapped/phase_pairs.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace straytrace {

std::vector<PhasePair> coherent_family(MotionSet const& motion, std::vector<MotionClass> const& classes,
                                       std::span<CoherentPath const> paths) {
  if (paths.size() > most_coherent)
    throw NumericalError(fmt::format("{} paths cannot be added as fields: at most {}", paths.size(), most_coherent));
  std::vector<std::vector<double>> kappa;
  for (CoherentPath const& p : paths) kappa.push_back(kappa_of(motion, classes, p.phase_sensitivities));
  std::vector<PhasePair> pairs;
  for (std::size_t j = 0; j < paths.size(); ++j) {
    pairs.push_back({std::norm(paths[j].field), kappa[j], kappa[j]});
    for (std::size_t k = j + 1; k < paths.size(); ++k) {
      std::vector<PhaseSensitivity> apart = paths[j].phase_sensitivities;
      for (PhaseSensitivity l : paths[k].phase_sensitivities) {
        for (double& d : l.d) d = -d;
        apart.push_back(l);
      }
      std::vector<double> own = kappa_of(motion, classes, apart), cross = own;  // of the difference of both phases
      for (std::size_t c = 0; c < classes.size(); ++c) {
        double const both = (kappa[j][c] + kappa[k][c]) / 2;
        cross[c] = both - own[c] / 2;
        own[c] = both;
      }
      pairs.push_back({2 * (paths[j].field * std::conj(paths[k].field)).real(), std::move(own), std::move(cross)});
    }
  }
  return pairs;
}

}  // namespace straytrace
