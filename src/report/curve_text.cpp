// SPDX-License-Identifier: BSD-3-Clause
// Curves and maps as columns of text, CSV and JSON.
#include "report/curve_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "report/csv.hpp"

namespace straytrace::curve_format {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) { return csv_number(std::isfinite(value), value); }

std::string with_unit(CurveColumn const& c) { return c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit); }

std::string one_word(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string comments(std::string const& title, std::vector<std::string> const& notes) {
  std::string text = fmt::format("# {}\n", title);
  for (std::string const& note : notes) text += fmt::format("# {}\n", note);
  return text;
}

std::vector<CurveColumn const*> columns_of(CurveSheet const& sheet) {
  std::vector<CurveColumn const*> all{&sheet.x};
  for (CurveColumn const& c : sheet.y) all.push_back(&c);
  return all;
}

std::string rows(CurveSheet const& sheet, char separator) {
  std::string text;
  std::vector<CurveColumn const*> const columns = columns_of(sheet);
  for (std::size_t i = 0; i < sheet.x.values.size(); ++i)
    for (CurveColumn const* c : columns) {
      text += number(c->values[i]);
      text += c == columns.back() ? '\n' : separator;
    }
  return text;
}

// The map as rows time, frequency, value; lines over it are curves of their own and left to JSON and pictures.
CurveSheet long_form(MapSheet const& map) {
  CurveSheet sheet{map.title, map.notes, {"time", "s", {}},
                   false,     false,     {{"frequency", "Hz", {}}, {"value", map.unit, {}}}};
  for (std::size_t i = 0; i < map.time.size(); ++i)
    for (std::size_t k = 0; k < map.frequency.size(); ++k) {
      sheet.x.values.push_back(map.time[i]);
      sheet.y[0].values.push_back(map.frequency[k]);
      sheet.y[1].values.push_back(map.value[i * map.frequency.size() + k]);
    }
  return sheet;
}

Json numbers(std::vector<double> const& values) {
  Json list = Json::array();
  for (double const v : values) list.push_back(std::isfinite(v) ? Json(v) : Json());
  return list;
}

Json json_of(CurveColumn const& c) {
  return {{"name", c.name}, {"unit", c.unit}, {"style", c.style}, {"values", numbers(c.values)}};
}

}  // namespace

std::string text(CurveSheet const& sheet) {
  std::vector<std::string> names, words;
  for (CurveColumn const* c : columns_of(sheet)) {
    names.push_back(with_unit(*c));
    words.push_back(one_word(c->name));
  }
  return comments(sheet.title, sheet.notes) +
         fmt::format("# {}\n# {}\n", fmt::join(names, ", "), fmt::join(words, " ")) + rows(sheet, ' ');
}

std::string csv(CurveSheet const& sheet) {
  std::vector<std::string> names;
  for (CurveColumn const* c : columns_of(sheet)) names.push_back(csv_text(with_unit(*c)));
  return comments(sheet.title, sheet.notes) + fmt::format("{}\n", fmt::join(names, ",")) + rows(sheet, ',');
}

std::string json(CurveSheet const& sheet) {
  Json j{{"title", sheet.title},
         {"notes", sheet.notes},
         {"log_x", sheet.log_x},
         {"log_y", sheet.log_y},
         {"x", json_of(sheet.x)}};
  j["y"] = Json::array();
  for (CurveColumn const& c : sheet.y) j["y"].push_back(json_of(c));
  return j.dump(1) + "\n";
}

std::string text(MapSheet const& map) { return text(long_form(map)); }
std::string csv(MapSheet const& map) { return csv(long_form(map)); }

std::string json(MapSheet const& map) {
  Json j{{"title", map.title},
         {"notes", map.notes},
         {"unit", map.unit},
         {"time_s", map.time},
         {"frequency_Hz", map.frequency}};
  std::size_t const width = map.frequency.size();
  j["value"] = Json::array();
  for (std::size_t i = 0; i < map.time.size(); ++i) {
    auto const from = map.value.begin() + std::ptrdiff_t(i * width);
    j["value"].push_back(numbers({from, from + std::ptrdiff_t(width)}));
  }
  j["lines"] = Json::array();
  for (CurveColumn const& c : map.lines) j["lines"].push_back(json_of(c));
  j["line_time_s"] = map.line_time;
  return j.dump() + "\n";
}

}  // namespace straytrace::curve_format
