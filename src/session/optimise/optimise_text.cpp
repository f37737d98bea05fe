// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "io/markup.hpp"
#include "results/text/columns.hpp"
#include "results/text/table.hpp"
#include "scene/model_tree.hpp"
#include "session/optimise/optimise.hpp"

namespace straytrace::session {
namespace {

using Json = nlohmann::ordered_json;

char const* word_of(Finalist::Verdict v) {
  constexpr char const* words[] = {"met", "not met", "not decided"};
  return words[std::size_t(v)];
}

std::string value_in(std::string const& setting) { return setting.substr(setting.find('=') + 1); }

std::string ratio_text(Outcome const& o) {
  LineVerdict const* const v = o.deciding();
  if (!v || std::isnan(v->ratio.value)) return "-";
  return (o.point.unresolved.empty() ? "" : "> ") + with_brackets(v->ratio);
}

std::string upper_text(Outcome const& o) {
  LineVerdict const* const v = o.deciding();
  return v && std::isfinite(v->excess) ? fmt::format("{:.4g}", std::exp(v->excess)) : "-";
}

std::vector<std::string> columns_of(Outcome const& o) {
  LineVerdict const* const v = o.deciding();
  std::vector<std::string> row;
  for (std::string const& s : o.settings) row.push_back(value_in(s));
  row.push_back(std::isnan(o.objective) ? "-" : fmt::format("{:.6g}", o.objective));
  row.push_back(ratio_text(o));
  row.push_back(upper_text(o));
  row.push_back(v && std::isfinite(v->hz) ? fmt::format("{:.3g}", v->hz) : "-");
  row.push_back(o.traced ? fmt::format("{:.3g}", double(o.point.histories)) : "not traced");
  return row;
}

// Why candidates have no scene.
std::string problems_text(OptimiseReport const& r) {
  std::string text;
  for (Outcome const& o : r.outcomes)
    if (!o.problem.empty()) text += fmt::format("not traced, {}: {}\n", fmt::join(o.settings, ", "), o.problem);
  return text.empty() ? text : text + "\n";
}

std::vector<std::string> titles_of(OptimiseReport const& r) {
  std::vector<std::string> titles;
  for (VariedParameter const& p : r.order.vary) titles.push_back(p.name);
  titles.push_back(r.order.least_noise() ? "h/line" : "cost");
  titles.insert(titles.end(), {"h/limit", "upper", "at/Hz", "histories"});
  return titles;
}

}  // namespace

Columns finalists_table(OptimiseReport const& r) {
  Columns c;
  c.titles = titles_of(r);
  c.titles.insert(c.titles.begin(), {"", "seed"});
  c.titles.push_back("limits");
  for (std::size_t i = 0; i < r.finalists.size(); ++i) {
    Finalist const& f = r.finalists[i];
    auto const add = [&](char const* what, std::uint64_t seed, Outcome const& o, char const* verdict) {
      std::vector<std::string> row = columns_of(o);
      row.insert(row.begin(), {what, std::to_string(seed)});
      row.emplace_back(verdict);
      c.rows.push_back(std::move(row));
    };
    add("search", r.seed, r.outcomes[f.number], "met");
    add("fresh", r.seed + 1 + i, f.fresh, word_of(f.verdict));
  }
  return c;
}

Columns candidates_table(OptimiseReport const& r) {
  Columns c;
  c.titles = titles_of(r);
  for (Outcome const& o : r.outcomes) c.rows.push_back(columns_of(o));
  return c;
}

namespace {

// "rim is at the lower end of its range"
std::string ends_text(OptimiseReport const& r, Outcome const& best) {
  constexpr double near = 1e-3;  // of a range
  std::string text;
  for (std::size_t i = 0; i < best.settings.size(); ++i) {
    VariedParameter const& p = r.order.vary[i];
    if (p.listed()) continue;
    double const value = std::strtod(value_in(best.settings[i]).c_str(), nullptr);
    char const* const end = value - p.low < near * (p.high - p.low)    ? "lower"
                            : p.high - value < near * (p.high - p.low) ? "upper"
                                                                       : nullptr;
    if (end) text += fmt::format("'{}' is at the {} end of its range: a wider one may give more.\n", p.name, end);
  }
  return text;
}

// The cheapest candidate that misses a limit, among those below the best one: what a lower cost runs into.
Outcome const* next_cheaper(OptimiseReport const& r, Outcome const& best) {
  Outcome const* found = nullptr;
  for (Outcome const& o : r.outcomes)
    if (o.traced && !o.met() && o.objective < best.objective &&
        (!found || o.objective > found->objective || (o.objective == found->objective && o.worst() < found->worst())))
      found = &o;
  return found;
}

// The texts of what bounds a candidate, in the order of its excess.
std::vector<std::string> bounds_of(OptimiseOrder const& order) {
  std::vector<std::string> all;
  for (Relation const& relation : order.relations) all.push_back(relation.text);
  for (std::string& limit : order.limit_texts()) all.push_back(std::move(limit));
  return all;
}

// Of a bound of the finalist: d objective/d ln limit, at most 0; NaN: not known.
WithError price_of_bound(OptimiseReport const& r, Finalist const& f, std::size_t bound) {
  auto const found = r.multipliers.find(f.number);
  if (found == r.multipliers.end() || bound >= found->second.size()) return {not_a_number, not_a_number};
  WithError const& multiplier = found->second[bound];
  return {0.0 - multiplier.value, multiplier.sigma};
}

std::string binding_text(OptimiseReport const& r, Finalist const& f) {
  constexpr double near = 0.1;  // relative
  Outcome const& best = f.fresh;
  std::string text;
  std::vector<std::string> const bounds = bounds_of(r.order);
  for (std::size_t k = 0; k < best.excess.size(); ++k) {
    double const room = k < r.order.relations.size() ? -best.excess[k] : 1 - std::exp(best.excess[k]);
    WithError const price = price_of_bound(r, f, k);
    text += fmt::format("{}: {}, {:.2g} % of room", bounds[k], room < near ? "binds" : "does not bind",
                        100 * std::max(0.0, room));
    if (price.value < 0)
      text += fmt::format("; 1 % more of it lowers the {} by about {}", r.order.least_noise() ? "ratio h/line" : "cost",
                          price.sigma > 0 ? with_brackets({-0.01 * price.value, 0.01 * price.sigma})
                                          : fmt::format("{:.2g}", -0.01 * price.value));
    text += "\n";
  }
  if (Outcome const* const next = r.order.least_noise() ? nullptr : next_cheaper(r, best))
    text += fmt::format("next lower cost that was traced: {:.6g} with {}, h/limit {}, upper limit {}: not met\n",
                        next->objective, fmt::join(next->settings, ", "), ratio_text(*next), upper_text(*next));
  return text + ends_text(r, best);
}

}  // namespace

std::string range_text(VariedParameter const& p) {
  if (p.listed()) return fmt::format("{}: {}", p.name, fmt::join(p.values, ", "));
  auto const end = [&](double value) {
    double const rounded = std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
    return si_text(Value{{rounded, p.dimension, {}}, false});
  };
  return fmt::format("{} {} to {}{}", p.name, end(p.low), end(p.high), p.whole ? " (whole)" : "");
}

std::string spent_text(OptimiseReport const& r) {
  std::vector<std::string> reasons;
  for (std::string const& reason : r.ended)
    if (std::ranges::find(reasons, reason) == reasons.end()) reasons.push_back(reason);
  return fmt::format("{}; search: {}.", counted(r.outcomes.size(), "candidate"), fmt::join(reasons, "; "));
}

std::string optimise_verdict(OptimiseReport const& r) {
  if (!r.complete) return "Stopped: the search is not finished.\n";
  if (r.chosen) {
    Outcome const& best = r.finalists[*r.chosen].fresh;
    Outcome const& first = r.outcomes.front();
    std::string text = fmt::format("Best: {}.\n", fmt::join(best.settings, ", "));
    if (first.traced)
      text += fmt::format("{} {:.6g} in place of {:.6g} at the start ({}, h/limit {}{}).\n",
                          r.order.least_noise() ? "h/line" : "Cost", best.objective, first.objective,
                          fmt::join(first.settings, ", "), ratio_text(first), first.met() ? "" : ", not met");
    return text + binding_text(r, r.finalists[*r.chosen]);
  }
  if (!r.finalists.empty())
    return "None of the best candidates meets the limits with a fresh seed: give more histories.\n";
  if (r.outcomes.empty() || !r.outcomes[r.closest].traced) return "No candidate could be traced.\n";
  Outcome const& near = r.outcomes[r.closest];
  return fmt::format("None of {} meets the limits. The closest: {}, h/limit {}, upper limit {}.\n",
                     counted(r.outcomes.size(), "candidate"), fmt::join(near.settings, ", "), ratio_text(near),
                     upper_text(near)) +
         ends_text(r, near);
}

namespace {

Json json_of(OptimiseReport const& r, Outcome const& o) {
  Json settings = Json::object();
  for (std::string const& s : o.settings) settings[s.substr(0, s.find('='))] = value_in(s);
  Json j{{"settings", settings}, {"objective", o.objective}, {"met", o.met()}, {"traced", o.traced}};
  j["limits"] = Json::array();
  for (LineVerdict const& v : o.limits)
    j["limits"].push_back({{"ratio", error_json(v.ratio)},
                           {"upper", std::exp(v.excess)},
                           {"standard_errors", v.factor},
                           {"frequency_Hz", v.hz}});
  for (std::size_t k = 0; k < r.order.relations.size(); ++k)
    j["relations"].push_back({{"relation", r.order.relations[k].text}, {"excess", o.excess.at(k)}});
  if (!o.problem.empty()) j["problem"] = o.problem;
  j["unresolved"] = o.point.unresolved;
  j["histories"] = o.point.histories;
  j["model_hash"] = o.point.model_hash;
  return j;
}

// What each relation and limit costs: d objective/d ln limit.
Json prices_json(OptimiseReport const& r, Finalist const& f) {
  std::vector<std::string> const bounds = bounds_of(r.order);
  Json all = Json::array();
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    WithError const price = price_of_bound(r, f, k);
    auto const number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
    all.push_back({{"limit", bounds[k]}, {"per_ln_limit", number(price.value)}, {"sigma", number(price.sigma)}});
  }
  return all;
}

}  // namespace

std::string optimise_text(OptimiseReport const& r) {
  std::string text = fmt::format("{}: least {}", r.model, r.order.minimise);
  for (VariedParameter const& p : r.order.vary) text += "; " + range_text(p);
  text += "\n";
  for (Relation const& relation : r.order.relations) text += fmt::format("limit: {}\n", relation.text);
  for (std::string const& limit : r.order.limit_texts()) text += fmt::format("limit: {}\n", limit);
  text += spent_text(r) + "\n\n";
  text += aligned(candidates_table(r)) + "\n" + problems_text(r);
  if (!r.finalists.empty()) text += aligned(finalists_table(r)) + "\n";
  text += optimise_verdict(r);
  text +=
      "h/limit: largest ratio of the total to its limit, (n): one standard error, last digits; '>': routes are "
      "unresolved.\n"
      "upper: the same with the stated confidence in all bins at once, unresolved routes tenfold: met at 1 or below "
      "(eq. "
      "O.2).\n";
  if (!r.order.powers.empty()) text += "Where at/Hz is empty, h/limit is that of a power.\n";
  return text;
}

std::string optimise_csv(OptimiseReport const& r) {
  std::string text = fmt::format("# straytrace optimise {}: least {}, seed {}\n", r.model, r.order.minimise, r.seed);
  for (VariedParameter const& p : r.order.vary) text += csv_text(p.name) + ",";
  text += "objective,ratio,ratio_sigma,upper,frequency_Hz,met,front,unresolved,histories,model_hash\n";
  for (std::size_t i = 0; i < r.outcomes.size(); ++i) {
    Outcome const& o = r.outcomes[i];
    LineVerdict const* const found = o.deciding();
    LineVerdict const v = found ? *found : LineVerdict{};
    for (std::string const& s : o.settings) text += csv_text(value_in(s)) + ",";
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_number(true, o.objective), csv_number(true, v.ratio.value),
                    csv_number(true, v.ratio.sigma), csv_number(true, std::exp(v.excess)), csv_number(true, v.hz),
                    int(o.met()), int(r.on_front(i)), o.point.unresolved.size(), o.point.histories, o.point.model_hash);
  }
  return text;
}

std::string optimise_json(OptimiseReport const& r) {
  Json j{{"model", r.model}, {"minimise", r.order.minimise}, {"seed", r.seed}, {"complete", r.complete}};
  for (VariedParameter const& p : r.order.vary) j["vary"].push_back(p.name);
  j["limits"] = r.order.limit_texts();
  j["ended"] = r.ended;
  j["candidates"] = Json::array();
  for (std::size_t i = 0; i < r.outcomes.size(); ++i) {
    j["candidates"].push_back(json_of(r, r.outcomes[i]));
    j["candidates"].back()["front"] = r.on_front(i);
  }
  j["finalists"] = Json::array();
  for (std::size_t i = 0; i < r.finalists.size(); ++i) {
    Finalist const& f = r.finalists[i];
    Json fresh = json_of(r, f.fresh);
    fresh["candidate"] = f.number;
    fresh["seed"] = r.seed + 1 + i;
    fresh["verdict"] = word_of(f.verdict);
    fresh["prices_of_limits"] = prices_json(r, f);
    j["finalists"].push_back(fresh);
  }
  j["best"] = r.chosen ? Json(*r.chosen) : Json(nullptr);
  if (!r.chosen && !r.outcomes.empty()) j["closest"] = r.closest;
  return json_text(j, 2) + "\n";
}

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
      table(candidates_table(r)) + paragraphs(problems_text(r) + spent_text(r), "p");
  return html_text(page);
}

}  // namespace straytrace::session
