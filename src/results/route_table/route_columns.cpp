// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "base/units/quantity.hpp"
#include "results/curves/band.hpp"
#include "results/text/columns.hpp"

namespace straytrace {
namespace {

// What follows from the steps of a route.
struct Steps {
  int scatters = 0, bounces = 0, reflections = 0;
  std::string first, last;  // scatterer that is neither the start nor the end
  std::set<std::uint32_t> met;
};

Steps steps_of(CouplingTable const& coupling, CouplingClass const& c) {
  Steps s;
  for (std::size_t i = 0; i < c.steps.size(); ++i) {
    char const event = letter(c.steps[i].event);
    s.met.insert(c.steps[i].group.value);
    s.scatters += event == 'S';
    s.reflections += event == 'R';
    if (i == 0 || i + 1 == c.steps.size()) continue;
    ++s.bounces;
    if (event != 'S') continue;
    std::string const& name = coupling.groups.at(c.steps[i].group.value);
    if (s.first.empty()) s.first = name;
    s.last = name;
  }
  return s;
}

std::string strain_key(double hz) { return fmt::format("h{:g}", hz); }

std::string hertz(std::vector<double> const& all) {
  std::string text;
  for (double const f : all) text += fmt::format("{}{:g} Hz", text.empty() ? "" : ", ", f);
  return text;
}

}  // namespace

double six_digits(double x) {
  return std::isfinite(x) && x != 0 ? std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr) : x;
}

std::vector<std::string> objects_of(std::string const& sequence) {
  constexpr std::string_view then = " > ", event = "·";
  std::vector<std::string> all;
  for (std::size_t at = 0; at <= sequence.size();) {
    std::size_t const end = std::min(sequence.find(then, at), sequence.size());
    std::string const step = sequence.substr(at, end - at);
    if (std::size_t const name = step.find(event); name != std::string::npos) all.push_back(step.substr(0, name));
    at = end + then.size();
  }
  return all;
}

RouteColumns::RouteColumns(PathTable const& table, CouplingTable const& coupling, NoiseBudget const* budget)
    : listed_(table.has_noise ? table.frequencies : std::vector<double>{}), budget_(budget), rows_(table.rows.size()) {
  std::map<std::uint64_t, CouplingClass const*> by_hash;
  for (CouplingClass const& c : coupling.classes) by_hash[c.hash] = &c;
  for (PathRow const& row : table.rows) {
    hashes_.push_back(row.hash);
    resolved_.push_back(row.resolved);
    auto const found = by_hash.find(row.hash);
    add_names(row, found == by_hash.end() ? nullptr : found->second, coupling);
    add_noise(table, row);
    add_light(row, coupling.wavelength);
  }
  add_units();
}

RouteColumn const* RouteColumns::find(std::string_view key) const {
  auto const hit = place_.find(key);
  return hit == place_.end() ? nullptr : &all_[hit->second];
}

RouteColumn const& RouteColumns::strain(double hz) {
  std::string const key = strain_key(hz);
  bool const listed = std::find(listed_.begin(), listed_.end(), hz) != listed_.end();
  if (listed) return *find(key);
  if (listed_.empty()) throw std::out_of_range("this run has no noise yet; write: straytrace noise RUN");
  if (!budget_) throw std::out_of_range("h is listed at " + hertz(listed_));
  FrequencyGrid const& grid = budget_->grid;
  if (!(hz >= grid.edges.front() && hz < grid.edges.back()))
    throw std::out_of_range(fmt::format("h is known from {:g} Hz to {:g} Hz", grid.edges.front(), grid.edges.back()));
  std::map<std::uint64_t, NoiseTrace const*> curves;
  for (NoiseTrace const& t : budget_->routes) curves[t.hash] = &t;
  RouteColumn& c = at(key, fmt::format("h({:g} Hz)", hz), "1/√Hz", "");
  c.numbers.clear();
  for (std::size_t i = 0; i < rows_; ++i) {
    auto const curve = curves.find(hashes_[i]);
    bool const known = resolved_[i] && curve != curves.end();
    c.numbers.push_back(known ? strain_at(*curve->second, grid, hz).value : not_a_number);
  }
  c.units = {{"/sqrt(Hz)", 1.0}};
  return c;
}

RouteColumn& RouteColumns::at(std::string const& key, std::string const& title, std::string const& unit,
                              std::string const& help) {
  auto const [place, added] = place_.emplace(key, all_.size());
  if (added) {
    all_.emplace_back();
    all_.back().key = key;
    all_.back().title = title;
    all_.back().unit = unit;
    all_.back().help = help;
  }
  return all_[place->second];
}

void RouteColumns::text(std::string const& key, std::string const& title, std::string const& help, std::string value) {
  RouteColumn& c = at(key, title, "", help);
  c.is_text = true;
  c.texts.push_back(std::move(value));
}

void RouteColumns::number(std::string const& key, std::string const& title, std::string const& unit,
                          std::string const& help, double value) {
  at(key, title, unit, help).numbers.push_back(std::isfinite(value) ? value : not_a_number);
}

void RouteColumns::count(std::string const& key, std::string const& title, std::string const& help, double value) {
  number(key, title, "", help, value);
  at(key, title, "", help).whole = true;
}

void RouteColumns::add_names(PathRow const& row, CouplingClass const* c, CouplingTable const& coupling) {
  Steps const s = c ? steps_of(coupling, *c) : Steps{};
  bool const named = c && !c->steps.empty();  // `other` sums routes that differ in all of these
  auto const of_route = [&](double n) { return named ? n : not_a_number; };
  count("rank", "rank", "1 = largest share of the strain noise", double(row.rank));
  text("sequence", "route", "R reflect, T transmit, S scatter, E edge", row.sequence);
  text("port", "port", "where the light rejoins the mode", row.port);
  text("kind", "kind", "scattered, ghost or edge", name_of(row.kind));
  number("share", "share", "%", "of the resolved strain noise power in the band", 100 * row.share.value);
  number("share_sigma", "± share", "%", "one standard error", 100 * row.share.sigma);
  count("scatters", "scatters", "diffuse events, those on lit optics included", of_route(s.scatters));
  count("bounces", "bounces", "surfaces between the first and the last", of_route(s.bounces));
  bool const ghost = row.kind == ClassKind::ghost;
  count("order", "ghost order", "reflections on the route of a ghost", ghost ? of_route(s.reflections) : not_a_number);
  count("objects", "objects", "different objects on the route", of_route(double(s.met.size())));
  text("first", "first scatterer", "between start and end", s.first);
  text("last", "last scatterer", "between start and end", s.last);
}

void RouteColumns::add_noise(PathTable const& table, PathRow const& row) {
  for (std::size_t i = 0; i < row.strain.size(); ++i) {
    std::string const key = strain_key(table.frequencies[i]), title = fmt::format("h({:g} Hz)", table.frequencies[i]);
    number(key, title, "1/√Hz", "one-sided strain ASD, mean over static phases", row.strain[i].value);
    number(key + "_sigma", "± " + title, "1/√Hz", "one standard error", row.strain[i].sigma);
  }
  double const rest = 1 - std::sqrt(std::max(0.0, 1 - row.share.value));
  number("without", "without it", "%", "change of the total strain if this route were absent",
         row.share.value > 0 ? -100 * rest : not_a_number);
}

void RouteColumns::add_light(PathRow const& row, double wavelength) {
  double const phase_sensitivity = row.body.empty() ? not_a_number : row.phase_sensitivity;
  number("coupling", "coupling", "1", "recoupled power fraction of ordered paths",
         row.resolved ? row.coupling.mean : not_a_number);
  number("coupling_sigma", "± coupling", "1", "one standard error",
         row.resolved ? row.coupling.std_error : not_a_number);
  text("status", "status", "resolved, or why not", row.resolved ? "resolved" : "unresolved: " + row.why_not);
  text("body", "moving body", "whose motion contributes most", row.body);
  number("phase_sensitivity", "phase_sensitivity", "rad/m", "phase per displacement of that body, rms over paths",
         phase_sensitivity);
  number("rms_phase", "rms phase", "rad", "above 1 fringes wrap", row.rms_phase);
  text("regime", "regime", "linear, or wrapped fringes", row.regime);
  number("fringes", "fringe multiplicity", "2v/λ", "fringe rate over that of a single retro-reflection",
         phase_sensitivity * wavelength / (4 * pi));
  number("opl", "optical path", "m", "mean over its paths", row.length_mean);
  number("opl_min", "shortest", "m", "of the kept paths", row.length_min);
  number("opl_max", "longest", "m", "of the kept paths", row.length_max);
  number("delay", "delay", "s", "light time along the mean optical path", row.length_mean / speed_of_light);
  count("histories", "histories", "that have scored", double(row.coupling.scored));
  number("largest", "largest history", "%", "share of the largest single one", 100 * row.coupling.largest_share);
  text("id", "id", "stable name of the route between runs of one model", hash_text(row.hash));
}

// Units are those of the language; a bare number stands where there is none, and for h.
void RouteColumns::add_units() {
  for (RouteColumn& c : all_) {
    if (c.is_text) continue;
    std::string names;
    if (c.unit == "m") names = accepted_units(dim::length);
    if (c.unit == "s") names = accepted_units(dim::time);
    if (c.unit == "rad") names = accepted_units(dim::angle);
    if (c.unit == "rad/m") names = "rad/m, rad/mm, rad/um";
    if (c.unit == "%" || c.unit == "1") names = "%, ppm, ppb";
    for (std::size_t at = 0; at < names.size();) {
      std::size_t const end = std::min(names.find(", ", at), names.size());
      std::string const name = names.substr(at, end - at);
      if (auto const unit = parse_unit(name)) c.units.emplace_back(name, unit->si * (c.unit == "%" ? 100 : 1));
      at = end + 2;
    }
    c.needs_unit = !c.units.empty() && c.unit != "1";
    if (c.unit == "1/√Hz") c.units = {{"/sqrt(Hz)", 1.0}};
  }
}

}  // namespace straytrace
