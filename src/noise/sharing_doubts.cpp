// SPDX-License-Identifier: BSD-3-Clause
#include "noise/sharing_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace straytrace {
namespace {

struct OfRoute {
  std::size_t checked = 0;
  SpotCheck worst;
};

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

std::vector<std::string> sharing_doubts(CouplingTable const& table, MotionSet const& motion,
                                        PhaseSpectra const& spectra, Strengths const& paths,
                                        std::vector<SpotCheck> const& checks) {
  std::map<std::size_t, OfRoute> routes;
  for (SpotCheck const& check : checks) {
    auto const after = std::upper_bound(paths.first.begin(), paths.first.end(), check.path);
    OfRoute& route = routes[static_cast<std::size_t>(after - paths.first.begin()) - 1];
    ++route.checked;
    if (check.error > route.worst.error) route.worst = check;
  }
  std::vector<std::string> out;
  for (auto const& [r, route] : routes) {
    if (route.worst.error <= StrengthNodes::tolerance) continue;
    CouplingClass const& c = table.classes[r];
    out.push_back(fmt::format(
        "route '{}': spectra that its paths share are off by up to {:.2g} of the PSD, at {:.3g} Hz, on {} of {} paths "
        "that were looked at (moved most by '{}'; tolerance {:g})",
        route_name(table, c), route.worst.error, spectra.grid().centre(route.worst.bin), route.checked,
        c.records.size(), strongest_motion(motion, spectra, paths.of(route.worst.path)), StrengthNodes::tolerance));
  }
  return out;
}

}  // namespace straytrace
