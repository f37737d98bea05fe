// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "noise/noise.hpp"
#include "spectra/curve.hpp"

namespace straytrace::noise {

std::vector<double> NoiseTable::total() const {
  std::vector<double> sum(hz.size(), 0.0);
  for (std::size_t i = 0; i < hz.size(); ++i) {
    bool known = false;
    for (BudgetEntry const& e : entries)
      if (std::isfinite(e.asd[i])) known = true, sum[i] += e.asd[i] * e.asd[i];
    sum[i] = known ? std::sqrt(sum[i]) : not_a_number;
  }
  return sum;
}

std::vector<double> NoiseTable::total_sigma() const {
  if (std::ranges::all_of(entries, [](BudgetEntry const& e) { return e.sigma.empty(); })) return {};
  std::vector<double> const h = total();
  std::vector<double> out;
  for (std::size_t i = 0; i < hz.size(); ++i) {
    double square = 0;  // of the error of the PSD over two: h sigma
    for (BudgetEntry const& e : entries)
      if (!e.sigma.empty() && std::isfinite(e.asd[i])) square += std::pow(e.asd[i] * e.sigma[i], 2);
    out.push_back(h[i] > 0 ? std::sqrt(square) / h[i] : h[i]);
  }
  return out;
}

std::vector<double> NoiseTable::total_at(std::vector<double> BudgetBands::*end) const {
  NoiseTable moved{hz, {}};
  bool stated = false;
  for (BudgetEntry e : entries) {
    stated |= e.inputs_stated;
    if (e.inputs_stated) e.asd = e.bands.*end;
    moved.entries.push_back(std::move(e));
  }
  return stated ? moved.total() : std::vector<double>();
}

namespace {

BudgetEntry entry_of(FundamentalNoise const& noise, Detector const& d, std::span<double const> hz) {
  BudgetEntry e{
      std::string(noise.name), std::string(noise.words), BudgetEntry::Kind::fundamental, noise.psd(d, hz), {}, "", {}};
  for (std::size_t i = 0; i < hz.size(); ++i) {
    if (!std::isfinite(e.asd[i]) || e.asd[i] < 0)
      throw NumericalError(fmt::format("{} is not finite at {:g} Hz", noise.name, hz[i]));
    e.asd[i] = std::sqrt(e.asd[i]);
  }
  for (FundamentalNoise const& part : noise.parts) e.parts.push_back(entry_of(part, d, hz));
  return e;
}

}  // namespace

FundamentalEntries fundamental_entries(Detector const& d, std::span<double const> hz) {
  FundamentalEntries all;
  for (FundamentalNoise const& noise : fundamental_noises())
    if (noise.known(d))
      all.entries.push_back(entry_of(noise, d, hz));
    else
      all.left_out.push_back(fmt::format("{} (needs {})", noise.name, noise.needs));
  return all;
}

std::vector<double> thermal_requirement(NoiseTable const& table) {
  constexpr std::string_view needed[] = {"SuspensionThermal", "CoatingBrownian", "CoatingThermoOptic",
                                         "SubstrateBrownian", "SubstrateThermoElastic"};
  std::vector<double> sum(table.hz.size(), 0.0);
  for (std::string_view const name : needed) {
    auto const found = std::ranges::find_if(table.entries, [&](BudgetEntry const& e) { return e.name == name; });
    if (found == table.entries.end()) return {};
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = std::hypot(sum[i], found->asd[i]);
  }
  for (double& x : sum) x *= 0.1;
  return sum;
}

namespace {

constexpr std::string_view folder = "curves/";

// a exp(p0 + p1 x + p2 x^2), x = ln(f / reference)
struct Term {
  double a, p0, p1, p2;
};
constexpr Term adv[] = {{0.07, -0.142, -1.437, 0.407},
                        {3.1, -0.466, -1.043, -0.548},
                        {0.4, -0.304, 2.896, -0.293},
                        {0.09, 1.466, 3.722, -0.984}};
constexpr Term kagra[] = {
    {9.72e-9, -1.43, -9.88, -0.23}, {1.17, 0.14, -3.10, -0.26}, {1.70, 0.14, 1.09, -0.013}, {1.25, 0.071, 2.83, -4.91}};

double fit(std::span<Term const> terms, double scale, double reference, double hz) {
  double const x = std::log(hz / reference);
  double sum = 0;
  for (Term const& t : terms) sum += t.a * std::exp(t.p0 + t.p1 * x + t.p2 * x * x);
  return scale * sum;
}

// Tables that come with the program: data/curves/NAME.txt.
Curve const* table_of(std::string_view name) {
  static std::map<std::string, Curve, std::less<>> const tables = [] {
    std::map<std::string, Curve, std::less<>> all;
    for (EmbeddedFile const& file : embedded_files())
      if (file.name.starts_with(folder))
        all.emplace(file.name.substr(folder.size(), file.name.size() - folder.size() - 4), parse_curve(file.text));
    return all;
  }();
  auto const found = tables.find(name);
  return found == tables.end() ? nullptr : &found->second;
}

constexpr double et_d_hz[] = {1, 3, 5, 10, 20, 100, 1000};
constexpr double et_d_asd[] = {3.50e-17, 2.22e-23, 3.56e-24, 1.16e-24, 9.39e-25, 3.93e-25, 5.78e-25};

DesignCurve from_file(Node const& where, std::string const& name, FrequencyGrid const& grid) {
  DesignCurve design{name, std::vector<double>(grid.size(), not_a_number)};
  std::string const text = where.data_file(name);
  if (text.empty() && !where.document()->optional_file(where, name)) return design;  // data_file() reported it
  Curve const curve = parse_named_curve(text, strain_columns);
  for (Problem const& p : curve.problems)
    where.file_problem(name, p.place.line, p.place.column, p.what,
                       "a design curve consists of two columns: frequency in Hz, strain in 1/sqrt(Hz)");
  if (curve.problems.empty())
    for (std::size_t i = 0; i < grid.size(); ++i) design.asd[i] = curve.at(grid.centre(i));
  return design;
}

}  // namespace

std::span<std::string const> built_in_designs() {
  static std::vector<std::string> const names = [] {
    std::vector<std::string> all = {"adv-lal", "kagra-lal", "et-d-points"};
    for (EmbeddedFile const& file : embedded_files())
      if (file.name.starts_with(folder))
        all.emplace_back(file.name.substr(folder.size(), file.name.size() - folder.size() - 4));
    return all;
  }();
  return names;
}

std::vector<std::string> detectors_of_design(std::string_view name) {
  static std::map<std::string, std::vector<std::string>, std::less<>> const detectors = {
      {"adv-lal", {"adv"}},         {"kagra-lal", {"kagra"}},     {"et-d-points", {"et-hf", "et-lf"}},
      {"et-d", {"et-hf", "et-lf"}}, {"aligo-gwinc", {"aligo"}},   {"aplus-gwinc", {"aplus"}},
      {"ce1-gwinc", {"ce"}},        {"ce2-silica-gwinc", {"ce"}},
  };
  auto const found = detectors.find(name);
  return found == detectors.end() ? std::vector<std::string>{} : found->second;
}

double design_asd(std::string_view name, double hz) {
  if (name == "adv-lal") return fit(adv, 1.259e-24, 300, hz);
  if (name == "kagra-lal") return fit(kagra, 6.499e-25, 100, hz);
  if (name == "et-d-points") return log_log_at(et_d_hz, et_d_asd, hz);
  Curve const* const table = table_of(name);
  return table ? table->at(hz) : not_a_number;
}

std::vector<DesignCurve> read_design_curves(Node const& noise_table, NoiseSettings const& settings) {
  std::vector<DesignCurve> curves;
  std::span<std::string const> const known = built_in_designs();
  for (Node const& node : noise_table.list("compare")) {
    std::string const name = node.as_word();
    if (std::ranges::find(known, name) != known.end()) {
      curves.push_back({name, {}});
      for (std::size_t i = 0; i < settings.grid.size(); ++i)
        curves.back().asd.push_back(design_asd(name, settings.grid.centre(i)));
    } else if (name.find_first_of("./") != name.npos) {
      curves.push_back(from_file(node, name, settings.grid));
    } else if (!name.empty()) {
      node.problem(
          fmt::format("'{}' is not a design curve", name),
          did_you_mean(name, known,
                       fmt::format("write {}, or the name of a file such as 'design.txt'", fmt::join(known, ", "))));
    }
  }
  return curves;
}

}  // namespace straytrace::noise
