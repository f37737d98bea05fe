// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "io/markup.hpp"
#include "session/optimise/optimise.hpp"

namespace straytrace::session {
namespace {

std::string paragraphs(std::string const& lines, char const* tag) {
  std::string text;
  for (std::size_t at = 0; at < lines.size();) {
    std::size_t const end = std::min(lines.find('\n', at), lines.size());
    if (end > at) text += fmt::format("<{0}>{1}</{0}>\n", tag, escaped(lines.substr(at, end - at)));
    at = end + 1;
  }
  return text;
}

std::string table(Columns const& columns) {
  std::string text = "<table><thead><tr>";
  for (std::string const& title : columns.titles) text += fmt::format("<th>{}</th>", escaped(title));
  text += "</tr></thead><tbody>\n";
  for (auto const& row : columns.rows) {
    text += "<tr>";
    for (std::string const& cell : row) text += fmt::format("<td>{}</td>", escaped(cell));
    text += "</tr>\n";
  }
  return text + "</tbody></table>\n";
}

std::string picture_html(Picture const& picture) {
  if (picture.bytes.empty()) return "";
  return fmt::format(
      "<p><img class=\"budget\" alt=\"candidates: cost and h over the limit, with their errors\" "
      "src=\"data:image/{};base64,{}\"></p>\n",
      picture.type, base64(picture.bytes.data(), picture.bytes.size()));
}

std::string asked(OptimiseReport const& r) {
  std::string text;
  for (VariedParameter const& p : r.order.vary) text += fmt::format("<li>varied: {}</li>\n", escaped(range_text(p)));
  for (Relation const& relation : r.order.relations)
    text += fmt::format("<li>limit: {}</li>\n", escaped(relation.text));
  for (std::string const& limit : r.order.limit_texts()) text += fmt::format("<li>limit: {}</li>\n", escaped(limit));
  return "<ul>\n" + text + "</ul>\n";
}

}  // namespace

std::string optimise_page(OptimiseReport const& r, Picture const& picture) {
  std::string const verdict = optimise_verdict(r);
  std::size_t const first = std::min(verdict.find('\n'), verdict.size());
  HtmlPage page;
  page.title = fmt::format("{}: least {}", r.model, r.order.minimise);
  page.body = fmt::format("<p class=\"verdict\">{}</p>\n", escaped(verdict.substr(0, first)));
  page.body += paragraphs(verdict.substr(std::min(first + 1, verdict.size())), "p") + picture_html(picture);
  if (!r.finalists.empty())
    page.body +=
        "<h2>Traced anew</h2>\n<p>Each of the best candidates as the search saw it, and with a seed that the search "
        "has not used. Only the fresh value counts.</p>\n" +
        table(finalists_table(r));
  page.body += "<h2>What was asked</h2>\n" + asked(r) + "<h2>Candidates</h2>\n";
  page.body +=
      "<p>h/limit: largest ratio of the total to its limit, with one standard error; '&gt;': routes are "
      "unresolved. upper: the same with the stated confidence in all bins at once, unresolved routes tenfold. "
      "The limits are met at 1 or below.</p>\n" +
      table(candidates_table(r)) + paragraphs(spent_text(r), "p");
  return html_text(page);
}

}  // namespace straytrace::session
