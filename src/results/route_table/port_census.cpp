// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/port_census.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/words.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {
namespace {

using Json = nlohmann::ordered_json;

// Sums over routes: noise power in the band, PSD at each frequency, coupling.
struct Sums {
  ReplicaSum power, coupling;
  std::vector<ReplicaSum> psd;
  std::vector<std::size_t> routes;
  bool at_most = false;

  void add(PathRow const& row) {
    power.add({row.power, row.replicas});
    coupling.add({row.coupling_with_error(), row.replicas});
    psd.resize(row.strain.size());
    for (std::size_t k = 0; k < psd.size(); ++k) {
      WithError const& h = row.strain[k];
      if (h.value > 0) psd[k].add({{h.value * h.value, 2 * h.value * h.sigma}, row.replicas});
    }
    routes.push_back(row.rank);
    at_most = at_most || row.upper_bound();
  }
};

WithError root(WithError square) {
  double const h = std::sqrt(square.value);
  return h > 0 ? WithError{h, square.sigma / (2 * h)} : WithError{not_a_number, not_a_number};
}

struct ObjectLine {
  PathTable const& table;
  MetObject const& met;
};

Json strain_of(ObjectLine const& r) {
  Json all = Json::array();
  for (std::size_t k = 0; k < r.met.strain.size(); ++k) {
    Json h = error_json(r.met.strain[k]);
    h["frequency_Hz"] = r.table.frequencies[k];
    all.push_back(h);
  }
  return all;
}

// clang-format off

std::vector<TableColumn<ObjectLine>> columns_of(PathTable const& table) {
  std::vector<TableColumn<ObjectLine>> all;
  all.push_back({.key = "object", .kind = ColumnKind::text, .help = "that the light has met",
    .value = [](ObjectLine const& r) { return r.met.object.empty() ? "(routes not named)" : r.met.object; },
    .text = {10}, .csv = {10}, .json = {10}, .left = true,
    .as_json = [](ObjectLine const& r) { return Json(r.met.object); }});
  all.push_back({.key = "share", .kind = ColumnKind::estimate, .unit = "1",
    .help = "of the resolved strain noise power in the band", .value = [](ObjectLine const& r) { return r.met.share; },
    .text = {table.has_noise ? 20 : 0, "share/%"}, .csv = {20, "share_percent", 100}, .json = {20},
    .as_text = [](ObjectLine const& r) { return percent_text(r.met.share); }});
  for (std::size_t k = 0; table.has_noise && k < table.frequencies.size(); ++k)
    all.push_back({.key = strain_key(table.frequencies[k]), .kind = ColumnKind::estimate, .unit = "1/√Hz",
      .help = "one-sided strain ASD, mean over random static phases",
      .value = [k](ObjectLine const& r) { return r.met.strain[k]; },
      .text = {30, fmt::format("h({:g} Hz)", table.frequencies[k])},
      .csv = {30, fmt::format("h_{:g}Hz", table.frequencies[k])}});
  all.push_back({.key = "strain", .kind = ColumnKind::list, .help = "one-sided strain ASD at each frequency",
    .json = {table.has_noise ? 30 : 0}, .as_json = strain_of});
  all.push_back({.key = "coupling", .kind = ColumnKind::estimate, .unit = "1", .help = "recoupled power fraction",
    .value = [](ObjectLine const& r) { return r.met.coupling; }, .text = {40}, .csv = {40}, .json = {40}});
  all.push_back({.key = "routes", .kind = ColumnKind::text, .help = "ranks of its routes",
    .value = [](ObjectLine const& r) { return fmt::format("{}", fmt::join(r.met.routes, " ")); },
    .text = {50, "by path"}, .csv = {50}, .json = {50}, .left = true,
    .as_text = [](ObjectLine const& r) { return first_ranks(r.met.routes); },
    .as_json = [](ObjectLine const& r) { return Json(r.met.routes); }});
  return all;
}

// clang-format on

// What the numbers leave out.
std::string limits(PathTable const& table) {
  return table.unresolved == 0 ? ""
                               : fmt::format("{} {} not in it.\n", counted(table.unresolved, "unresolved route"),
                                             table.unresolved == 1 ? "is" : "are");
}

}  // namespace

std::vector<MetObject> objects_by_noise(PathTable const& table) {
  std::map<std::string, Sums> objects;
  Sums all;
  for (PathRow const& row : table.rows) {
    if (!row.resolved) continue;
    all.add(row);
    std::vector<std::string> names = objects_met(row);
    if (names.empty()) names = {""};
    for (std::string const& name : names) objects[name].add(row);
  }
  std::vector<MetObject> met;
  for (auto const& [name, sums] : objects) {
    MetObject o{name, {not_a_number, not_a_number}, {}, sums.coupling.result(), sums.routes};
    o.coupling.at_most = sums.at_most;
    if (table.has_noise) o.share = sums.power.share_of(all.power);
    for (ReplicaSum const& psd : sums.psd) {
      o.strain.push_back(root(psd.result()));
      o.strain.back().at_most = sums.at_most;
    }
    met.push_back(std::move(o));
  }
  std::ranges::sort(met, [&](MetObject const& a, MetObject const& b) {
    if (a.object.empty() != b.object.empty()) return b.object.empty();
    double const one = table.has_noise ? a.share.value : a.coupling.value,
                 two = table.has_noise ? b.share.value : b.coupling.value;
    return one != two ? one > two : a.object < b.object;
  });
  return met;
}

std::string port_census_text(PathTable const& table, std::size_t show) {
  std::string text = "Objects met by the light that rejoins the mode, by the ";
  text += table.has_noise ? fmt::format("strain noise power of their routes, {:g} to {:g} Hz.\n", table.low, table.high)
                          : std::string("coupling of their routes.\n");
  text += "A route counts once for every object that it meets, so shares add up to more than 100 %. " + limits(table) +
          "(n): one standard error, last digits.\n\n";
  TableWriter<ObjectLine> const list(columns_of(table));
  Columns c = list.text_head();
  std::vector<MetObject> const all = objects_by_noise(table);
  for (std::size_t i = 0; i < std::min(show, all.size()); ++i) c.rows.push_back(list.text_row({table, all[i]}));
  text += aligned(c);
  return show < all.size() ? text + fmt::format("and {} more\n", all.size() - show) : text;
}

std::string port_census_csv(PathTable const& table, RunContent const& run) {
  TableWriter<ObjectLine> const list(columns_of(table));
  std::string text =
      file_header(run) +
      "# one row per object met by the light that rejoins the mode, over all routes that meet it; routes: "
      "ranks in the path table\n" +
      fmt::format("# share_percent: of the resolved strain noise power between {} and {} Hz\n", table.low, table.high);
  if (table.unresolved > 0) text += "# " + limits(table);
  text += list.csv_head();
  for (MetObject const& o : objects_by_noise(table)) text += list.csv_row({table, o});
  return text;
}

std::string port_census_json(PathTable const& table, RunContent const& run) {
  TableWriter<ObjectLine> const list(columns_of(table));
  Json j{{"model_hash", run.model_hash},
         {"seed", run.trace->coupling.seed},
         {"histories", run.trace->coupling.histories},
         {"band_Hz", {table.low, table.high}},
         {"unresolved_routes", table.unresolved},
         {"objects", Json::array()}};
  for (MetObject const& o : objects_by_noise(table)) j["objects"].push_back(list.json_row({table, o}));
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace straytrace::results
