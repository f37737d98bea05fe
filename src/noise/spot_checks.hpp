// SPDX-License-Identifier: BSD-3-Clause
// Some paths' own spectra, held against those that they share with others.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "noise/phase_spectra.hpp"
#include "noise/strengths.hpp"

namespace straytrace {

// What was found on one path.
struct SpotCheck {
  std::size_t path = 0;
  // Largest over the bins: |shared - own| over the larger of its own PSD and the mean over the checked paths of its
  // route. Only bins that are fringes within twelve decades of the highest, or mostly first order.
  double error = 0;
  std::size_t bin = 0;
};

// Chosen by rule: the path of most noise of each of the routes with most of it, the most moved one of all, and paths at
// equal steps of the sum of noise over all paths. Noise of a path: weight times s/(1 + s), s its mean-square phase.
class SpotChecks {
 public:
  SpotChecks(PhaseSpectra const&, Strengths const&, std::size_t count);
  // `shared`: PSD of a path as it is shared. Increasing numbers of paths.
  std::vector<SpotCheck> compared(std::function<std::vector<double>(std::size_t path)> const& shared) const;

 private:
  struct Own {
    std::size_t path, route;
    bool at_random;  // stands for its route
    PhaseSpectrum spectrum;
  };
  std::vector<double> mean(std::size_t route) const;

  std::vector<Own> own_;
};

}  // namespace straytrace
