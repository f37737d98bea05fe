// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/deterministic_classes.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "trace/step/path.hpp"
#include "trace/tally/reverse.hpp"

namespace straytrace {

CouplingClass deterministic_class(ClassKind kind, std::vector<PathStep> steps, PortId port, double reverse,
                                  std::vector<PathRecord> records, std::string statement) {
  CouplingClass c;
  c.kind = kind;
  c.hash = mixed(hash_of_route(steps, 0, port.value) + std::uint64_t(kind));
  c.port = port;
  c.steps = std::move(steps);
  c.reverse = reverse;
  c.records = std::move(records);
  c.statement = std::move(statement);
  for (PathRecord const& r : c.records) c.coupling.mean += r.weight;
  if (!std::isfinite(c.coupling.mean)) throw NumericalError("the coupling of a deterministic route is not finite");
  c.coupling.trusted = true;
  return c;
}

void add_beside(CouplingTable& table, std::vector<CouplingClass> const& classes) {
  if (classes.empty()) return;
  table.classes.insert(table.classes.end(), classes.begin(), classes.end());
  std::sort(table.classes.begin(), table.classes.end(), [](auto const& a, auto const& b) { return a.hash < b.hash; });
  auto const twice = std::adjacent_find(table.classes.begin(), table.classes.end(),
                                        [](auto const& a, auto const& b) { return a.hash == b.hash; });
  if (twice != table.classes.end()) throw NumericalError("two routes have one hash: " + route_name(table, *twice));
}

}  // namespace straytrace
