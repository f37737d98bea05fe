// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "base/errors.hpp"
#include "base/files/embedded.hpp"
#include "io/markup.hpp"
#include "report/html/page_json.hpp"
#include "report/html/scripts.hpp"

namespace straytrace {
namespace {

constexpr char policy[] =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

std::string_view own(std::string const& name) {
  std::string_view const text = embedded_file("page/" + name);
  if (text.empty()) throw NumericalError("the program was built without data/page/" + name);
  return text;
}

// Within a script element only "</script" and "<!--" matter; in JSON every '<' stands in a string.
std::string json_text(nlohmann::json const& data) {
  std::string const text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (char const c : text)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

std::string cell(WithError const& x) { return std::isfinite(x.value) ? escaped(with_brackets(x)) : "unresolved"; }

// Browsers break lines behind a minus sign, which cuts exponents: 1.2(3)e-24 stays on one line. The lengths have limits
// because std::regex recurses.
std::string with_whole_numbers(std::string const& markup) {
  static std::regex const form(R"([0-9.]{1,20}(\([0-9]{1,9}\))?e[-+]?[0-9]{1,9})");
  return std::regex_replace(markup, form, "<span class=\"keep\">$&</span>");
}

std::string row_html(PathRow const& row) {
  std::string text = fmt::format("<tr><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{}</td>",
                                 row.rank, escaped(row.sequence), escaped(row.port),
                                 !row.resolved       ? "unresolved"
                                 : row.upper_bound() ? fmt::format("{:.3g}", 100 * row.share.value)
                                                     : percent_text(row.share.value, row.share.sigma));
  text += fmt::format("<td>{}</td>", row.resolved ? cell(row.coupling_with_error()) : escaped(row.why_not));
  for (WithError const& h : row.strain) text += fmt::format("<td>{}</td>", cell(h));
  return text + fmt::format("<td class=\"text\">{}</td><td>{}</td></tr>\n", escaped(row.body),
                            std::isfinite(row.length_mean) ? fmt::format("{:.6g}", row.length_mean) : "-");
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
  std::string text = "<noscript>\n<p>Scripts are off: this is the fixed part of the report.</p>\n";
  if (!r.picture.bytes.empty())
    text += fmt::format("<p><img alt=\"noise budget\" class=\"budget\" src=\"data:image/{};base64,{}\"></p>\n",
                        r.picture.type, base64(r.picture.bytes.data(), r.picture.bytes.size()));
  std::size_t const rows = std::min(table.rows.size(), r.most_rows);
  if (rows > 0) {
    text +=
        fmt::format("<h2>Routes</h2>\n<p>{} of {} rows.</p>\n<table id=\"fixed\"><thead><tr>", rows, table.rows.size());
    for (std::string const title : {"rank", "route", "port", "share [%]", "coupling"}) text += "<th>" + title + "</th>";
    for (double const f : table.frequencies) text += fmt::format("<th>h({:g} Hz) [1/√Hz]</th>", f);
    text += "<th>moving body</th><th>optical path [m]</th></tr></thead><tbody>\n";
    for (std::size_t i = 0; i < rows; ++i) text += row_html(table.rows[i]);
    text += "</tbody></table>\n";
  }
  return text + "<h2>Report as text</h2>\n<pre>" + escaped(r.text) + "</pre>\n</noscript>\n";
}

std::string html_text(HtmlPage const& page) {
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-"
      "Policy\" content=\"{}\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n<style>\n"
      "{}</style>\n</head>\n<body>\n<header><h1>{}</h1></header>\n{}",
      policy, escaped(page.title), own("page.css"), escaped(page.title), page.body);
  text += "<main id=\"page\"></main>\n<script type=\"application/json\" id=\"data\">" + json_text(page.data) +
          "</script>\n";
  auto const add = [&](std::string_view script) {
    text += "<script>\n";
    text += script;
    text += "\n</script>\n";
  };
  if (page.plots) add(d3_script().text);
  if (page.scene)
    for (PageScript const& script : three_scripts()) add(script.text);
  for (std::string const& name : page.scripts) add(own(name));
  return text + "</body>\n</html>\n";
}

}  // namespace straytrace
