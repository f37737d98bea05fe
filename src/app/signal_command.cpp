// SPDX-License-Identifier: BSD-3-Clause
// straytrace signal: spectra, transfer functions, displacement, maps of recorded data.
#include "app/signal_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/options.hpp"
#include "base/message.hpp"
#include "report/columns.hpp"

namespace straytrace {

std::string note_lines(std::vector<std::string> const& notes) {
  std::string text;
  for (std::string const& note : notes) text += note + "\n";
  return text;
}

void keep_band(CurveSheet& sheet, FrequencyBand band) {
  std::vector<double> const x = sheet.x.values;
  auto const kept = [&](CurveColumn& c) {
    std::vector<double> values;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (x[i] >= band.low * (1 - 1e-12) && x[i] <= band.high * (1 + 1e-12)) values.push_back(c.values[i]);
    c.values = std::move(values);
  };
  for (CurveColumn& c : sheet.y) kept(c);
  kept(sheet.x);
  if (sheet.x.values.empty())
    throw InputError(
        fmt::format("error: --band: no line between {:g} Hz and {:g} Hz\n  choose it wider, or longer segments",
                    band.low, band.high));
}

std::string some_rows(CurveSheet const& sheet, std::size_t count) {
  std::vector<double> const& x = sheet.x.values;
  std::size_t const first = sheet.log_x && x.size() > 1 && x[0] <= 0 ? 1 : 0;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < count && first < x.size(); ++i) {
    double const share = count > 1 ? double(i) / double(count - 1) : 0;
    double const at =
        sheet.log_x ? x[first] * std::pow(x.back() / x[first], share) : std::lerp(x[first], x.back(), share);
    auto const hit = std::min<std::ptrdiff_t>(std::lower_bound(x.begin(), x.end(), at * (1 - 1e-9)) - x.begin(),
                                              std::ptrdiff_t(x.size()) - 1);
    if (rows.empty() || rows.back() != std::size_t(hit)) rows.push_back(std::size_t(hit));
  }
  Columns table;
  table.titles.push_back(fmt::format("{} [{}]", sheet.x.name, sheet.x.unit));
  for (CurveColumn const& c : sheet.y)
    table.titles.push_back(c.unit.empty() || c.unit == "1" ? c.name : fmt::format("{} [{}]", c.name, c.unit));
  for (std::size_t const i : rows) {
    table.rows.push_back({fmt::format("{:.{}g}", x[i], sheet.x.unit == "s" ? 13 : 10)});  // GPS s to a millisecond
    for (CurveColumn const& c : sheet.y)
      table.rows.back().push_back(std::isfinite(c.values[i]) ? fmt::format("{:.4g}", c.values[i]) : "not known");
  }
  return aligned(table);
}

void add_signal(CLI::App& app, Options&, int& exit_code) {
  auto* const signal = app.add_subcommand("signal", "recorded data: spectra, transfer functions, displacement, maps");
  signal->require_subcommand(1);
  add_signal_spectra(*signal, exit_code);
  add_signal_records(*signal, exit_code);
  add_signal_maps(*signal, exit_code);
  signal->footer(
      "Data are FILE or FILE::CHANNEL: columns of text, CSV, HDF5 of gwpy or GWOSC.\n"
      "Examples:\n"
      "  straytrace signal psd examples/data/bench.csv::acc --segment \"4 s\"\n"
      "  straytrace signal transfer --help");
}

}  // namespace straytrace
