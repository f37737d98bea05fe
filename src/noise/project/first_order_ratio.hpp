// SPDX-License-Identifier: BSD-3-Clause
// What second moments of the phase sensitivities say about the noise of a route that its kept paths do not
// (docs/theory/errors.md, Second moments of the phase sensitivities).
#pragma once

#include <array>
#include <vector>

#include "noise/interpolate/strength_sample.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

// PSD of a route to first order in the motion, per bin: from the second moments over from the kept paths. The part of
// the PSD that is first order is multiplied by it. Both per unit of coupling, of all histories and without one replica.
class FirstOrderRatio {
 public:
  // `first`: number of the first record of the class among `paths`.
  FirstOrderRatio(PhaseSpectra const&, MotionSet const&, CouplingTable const&, CouplingClass const&,
                  Strengths const& paths, std::size_t first);

  bool known() const { return known_; }  // false: there are no second moments, or too few replicas
  static constexpr int all = -1;
  std::vector<double> operator()(int moments_without, int paths_without) const;  // a replica, or `all`

 private:
  using OfClasses = std::vector<double>;
  struct Means {
    OfClasses all;
    std::array<OfClasses, replica_count> without;
    OfClasses const& operator()(int replica) const { return replica < 0 ? all : without[std::size_t(replica)]; }
  };
  void take_paths(CouplingClass const&, Strengths const&, std::size_t first, std::uint64_t block_size);

  bool known_ = false;
  std::vector<OfClasses> weight_;  // per bin
  std::vector<bool> class_known_;  // of the second moments
  Means moments_, paths_;
};

}  // namespace straytrace
