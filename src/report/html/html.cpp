// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "base/text/pattern.hpp"
#include "io/markup.hpp"
#include "report/html/page_json.hpp"
#include "results/route_table/route_columns.hpp"

namespace straytrace::report {
namespace {

constexpr char policy[] =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";
constexpr char policy_of_live[] = "; connect-src 'self'; frame-src 'self'";

std::string_view own(std::string const& name) {
  std::string_view const text = embedded_file("page/" + name);
  if (text.empty()) throw NumericalError("the program was built without data/page/" + name);
  return text;
}

std::string bracketed(std::string const& unit) { return unit.empty() || unit == "1" ? "" : " [" + unit + "]"; }

// Within a script element only "</script" and "<!--" matter; in JSON every '<' is inside a string.
std::string text_for_script(nlohmann::json const& data) {
  std::string const text = json_text(data);
  std::string out;
  out.reserve(text.size());
  for (char const c : text)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

// Browsers break lines behind a minus sign, which cuts exponents: 1.2(3)e-24 stays on one line. The lengths have limits
// because std::regex recurses.
std::string with_whole_numbers(std::string const& markup) {
  static Pattern const form(R"([0-9.]{1,20}(\([0-9]{1,9}\))?e[-+]?[0-9]{1,9})");
  return form.replaced(markup, "<span class=\"keep\">$&</span>");
}

// The columns that the page shows at first.
std::string route_table(PathTable const& table, std::size_t rows) {
  using Writer = TableWriter<RouteRow>;
  Writer const list(route_columns(table));
  auto columns = list.of(&TableColumn<RouteRow>::page);
  std::erase_if(columns, [](auto const* c) { return !c->shown_first; });
  std::string text = "<table id=\"fixed\"><thead><tr>";
  for (auto const* c : columns) text += fmt::format("<th>{}</th>", escaped(c->title + bracketed(c->shown_unit())));
  text += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < rows; ++i) {
    text += "<tr>";
    for (auto const* c : columns)
      text += fmt::format("<td{}>{}</td>", c->kind == ColumnKind::text ? " class=\"text\"" : "",
                          escaped(Writer::shown(*c, {table, table.rows[i]})));
    text += "</tr>\n";
  }
  return text + "</tbody></table>\n";
}

}  // namespace

std::string static_head(StaticReport const& r) {
  std::string text =
      r.verdict.empty() ? "" : fmt::format("<p class=\"verdict\">{}</p>\n", with_whole_numbers(escaped(r.verdict)));
  if (!r.headline.empty())
    text += fmt::format("<p class=\"headline\">{}</p>\n", with_whole_numbers(escaped(r.headline)));
  return text;
}

std::string static_body(StaticReport const& r, PathTable const& table) {
  std::string text = "<noscript>\n<p>Scripts are off: this is the static part of the report.</p>\n";
  if (!r.picture.bytes.empty())
    text += fmt::format("<p><img alt=\"noise budget\" class=\"budget\" src=\"data:image/{};base64,{}\"></p>\n",
                        r.picture.type, base64(r.picture.bytes.data(), r.picture.bytes.size()));
  std::size_t const rows = std::min(table.rows.size(), r.most_rows);
  if (rows > 0)
    text += fmt::format("<h2>Routes</h2>\n<p>{} of {} rows.</p>\n", rows, table.rows.size()) + route_table(table, rows);
  return text + "<h2>Report as text</h2>\n<pre>" + escaped(r.text) + "</pre>\n</noscript>\n";
}

std::string html_text(HtmlPage const& page) {
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-"
      "Policy\" content=\"{}{}\">\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{}</title>\n<style>\n"
      "{}</style>\n</head>\n<body>\n<header><h1>{}</h1></header>\n{}",
      policy, page.live ? policy_of_live : "", escaped(page.title), own("page.css"), escaped(page.title), page.body);
  text += "<main id=\"page\"></main>\n<script type=\"application/json\" id=\"data\">" + text_for_script(page.data) +
          "</script>\n";
  auto const add = [&](std::string_view script) {
    text += "<script>\n";
    text += script;
    text += "\n</script>\n";
  };
  if (page.plots) add(d3_script().text);
  if (page.scene)
    for (PageScript const& script : three_scripts())
      text += fmt::format("<script type=\"application/gzip\">{}</script>\n", script.text);
  for (std::string const& name : page.scripts) add(own(name));
  return text + "</body>\n</html>\n";
}

}  // namespace straytrace::report
