// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/composition.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace straytrace::noise {
namespace {

using SpreadList = std::vector<MaterialSpread>;
using ScatterCounts = std::vector<int>;  // by material

bool is_one_route(CouplingClass const& c) { return !c.steps.empty() && c.folded_routes <= 1; }

// Ghosts only reflect and transmit.
bool never_scatters(MaterialSpread const& m, CouplingClass const& c) {
  return c.kind == ClassKind::ghost && !m.of_reflection;
}

ScatterCounts scatter_counts(SpreadList const& materials, std::vector<PathStep> const& steps) {
  ScatterCounts all;
  for (MaterialSpread const& m : materials) all.push_back(scatters_on(m, steps));
  return all;
}

// Numbers of scatters of the named routes of a class, and the share of their coupling with each; none: no names.
std::map<ScatterCounts, double> named_shares(SpreadList const& materials, CouplingClass const& c) {
  if (!c.steps.empty() && c.folded.empty()) return {{scatter_counts(materials, c.steps), 1.0}};
  std::map<ScatterCounts, double> shares;
  double sum = 0;
  for (FoldedRoute const& f : c.folded) {
    if (f.steps.empty() || !(f.mean > 0)) continue;
    shares[scatter_counts(materials, f.steps)] += f.mean;
    sum += f.mean;
  }
  for (auto& [scatters, share] : shares) share /= sum;
  return shares;
}

std::vector<RowPart> parts_by_coupling(SpreadList const& materials, CouplingClass const& c) {
  std::vector<RowPart> parts;
  for (auto const& [scatters, share] : named_shares(materials, c))
    parts.push_back({scatters, share, {}, !is_one_route(c)});
  if (parts.empty()) parts.push_back({ScatterCounts(materials.size(), 1), 1, {}, true});
  return parts;
}

// The paths of a row `other`, as one class for each combination of numbers of scatters; nothing: of unknown routes.
using DividedRow = std::map<std::optional<ScatterCounts>, CouplingClass>;

DividedRow divided_row(SpreadList const& materials, CouplingClass const& c) {
  std::vector<std::optional<ScatterCounts>> of_member;
  for (MemberRoute const& route : c.members)
    of_member.push_back(route.steps.empty() ? std::nullopt : std::optional(scatter_counts(materials, route.steps)));
  DividedRow all;
  double weights = 0;
  for (PathRecord const& r : c.records) {
    CouplingClass& part = all[r.member < of_member.size() ? of_member[r.member] : std::nullopt];
    part.records.push_back(r);
    part.coupling.mean += r.weight;
    weights += r.weight;
  }
  for (auto& [counts, part] : all) {
    double const share = weights > 0 ? part.coupling.mean / weights : 0;
    part.port = c.port;
    part.reverse = c.reverse;
    part.coupling.mean = share * c.coupling.mean;
    for (std::size_t r = 0; r < part.replica_sum.size(); ++r) part.replica_sum[r] = share * c.replica_sum[r];
  }
  return all;
}

CouplingTable without_classes(CouplingTable const& table) {
  CouplingTable out;
  out.groups = table.groups;
  out.bodies = table.bodies;
  out.ports = table.ports;
  out.replica_histories = table.replica_histories;
  out.histories = table.histories;
  out.block_size = table.block_size;
  out.wavelength = table.wavelength;
  return out;
}

// Shares of the PSD of the parts of one row, per bin: those of known routes, and last the rest, if any, which is
// divided as `named` is. Without noise the shares are those of the light.
std::vector<RowPart> parts_by_noise(std::span<std::optional<ScatterCounts> const> counts,
                                    std::span<CouplingClass const> light, std::span<NoiseTrace const> noise,
                                    std::vector<RowPart> const& named) {
  std::size_t const bins = noise.front().asd.size();
  double power = 0;
  for (CouplingClass const& c : light) power += c.coupling.mean;
  std::vector<RowPart> parts;
  for (std::size_t k = 0; k < noise.size(); ++k) {
    std::vector<double> share(bins);
    for (std::size_t i = 0; i < bins; ++i) {
      double all = 0;
      for (NoiseTrace const& t : noise) all += t.psd(i);
      share[i] = all > 0 ? noise[k].psd(i) / all : light[k].coupling.mean / power;
    }
    if (counts[k])
      parts.push_back({*counts[k], 1, std::move(share), false});
    else
      for (RowPart const& part : named) parts.push_back({part.scatters, part.share, share, true});
  }
  return parts;
}

}  // namespace

int scatters_on(MaterialSpread const& m, std::vector<PathStep> const& steps) {
  auto const counts = [&](PathStep const& s) {
    bool const scatters = letter(s.event) == 'S';
    return (m.of_reflection ? s.event == Event::reflect : scatters) &&
           std::binary_search(m.groups.begin(), m.groups.end(), s.group);
  };
  return int(std::ranges::count_if(steps, counts));
}

double coupling_factor(MaterialSpread const& m, CouplingClass const& c, double ratio) {
  double sum = 0;
  for (RowPart const& part : parts_by_coupling({m}, c)) sum += part.share * std::pow(ratio, part.scatters.front());
  return sum;
}

bool composition_known(MaterialSpread const& m, CouplingClass const& c) {
  if (is_one_route(c) || never_scatters(m, c)) return true;
  if (c.folded.empty() || c.folded.size() != c.folded_routes) return false;
  int const first = scatters_on(m, c.folded.front().steps);
  return std::ranges::all_of(
      c.folded, [&](FoldedRoute const& f) { return !f.steps.empty() && scatters_on(m, f.steps) == first; });
}

Composition::Composition(CouplingTable const& table, SpreadList materials, MotionSet const& motion,
                         Interferometer const& ifo, NoiseSettings const& settings)
    : materials_(std::move(materials)) {
  CouplingTable rows = without_classes(table);
  std::vector<std::optional<ScatterCounts>> counts;      // of each class in `rows`
  std::vector<std::pair<std::size_t, std::size_t>> row;  // route, number of its parts
  for (std::size_t r = 0; r < table.classes.size(); ++r) {
    CouplingClass const& c = table.classes[r];
    parts_.push_back(parts_by_coupling(materials_, c));
    std::vector<bool>& known = known_.emplace_back();
    for (MaterialSpread const& m : materials_) known.push_back(composition_known(m, c));
    bool const by_noise = c.mixes_routes() && !c.members.empty() && c.coupling.mean > 0 && !c.records.empty();
    if (!by_noise || std::ranges::find(known, false) == known.end()) continue;
    DividedRow divided = divided_row(materials_, c);
    row.emplace_back(r, divided.size());
    for (auto& [of_part, part] : divided) {
      counts.push_back(of_part);
      rows.classes.push_back(std::move(part));
    }
  }
  if (rows.classes.empty()) return;
  NoiseBudget const budget = project_noise(rows, motion, ifo, settings);
  std::size_t first = 0;
  for (auto const& [r, n] : row) {
    parts_[r] = parts_by_noise(std::span(counts).subspan(first, n), std::span(rows.classes).subspan(first, n),
                               std::span(budget.routes).subspan(first, n), parts_[r]);
    first += n;
  }
}

double Composition::factor(std::size_t route, std::size_t bin, std::span<double const> ratio) const {
  double sum = 0;
  for (RowPart const& part : parts_[route]) {
    double factor = part.at(bin);
    for (std::size_t m = 0; m < ratio.size(); ++m) factor *= std::pow(ratio[m], part.scatters[m]);
    sum += factor;
  }
  return sum;
}

double Composition::factor(std::size_t route, std::size_t bin, std::size_t material, double ratio) const {
  double sum = 0;
  for (RowPart const& part : parts_[route]) sum += part.at(bin) * std::pow(ratio, part.scatters[material]);
  return sum;
}

double Composition::unknown(std::size_t route, std::size_t bin, std::size_t material) const {
  if (known_[route][material]) return 0;
  double sum = 0;
  for (RowPart const& part : parts_[route]) sum += part.by_coupling ? part.at(bin) : 0;
  return sum;
}

}  // namespace straytrace::noise
