// SPDX-License-Identifier: BSD-3-Clause
// Receivers for people: what they get, by which routes, and what the light has met.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/columns.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

using Cells = std::vector<std::string>;

std::string verdict_text(Estimate const& e) {
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
  c.titles.insert(c.titles.end(), {"histories", "verdict"});
  c.left.assign(c.titles.size(), false);
  c.left.front() = c.left.back() = true;
  for (ReceiverEntry const& r : table.receivers) {
    Cells row = {r.name};
    add_power(row, {r.power.mean, r.power.std_error}, r.power.trusted, table.beam_power);
    row.push_back(fmt::format("{}", r.power.scored));
    row.push_back(verdict_text(r.power));
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
  c.titles.insert(c.titles.end(), {"share/%", "verdict"});
  c.left.assign(c.titles.size(), false);
  c.left[1] = c.left.back() = true;
  for (std::size_t i = 0; i < std::min(show, r.routes.size()); ++i) {
    ReceivedRoute const& route = r.routes[i];
    bool const resolved = route.power.trusted;
    Cells row = {fmt::format("{}", route.rank), route.sequence};
    add_power(row, {route.power.mean, route.power.std_error}, resolved, beam_power);
    row.push_back(resolved ? percent_text(route.share.value, route.share.sigma) : "-");
    row.push_back(verdict_text(route.power));
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

}  // namespace straytrace
