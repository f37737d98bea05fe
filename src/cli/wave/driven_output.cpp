// SPDX-License-Identifier: BSD-3-Clause
#include "cli/wave/driven_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/units/quantity.hpp"
#include "results/text/columns.hpp"
#include "session/scan/scan_axes.hpp"

namespace straytrace::cli {
namespace {

constexpr char example[] = "write for example --detuning -0.5..0.5:1001 (free spectral ranges) or -200Hz..200Hz:401";

double in_orders(DrivenPowers const& p) {
  double sum = 0;
  for (double share : p.orders) sum += share;
  return sum;
}

// Those of a list that is too long for a table: where the circulating power has a maximum, largest first.
std::vector<std::size_t> resonances(std::vector<DrivenPowers> const& all) {
  std::vector<std::size_t> peaks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool const above_last = i == 0 || all[i].circulating > all[i - 1].circulating,
               above_next = i + 1 == all.size() || all[i].circulating >= all[i + 1].circulating;
    if (above_last && above_next) peaks.push_back(i);
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, [&](std::size_t i) { return all[i].circulating; });
  return peaks;
}

Columns table_of(DrivenArm const& driven, std::vector<std::size_t> const& rows) {
  Columns table{{"detuning/FSR", "Hz", "circulating", "reflected", "transmitted"}, {}, {}};
  std::size_t const orders = driven.detunings.front().orders.size();
  for (std::size_t n = 0; n < orders; ++n) table.titles.push_back(fmt::format("order {}", n));
  table.titles.emplace_back("higher");
  for (std::size_t i : rows) {
    DrivenPowers const& p = driven.detunings[i];
    std::vector<std::string> row{
        fmt::format("{:+.6f}", p.detuning), fmt::format("{:+.6g}", p.detuning * driven.free_spectral_range),
        fmt::format("{:.5g}", p.circulating), fmt::format("{:.5g}", p.reflected), fmt::format("{:.4g}", p.transmitted)};
    for (double share : p.orders) row.push_back(fmt::format("{:.3g}", share));
    row.push_back(fmt::format("{:.3g}", std::max(1 - in_orders(p), 0.0)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<double> Detunings::in_ranges(double cavity_length) const {
  std::vector<double> all = values;
  if (in_hertz)
    for (double& v : all) v *= 2 * cavity_length / speed_of_light;
  return all;
}

Detunings parse_detunings(std::string const& text) {
  ScanAxis const axis = [&] {
    try {
      return parse_axes({"detuning=" + text}, false).front();
    } catch (InputError const&) {
      throw InputError(fmt::format("'{}' is not a list of detunings", text), example);
    }
  }();
  Detunings detunings{axis.numbers, false};
  for (double v : detunings.values)
    if (!std::isfinite(v)) throw InputError(fmt::format("'{}' is not a list of detunings", text), example);
  if (axis.unit.empty()) return detunings;
  auto const unit = parse_unit(axis.unit);
  if (!unit || unit->dimension != dim::frequency)
    throw InputError(fmt::format("'{}' is not a unit of frequency", axis.unit), example);
  for (double& v : detunings.values) v = to_si(v, *unit);
  detunings.in_hertz = true;
  return detunings;
}

std::string driven_text(DrivenArm const& driven, World const& world, std::size_t show) {
  auto const name = [&](std::size_t i) { return world.name_of(world.wave.mirrors[i].surface); };
  std::string text = fmt::format(
      "\nField driven through {}, which transmits {:.4g} ({}: {:.4g}), per input power. Free spectral range {:.6g} Hz; "
      "{} round\n"
      "trips; at the worst detuning the field is known to {:.1g} of itself.\n",
      name(0), driven.coatings[0].transmission, name(1), driven.coatings[1].transmission, driven.free_spectral_range,
      driven.round_trips, std::max(driven.error, 1e-15));
  if (driven.input_orders.empty()) {
    text += "The input is the mode of the cavity.\n";
  } else {
    text += fmt::format("The input shares with the modes of the mirrors");
    for (std::size_t n = 0; n < driven.input_orders.size(); ++n)
      text += fmt::format("{} {:.5g} in order {}", n ? "," : "", driven.input_orders[n], n);
    text += fmt::format("; {:.5g} of it falls on {}.\n", driven.entered, name(0));
  }
  std::vector<std::size_t> rows(driven.detunings.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  bool const all = rows.size() <= show;
  if (!all) rows = resonances(driven.detunings);
  std::size_t const found = rows.size();
  if (found > show) rows.resize(show);
  if (!all)
    text += fmt::format("Maxima of the circulating power over {} detunings, largest first{}; --csv has all.\n",
                        driven.detunings.size(), found > show ? fmt::format(", {} of {}", show, found) : "");
  return text + "\n" + aligned(table_of(driven, rows));
}

nlohmann::ordered_json driven_json(DrivenArm const& driven) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (DrivenPowers const& p : driven.detunings)
    points.push_back({{"detuning", p.detuning},
                      {"detuning_hz", p.detuning * driven.free_spectral_range},
                      {"circulating", p.circulating},
                      {"reflected", p.reflected},
                      {"transmitted", p.transmitted},
                      {"orders", p.orders},
                      {"field_error", p.error}});
  nlohmann::ordered_json mirrors = nlohmann::ordered_json::array();
  for (MirrorCoating const& c : driven.coatings)
    mirrors.push_back({{"transmission", c.transmission}, {"loss", c.loss}});
  return {{"mirrors", mirrors},
          {"free_spectral_range_hz", driven.free_spectral_range},
          {"entered", driven.entered},
          {"input_orders", driven.input_orders},
          {"round_trips", driven.round_trips},
          {"field_error", driven.error},
          {"detunings", points}};
}

std::string driven_csv(DrivenArm const& driven) {
  std::string text = "detuning,detuning [Hz],circulating,reflected,transmitted";
  for (std::size_t n = 0; n < driven.detunings.front().orders.size(); ++n) text += fmt::format(",order {}", n);
  text += ",field error\n";
  for (DrivenPowers const& p : driven.detunings) {
    text += fmt::format("{},{},{},{},{}", p.detuning, p.detuning * driven.free_spectral_range, p.circulating,
                        p.reflected, p.transmitted);
    for (double share : p.orders) text += fmt::format(",{}", share);
    text += fmt::format(",{}\n", p.error);
  }
  return text;
}

}  // namespace straytrace::cli
