// SPDX-License-Identifier: BSD-3-Clause
// Curves and maps as one page that needs nothing beside it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/curve_text.hpp"
#include "report/markup.hpp"

namespace straytrace::curve_format {
namespace {

constexpr std::size_t most_rows = 2000;  // a browser stays quick; the numbers are complete in the other formats

std::string head(std::string const& title, std::vector<std::string> const& notes, std::string const& png) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n<style>body{{font-family:"
      "sans-serif;max-width:70em;margin:1em auto;padding:0 1em}}img{{max-width:100%}}table{{border-collapse:collapse;"
      "font-size:85%}}td,th{{padding:.1em .8em;text-align:right;border-bottom:1px solid "
      "#ddd}}</style></head>\n<body><h1>"
      "{0}</h1>\n",
      escaped(title));
  page += fmt::format("<p><img alt=\"{}\" src=\"data:image/png;base64,{}\"></p>\n<ul>\n", escaped(title),
                      base64(png.data(), png.size()));
  for (std::string const& note : notes) page += fmt::format("<li>{}</li>\n", escaped(note));
  return page + "</ul>\n";
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "not known"; }

std::string title_of(std::string const& name, std::string const& unit) {
  return unit.empty() || unit == "1" ? escaped(name) : fmt::format("{} [{}]", escaped(name), escaped(unit));
}

std::string table(CurveSheet const& sheet) {
  std::size_t const rows = sheet.x.values.size(), every = rows > most_rows ? (rows + most_rows - 1) / most_rows : 1;
  std::string out = every > 1 ? fmt::format("<p>One row of {}; the other formats have all {}.</p>\n", every, rows) : "";
  out += fmt::format("<table><tr><th>{}</th>", title_of(sheet.x.name, sheet.x.unit));
  for (CurveColumn const& c : sheet.y) out += fmt::format("<th>{}</th>", title_of(c.name, c.unit));
  out += "</tr>\n";
  for (std::size_t i = 0; i < rows; i += every) {
    out += fmt::format("<tr><td>{:.14g}</td>", sheet.x.values[i]);
    for (CurveColumn const& c : sheet.y) out += fmt::format("<td>{}</td>", cell(c.values[i]));
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

}  // namespace

std::string html(CurveSheet const& sheet, std::string const& png) {
  return head(sheet.title, sheet.notes, png) + table(sheet) + "</body></html>\n";
}

std::string html(MapSheet const& map, std::string const& png) {
  // The loudest frequency of each time, which a table can hold.
  CurveSheet loudest{map.title, {},    {"time", "s", map.time},
                     false,     false, {{"loudest frequency", "Hz", {}}, {"its value", map.unit, {}}}};
  std::size_t const width = map.frequency.size();
  for (std::size_t i = 0; i < map.time.size(); ++i) {
    auto const from = map.value.begin() + std::ptrdiff_t(i * width), to = from + std::ptrdiff_t(width);
    auto const top = std::max_element(from, to);
    loudest.y[0].values.push_back(map.frequency[std::size_t(top - from)]);
    loudest.y[1].values.push_back(*top);
  }
  return head(map.title, map.notes, png) + table(loudest) + "</body></html>\n";
}

}  // namespace straytrace::curve_format
