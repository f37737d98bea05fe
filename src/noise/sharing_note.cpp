// SPDX-License-Identifier: BSD-3-Clause
#include "noise/sharing_note.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace straytrace {
namespace {

// The input whose class has the most phase power in a path; a drift counts by its rate.
std::string strongest_motion(MotionSet const& motion, PhaseSpectra const& spectra, std::span<double const> kappa) {
  std::size_t most = 0;
  double highest = -1;
  for (std::size_t c = 0; c < kappa.size(); ++c) {
    double const power = std::fabs(kappa[c]) * (spectra.classes()[c].drift ? 1 : spectra.variance(c));
    if (power > highest) most = c;
    highest = std::max(highest, power);
  }
  return motion.inputs[spectra.classes()[most].members.front().input].name;
}

}  // namespace

std::string sharing_note(CouplingTable const& table, MotionSet const& motion, PhaseSpectra const& spectra,
                         Strengths const& paths, StrengthNodes const& nodes, DrawnError const& added) {
  std::string const error = added.share > 0 ? fmt::format("up to {:.2g} % of h to its error, at {:.3g} Hz",
                                                          100 * added.share, spectra.grid().centre(added.bin))
                                            : "nothing to the error of the total";
  std::string const drawn = fmt::format(
      "the spectra of {} paths rest on {} of them, drawn at random among paths of like strength; this adds {}",
      paths.size(), nodes.drawn(), error);
  if (nodes.checks().empty()) return drawn + ". Their strengths differ too much for shared spectra";
  SpotCheck const worst = *std::max_element(nodes.checks().begin(), nodes.checks().end(),
                                            [](auto const& a, auto const& b) { return a.error < b.error; });
  auto const after = std::upper_bound(paths.first.begin(), paths.first.end(), worst.path);
  CouplingClass const& route = table.classes[static_cast<std::size_t>(after - paths.first.begin()) - 1];
  return fmt::format(
      "{}. Shared spectra were off by up to {:.2g} of the PSD of a path, at {:.3g} Hz on route '{}' (moved most by "
      "'{}')",
      drawn, worst.error, spectra.grid().centre(worst.bin), route_name(table, route),
      strongest_motion(motion, spectra, paths.of(worst.path)));
}

}  // namespace straytrace
