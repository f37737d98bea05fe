// SPDX-License-Identifier: BSD-3-Clause
#include "noise/motion_classes.hpp"

#include <algorithm>

namespace straytrace {

std::vector<MotionClass> group_by_shape(MotionSet const& motion) {
  std::vector<MotionClass> classes;
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) {
    MotionInput const& input = motion.inputs[i];
    bool const tone = input.tone_frequency > 0;
    if (!tone && !input.drift && !(input.spectrum.total() > 0)) continue;
    auto const same = std::find_if(classes.begin(), classes.end(), [&](MotionClass const& c) {
      return !tone && !input.drift && c.tone_frequency == 0 && !c.drift && same_shape(c.reference, input.spectrum);
    });
    if (same != classes.end())
      same->members.emplace_back(i, input.spectrum.total() / same->reference.total());
    else
      classes.push_back({input.spectrum, input.tone_frequency, {{i, 1.0}}, input.drift});
  }
  return classes;
}

std::vector<double> kappa_of(MotionSet const& motion, std::vector<MotionClass> const& classes,
                             std::span<Lever const> levers) {
  std::vector<double> kappa(classes.size());
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (auto const& [input, scale] : classes[c].members) kappa[c] += scale * motion.sensitivity(input, levers);
  return kappa;
}

}  // namespace straytrace
