// SPDX-License-Identifier: BSD-3-Clause
// The numbers behind the tables and maps of receivers.
#include <algorithm>
#include <cmath>

#include "report/receivers.hpp"
#include "report/replicas.hpp"

namespace straytrace {
namespace {

std::vector<std::string> first_and_last(CouplingTable const& table, CouplingClass const& c) {
  std::vector<std::string> objects;
  for (PathStep const& s : c.steps) {
    if (s.event == Event::receive) continue;
    std::string const& name = table.groups[s.group.value];
    if (std::find(objects.begin(), objects.end(), name) == objects.end()) objects.push_back(name);
  }
  return objects;
}

bool before(ReceivedRoute const& a, ReceivedRoute const& b) {
  if (a.power.trusted != b.power.trusted) return a.power.trusted;
  return a.power.mean != b.power.mean ? a.power.mean > b.power.mean : a.hash < b.hash;
}

ReplicaSum summand(CouplingTable const& table, CouplingClass const& c) {
  return {{c.coupling.mean, c.coupling.std_error}, pattern_of(table, c)};
}

void take_census(ReceiverEntry& entry, CouplingTable const& table, std::vector<CouplingClass const*> const& classes) {
  std::map<std::string, std::pair<ReplicaSum, std::vector<std::size_t>>> objects;
  for (ReceivedRoute const& route : entry.routes) {
    auto const is = [&](CouplingClass const* c) { return c->hash == route.hash; };
    CouplingClass const& c = **std::find_if(classes.begin(), classes.end(), is);
    std::vector<std::string> names = route.objects;
    if (c.steps.empty()) names = {""};
    for (std::string const& name : names) {
      objects[name].first.add(summand(table, c));
      objects[name].second.push_back(route.rank);
    }
  }
  auto const& histories = table.replica_histories;  // without all of them, what routes have in common is not known
  bool const known = std::find(histories.begin(), histories.end(), 0u) == histories.end();
  for (auto const& [name, found] : objects) {
    WithError const sum = found.first.result();
    entry.census.push_back({name, {sum.value, known ? sum.sigma : not_a_number}, found.second});
  }
  std::sort(entry.census.begin(), entry.census.end(), [](CensusRow const& a, CensusRow const& b) {
    if (a.object.empty() != b.object.empty()) return b.object.empty();
    return a.power.value != b.power.value ? a.power.value > b.power.value : a.object < b.object;
  });
}

ReceiverEntry entry_of(CouplingTable const& table, std::size_t number, BlockSums const& total) {
  ReceiverEntry entry;
  entry.name = table.receivers[number];
  entry.power = table.received_power.at(number);
  std::vector<CouplingClass const*> classes;
  ReplicaSum all;
  for (CouplingClass const& c : table.received)
    if (c.port.value == number) {
      classes.push_back(&c);
      all.add(summand(table, c));
    }
  for (CouplingClass const* c : classes)
    entry.routes.push_back({0, c->hash, received_name(table, *c), c->coupling, summand(table, *c).share_of(all),
                            first_and_last(table, *c), c->folded_routes, folded_rows(table, *c)});
  std::sort(entry.routes.begin(), entry.routes.end(), before);
  for (std::size_t i = 0; i < entry.routes.size(); ++i) entry.routes[i].rank = i + 1;
  take_census(entry, table, classes);
  entry.quadrants = cell_estimates(total.receivers.at(number).quadrants, total.histories, total.blocks);
  return entry;
}

}  // namespace

CellEstimates cell_estimates(MapSums const& map, std::uint64_t histories, std::uint64_t blocks) {
  constexpr double faintest = 1e-290;  // of squares: below, what single blocks add has lost digits or is gone
  constexpr double rounding = 1e-13;   // relative, of sums of squares
  CellEstimates cells;
  double const n = double(histories), b = double(blocks);
  for (std::size_t i = 0; i < map.sum.size(); ++i) {
    bool const seen = map.sum[i] > 0;
    double const between = map.sum2[i] - map.sum[i] * map.sum[i] / b;
    bool const known = seen && blocks > 1 && between > rounding * map.sum2[i] && map.sum2[i] > faintest;
    cells.mean.push_back(seen ? map.sum[i] / n : not_a_number);
    cells.error.push_back(known ? std::sqrt(between * b / (b - 1)) / n : not_a_number);
  }
  return cells;
}

FieldMap field_map(Receiver const& r, ReceiverSums const& sums, std::uint64_t histories) {
  FieldMap map;
  std::size_t const pixels = r.map_size();
  if (sums.fields.empty() || pixels == 0) return map;
  double const n = double(histories);
  map.field.resize(pixels);
  map.coherence.assign(pixels, not_a_number);
  for (auto const& [route, f] : sums.fields)
    for (std::size_t i = 0; i < pixels; ++i) {
      std::complex<double> const mean(f.real[i], f.imaginary[i]);
      double const in_phase = std::abs(mean);
      if (!(in_phase > 0)) continue;
      map.field[i] += std::sqrt(f.power[i] / (n * r.area(i))) * (mean / in_phase);
      map.coherence[i] = std::fmin(map.coherence[i], in_phase / f.power[i]);  // fmin passes over NaN
    }
  return map;
}

ReceiverTable receiver_table(RunContent const& run) {
  ReceiverTable table;
  table.beam_power = run.beam_power;
  CouplingTable const& coupling = run.trace->coupling;
  for (std::size_t i = 0; i < coupling.receivers.size(); ++i)
    table.receivers.push_back(entry_of(coupling, i, run.trace->total));
  return table;
}

}  // namespace straytrace
