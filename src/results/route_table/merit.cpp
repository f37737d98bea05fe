// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/merit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/route_table/route_sums.hpp"

namespace straytrace {
namespace {

constexpr char const* ends[] = {"receiver ", "port "};

double merit(double mean, double error, double seconds) {
  double const relative = error / mean;
  return mean > 0 && error > 0 && seconds > 0 ? 1 / (relative * relative * seconds) : not_a_number;
}
double merit(Estimate const& e, double seconds) {
  return e.trusted ? merit(e.mean, e.std_error, seconds) : not_a_number;
}

// Of the resolved routes of a port together.
Merit of_port(CouplingTable const& table, std::uint32_t port, double seconds) {
  ReplicaSum all;
  for (CouplingClass const& c : table.classes)
    if (c.port.value == port && c.coupling.trusted)
      all.add({{c.coupling.mean, c.coupling.std_error}, pattern_of(table, c)});
  return {"port " + table.ports[port], merit(all.result().value, all.result().sigma, seconds)};
}

template <class Name>
void add_routes(std::vector<Merit>& all, CouplingTable const& table, std::vector<CouplingClass> const& classes,
                Name const& name, double seconds) {
  std::vector<CouplingClass const*> sorted;
  for (CouplingClass const& c : classes) sorted.push_back(&c);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](auto const* a, auto const* b) { return a->coupling.mean > b->coupling.mean; });
  for (CouplingClass const* c : sorted) all.push_back({name(table, *c), merit(c->coupling, seconds)});
}

bool is_end(Merit const& m) {
  return std::any_of(std::begin(ends), std::end(ends), [&](char const* end) { return m.what.starts_with(end); });
}

}  // namespace

std::vector<Merit> merits(RunContent const& run) {
  CouplingTable const& table = run.trace->coupling;
  double const seconds = run.trace->seconds;
  std::vector<Merit> all;
  for (std::uint32_t i = 0; i < table.ports.size(); ++i) all.push_back(of_port(table, i, seconds));
  for (std::size_t i = 0; i < table.receivers.size(); ++i)
    all.push_back({"receiver " + table.receivers[i], merit(table.received_power[i], seconds)});
  add_routes(all, table, table.classes, route_name, seconds);
  add_routes(all, table, table.received, received_name, seconds);
  return all;
}

std::string merit_text(std::vector<Merit> const& all, std::size_t routes) {
  std::string text;
  for (Merit const& m : all) {
    bool const route = !is_end(m);
    if (std::isnan(m.value) || (route && routes == 0)) continue;
    routes -= route;
    text += fmt::format("figure of merit  {:8.2g} /s  {}\n", m.value, m.what);
  }
  return text;
}

}  // namespace straytrace
