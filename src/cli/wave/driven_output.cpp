// SPDX-License-Identifier: BSD-3-Clause
#include "cli/wave/driven_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/units/quantity.hpp"
#include "results/text/columns.hpp"
#include "session/scan/scan_axes.hpp"

namespace straytrace::cli {
namespace {

constexpr char example[] = "write for example --detuning -0.5..0.5:1001 (free spectral ranges) or -200Hz..200Hz:401";

constexpr double most_detuning = 1e-4;  // of the frequency of the light

ScanAxis axis_of(std::string const& option) {
  try {
    return parse_axes({option}, false).front();
  } catch (InputError const& e) {
    throw InputError(e.reason(), example);
  }
}

// Of a value in a list that did not become a finite number.
std::string fault_of(std::string const& value, double number) {
  if (std::isinf(number)) return fmt::format("'{}' is outside the range of double precision", value);
  char const* const fault = leading_number(value) ? "has another unit than the first value" : "is not a number";
  return fmt::format("'{}' {}", value, fault);
}

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

Columns table_of(DrivenScan const& driven, World const& world, std::vector<std::size_t> const& rows) {
  Columns table{{"detuning/FSR", "Hz", "circulating", "reflected", "transmitted"}, {}, {}};
  std::size_t const ports = driven.detunings.front().ports.size();
  if (ports > 1) {
    table.titles.pop_back();
    for (std::size_t i = 0; i < ports; ++i) table.titles.push_back("by " + world.name_of(driven.surfaces[i + 1]));
  }
  std::size_t const orders = driven.detunings.front().orders.size();
  for (std::size_t n = 0; n < orders; ++n) table.titles.push_back(fmt::format("order {}", n));
  table.titles.emplace_back("higher");
  for (std::size_t i : rows) {
    DrivenPowers const& p = driven.detunings[i];
    std::vector<std::string> row{fmt::format("{:+.6f}", p.detuning),
                                 fmt::format("{:+.6g}", p.detuning * driven.free_spectral_range),
                                 fmt::format("{:.5g}", p.circulating), fmt::format("{:.5g}", p.reflected)};
    for (double power : p.ports) row.push_back(fmt::format("{:.4g}", power));
    for (double share : p.orders) row.push_back(fmt::format("{:.3g}", share));
    row.push_back(fmt::format("{:.3g}", std::max(1 - in_orders(p), 0.0)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<double> parse_detunings(std::string const& text, double round_trip, double wavelength) {
  std::string const option = "--detuning=" + text;
  ScanAxis const axis = axis_of(option);
  std::vector<InputError> errors;
  auto const refuse = [&](std::string const& why, std::string const& remedy = example) {
    errors.emplace_back(fmt::format("'{}': {}", option, why), remedy);
  };
  auto const unit = axis.unit.empty() ? std::nullopt : parse_unit(axis.unit);
  if (!axis.unit.empty() && (!unit || unit->dimension != dim::frequency))
    refuse(fmt::format("'{}' is not a unit of frequency", axis.unit));
  if (axis.range && axis.numbers.front() > axis.numbers.back()) refuse("the range runs downwards");
  double const largest = most_detuning * round_trip / wavelength;
  std::vector<double> detunings;
  for (std::size_t i = 0; i < axis.numbers.size(); ++i) {
    double const number = axis.numbers[i];
    detunings.push_back(unit ? to_si(number, *unit) * round_trip / speed_of_light : number);
    bool const inside = axis.range && i > 0 && i + 1 < axis.numbers.size();  // of a range only the ends are reported
    if (!std::isfinite(number))
      refuse(fault_of(axis.values[i], number));
    else if (!inside && std::fabs(detunings.back()) > largest)
      refuse(fmt::format("'{}' is more than {:g} of the frequency of the light, and the field is computed at one "
                         "wavelength",
                         axis.values[i], most_detuning),
             fmt::format("stay within {:.3g} free spectral ranges, {:.3g} Hz", largest,
                         most_detuning * speed_of_light / wavelength));
  }
  throw_all(errors);
  return detunings;
}

std::string driven_text(DrivenScan const& driven, World const& world, std::size_t show) {
  auto const name = [&](std::size_t i) { return world.name_of(driven.surfaces[i]); };
  std::string others;
  for (std::size_t i = 1; i < driven.surfaces.size(); ++i)
    others += fmt::format("{}{}: {:.4g}", i > 1 ? ", " : "", name(i), driven.coatings[i].transmission);
  std::string text = fmt::format(
      "\nField driven through {}, which transmits {:.4g} ({}), per input power. Free spectral range {:.6g} Hz; {} "
      "round\n"
      "trips; at the worst detuning the field is known to {:.1g} of itself.\n",
      name(0), driven.coatings[0].transmission, others, driven.free_spectral_range, driven.round_trips,
      std::max(driven.error, 1e-15));
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
  return text + "\n" + aligned(table_of(driven, world, rows));
}

nlohmann::ordered_json driven_json(DrivenScan const& driven, World const& world) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (DrivenPowers const& p : driven.detunings)
    points.push_back({{"detuning", p.detuning},
                      {"detuning_hz", p.detuning * driven.free_spectral_range},
                      {"circulating", p.circulating},
                      {"reflected", p.reflected},
                      {"transmitted", p.transmitted},
                      {"ports", p.ports},
                      {"orders", p.orders},
                      {"field_error", p.error}});
  nlohmann::ordered_json mirrors = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < driven.surfaces.size(); ++i)
    mirrors.push_back({{"name", world.name_of(driven.surfaces[i])},
                       {"transmission", driven.coatings[i].transmission},
                       {"loss", driven.coatings[i].loss}});
  return {{"mirrors", mirrors},
          {"free_spectral_range_hz", driven.free_spectral_range},
          {"entered", driven.entered},
          {"input_orders", driven.input_orders},
          {"round_trips", driven.round_trips},
          {"field_error", driven.error},
          {"detunings", points}};
}

std::string driven_csv(DrivenScan const& driven, World const& world) {
  std::string text = "detuning,detuning [Hz],circulating,reflected,transmitted";
  std::size_t const ports = driven.detunings.front().ports.size();
  for (std::size_t i = 0; ports > 1 && i < ports; ++i) text += ",by " + world.name_of(driven.surfaces[i + 1]);
  for (std::size_t n = 0; n < driven.detunings.front().orders.size(); ++n) text += fmt::format(",order {}", n);
  text += ",field error\n";
  for (DrivenPowers const& p : driven.detunings) {
    text += fmt::format("{},{},{},{},{}", p.detuning, p.detuning * driven.free_spectral_range, p.circulating,
                        p.reflected, p.transmitted);
    for (std::size_t i = 0; ports > 1 && i < ports; ++i) text += fmt::format(",{}", p.ports[i]);
    for (double share : p.orders) text += fmt::format(",{}", share);
    text += fmt::format(",{}\n", p.error);
  }
  return text;
}

}  // namespace straytrace::cli
