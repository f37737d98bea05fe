// SPDX-License-Identifier: BSD-3-Clause
#include "session/scan/scan_view.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "results/text/columns.hpp"

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;

char const* word_of(ScanPoint::From from) {
  constexpr char const* words[] = {"traced", "stored", "same trace"};
  return words[std::size_t(from)];
}

std::string value_of(std::string const& setting) { return setting.substr(setting.find('=') + 1); }

std::string short_hertz(double hz) { return fmt::format("{:.3g}", hz); }

bool bound(ScanPoint const& p) { return !p.unresolved.empty(); }

std::string above(ScanPoint const& p, WithError const& x) { return bound(p) && !x.at_most ? "> " : ""; }

std::vector<std::string> row_of(ScanPoint const& p, bool compared) {
  std::vector<std::string> row;
  for (std::string const& s : p.settings) row.push_back(value_of(s));
  for (WithError const& h : p.strain) row.push_back(std::isnan(h.value) ? "no answer" : above(p, h) + with_brackets(h));
  if (compared) {
    bool const known = !std::isnan(p.ratio.value);
    row.push_back(known ? above(p, p.ratio) + with_brackets(p.ratio) : "-");
    row.push_back(known ? short_hertz(p.worst_hz) : "-");
  }
  row.push_back(bound(p) ? fmt::format("{}", p.unresolved.size()) : "none");
  row.push_back(fmt::format("{:.3g}", double(p.histories)));
  row.push_back(p.complete ? word_of(p.from) : "not finished");
  return row;
}

Json numbers(WithError const& x) {
  Json j{{"value", x.value}, {"sigma", x.sigma}};
  if (x.at_most) j["at_most"] = true;
  return j;
}

}  // namespace

std::string scan_text(ScanTable const& t) {
  Columns c;
  for (ScanAxis const& axis : t.axes) c.titles.push_back(axis.name);
  for (double const f : Scanner::frequencies) c.titles.push_back(fmt::format("h({:g} Hz)", f));
  bool const compared = !t.line.empty();
  if (compared) c.titles.insert(c.titles.end(), {"worst h/line", "at/Hz"});
  c.titles.insert(c.titles.end(), {"unresolved", "histories", "from"});
  for (ScanPoint const& p : t.points) c.rows.push_back(row_of(p, compared));
  std::string text = aligned(c);
  if (compared) text += fmt::format("\nline: {}; above 1 the total exceeds it.", t.line);
  text += "\nh: one-sided strain ASD in 1/sqrt(Hz), mean over static phases; (n): one standard error, last digits.\n";
  for (ScanPoint const& p : t.points)
    if (bound(p))
      return text +
             "'>': a lower bound, 'no answer': no route is resolved; give more --histories, or --until \"h_total < 5 "
             "%\".\n";
  return text;
}

std::string scan_csv(ScanTable const& t) {
  std::string text = fmt::format("# straytrace scan of {}\n# line: {}\n", t.model, t.line.empty() ? "none" : t.line);
  text +=
      "# h: one-sided strain ASD [1/sqrt(Hz)]; sigma: one standard error, Monte Carlo; with unresolved routes h and "
      "ratio are lower bounds\n";
  for (ScanAxis const& axis : t.axes) text += csv_text(axis.name) + ",";
  for (double const f : Scanner::frequencies) text += fmt::format("h_{0:g}Hz,h_{0:g}Hz_sigma,", f);
  text += "worst_ratio,worst_ratio_sigma,worst_Hz,unresolved,histories,from,complete,model_hash\n";
  for (ScanPoint const& p : t.points) {
    for (std::string const& s : p.settings) text += csv_text(value_of(s)) + ",";
    for (WithError const& h : p.strain) text += csv_number(true, h.value) + "," + csv_number(true, h.sigma) + ",";
    text += fmt::format("{},{},{},{},{},{},{},{}\n", csv_number(true, p.ratio.value), csv_number(true, p.ratio.sigma),
                        csv_number(true, p.worst_hz), p.unresolved.size(), p.histories, word_of(p.from),
                        int(p.complete), p.model_hash);
  }
  return text;
}

std::string scan_json(ScanTable const& t) {
  Json j;
  j["model"] = t.model;
  j["line"] = t.line;
  j["complete"] = t.points.size() == t.wanted && (t.points.empty() || t.points.back().complete);
  j["parameters"] = Json::array();
  for (ScanAxis const& a : t.axes)
    j["parameters"].push_back({{"name", a.name}, {"unit", a.unit}, {"values", a.values}, {"numbers", a.numbers}});
  j["points"] = Json::array();
  for (ScanPoint const& p : t.points) {
    Json point, settings = Json::object();
    for (std::string const& s : p.settings) settings[s.substr(0, s.find('='))] = value_of(s);
    point["settings"] = settings;
    point["strain"] = Json::array();
    for (std::size_t i = 0; i < p.strain.size(); ++i) {
      Json h = numbers(p.strain[i]);
      h["frequency_Hz"] = Scanner::frequencies[i];
      point["strain"].push_back(h);
    }
    point["worst_ratio"] = numbers(p.ratio);
    point["worst_Hz"] = p.worst_hz;
    point["unresolved"] = p.unresolved;
    point["warnings"] = p.warnings;
    point["histories"] = p.histories;
    point["from"] = word_of(p.from);
    point["complete"] = p.complete;
    point["model_hash"] = p.model_hash;
    j["points"].push_back(point);
  }
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace straytrace
