// SPDX-License-Identifier: BSD-3-Clause
// The numbers behind the tables and maps of receivers.
#include "results/receivers/receivers.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "results/route_table/route_sums.hpp"
#include "results/text/columns.hpp"

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

// Receivers for people: what they get, by which routes, and what the light has met.

namespace {

using Cells = std::vector<std::string>;

std::string status_text(Estimate const& e) {
  return e.trusted ? "resolved" : fmt::format("unresolved: {} (hint: about {:.1g})", e.why_not, e.mean);
}

// Relative power, and in watts where the power of the beam is known.
void add_power(Cells& row, WithError p, bool resolved, double beam_power) {
  row.push_back(resolved ? with_brackets(p.value, p.sigma) : "unresolved");
  if (beam_power > 0)
    row.push_back(resolved ? with_brackets(p.value * beam_power, p.sigma * beam_power) : "unresolved");
}
void add_power_titles(Columns& c, double beam_power) {
  c.titles.push_back("power/(W/W)");
  if (beam_power > 0) c.titles.push_back("power/W");
}

std::string totals(ReceiverTable const& table) {
  Columns c;
  c.titles = {"receiver"};
  add_power_titles(c, table.beam_power);
  c.titles.insert(c.titles.end(), {"histories", "status"});
  c.left.assign(c.titles.size(), false);
  c.left.front() = c.left.back() = true;
  for (ReceiverEntry const& r : table.receivers) {
    Cells row = {r.name};
    add_power(row, {r.power.mean, r.power.std_error}, r.power.trusted, table.beam_power);
    row.push_back(fmt::format("{}", r.power.scored));
    row.push_back(status_text(r.power));
    c.rows.push_back(std::move(row));
  }
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
    Cells row = {names[i]};
    if (std::isnan(p.value))
      row.insert(row.end(), c.titles.size() - 1, "no light seen");
    else
      add_power(row, p, std::isfinite(p.sigma), beam_power);
    c.rows.push_back(std::move(row));
  }
  return "\n" + aligned(c);
}

std::string routes(ReceiverEntry const& r, double beam_power, std::size_t show) {
  if (r.routes.empty()) return "No light has arrived.\n";
  Columns c;
  c.titles = {"#", "route"};
  add_power_titles(c, beam_power);
  c.titles.insert(c.titles.end(), {"share/%", "status"});
  c.left.assign(c.titles.size(), false);
  c.left[1] = c.left.back() = true;
  for (std::size_t i = 0; i < std::min(show, r.routes.size()); ++i) {
    ReceivedRoute const& route = r.routes[i];
    bool const resolved = route.power.trusted;
    Cells row = {fmt::format("{}", route.rank), route.sequence};
    add_power(row, {route.power.mean, route.power.std_error}, resolved, beam_power);
    row.push_back(resolved ? percent_text(route.share.value, route.share.sigma) : "-");
    row.push_back(status_text(route.power));
    c.rows.push_back(std::move(row));
  }
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

std::string census(ReceiverEntry const& r, double beam_power, std::size_t show) {
  if (r.census.empty()) return "No light has arrived.\n";
  Columns c;
  c.titles = {"object"};
  add_power_titles(c, beam_power);
  c.titles.insert(c.titles.end(), {"share/%", "by path"});
  c.left.assign(c.titles.size(), false);
  c.left.front() = c.left.back() = true;
  for (std::size_t i = 0; i < std::min(show, r.census.size()); ++i) {
    CensusRow const& object = r.census[i];
    bool const resolved = std::isfinite(object.power.sigma) && r.power.trusted;
    Cells row = {object.object.empty() ? "(routes not named)" : object.object};
    add_power(row, object.power, resolved, beam_power);
    double const scale = 100 / r.power.mean;
    row.push_back(resolved ? with_brackets(scale * object.power.value, scale * object.power.sigma) : "-");
    std::string paths;
    for (std::size_t k = 0; k < std::min<std::size_t>(object.routes.size(), 8); ++k)
      paths += fmt::format("{}#{}", k > 0 ? " " : "", object.routes[k]);
    if (object.routes.size() > 8) paths += fmt::format(" and {} more", object.routes.size() - 8);
    row.push_back(paths);
    c.rows.push_back(std::move(row));
  }
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
    text += headline(r) + routes(r, table.beam_power, show) + quadrants(r, table.beam_power);
  return text;
}

std::string census_text(ReceiverTable const& table, std::size_t show) {
  if (table.receivers.empty()) return "The scene has no receivers.\n";
  std::string text = "What the light that arrives has met. " + units_text(table) +
                     ".\nA path counts once for every object it touches, so shares add up to more than 100 %.\n";
  for (ReceiverEntry const& r : table.receivers)
    text += headline(r) + census(r, table.beam_power, show) + "\n" + routes(r, table.beam_power, show);
  return text;
}

// Receivers for other programs: CSV and JSON.

namespace {

using Json = nlohmann::ordered_json;

std::string status_of(Estimate const& e) { return e.trusted ? "resolved" : "unresolved: " + e.why_not; }

std::string units(ReceiverTable const& table) {
  std::string const watts = table.beam_power > 0 ? fmt::format("# main mode: {} W\n", table.beam_power)
                                                 : std::string("# power of the main mode: not stated\n");
  return watts + "# power: over that of the main mode; sigma: one standard error; nan: not resolved, see status\n";
}

// Numbers that are not known are null, not NaN, which JSON does not have.
Json json_of(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
Json json_of(Estimate const& e) {
  return {{"value", e.trusted ? Json(e.mean) : Json(nullptr)},
          {"sigma", e.trusted ? json_of(e.std_error) : Json(nullptr)},
          {"hint", e.mean},
          {"resolved", e.trusted},
          {"why_not", e.why_not},
          {"histories_scored", e.scored}};
}

Json json_of(ReceivedRoute const& route) {
  Json j = {{"rank", route.rank},
            {"id", hash_text(route.hash)},
            {"sequence", route.sequence},
            {"power", json_of(route.power)},
            {"share", json_of(route.share.value)},
            {"share_sigma", json_of(route.share.sigma)},
            {"objects", route.objects}};
  if (route.folded_routes == 0) return j;
  j["folded_routes"] = route.folded_routes;
  for (FoldedRow const& f : route.folded)
    j["folded"].push_back({{"id", hash_text(f.hash)},
                           {"sequence", f.sequence},
                           {"power_hint", f.coupling.value},
                           {"resolved", f.trusted},
                           {"why", f.why}});
  return j;
}

Json json_of(ReceiverEntry const& r) {
  Json j;
  j["name"] = r.name;
  j["power"] = json_of(r.power);
  j["quadrants"] = Json::array();
  for (std::size_t i = 0; i < r.quadrants.mean.size(); ++i)
    j["quadrants"].push_back({{"value", json_of(r.quadrants.mean[i])}, {"sigma", json_of(r.quadrants.error[i])}});
  j["routes"] = Json::array();
  for (ReceivedRoute const& route : r.routes) j["routes"].push_back(json_of(route));
  j["census"] = Json::array();
  for (CensusRow const& row : r.census)
    j["census"].push_back({{"object", row.object},
                           {"power",
                            {{"value", r.power.trusted ? Json(row.power.value) : Json(nullptr)},
                             {"sigma", json_of(row.power.sigma)},
                             {"hint", row.power.value}}},
                           {"routes", row.routes}});
  return j;
}

}  // namespace

std::string receiver_csv(ReceiverTable const& table, RunContent const& run) {
  std::string text = file_header(run) + "# one row per receiver (rank 0: all its light) and per route\n" + units(table);
  text += "receiver,rank,id,sequence,power,power_sigma,power_hint,share_percent,status,histories_scored\n";
  auto const row = [&](std::string const& receiver, std::size_t rank, std::string const& id,
                       std::string const& sequence, Estimate const& e, double share) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_text(receiver), rank, id, csv_text(sequence),
                        csv_number(e.trusted, e.mean), csv_number(e.trusted, e.std_error), csv_number(true, e.mean),
                        csv_number(e.trusted, 100 * share), csv_text(status_of(e)), e.scored);
  };
  for (ReceiverEntry const& r : table.receivers) {
    row(r.name, 0, "", "all", r.power, r.power.mean > 0 ? 1 : not_a_number);
    for (ReceivedRoute const& route : r.routes)
      row(r.name, route.rank, hash_text(route.hash), route.sequence, route.power, route.share.value);
  }
  return text;
}

std::string census_csv(ReceiverTable const& table, RunContent const& run) {
  std::string text = file_header(run) + "# what the light of each receiver has met; routes: ranks in its table\n" +
                     units(table) + "receiver,object,power,power_sigma,share_percent,routes\n";
  for (ReceiverEntry const& r : table.receivers)
    for (CensusRow const& object : r.census) {
      bool const known = r.power.trusted && std::isfinite(object.power.sigma);
      std::string routes;
      for (std::size_t const rank : object.routes) routes += fmt::format("{}{}", routes.empty() ? "" : " ", rank);
      text += fmt::format("{},{},{},{},{},{}\n", csv_text(r.name),
                          csv_text(object.object.empty() ? "(routes not named)" : object.object),
                          csv_number(known, object.power.value), csv_number(known, object.power.sigma),
                          csv_number(known, 100 * object.power.value / r.power.mean), routes);
    }
  return text;
}

std::string receiver_json(ReceiverTable const& table, RunContent const& run) {
  Json j;
  j["model_hash"] = run.model_hash;
  j["seed"] = run.trace->coupling.seed;
  j["histories"] = run.trace->coupling.histories;
  j["beam_power_W"] = table.beam_power > 0 ? Json(table.beam_power) : Json(nullptr);
  j["receivers"] = Json::array();
  for (ReceiverEntry const& r : table.receivers) j["receivers"].push_back(json_of(r));
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace straytrace
