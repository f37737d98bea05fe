// SPDX-License-Identifier: BSD-3-Clause
// Path table and noise budget of a page.
#include <algorithm>
#include <cmath>
#include <map>

#include "page/page_json.hpp"
#include "report/csv.hpp"

namespace straytrace {

Json number(double x) {
  if (!std::isfinite(x)) return nullptr;
  return x == 0 ? 0 : std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr);
}

Json numbers(std::vector<double> const& all) {
  Json list = Json::array();
  for (double const x : all) list.push_back(number(x));
  return list;
}

namespace {

// What follows from the steps of a route.
struct Steps {
  int scatters = 0, bounces = 0;
  std::string first, last;  // scatterer that is neither the start nor the end
};

Steps steps_of(CouplingTable const& coupling, CouplingClass const& c) {
  Steps s;
  for (std::size_t i = 0; i < c.steps.size(); ++i) {
    char const event = letter(c.steps[i].event);
    s.scatters += event == 'S';
    if (i == 0 || i + 1 == c.steps.size()) continue;
    ++s.bounces;
    if (event != 'S') continue;
    std::string const& name = coupling.groups.at(c.steps[i].group.value);
    if (s.first.empty()) s.first = name;
    s.last = name;
  }
  return s;
}

struct Column {
  std::string key, title, unit, help;
  Json values = Json::array();
};

class Columns {
 public:
  // The reference holds until the next call.
  Json& operator()(std::string const& key, std::string const& title, std::string const& unit, std::string const& help) {
    auto const [at, added] = place_.emplace(key, all_.size());
    if (added) all_.push_back({key, title, unit, help});
    return all_[at->second].values;
  }
  Json json() const {
    Json list = Json::array();
    for (Column const& c : all_)
      list.push_back({{"key", c.key}, {"title", c.title}, {"unit", c.unit}, {"help", c.help}, {"values", c.values}});
    return list;
  }

 private:
  std::map<std::string, std::size_t> place_;
  std::vector<Column> all_;
};

void add_names(Columns& at, PathRow const& row, Steps const& s) {
  at("rank", "rank", "", "1 = largest share of the strain noise").push_back(row.rank);
  at("sequence", "route", "", "R reflect, T transmit, S scatter, E edge").push_back(row.sequence);
  at("port", "port", "", "where the light rejoins the mode").push_back(row.port);
  at("kind", "kind", "", "scattered, ghost or edge").push_back(name_of(row.kind));
  at("share", "share", "%", "of the resolved strain noise power in the band").push_back(number(100 * row.share.value));
  at("share_sigma", "± share", "%", "one standard error").push_back(number(100 * row.share.sigma));
  at("scatters", "scatters", "", "diffuse events, those on lit optics included").push_back(s.scatters);
  at("bounces", "bounces", "", "surfaces between the first and the last").push_back(s.bounces);
}

void add_noise(Columns& at, PathTable const& table, PathRow const& row) {
  for (std::size_t i = 0; i < row.strain.size(); ++i) {
    std::string const f = fmt::format("{:g}", table.frequencies[i]);
    at("h" + f, "h(" + f + " Hz)", "1/√Hz", "one-sided strain ASD, mean over static phases")
        .push_back(number(row.strain[i].value));
    at("h" + f + "_sigma", "± h(" + f + " Hz)", "1/√Hz", "one standard error").push_back(number(row.strain[i].sigma));
  }
  double const rest = 1 - std::sqrt(std::max(0.0, 1 - row.share.value));
  at("without", "without it", "%", "change of the total strain if this route were absent")
      .push_back(row.share.value > 0 ? number(-100 * rest) : number(not_a_number));
}

void add_light(Columns& at, PathRow const& row, double wavelength) {
  double const fringes = row.lever * wavelength / (4 * pi);
  at("coupling", "coupling", "1", "recoupled power fraction of ordered paths")
      .push_back(row.resolved ? number(row.coupling.mean) : Json());
  at("coupling_sigma", "± coupling", "1", "one standard error")
      .push_back(row.resolved ? number(row.coupling.std_error) : Json());
  at("verdict", "verdict", "", "resolved, or why not")
      .push_back(row.resolved ? "resolved" : "unresolved: " + row.why_not);
  at("body", "moving body", "", "whose motion contributes most").push_back(row.body);
  at("lever", "lever", "rad/m", "phase per displacement of that body, rms over paths")
      .push_back(row.body.empty() ? Json() : number(row.lever));
  at("rms_phase", "rms phase", "rad", "above 1 fringes wrap").push_back(number(row.rms_phase));
  at("regime", "regime", "", "linear, or wrapped fringes").push_back(row.regime);
  at("fringes", "fringe multiplicity", "2v/λ", "fringe rate over that of a single retro-reflection")
      .push_back(row.body.empty() ? Json() : number(fringes));
  at("opl", "optical path", "m", "mean over its paths").push_back(number(row.length_mean));
  at("opl_min", "shortest", "m", "of the kept paths").push_back(number(row.length_min));
  at("opl_max", "longest", "m", "of the kept paths").push_back(number(row.length_max));
  at("delay", "delay", "s", "light time along the mean optical path")
      .push_back(number(row.length_mean / speed_of_light));
  at("histories", "histories", "", "that have scored").push_back(row.coupling.scored);
  at("largest", "largest history", "%", "share of the largest single one")
      .push_back(number(100 * row.coupling.largest_share));
  at("id", "id", "", "stable name of the route between runs of one model").push_back(hash_text(row.hash));
}

Json curve_json(NoiseTrace const& t) {
  return {{"name", t.name}, {"asd", numbers(t.asd)}, {"sigma", numbers(t.sigma)}};
}

}  // namespace

Json table_json(PathTable const& table, CouplingTable const& coupling) {
  std::map<std::uint64_t, CouplingClass const*> by_hash;
  for (CouplingClass const& c : coupling.classes) by_hash[c.hash] = &c;
  Columns at;
  for (PathRow const& row : table.rows) {
    auto const found = by_hash.find(row.hash);
    Steps const steps = found == by_hash.end() ? Steps{} : steps_of(coupling, *found->second);
    add_names(at, row, steps);
    add_noise(at, table, row);
    at("first", "first scatterer", "", "between start and end").push_back(steps.first);
    at("last", "last scatterer", "", "between start and end").push_back(steps.last);
    add_light(at, row, coupling.wavelength);
  }
  return {{"columns", at.json()}, {"rows", table.rows.size()}, {"band", {table.low, table.high}}};
}

Json budget_json(NoiseBudget const& b, PathTable const& table, std::size_t routes) {
  Json j;
  std::vector<double> f;
  for (std::size_t i = 0; i < b.grid.size(); ++i) f.push_back(b.grid.centre(i));
  j["frequency"] = numbers(f);
  j["total"] = curve_json(b.total);
  j["phase"] = numbers(b.total.phase_asd);
  j["amplitude"] = numbers(b.total.amplitude_asd);
  NoiseBands const& d = b.bands;
  for (auto const& [name, curve] : {std::pair{"input_low", &d.input_low},
                                    {"input_high", &d.input_high},
                                    {"speckle_05", &d.speckle_05},
                                    {"speckle_50", &d.speckle_50},
                                    {"speckle_95", &d.speckle_95},
                                    {"coherent", &d.coherent}})
    j[name] = numbers(*curve);
  j["design"] = Json::array();
  for (DesignCurve const& c : b.design) j["design"].push_back({{"name", c.name}, {"asd", numbers(c.asd)}});
  j["margin"] = b.margin;
  j["unresolved"] = b.unresolved;
  j["routes"] = Json::array();
  std::map<std::uint64_t, NoiseTrace const*> by_hash;
  for (NoiseTrace const& t : b.routes) by_hash[t.hash] = &t;
  for (PathRow const& row : table.rows) {
    auto const found = by_hash.find(row.hash);
    if (j["routes"].size() >= routes) break;
    if (!row.resolved || found == by_hash.end() || !(row.share.value > 0)) continue;
    j["routes"].push_back({{"id", hash_text(row.hash)}, {"name", row.sequence}, {"asd", numbers(found->second->asd)}});
  }
  return j;
}

}  // namespace straytrace
