// SPDX-License-Identifier: BSD-3-Clause
// Photodiodes of the field, as text and CSV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "cli/wave/wave_output.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

// Over the power of the mode, or in W where the beam states its power.
double diode_scale(World const& world) { return arm_power(world) > 0 ? arm_power(world) : 1; }

double first_draw(DiodeResult const& found) { return found.draws.empty() ? not_a_number : found.draws.front(); }

}  // namespace

std::string photodiodes_text(ArmWaves const& waves, World const& world, std::size_t show) {
  if (waves.diodes.empty()) return "";
  bool const several = waves.draws.size() > 1;
  Columns table{{"photodiode", "radius/mm", "azimuth/deg", arm_power(world) > 0 ? "W" : "share"}, {true}, {}};
  if (several) table.titles.push_back("of draws");
  table.titles.insert(table.titles.end(), {"mean", "spread"});
  double const scale = diode_scale(world);
  for (std::size_t i = 0; i < std::min(show, waves.diodes.size()); ++i) {
    Photodiode const& d = waves.arm.diodes[i];
    DiodeResult const& found = waves.diodes[i];
    std::vector<std::string> row{d.name, fmt::format("{:.4g}", 1e3 * d.radius),
                                 fmt::format("{:.4g}", d.azimuth * 180 / pi),
                                 finite_text(scale * first_draw(found), "{:.4g}")};
    if (several) row.push_back(found.draws.empty() ? "-" : fmt::format("{:.4g}", scale * spread_of(found.draws).mean));
    row.push_back(fmt::format("{:.4g}", scale * found.mean));
    row.push_back(fmt::format("{:.2g}", scale * found.spread));
    table.rows.push_back(std::move(row));
  }
  std::string text = fmt::format(
      "\nLight on photodiodes: with the heights of the mirrors as first drawn{}; mean and standard deviation over all "
      "heights\nthat no map states (eq. W.41, W.43).\n\n{}",
      several ? ", mean of the draws" : "", aligned(table));
  if (waves.diodes.size() > show)
    text += fmt::format("and {} more; --show N has more rows\n", waves.diodes.size() - show);
  return text;
}

std::string photodiodes_csv(ArmWaves const& waves, World const& world) {
  char const* const unit = arm_power(world) > 0 ? "W" : "W/W";
  std::string text = fmt::format("photodiode,x [m],y [m],power [{0}],mean [{0}],spread [{0}]\n", unit);
  double const scale = diode_scale(world);
  for (std::size_t i = 0; i < waves.diodes.size(); ++i) {
    Photodiode const& d = waves.arm.diodes[i];
    DiodeResult const& found = waves.diodes[i];
    text +=
        fmt::format("{},{},{},{},{},{}\n", csv_text(d.name), d.x + d.radius * std::cos(d.azimuth),
                    d.y + d.radius * std::sin(d.azimuth), csv_number(!found.draws.empty(), scale * first_draw(found)),
                    scale * found.mean, scale * found.spread);
  }
  return text;
}

}  // namespace straytrace::cli
