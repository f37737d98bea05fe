// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion.hpp"

namespace straytrace {

double MotionSet::sensitivity(std::size_t i, std::span<Lever const> levers, double hz) const {
  std::complex<double> phase = 0;  // per unit of the input
  for (Lever const& lever : levers)
    for (Gain const& gain : inputs[i].gains)
      if (gain.body == lever.body)
        phase += lever.d[gain.axis] * gain.value * (gain.transfer ? (*gain.transfer)(hz) : 1.0);
  return std::norm(phase);
}

}  // namespace straytrace
