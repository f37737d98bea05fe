// SPDX-License-Identifier: BSD-3-Clause
#include "app/ghosts_uncounted.hpp"

#include <fmt/format.h>

#include <numeric>

#include "app/ghost_search.hpp"

namespace straytrace {
namespace {

std::string power_of(GhostReport const& r) {
  double const share = std::accumulate(r.power_by_order.begin() + 1, r.power_by_order.end(), 0.0);
  return r.power > 0 ? fmt::format("{:.2g} W", share * r.power) : fmt::format("{:.2g} of the launched light", share);
}

std::string strain_of(GhostReport const& r) {
  double const h = r.strain[0];
  return h > 0 ? fmt::format(", which makes h({:g} Hz) = {:.2g} /sqrt(Hz)", ghost_frequencies[0], h) : "";
}

}  // namespace

void warn_of_uncounted_ghosts(Model const& model) {
  if (!model.detector || model.scene.root().has("ghosts")) return;
  GhostSearch const search{model, quick_search(), GhostRank::power, 1, nullptr, {}};
  auto const beams = model.scene.table("beams").items();
  for (BeamLaunch const& launch : launches(model.world)) {
    if (launch.through_input_mirror()) continue;
    GhostReport const r = ghost_report(search, launch, {});
    if (!(r.share > 0)) continue;
    beams.at(launch.beam)
        .second.warning(
            fmt::format("ghost beams are not counted: to order {} they take {} of '{}', and bring {:.2g} of the main "
                        "mode back to port '{}'{}",
                        r.limits.order, power_of(r), r.beam, r.share, r.port, strain_of(r)),
            "add 'ghosts: {order: 2}' to count them, or 'ghosts: off' where you know that they do not matter; "
            "straytrace ghosts lists them");
  }
}

}  // namespace straytrace
