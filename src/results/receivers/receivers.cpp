// SPDX-License-Identifier: BSD-3-Clause
// The numbers behind the tables and maps of receivers.
#include "results/receivers/receivers.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/json_text.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {
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
  auto const& histories = table.replica_histories;  // without all of them, correlations of routes are unknown
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
  constexpr double faintest = 1e-290;  // of squares: below, contributions of single blocks lose precision or underflow
  constexpr double rounding = 1e-13;   // relative, of sums of squares
  CellEstimates cells;
  double const n = double(histories), b = double(blocks);
  for (std::size_t i = 0; i < map.sum.size(); ++i) {
    bool const seen = map.sum[i] > 0;
    double const between = map.sum2[i] - map.sum[i] * map.sum[i] / b;
    bool const known = seen && blocks > 1 && map.sum2[i] > faintest;
    // Blocks to which strata deal the same light: the error is at most one history, whose light is at most that of a
    // block.
    bool const equal = between <= rounding * map.sum2[i];
    cells.mean.push_back(seen ? map.sum[i] / n : not_a_number);
    cells.error.push_back(!known ? not_a_number : equal ? map.sum[i] / (n * b) : std::sqrt(between * b / (b - 1)) / n);
  }
  return cells;
}

FieldMap field_map(Receiver const& r, ReceiverSums const& sums, std::uint64_t histories,
                   std::vector<double> const& areas) {
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
      map.field[i] += std::sqrt(f.power[i] / (n * areas.at(i))) * (mean / in_phase);
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

// The columns of receivers and their routes, and of the objects met by the light.

namespace {

using Json = nlohmann::ordered_json;

// All light of a receiver, or one of its routes.
struct ReceivedRow {
  ReceiverTable const& table;
  ReceiverEntry const& receiver;
  ReceivedRoute const* route = nullptr;

  Estimate const& power() const { return route ? route->power : receiver.power; }
  // Of the light of the receiver; NaN where it is not resolved.
  WithError share() const {
    if (!power().trusted || !(receiver.power.mean > 0)) return {not_a_number, not_a_number};
    return route ? route->share : WithError{1, 0};
  }
};
using ReceivedList = std::vector<TableColumn<ReceivedRow>>;

WithError scaled(WithError p, double factor) { return {p.value * factor, p.sigma * factor}; }

WithError known_power(Estimate const& e) {
  return e.trusted ? WithError{e.mean, e.std_error} : WithError{not_a_number, not_a_number};
}

// Numbers that are not known are null, not NaN, which JSON does not have.
Json json_number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json folded_routes(std::vector<FoldedRow> const& folded) {
  if (folded.empty()) return Json(Json::value_t::discarded);
  Json all = Json::array();
  for (FoldedRow const& f : folded)
    all.push_back({{"id", hash_text(f.hash)},
                   {"sequence", f.sequence},
                   {"power_hint", f.coupling.value},
                   {"resolved", f.trusted},
                   {"why", f.why}});
  return all;
}

std::string share_text(ReceivedRow const& r) {
  return r.power().trusted && r.route ? percent_text(r.route->share) : "-";
}

// On pages: why it is not known.
Json power_on_page(ReceivedRow const& r, double factor) {
  return r.power().trusted ? error_json(scaled(known_power(r.power()), factor))
                           : Json("unresolved: " + r.power().why_not);
}

char const* unit_on_pages(double beam_power) { return beam_power > 0 ? "W" : "W per W of the main mode"; }

std::string status_text(Estimate const& e) {
  return e.trusted ? "resolved" : fmt::format("unresolved: {} (hint: about {:.1g})", e.why_not, e.mean);
}

// clang-format off

void add_power_columns(ReceivedList& all, double beam_power) {
  all.push_back({.key = "power", .kind = ColumnKind::estimate, .unit = "1", .help = "over that of the main mode",
    .value = [](ReceivedRow const& r) { return known_power(r.power()); },
    .text = {50, "power/(W/W)"}, .csv = {50}, .json = {40}});
  all.push_back({.key = "light", .kind = ColumnKind::estimate, .help = "power, or why it is not known",
    .page = {50, fmt::format("power [{}]", unit_on_pages(beam_power))},
    .as_page = [](ReceivedRow const& r) {
      return power_on_page(r, r.table.beam_power > 0 ? r.table.beam_power : 1); }});
  all.push_back({.key = "watts", .kind = ColumnKind::estimate, .unit = "W", .help = "power",
    .value = [](ReceivedRow const& r) { return scaled(known_power(r.power()), r.table.beam_power); },
    .text = {beam_power > 0 ? 60 : 0, "power/W"}});
  all.push_back({.key = "hint", .unit = "1", .help = "the power, also where it is not reliable",
    .value = [](ReceivedRow const& r) { return r.power().mean; },
    .csv = {60, "power_hint"}, .json = {40, "power/hint"}});
  all.push_back({.key = "resolved", .kind = ColumnKind::flag, .help = "whether the power is reliable",
    .value = [](ReceivedRow const& r) { return r.power().trusted; }, .json = {40, "power/resolved"}});
  all.push_back({.key = "why_not", .kind = ColumnKind::text, .help = "why it is not resolved",
    .value = [](ReceivedRow const& r) { return r.power().why_not; }, .json = {40, "power/why_not"}});
}

// `totals`: text and JSON have the light of whole receivers, otherwise that of routes; CSV has both.
ReceivedList received_columns(double beam_power, bool totals) {
  ReceivedList all;
  int const of_totals = totals, of_routes = !totals;
  all.push_back({.key = "receiver", .kind = ColumnKind::text, .help = "name of the receiver",
    .value = [](ReceivedRow const& r) { return r.receiver.name; },
    .text = {10 * of_totals}, .csv = {10}, .json = {10 * of_totals, "name"}, .left = true});
  all.push_back({.key = "rank", .kind = ColumnKind::count, .help = "of a route by power; 0: all light of the receiver",
    .value = [](ReceivedRow const& r) { return std::uint64_t{r.route ? r.route->rank : 0}; },
    .text = {20 * of_routes, "#"}, .csv = {20}, .json = {10 * of_routes}, .page = {20}});
  all.push_back({.key = "id", .kind = ColumnKind::text, .help = "identifier of the route, the same in all runs of one model",
    .value = [](ReceivedRow const& r) { return r.route ? hash_text(r.route->hash) : ""; },
    .csv = {30}, .json = {20 * of_routes}});
  all.push_back({.key = "sequence", .kind = ColumnKind::text, .help = "the route",
    .value = [](ReceivedRow const& r) { return r.route ? r.route->sequence : "all"; },
    .text = {40 * of_routes, "route"}, .csv = {40}, .json = {30 * of_routes}, .page = {40, "route"}, .left = true});
  add_power_columns(all, beam_power);
  all.push_back({.key = "histories", .kind = ColumnKind::count, .help = "that have scored",
    .value = [](ReceivedRow const& r) { return r.power().scored; },
    .text = {70 * of_totals}, .csv = {90, "histories_scored"}, .json = {40, "power/histories_scored"}});
  all.push_back({.key = "share", .unit = "1", .help = "of the light of the receiver",
    .value = [](ReceivedRow const& r) { return r.share().value; },
    .text = {80 * of_routes, "share/%"}, .csv = {70, "share_percent", 100}, .json = {50 * of_routes},
    .page = {80, "share [%]"}, .as_text = share_text,
    .as_json = [](ReceivedRow const& r) { return json_number(r.share().value); },
    .as_page = [](ReceivedRow const& r) {
      return r.power().trusted && r.route ? error_json(scaled(r.route->share, 100)) : Json(nullptr); }});
  all.push_back({.key = "share_sigma", .unit = "1", .help = "one standard error", .json = {60 * of_routes},
    .as_json = [](ReceivedRow const& r) { return json_number(r.share().sigma); }});
  all.push_back({.key = "status", .kind = ColumnKind::text, .help = "resolved, or why not",
    .value = [](ReceivedRow const& r) { return r.power().trusted ? "resolved" : "unresolved: " + r.power().why_not; },
    .text = {90}, .csv = {80}, .left = true,
    .as_text = [](ReceivedRow const& r) { return status_text(r.power()); }});
  all.push_back({.key = "objects", .kind = ColumnKind::list, .help = "on the route", .json = {70 * of_routes},
    .as_json = [](ReceivedRow const& r) { return Json(r.route->objects); }});
  all.push_back({.key = "folded_routes", .kind = ColumnKind::count, .help = "number of routes in a row that sums several",
    .json = {80 * of_routes}, .as_json = [](ReceivedRow const& r) {
      return r.route->folded_routes > 0 ? Json(r.route->folded_routes) : Json(Json::value_t::discarded); }});
  all.push_back({.key = "folded", .kind = ColumnKind::list, .help = "the largest of these routes",
    .json = {90 * of_routes}, .as_json = [](ReceivedRow const& r) { return folded_routes(r.route->folded); }});
  return all;
}

// clang-format on

struct MetRow {
  ReceiverTable const& table;
  ReceiverEntry const& receiver;
  CensusRow const& row;

  bool known() const { return receiver.power.trusted && std::isfinite(row.power.sigma); }
  WithError power() const { return known() ? row.power : WithError{not_a_number, not_a_number}; }
};

std::string object_share(MetRow const& r) {
  double const scale = 100 / r.receiver.power.mean;
  return r.known() ? with_brackets(scale * r.row.power.value, scale * r.row.power.sigma) : "-";
}

std::string object_routes(MetRow const& r) {
  std::string text;
  for (std::size_t const rank : r.row.routes) text += fmt::format("{}{}", text.empty() ? "" : " ", rank);
  return text;
}

Json object_power(MetRow const& r) {
  return {{"value", r.receiver.power.trusted ? Json(r.row.power.value) : Json(nullptr)},
          {"sigma", json_number(r.row.power.sigma)},
          {"hint", r.row.power.value}};
}

// clang-format off

std::vector<TableColumn<MetRow>> object_columns(double beam_power) {
  std::vector<TableColumn<MetRow>> all;
  all.push_back({.key = "receiver", .kind = ColumnKind::text, .help = "name of the receiver",
    .value = [](MetRow const& r) { return r.receiver.name; }, .csv = {10}});
  all.push_back({.key = "object", .kind = ColumnKind::text, .help = "that the light has met",
    .value = [](MetRow const& r) { return r.row.object.empty() ? "(routes not named)" : r.row.object; },
    .text = {10}, .csv = {20}, .json = {10}, .left = true,
    .as_json = [](MetRow const& r) { return Json(r.row.object); }});
  all.push_back({.key = "power", .kind = ColumnKind::estimate, .unit = "1", .help = "over that of the main mode",
    .value = [](MetRow const& r) { return r.power(); },
    .text = {20, "power/(W/W)"}, .csv = {30}, .json = {20}, .as_json = object_power});
  all.push_back({.key = "watts", .kind = ColumnKind::estimate, .unit = "W", .help = "power",
    .value = [](MetRow const& r) { return scaled(r.power(), r.table.beam_power); },
    .text = {beam_power > 0 ? 30 : 0, "power/W"}});
  all.push_back({.key = "share_percent", .unit = "%", .help = "of the light of the receiver",
    .value = [](MetRow const& r) { return 100 * r.power().value / r.receiver.power.mean; },
    .text = {40, "share/%"}, .csv = {40}, .as_text = object_share});
  all.push_back({.key = "routes", .kind = ColumnKind::text, .help = "ranks of its routes", .value = object_routes,
    .text = {50, "by path"}, .csv = {50}, .json = {30}, .left = true,
    .as_text = [](MetRow const& r) { return first_ranks(r.row.routes); },
    .as_json = [](MetRow const& r) { return Json(r.row.routes); }});
  return all;
}

// clang-format on

// Receivers as text: their light, its routes, and the objects that it met.

// Relative power, and in watts where the power of the beam is known.
void add_power(std::vector<std::string>& row, WithError p, bool resolved, double beam_power) {
  row.push_back(resolved ? with_brackets(p.value, p.sigma) : "unresolved");
  if (beam_power > 0)
    row.push_back(resolved ? with_brackets(p.value * beam_power, p.sigma * beam_power) : "unresolved");
}
void add_power_titles(Columns& c, double beam_power) {
  c.titles.push_back("power/(W/W)");
  if (beam_power > 0) c.titles.push_back("power/W");
}

std::string totals(ReceiverTable const& table) {
  TableWriter<ReceivedRow> const list(received_columns(table.beam_power, true));
  Columns c = list.text_head();
  for (ReceiverEntry const& r : table.receivers) c.rows.push_back(list.text_row({table, r}));
  return aligned(c);
}

std::string quadrants(ReceiverEntry const& r, double beam_power) {
  if (r.quadrants.mean.empty()) return "";
  Columns c;
  c.titles = {"quadrant"};
  add_power_titles(c, beam_power);
  c.left = {true};
  char const* const names[] = {"lower left", "lower right", "upper left", "upper right", "gap"};
  for (std::size_t i = 0; i < r.quadrants.mean.size(); ++i) {
    WithError const p{r.quadrants.mean[i], r.quadrants.error[i]};
    std::vector<std::string> row = {names[i]};
    if (std::isnan(p.value))
      row.insert(row.end(), c.titles.size() - 1, "no light seen");
    else
      add_power(row, p, r.power.trusted && std::isfinite(p.sigma), beam_power);
    c.rows.push_back(std::move(row));
  }
  return "\n" + aligned(c);
}

std::string routes(ReceiverTable const& table, ReceiverEntry const& r, std::size_t show) {
  if (r.routes.empty()) return "No light has arrived.\n";
  TableWriter<ReceivedRow> const list(received_columns(table.beam_power, false));
  Columns c = list.text_head();
  for (std::size_t i = 0; i < std::min(show, r.routes.size()); ++i)
    c.rows.push_back(list.text_row({table, r, &r.routes[i]}));
  std::string text = aligned(c);
  if (show < r.routes.size()) text += fmt::format("and {} more\n", r.routes.size() - show);
  std::string folded;
  for (ReceivedRoute const& route : r.routes) folded += folded_text(route.sequence, route.folded_routes, route.folded);
  return folded.empty() ? text : text + "\n" + folded;
}

std::string units_text(ReceiverTable const& table) {
  return table.beam_power > 0 ? fmt::format("Power over that of the main mode, {:g} W", table.beam_power)
                              : "Power over that of the main mode; no beam states its 'power', so there are no watts";
}

std::string census(ReceiverTable const& table, ReceiverEntry const& r, std::size_t show) {
  if (r.census.empty()) return "No light has arrived.\n";
  TableWriter<MetRow> const list(object_columns(table.beam_power));
  Columns c = list.text_head();
  for (std::size_t i = 0; i < std::min(show, r.census.size()); ++i)
    c.rows.push_back(list.text_row({table, r, r.census[i]}));
  return aligned(c);
}

std::string headline(ReceiverEntry const& r) {
  return fmt::format("\n{}\n{}\n\n", r.name, std::string(r.name.size(), '-'));
}

}  // namespace

std::string receiver_text(ReceiverTable const& table, std::size_t show) {
  if (table.receivers.empty()) return "The scene has no receivers.\n";
  std::string text = "Light on receivers. " + units_text(table) + ".\n(n): one standard error, last digits.\n\n";
  text += totals(table);
  for (ReceiverEntry const& r : table.receivers)
    text += headline(r) + routes(table, r, show) + quadrants(r, table.beam_power);
  return text;
}

std::string census_text(ReceiverTable const& table, std::size_t show) {
  if (table.receivers.empty()) return "The scene has no receivers.\n";
  std::string text = "Objects met by the arriving light. " + units_text(table) +
                     ".\nA path counts once for every object it touches, so shares add up to more than 100 %.\n";
  for (ReceiverEntry const& r : table.receivers)
    text += headline(r) + census(table, r, show) + "\n" + routes(table, r, show);
  return text;
}

// Receivers for other programs: CSV and JSON.

namespace {

std::string units(ReceiverTable const& table) {
  std::string const watts = table.beam_power > 0 ? fmt::format("# main mode: {} W\n", table.beam_power)
                                                 : std::string("# power of the main mode: not stated\n");
  return watts + "# power: over that of the main mode; sigma: one standard error; nan: not resolved, see status\n";
}

Json json_of(ReceiverTable const& table, ReceiverEntry const& r) {
  TableWriter<ReceivedRow> const totals(received_columns(table.beam_power, true)),
      routes(received_columns(table.beam_power, false));
  TableWriter<MetRow> const objects(object_columns(table.beam_power));
  Json j = totals.json_row({table, r});
  j["quadrants"] = Json::array();
  for (std::size_t i = 0; i < r.quadrants.mean.size(); ++i) {
    bool const known = r.power.trusted;
    j["quadrants"].push_back({{"value", json_number(known ? r.quadrants.mean[i] : not_a_number)},
                              {"sigma", json_number(known ? r.quadrants.error[i] : not_a_number)}});
  }
  j["routes"] = Json::array();
  for (ReceivedRoute const& route : r.routes) j["routes"].push_back(routes.json_row({table, r, &route}));
  j["census"] = Json::array();
  for (CensusRow const& row : r.census) j["census"].push_back(objects.json_row({table, r, row}));
  return j;
}

}  // namespace

std::string receiver_csv(ReceiverTable const& table, RunContent const& run) {
  TableWriter<ReceivedRow> const list(received_columns(table.beam_power, true));
  std::string text = file_header(run) + "# one row per receiver (rank 0: all its light) and per route\n" +
                     units(table) + list.csv_head();
  for (ReceiverEntry const& r : table.receivers) {
    text += list.csv_row({table, r});
    for (ReceivedRoute const& route : r.routes) text += list.csv_row({table, r, &route});
  }
  return text;
}

std::string census_csv(ReceiverTable const& table, RunContent const& run) {
  TableWriter<MetRow> const list(object_columns(table.beam_power));
  std::string text = file_header(run) +
                     "# the objects that the light of each receiver has met; routes: ranks in its table\n" +
                     units(table) + list.csv_head();
  for (ReceiverEntry const& r : table.receivers)
    for (CensusRow const& object : r.census) text += list.csv_row({table, r, object});
  return text;
}

std::string receiver_json(ReceiverTable const& table, RunContent const& run) {
  Json j;
  j["model_hash"] = run.model_hash;
  j["seed"] = run.trace->coupling.seed;
  j["histories"] = run.trace->coupling.histories;
  j["beam_power_W"] = table.beam_power > 0 ? Json(table.beam_power) : Json(nullptr);
  j["receivers"] = Json::array();
  for (ReceiverEntry const& r : table.receivers) j["receivers"].push_back(json_of(table, r));
  return json_text(j, 2) + "\n";
}

Json receiver_page_list(ReceiverTable const& table) {
  constexpr std::size_t most_routes = 12;
  TableWriter<ReceivedRow> const list(received_columns(table.beam_power, false));
  Json all = Json::array();
  for (ReceiverEntry const& r : table.receivers) {
    std::vector<ReceivedRow> rows;
    for (std::size_t i = 0; i < std::min(most_routes, r.routes.size()); ++i) rows.push_back({table, r, &r.routes[i]});
    all.push_back({{"name", r.name},
                   {"light", power_on_page({table, r}, table.beam_power > 0 ? table.beam_power : 1)},
                   {"unit", unit_on_pages(table.beam_power)},
                   {"table", list.page_table(rows)}});
  }
  return all;
}

// Sources by receiver: the resolved routes, summed by the object where they start.

namespace {

struct LightSource {
  std::string source;
  std::vector<WithError> power;  // by receiver; 0 without an error: nothing resolved
  double all() const {
    double sum = 0;
    for (WithError const& p : power) sum += p.value;
    return sum;
  }
};

std::vector<LightSource> rows_of(ReceiverTable const& table) {
  std::map<std::string, LightSource> found;
  for (std::size_t i = 0; i < table.receivers.size(); ++i)
    for (ReceivedRoute const& route : table.receivers[i].routes) {
      if (route.objects.empty() || !route.power.trusted) continue;
      LightSource& row = found[route.objects.front()];
      row.source = route.objects.front();
      row.power.resize(table.receivers.size());
      row.power[i].value += route.power.mean;
      row.power[i].sigma = std::hypot(row.power[i].sigma, route.power.std_error);
    }
  std::vector<LightSource> rows;
  for (auto& [name, row] : found) rows.push_back(std::move(row));
  std::stable_sort(rows.begin(), rows.end(),
                   [](LightSource const& a, LightSource const& b) { return a.all() > b.all(); });
  return rows;
}

}  // namespace

std::string source_text(ReceiverTable const& table) {
  Columns c;
  c.titles = {"source"};
  for (ReceiverEntry const& r : table.receivers) c.titles.push_back(r.name);
  c.left = {true};
  for (LightSource const& row : rows_of(table)) {
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
  return "Power on each receiver (columns) by the object where it starts, over that of the main mode; (n): one "
         "standard\n"
         "error, last digits. Resolved routes; errors of routes added in quadrature.\n\n" +
         aligned(c);
}

std::string source_csv(ReceiverTable const& table) {
  std::string text = "source,receiver,power,power_sigma\n";
  for (LightSource const& row : rows_of(table))
    for (std::size_t i = 0; i < row.power.size(); ++i)
      if (row.power[i].value > 0)
        text +=
            fmt::format("{},{},{},{}\n", row.source, table.receivers[i].name, row.power[i].value, row.power[i].sigma);
  return text;
}

}  // namespace straytrace::results
