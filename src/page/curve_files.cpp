// SPDX-License-Identifier: BSD-3-Clause
// Every curve of a run as CSV.
#include <fmt/format.h>

#include <map>

#include "page/exports.hpp"
#include "report/csv.hpp"

namespace straytrace {
namespace {

std::string value_at(std::vector<double> const& curve, std::size_t i) {
  return i < curve.size() ? csv_number(true, curve[i]) : "nan";
}

std::string budget_csv(RunContent const& run) {
  NoiseBudget const& b = *run.noise;
  NoiseBands const& d = b.bands;
  std::vector<std::pair<std::string, std::vector<double> const*>> curves = {
      {"h_mean", &b.total.asd},           {"h_sigma", &b.total.sigma},
      {"phase_only", &b.total.phase_asd}, {"amplitude_only", &b.total.amplitude_asd},
      {"input_low", &d.input_low},        {"input_high", &d.input_high},
      {"speckle_05", &d.speckle_05},      {"speckle_50", &d.speckle_50},
      {"speckle_95", &d.speckle_95},      {"coherent", &d.coherent}};
  for (DesignCurve const& c : b.design) curves.emplace_back(c.name, &c.asd);
  std::string text = file_header(run) + "# one-sided strain ASD, 1/sqrt(Hz)\nfrequency_Hz";
  for (auto const& [name, curve] : curves) text += "," + csv_text(name);
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    text += "\n" + csv_number(true, b.grid.centre(i));
    for (auto const& [name, curve] : curves) text += "," + value_at(*curve, i);
  }
  return text + "\n";
}

std::string routes_csv(RunContent const& run, PathTable const& table) {
  NoiseBudget const& b = *run.noise;
  std::map<std::uint64_t, NoiseTrace const*> by_hash;
  for (NoiseTrace const& t : b.routes) by_hash[t.hash] = &t;
  std::vector<NoiseTrace const*> routes;
  std::string text = file_header(run) +
                     "# one-sided strain ASD of each resolved route and its standard error, 1/sqrt(Hz), by rank\n"
                     "frequency_Hz";
  for (PathRow const& row : table.rows) {
    auto const found = by_hash.find(row.hash);
    if (!row.resolved || found == by_hash.end()) continue;
    routes.push_back(found->second);
    text += "," + csv_text(row.sequence) + "," + csv_text(row.sequence + " sigma");
  }
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    text += "\n" + csv_number(true, b.grid.centre(i));
    for (NoiseTrace const* t : routes) text += "," + value_at(t->asd, i) + "," + value_at(t->sigma, i);
  }
  return text + "\n";
}

}  // namespace

NamedTexts curve_files(RunContent const& run, PathTable const& table) {
  NamedTexts files;
  if (run.noise) {
    files.emplace_back("budget.csv", budget_csv(run));
    files.emplace_back("routes.csv", routes_csv(run, table));
  }
  files.emplace_back("paths.csv", path_csv(table, run));
  return files;
}

}  // namespace straytrace
