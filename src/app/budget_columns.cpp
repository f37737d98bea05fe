// SPDX-License-Identifier: BSD-3-Clause
// budget.txt: a column per curve.
#include <fmt/format.h>

#include <algorithm>

#include "app/budget_view.hpp"
#include "app/build_info.hpp"

namespace straytrace {
namespace {

// Names of columns hold no spaces.
std::string joined(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

struct Column {
  std::string name;
  std::vector<double> values;
};

// All columns of strain after the frequency, then the same of displacement for entries and total.
std::vector<Column> columns_of(BudgetOn const& b) {
  NoiseTable const& t = b.table;
  std::vector<Column> all, moved;
  auto const metres = [&](std::string const& name, std::vector<double> values) {
    for (std::size_t i = 0; i < values.size() && !b.metres.empty(); ++i) values[i] *= b.metres[i];
    if (!b.metres.empty()) moved.push_back({joined(name) + "_displacement", std::move(values)});
  };
  for (BudgetEntry const& e : t.entries) {
    all.push_back({joined(e.name) + "_strain", e.asd});
    metres(e.name, e.asd);
  }
  all.push_back({"total_strain", t.total()});
  metres("total", t.total());
  for (ReferenceCurve const& c : b.curves) all.push_back({joined(c.name), c.asd});
  for (ReferenceCurve const& c : b.lines) all.push_back({joined(c.name) + "_strain", c.asd});
  all.insert(all.end(), moved.begin(), moved.end());
  for (BudgetEntry const& e : t.entries) {
    if (!e.sigma.empty()) all.push_back({joined(e.name) + "_sigma", e.sigma});
    for (BudgetBandColumn const& c : budget_band_columns)
      if (!(e.bands.*c.curve).empty()) all.push_back({joined(e.name) + "_" + c.name, e.bands.*c.curve});
  }
  if (auto sigma = t.total_sigma(); !sigma.empty()) all.push_back({"total_sigma", std::move(sigma)});
  for (auto const& [name, end] :
       {std::pair{"total_input_low", &BudgetBands::input_low}, {"total_input_high", &BudgetBands::input_high}})
    if (auto curve = t.total_at(end); !curve.empty()) all.push_back({name, std::move(curve)});
  return all;
}

}  // namespace

std::string budget_columns(BudgetView const& v) {
  std::vector<double> const& hz = v.grid.table.hz;
  std::string text = fmt::format(
      "# {}\n# straytrace {} ({})\n# ASD, one-sided: _strain [1/sqrt(Hz)], _displacement of the difference of the arms "
      "[m/sqrt(Hz)]; nan: not known\n# of stray light [1/sqrt(Hz)]: _sigma one standard error (Monte Carlo), "
      "_input_low, "
      "_input_high what stated inputs leave open,\n# _speckle_05, _50, _95 percentiles of one realisation\n# Hz",
      v.title, build_info::version, build_info::commit);
  std::vector<Column> const columns = columns_of(v.grid);
  for (Column const& c : columns) text += " " + c.name;
  text += '\n';
  for (std::size_t i = 0; i < hz.size(); ++i) {
    text += fmt::format("{:.9g}", hz[i]);
    for (Column const& c : columns) text += fmt::format(" {:.6e}", c.values[i]);
    text += '\n';
  }
  return text;
}

}  // namespace straytrace
