// SPDX-License-Identifier: BSD-3-Clause
#include "world/read_coating.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "optics/coating_table.hpp"
#include "world/degree.hpp"
#include "world/share_table.hpp"

namespace straytrace {
namespace {

bool same_wavelength(double a, double b) { return std::fabs(a - b) <= 1e-9 * b; }

double share_at(ShareTable const& t, std::size_t row, char const* both, char const* own) {
  auto const pick = [&](char const* name) {
    auto const found = t.columns.find(name);
    return found == t.columns.end() ? 0 : found->second[row];
  };
  return pick(both) + pick(own);
}

// Problems of a row are said where the row stands.
void row_problem(Node const& node, ShareTable const& t, std::size_t row, std::string what, std::string suggestion) {
  if (t.file.empty())
    node.problem(std::move(what), std::move(suggestion));
  else
    node["file"].file_problem(t.file, t.line[row], 1, std::move(what), std::move(suggestion));
}

// Nothing when the table is wrong, and reported.
std::vector<CoatingRow> rows_of(Node const& node, ShareTable const& t) {
  std::vector<CoatingRow> rows;
  bool const absorbs = t.columns.contains("absorb");
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    CoatingRow r{t.angle[i],
                 share_at(t, i, "reflect", "reflect_s"),
                 share_at(t, i, "reflect", "reflect_p"),
                 share_at(t, i, "transmit", "transmit_s"),
                 share_at(t, i, "transmit", "transmit_p"),
                 share_at(t, i, "scatter", "")};
    double const absorbed = share_at(t, i, "absorb", ""), degrees = t.angle[i] * 180 / pi;
    if (absorbs) r.scatter = 1 - 0.5 * (r.reflect_s + r.reflect_p + r.transmit_s + r.transmit_p) - absorbed;
    double const least = std::min({r.reflect_s, r.reflect_p, r.transmit_s, r.transmit_p, r.scatter + 1e-9, absorbed});
    double const sum =
        absorbed + std::max(r.reflect_s + r.transmit_s, r.reflect_p + r.transmit_p) + (absorbs ? 0 : r.scatter);
    if (!std::isfinite(sum) || !std::isfinite(least) || std::isnan(degrees)) return {};
    if (i > 0 && !(t.angle[i] > t.angle[i - 1]))
      row_problem(node, t, i,
                  fmt::format("angle {:.6g} deg does not come after {:.6g} deg", degrees, t.angle[i - 1] * 180 / pi),
                  "sort the rows by rising angle of incidence");
    else if (least < 0 || sum > 1 + 1e-9)
      row_problem(
          node, t, i,
          fmt::format("the coating makes light: at {:.6g} deg it reflects {:.6g}, transmits {:.6g} and scatters "
                      "{:.6g}",
                      degrees, 0.5 * (r.reflect_s + r.reflect_p), 0.5 * (r.transmit_s + r.transmit_p), r.scatter),
          "no share may be negative, and for s and p each they must not exceed 1 together");
    else {
      r.scatter = std::max(0.0, r.scatter);
      rows.push_back(r);
      continue;
    }
    return {};
  }
  return rows;
}

bool check_columns(Node const& node, ShareTable const& t) {
  for (std::string const share : {"reflect", "transmit"}) {
    bool const s = t.columns.contains(share + "_s"), p = t.columns.contains(share + "_p");
    if (s != p || (s && t.columns.contains(share))) {
      node.problem(fmt::format("'{0}' is given for one polarisation only, or twice", share),
                   fmt::format("give '{0}', or '{0}_s' and '{0}_p'", share));
      return false;
    }
  }
  if (t.columns.contains("scatter") && t.columns.contains("absorb")) {
    node.problem("'scatter' and 'absorb' say the same thing twice", "keep one; the other is what is left over");
    return false;
  }
  return true;
}

// The part of the table for one wavelength.
ShareTable rows_at(ShareTable const& t, double wavelength) {
  ShareTable part;
  part.file = t.file;
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    if (!same_wavelength(t.wavelength[i], wavelength)) continue;
    part.angle.push_back(t.angle[i]);
    for (auto const& [name, column] : t.columns) part.columns[name].push_back(column[i]);
    if (i < t.line.size()) part.line.push_back(t.line[i]);
  }
  return part;
}

// Rows of one wavelength, checked; nothing when they are wrong, and reported.
std::vector<CoatingRow> checked_rows(Node const& node, ShareTable const& table) {
  auto rows = rows_of(node, table);
  if (rows.empty()) return rows;
  if (rows.size() >= 2 && rows.front().angle >= 0 && rows.front().angle <= 15 * degree &&
      std::fabs(rows.back().angle - pi / 2) <= 1e-9)
    return rows;
  std::string const at = table.wavelength.empty() ? "" : fmt::format(" at {:.6g} nm", table.wavelength.front() * 1e9);
  node.problem(fmt::format("the table runs from {:.6g} to {:.6g} deg{}", rows.front().angle / degree,
                           rows.back().angle / degree, at),
               "begin at 15 deg or below, and end at 90 deg: there every smooth surface reflects all");
  return {};
}

// Between two wavelengths, at every angle that one of them has: shares are mixed, which makes no light.
std::vector<CoatingRow> mixed(std::vector<CoatingRow> const& low, std::vector<CoatingRow> const& high, double share,
                              bool scatters) {
  Storage storage;
  Coating const a = make_coating(low, scatters, storage), b = make_coating(high, scatters, storage);
  std::vector<double> angles;
  for (auto const* rows : {&low, &high})
    for (CoatingRow const& r : *rows) angles.push_back(r.angle);
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end(), [](double x, double y) { return y - x < 1e-9; }),
               angles.end());
  std::vector<CoatingRow> rows;
  for (double const angle : angles) {
    double const cosine = angle >= pi / 2 - 1e-9 ? 0 : std::cos(angle);
    auto const x = a.table.at(cosine), y = b.table.at(cosine);
    double share_of[Coating::columns];
    for (int i = 0; i < Coating::columns; ++i)
      share_of[i] = std::max(0.0, (1 - share) * x.value[i] + share * y.value[i]);
    rows.push_back({angle, share_of[Coating::reflect_s], share_of[Coating::reflect_p], share_of[Coating::transmit_s],
                    share_of[Coating::transmit_p], share_of[Coating::scatter]});
  }
  return rows;
}

// Every wavelength of the table is checked; that of the light picks, linear between two of them.
std::vector<CoatingRow> rows_for_light(Node const& node, ShareTable const& table, double light, bool scatters) {
  if (table.wavelength.empty()) return checked_rows(node, table);
  std::map<double, std::vector<CoatingRow>> known;
  for (double const wavelength : table.wavelength) {
    bool const seen = std::any_of(known.begin(), known.end(),
                                  [&](auto const& entry) { return same_wavelength(entry.first, wavelength); });
    if (seen) continue;
    ShareTable part = rows_at(table, wavelength);
    part.wavelength = {wavelength};
    auto rows = checked_rows(node, part);
    if (rows.empty()) return {};
    known[wavelength] = std::move(rows);
  }
  auto above = known.begin();
  while (above != known.end() && above->first < light && !same_wavelength(above->first, light)) ++above;
  if (above != known.end() && same_wavelength(above->first, light)) return above->second;
  if (above == known.begin() || above == known.end()) {
    node.problem(fmt::format("the light has {:.6g} nm, and the table covers {:.6g} to {:.6g} nm", light * 1e9,
                             known.begin()->first * 1e9, known.rbegin()->first * 1e9),
                 "add rows for the wavelength of the beams, or leave the column out if it makes no difference");
    return {};
  }
  auto const below = std::prev(above);
  return mixed(below->second, above->second, (light - below->first) / (above->first - below->first), scatters);
}

std::optional<Coating> coating_table(Node const& node, World& world) {
  ShareTable const table = read_share_table(node);
  node.has("source");
  node.refuse_unknown("'coating'");
  if (table.angle.empty() || !check_columns(node, table)) return {};
  for (double const wavelength : table.wavelength)
    if (!(wavelength > 0)) {
      node.problem("a wavelength that is not above 0", "write the wavelength in vacuum, such as 1064 nm");
      return {};
    }
  bool const scatters = table.columns.contains("scatter") || table.columns.contains("absorb");
  auto const rows = rows_for_light(node, table, world.wavelength, scatters);
  if (rows.empty()) return {};
  return make_coating(rows, scatters, world.storage);
}

std::optional<Coating> coating_preset(Node const& node, World& world) {
  std::vector<std::string> names;
  for (CoatingPreset const& p : coating_presets()) {
    if (node.text() == p.name) return make_coating(p.rows, true, world.storage);
    names.emplace_back(p.name);
  }
  std::string const near = nearest_word(node.text(), names);
  node.problem(fmt::format("no coating is called '{}'", node.text()),
               near.empty() ? fmt::format("write '{}' or a table {{angle: ..., reflect: ...}}", names.front())
                            : fmt::format("did you mean '{}'?", near));
  return {};
}

}  // namespace

std::optional<Coating> read_coating(Node const& specular, World& world) {
  Node const c = specular["coating"];
  return c.kind() == Node::Kind::scalar ? coating_preset(c, world) : coating_table(specular.table("coating"), world);
}

}  // namespace straytrace
