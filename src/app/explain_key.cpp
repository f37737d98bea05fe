// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "app/explain.hpp"
#include "app/language.hpp"
#include "base/message.hpp"
#include "base/table.hpp"
#include "report/route_columns.hpp"

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t shown_whole = 3;  // keys of one name that are printed with everything

std::string full_name(LanguageKey const& k) { return k.table + "." + k.key; }

std::string whole_text(LanguageKey const& k) {
  std::string out = fmt::format("{}: key of {}\n  {}\n", full_name(k), k.about, k.text());
  for (char const* fact : {"type", "range", "default", "example"})
    if (std::string const value = k.fact(fact); !value.empty()) out += fmt::format("  {:<8} {}\n", fact, value);
  return out + fmt::format("  {:<8} {}\n", "see", k.fact("page"));
}

Json as_json(LanguageKey const& k) {
  Json out{{"key", full_name(k)}, {"of", k.about}, {"text", k.text()}};
  for (auto const& [name, value] : k.schema.at("x-straytrace").items()) out[name] = value;
  return out;
}

Explanation answer(std::vector<LanguageKey const*> const& found, bool table) {
  Explanation a;
  a.json = Json::array();
  std::size_t width = 0;
  for (LanguageKey const* k : found) width = std::max(width, (table ? k->key : full_name(*k)).size());
  if (table) a.text = fmt::format("{}: {}\n", found.front()->table, found.front()->about);
  for (LanguageKey const* k : found) {
    a.json.push_back(as_json(*k));
    if (!table && found.size() <= shown_whole)
      a.text += whole_text(*k);
    else
      a.text += fmt::format("  {:<{}}  {}\n", table ? k->key : full_name(*k), width, k->text());
  }
  if (table) a.text += fmt::format("see {}\n", found.front()->fact("page"));
  return a;
}

}  // namespace

std::optional<Explanation> explain_key(std::string const& what) {
  std::vector<LanguageKey const*> keys, tables;
  for (LanguageKey const& k : language_keys()) {
    if (full_name(k) == what || k.key == what) keys.push_back(&k);
    if (k.table == what) tables.push_back(&k);
  }
  if (keys.empty() && tables.empty()) return {};
  if (keys.empty()) return answer(tables, true);
  Explanation a = answer(keys, false);
  if (tables.empty()) return a;
  Explanation const more = answer(tables, true);
  a.text += more.text;
  a.json.insert(a.json.end(), more.json.begin(), more.json.end());
  return a;
}

std::optional<Explanation> explain_column(std::string const& what) {
  PathTable table;  // one empty row has all columns
  table.has_noise = true;
  table.rows.emplace_back();
  CouplingTable const coupling;
  RouteColumns const columns(table, coupling, nullptr);
  auto const& all = columns.all();
  auto const hit =
      std::find_if(all.begin(), all.end(), [&](RouteColumn const& c) { return c.key == what || c.title == what; });
  if (hit == all.end()) return {};
  Explanation a;
  a.json = {{"column", hit->key}, {"title", hit->title}, {"unit", hit->unit}, {"text", hit->help}};
  std::string const unit = hit->is_text ? "text" : hit->unit.empty() ? "number" : hit->unit;
  a.text =
      fmt::format("{}: column of the path table, {}\n  {}\n  asked by straytrace paths RUN --where, --sort, --csv\n",
                  hit->key, unit, hit->help);
  a.text += "see docs/reference/run_file.md\n";
  return a;
}

std::string nearest_key(std::string const& what) {
  std::vector<std::string> names, keys;
  std::size_t const dot = what.find('.');
  std::string const table = what.substr(0, dot), key = dot == what.npos ? "" : what.substr(dot + 1);
  for (LanguageKey const& k : language_keys()) {
    names.insert(names.end(), {full_name(k), k.key, k.table});
    if (k.table == table) keys.push_back(k.key);
  }
  if (std::string const near = nearest_word(key, keys); !near.empty()) return table + "." + near;
  return nearest_word(what, names);
}

Explanation explain_unit(std::string const& unit) {
  auto const found = parse_unit(unit);
  if (!found) {
    std::string const near = likely_unit(unit);
    throw InputError(fmt::format("error: '{}' is not a unit\n  {}known units: {}", unit,
                                 near.empty() ? "" : fmt::format("did you mean '{}'? ", near), all_unit_names()));
  }
  std::string const accepted = accepted_units(found->dimension), si = with_unit("1", found->dimension);
  Explanation a;
  a.json = {{"unit", unit}, {"dimension", name_of(found->dimension)}, {"si", found->si}, {"accepted", accepted}};
  a.text = fmt::format("{}: {}\n  in SI    {:.10g}{}\n  accepted {}\n", unit, described(found->dimension), found->si,
                       found->dimension == dim::angle   ? " rad"
                       : found->dimension == dim::plain ? ""
                                                        : si.substr(1),
                       accepted);
  if (found->dimension == dim::length || found->dimension == dim::angle)
    a.text += "  amplitudes of motion name their kind: peak, pp (peak to peak) or rms\n";
  if (found->dimension.second % 2 != 0) a.text += "  amplitude spectral density, one-sided\n";
  a.text += "see docs/reference/scene.md\n";
  return a;
}

}  // namespace straytrace
