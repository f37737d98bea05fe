// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_names.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace straytrace::results {
namespace {

using Steps = std::vector<std::string>;
constexpr char const* between_steps = " > ";

Steps steps_of(std::string const& name) {
  Steps steps;
  for (std::size_t at = 0; at <= name.size();) {
    std::size_t const end = std::min(name.find(between_steps, at), name.size());
    steps.push_back(name.substr(at, end - at));
    at = end + std::char_traits<char>::length(between_steps);
  }
  return steps;
}

// The kept steps, with one "…" for each gap between them.
std::string text_of_steps(Steps const& steps, std::vector<bool> const& kept) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!kept[i] && !kept[i - 1]) continue;
    text += (i > 0 ? between_steps : "") + (kept[i] ? steps[i] : "…");
  }
  return text;
}

// Both ends, and the steps of `order` while they fit.
std::string fitted(Steps const& steps, std::vector<std::size_t> const& order, std::size_t width) {
  std::vector<bool> kept(steps.size());
  kept.front() = kept.back() = true;
  for (std::size_t const i : order) {
    kept[i] = true;
    if (width_of(text_of_steps(steps, kept)) <= width) continue;
    kept[i] = false;
    break;
  }
  return text_of_steps(steps, kept);
}

// Inner steps from both ends towards the middle.
std::vector<std::size_t> from_ends(std::size_t count) {
  std::vector<std::size_t> order;
  for (std::size_t i = 1; 2 * i < count; ++i) {
    order.push_back(i);
    if (count - 1 - i > i) order.push_back(count - 1 - i);
  }
  return order;
}

// Inner steps from `first` on, then those before it.
std::vector<std::size_t> from_step(std::size_t count, std::size_t first) {
  std::vector<std::size_t> order;
  for (std::size_t i = first; i + 1 < count; ++i) order.push_back(i);
  for (std::size_t i = first - 1; i > 0; --i) order.push_back(i);
  return order;
}

// The first form that no other name has; where all are taken, the usual one.
std::string form_unlike(std::set<std::string> const& taken, Steps const& steps, std::size_t width) {
  std::string const usual = fitted(steps, from_ends(steps.size()), width);
  std::string form = usual;
  for (std::size_t first = 1; taken.contains(form) && first + 1 < steps.size(); ++first)
    form = fitted(steps, from_step(steps.size(), first), width);
  return taken.contains(form) ? usual : form;
}

}  // namespace

std::vector<std::string> shortened_routes(std::vector<std::string> const& names, std::size_t width) {
  std::vector<std::string> all = names;
  std::map<std::string, std::string> short_of;
  std::set<std::string> taken;
  for (std::string& name : all) {
    if (width_of(name) <= width) continue;
    auto const [form, is_new] = short_of.try_emplace(name);
    if (is_new) form->second = form_unlike(taken, steps_of(name), width);
    name = form->second;
    taken.insert(name);
  }
  return all;
}

bool shorten_routes(Columns& columns) {
  constexpr std::size_t widest = 72;  // characters
  std::size_t const at = std::size_t(std::ranges::find(columns.titles, "route") - columns.titles.begin());
  std::vector<std::string> names;
  for (auto const& row : columns.rows) names.push_back(row.empty() ? "" : row[at]);
  std::vector<std::string> const shorter = shortened_routes(names, widest);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!columns.rows[i].empty()) columns.rows[i][at] = shorter[i];
  return shorter != names;
}

}  // namespace straytrace::results
