// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "noise/fundamental/fundamental.hpp"

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

}  // namespace straytrace::noise
