// SPDX-License-Identifier: BSD-3-Clause
// Which source lights which receiver: the resolved routes, summed by the object they start from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "results/receivers/receivers.hpp"
#include "results/text/columns.hpp"

namespace straytrace {
namespace {

struct SourceRow {
  std::string source;
  std::vector<WithError> power;  // by receiver; 0 without an error: nothing resolved
  double all() const {
    double sum = 0;
    for (WithError const& p : power) sum += p.value;
    return sum;
  }
};

std::vector<SourceRow> rows_of(ReceiverTable const& table) {
  std::map<std::string, SourceRow> found;
  for (std::size_t i = 0; i < table.receivers.size(); ++i)
    for (ReceivedRoute const& route : table.receivers[i].routes) {
      if (route.objects.empty() || !route.power.trusted) continue;
      SourceRow& row = found[route.objects.front()];
      row.source = route.objects.front();
      row.power.resize(table.receivers.size());
      row.power[i].value += route.power.mean;
      row.power[i].sigma = std::hypot(row.power[i].sigma, route.power.std_error);
    }
  std::vector<SourceRow> rows;
  for (auto& [name, row] : found) rows.push_back(std::move(row));
  std::stable_sort(rows.begin(), rows.end(), [](SourceRow const& a, SourceRow const& b) { return a.all() > b.all(); });
  return rows;
}

}  // namespace

std::string source_text(ReceiverTable const& table) {
  Columns c;
  c.titles = {"source"};
  for (ReceiverEntry const& r : table.receivers) c.titles.push_back(r.name);
  c.left = {true};
  for (SourceRow const& row : rows_of(table)) {
    std::vector<std::string> cells = {row.source};
    for (WithError const& p : row.power) cells.push_back(p.value > 0 ? with_brackets(p.value, p.sigma) : "-");
    c.rows.push_back(std::move(cells));
  }
  std::vector<std::string> hints = {"not resolved"};
  for (ReceiverEntry const& r : table.receivers) {
    double hint = 0;
    for (ReceivedRoute const& route : r.routes)
      if (!route.power.trusted || route.objects.empty()) hint += route.power.mean;
    hints.push_back(hint > 0 ? fmt::format("about {:.1g}", hint) : "-");
  }
  c.rows.push_back(std::move(hints));
  return "Power on each receiver (columns) by the object it starts from, over that of the main mode; (n): one "
         "standard\n"
         "error, last digits. Resolved routes; errors of routes added in quadrature.\n\n" +
         aligned(c);
}

std::string source_csv(ReceiverTable const& table) {
  std::string text = "source,receiver,power,power_sigma\n";
  for (SourceRow const& row : rows_of(table))
    for (std::size_t i = 0; i < row.power.size(); ++i)
      if (row.power[i].value > 0)
        text +=
            fmt::format("{},{},{},{}\n", row.source, table.receivers[i].name, row.power[i].value, row.power[i].sigma);
  return text;
}

}  // namespace straytrace
