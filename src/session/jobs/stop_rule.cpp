// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/errors.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "session/model.hpp"

namespace straytrace::session {
namespace {

using Goal = StopRule::Goal;

double seconds_in(std::string const& unit) { return unit == "h" ? 3600 : unit == "min" ? 60 : 1; }

Goal goal_of(std::string const& what, double relative_error) {
  if (what == "h_total" || what == "h") return {Goal::Of::total, "", relative_error};
  if (what == "routes") return {Goal::Of::routes, "", relative_error};
  std::size_t const colon = what.find(':');
  return {what.starts_with("receiver") ? Goal::Of::receiver : Goal::Of::route, what.substr(colon + 1), relative_error};
}

void parse_one(std::string const& written, StopRule& rule) {
  std::string const text = with_plain_spaces(written);
  static Pattern const by_error(
      R"(\s*(h_total|h|routes|receiver:[^<\s]+|class:[^<]*[^<\s])\s*<\s*([0-9.eE+-]+)\s*(%?)\s*)");
  static Pattern const by_time(R"(\s*([0-9.eE+-]+)\s*(s|min|h)\s*)");
  try {
    if (PatternMatch const m = by_error.match(text)) {
      double const error = std::stod(m[2]) * (m[3].empty() ? 1 : 0.01);
      rule.goals.push_back(goal_of(m[1], error));
      rule.error_rule +=
          fmt::format("{}{} < {:g}", rule.error_rule.empty() ? "" : ", ", m[1] == "h" ? "h_total" : m[1], error);
      if (error > 0 && error < 1) return;
    } else if (PatternMatch const time = by_time.match(text)) {
      rule.max_seconds = std::stod(time[1]) * seconds_in(time[2]);
      if (rule.max_seconds > 0) return;
    }
  } catch (std::exception const&) {  // not a number: fall through to the message
  }
  throw InputError(fmt::format("'{}' is not a stop rule", text),
                   "write 'h_total < 5 %', 'routes < 10 %', 'receiver:* < 5 %', 'class:* < 10 %' or '10 min'");
}

// "h_total < 0,5 %" as it was meant.
std::string with_decimal_points(std::string text) {
  auto const digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  for (std::size_t i = 1; i < text.size(); ++i)
    if (text[i] == ',' && digit(i - 1) && digit(i + 1)) text[i] = '.';
  return text;
}

// "lamp·S > PD1·D" and "lamp > PD1" are the same route: names of groups without what happened there.
std::vector<std::string> groups_in(std::string const& route) {
  std::vector<std::string> groups;
  for (std::size_t at = 0; at <= route.size();) {
    std::size_t const end = std::min(route.find('>', at), route.size());
    std::string group = route.substr(at, end - at);
    group.erase(std::min(group.find("·"), group.size()));
    group.erase(0, group.find_first_not_of(' '));
    group.erase(group.find_last_not_of(' ') + 1);
    groups.push_back(group);
    at = end + 1;
  }
  return groups;
}

double relative(Estimate const& e) { return e.trusted && e.mean > 0 ? e.std_error / e.mean : infinity; }

double worst_receiver(Goal const& goal, CouplingTable const& table) {
  double worst = 0;
  for (std::size_t i = 0; i < table.receivers.size(); ++i)
    if (goal.name == "*" || goal.name == table.receivers[i]) worst = std::max(worst, relative(table.received_power[i]));
  return worst;
}

// Of one named route, or of all with more than 1 % of the light of their end.
double worst_route(Goal const& goal, CouplingTable const& table) {
  double worst = 0;
  bool found = false;
  std::vector<std::string> const wanted = groups_in(goal.name);
  auto const look = [&](std::vector<CouplingClass> const& classes, auto const& name_of_route) {
    std::map<std::uint32_t, double> all;
    for (CouplingClass const& c : classes) all[c.port.value] += c.coupling.mean;
    for (CouplingClass const& c : classes) {
      bool const asked =
          goal.name == "*" ? c.coupling.mean > 0.01 * all[c.port.value] : groups_in(name_of_route(table, c)) == wanted;
      if (!asked) continue;
      found = true;
      if (!c.deterministic()) worst = std::max(worst, relative(c.coupling));  // no history lowers theirs
    }
  };
  look(table.classes, route_name);
  look(table.received, received_name);
  return found ? worst : infinity;
}

// Largest relative error over the band; infinite while anything needed is unresolved.
double worst_noise(Goal const& goal, NoiseBudget const& budget) {
  auto const worst = [](NoiseTrace const& trace) {
    double largest = 0;
    for (std::size_t i = 0; i < trace.asd.size(); ++i)
      if (trace.asd[i] > 0) largest = std::max(largest, trace.sigma[i] / trace.asd[i]);
    return largest;
  };
  bool const any = std::any_of(budget.routes.begin(), budget.routes.end(), [](auto const& r) { return r.resolved; });
  bool const still = std::all_of(budget.total.asd.begin(), budget.total.asd.end(), [](double h) { return h == 0; });
  if (any && still && budget.unresolved.empty()) return 0;  // nothing moves: no error to reduce
  double error = worst(budget.total);
  if (goal.of == Goal::Of::routes) {
    double total = 0;
    for (double x : budget.total.asd) total += x * x;
    for (NoiseTrace const& route : budget.routes) {
      double share = 0;
      for (double x : route.asd) share += x * x;
      if (route.resolved && share > 0.01 * total) error = std::max(error, worst(route));
    }
  }
  if (budget.unresolved_hint > 0.01) error = std::max(error, budget.unresolved_hint);
  return error > 0 ? error : infinity;
}

bool about_noise(Goal const& goal) { return goal.of == Goal::Of::total || goal.of == Goal::Of::routes; }

std::string nearest_of(std::string const& word, std::vector<std::string> const& known, std::string const& what) {
  if (std::string const near = nearest_word(word, known); !near.empty()) return fmt::format("did you mean '{}'?", near);
  return known.empty() ? fmt::format("the scene has no {}", what) : fmt::format("known: {}", fmt::join(known, ", "));
}

}  // namespace

double StopRule::wanted_error() const {
  double least = infinity;
  for (Goal const& goal : goals) least = std::min(least, goal.relative_error);
  return least;
}

double stop_rule_error(StopRule const& rule, Model const& model, CouplingTable const& table) {
  std::optional<NoiseBudget> budget;
  double worst = 0;
  for (Goal const& goal : rule.goals) {
    if (about_noise(goal) && !budget) budget = model.project(table);
    double const error = about_noise(goal)               ? worst_noise(goal, *budget)
                         : goal.of == Goal::Of::receiver ? worst_receiver(goal, table)
                                                         : worst_route(goal, table);
    worst = std::max(worst, error / goal.relative_error);
  }
  return worst * rule.wanted_error();
}

std::optional<StopRule::Complaint> complaint_about(StopRule const& rule, Model const& model) {
  std::vector<std::string> const& receivers = model.world.receiver_names();
  std::vector<std::string> names = model.world.groups();
  names.emplace_back("other");
  for (Goal const& goal : rule.goals) {
    if (about_noise(goal) && !model.detector)
      return StopRule::Complaint{"without an interferometer there is no h for a stop rule",
                                 "write for example 'receiver:* < 5 %'"};
    if (goal.of == Goal::Of::receiver && receivers.empty())
      return StopRule::Complaint{"the scene has no receivers", "write for example 'h_total < 5 %'"};
    if (goal.of == Goal::Of::receiver && goal.name != "*" &&
        std::find(receivers.begin(), receivers.end(), goal.name) == receivers.end())
      return StopRule::Complaint{fmt::format("'{}' is not a receiver", goal.name),
                                 nearest_of(goal.name, receivers, "receivers")};
    if (goal.of == Goal::Of::route && goal.name != "*")
      for (std::string const& group : groups_in(goal.name))
        if (std::find(names.begin(), names.end(), group) == names.end())
          return StopRule::Complaint{fmt::format("'{}' in '{}' is not an object of any route", group, goal.name),
                                     nearest_of(group, names, "surfaces")};
  }
  return {};
}

double parse_duration(std::string const& written) {
  std::string const text = with_plain_spaces(written);
  static Pattern const duration(R"(\s*([0-9]+\.?[0-9]*(?:[eE][+-]?[0-9]+)?)\s*(s|min|h)\s*)");
  double seconds = 0;
  if (PatternMatch const m = duration.match(text)) seconds = std::strtod(m[1].c_str(), nullptr) * seconds_in(m[2]);
  if (!(seconds > 0) || !std::isfinite(seconds))
    throw InputError(fmt::format("'{}' is not a time", text), "write for example 90s, 50min or 1h");
  return seconds;
}

namespace {

StopRule parse_all(std::string const& text) {
  StopRule rule;
  for (std::size_t at = 0; at <= text.size();) {
    std::size_t const comma = std::min(text.find(',', at), text.size());
    parse_one(text.substr(at, comma - at), rule);
    at = comma + 1;
  }
  return rule;
}

}  // namespace

StopRule parse_stop_rule(std::string const& text) try { return parse_all(text); } catch (InputError const&) {
  std::string const meant = with_decimal_points(text);
  if (meant == text) throw;
  std::string remedy = fmt::format("write '{}'", meant);
  try {
    parse_all(meant);
  } catch (InputError const& other) {  // more is wrong with it
    remedy = other.remedy();
  }
  throw InputError(fmt::format("'{}' is not a stop rule: it has a decimal comma", text), remedy);
}

}  // namespace straytrace::session
