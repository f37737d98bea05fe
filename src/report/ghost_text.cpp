// SPDX-License-Identifier: BSD-3-Clause
// The table of ghosts for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/counted.hpp"
#include "report/columns.hpp"
#include "report/ghost_table.hpp"

namespace straytrace {
namespace {

std::string short_number(double x, char const* format = "{:.3g}") {
  return std::isfinite(x) ? fmt::format(fmt::runtime(format), x) : "-";
}

std::string watts(double share, double power) {
  return power > 0 ? fmt::format("{:.3g} W", share * power) : fmt::format("{:.3g}", share);
}

std::string spot_text(Spot const& s) {
  return s.major < 1.005 * s.minor ? fmt::format("{:.3g}", 1e3 * s.major)
                                   : fmt::format("{:.3g}x{:.3g}", 1e3 * s.major, 1e3 * s.minor);
}

// Long ways keep their ends; programs get all of it.
std::string short_route(std::string const& route) {
  constexpr std::string_view sign = " > ";
  constexpr std::size_t shown_before = 3, shown_behind = 2;
  std::vector<std::size_t> at;
  for (std::size_t i = route.find(sign); i != route.npos; i = route.find(sign, i + 1)) at.push_back(i);
  if (at.size() <= shown_before + shown_behind + 1) return route;
  std::size_t const left_out = at.size() - shown_before - shown_behind;
  return fmt::format("{} > ({} more){}", route.substr(0, at[shown_before]), left_out,
                     route.substr(at[at.size() - shown_behind]));
}

void add_row(Columns& table, GhostReport const& report, GhostRow const& r) {
  Ghost const& g = r.ghost;
  Standing const& s = g.standing;
  std::vector<std::string> row = {fmt::format("{}", g.order)};
  if (report.power > 0) row.push_back(fmt::format("{:.3g}", g.power * report.power));
  row.push_back(fmt::format("{:.3g}", g.power));
  row.push_back(spot_text(g.spot));
  row.push_back(g.clipped > 1e-12 ? fmt::format("{:.2g}", g.clipped) : "-");
  double const angle = s.angle > 1e-12 ? s.angle : 0;  // below: rounding
  row.push_back(s.known ? fmt::format("{:.4g}{}", 1e3 * angle, s.against ? " back" : "") : "-");
  row.push_back(s.known ? fmt::format("{:.5g}", 1e3 * s.difference) : "-");
  row.push_back(s.recoupled.any && g.order > 0 ? short_number(s.recoupled.share()) : "-");
  if (report.has_noise)
    for (double h : r.strain) row.push_back(short_number(h, "{:.2g}"));
  row.push_back(short_route(r.route));
  table.rows.push_back(row);
}

std::string rows_text(GhostReport const& report) {
  Columns table;
  table.titles = {"order"};
  if (report.power > 0) table.titles.push_back("power/W");
  for (char const* title : {"relative", "spot/mm", "beside", "angle/mrad", "difference/mm", "recoupled"})
    table.titles.push_back(title);
  if (report.has_noise)
    for (double hz : ghost_frequencies) table.titles.push_back(fmt::format("h({:g} Hz)", hz));
  table.titles.push_back("route");
  table.left.assign(table.titles.size(), false);
  table.left.back() = true;
  std::uint64_t main = 0;
  for (GhostRow const& r : report.rows) {
    main += r.ghost.order == 0;
    add_row(table, report, r);
  }
  std::uint64_t const ends = report.by_order.empty() ? 0 : report.by_order[0], ghosts = report.rows.size() - main;
  std::string more;
  if (ends > main)
    more += counted(ends - main, "weaker end") +
            (ends - main == 1 ? " of the main beam is not shown. " : " of the main beam are not shown. ");
  if (report.ghosts > ghosts) more += counted(report.ghosts - ghosts, "more ghost") + "; --show N has more rows.";
  return aligned(table) + more + (more.empty() ? "" : "\n");
}

std::string orders_text(GhostReport const& report) {
  std::string text;
  for (std::size_t order = 1; order < report.by_order.size(); ++order)
    text += fmt::format("{}{} of order {} ({})", order > 1 ? ", " : "", report.by_order[order], order,
                        watts(report.power_by_order[order], report.power));
  return text;
}

std::string ledger_text(GhostReport const& report) {
  BeamLedger const& l = report.ledger;
  double landed = 0, beside = 0;
  for (BeamLedger::Object const& o : l.objects) {
    landed += o.landed;
    beside += o.beside;
  }
  auto const part = [&](double share) { return watts(std::fabs(share) < 1e-15 ? 0 : share, report.power); };
  return fmt::format(
      "Ledger of {}: {} absorbed or scattered on objects, {} beside their rims, {} absorbed in media, {} left the "
      "scene, {} back in the cavity or its mode; not followed: {} below the floor, {} beyond the order, {} beyond {} "
      "surfaces{}. Sum less 1: {:.1e}.\n",
      part(1), part(landed), part(beside), part(l.media), part(l.escaped), part(l.rejoined),
      watts(l.floor, report.power), watts(l.order, report.power), watts(l.longest, report.power), report.limits.longest,
      (l.wide > 0 ? fmt::format(", {} of beams far wider than what they met", part(l.wide)) : "") +
          (l.stopped > 0 ? fmt::format(", {} when stopped early", part(l.stopped)) : ""),
      l.total() - 1);
}

std::string objects_text(GhostReport const& report, std::size_t show) {
  double rounding = 0;  // what lossless surfaces keep
  for (double power : report.power_by_order) rounding += 1e-15 * power;
  std::vector<std::size_t> order(report.objects.size());
  std::iota(order.begin(), order.end(), 0);
  auto const key = [&](std::size_t i) {
    GhostObject const& o = report.objects[i];
    if (report.rank == GhostRank::power) return o.ends;
    if (report.rank == GhostRank::recoupled || !report.has_noise) return o.recoupled;
    return std::max({o.strain2[0], o.strain2[1], o.strain2[2]});
  };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) > key(b); });
  Columns table{
      {"dump me first", report.power > 0 ? "ghosts end there/W" : "ghosts end there", "recoupled saved"}, {true}, {}};
  if (report.has_noise)
    for (double hz : ghost_frequencies) table.titles.push_back(fmt::format("h({:g} Hz) saved", hz));
  for (std::size_t const i : order) {
    GhostObject const& o = report.objects[i];
    bool const ends = o.ends > rounding;
    if (table.rows.size() >= show || !(ends || o.recoupled > 0)) continue;
    std::vector<std::string> row = {report.groups[i],
                                    ends ? short_number(o.ends * (report.power > 0 ? report.power : 1)) : "-",
                                    o.recoupled > 0 ? short_number(o.recoupled) : "-"};
    if (report.has_noise)
      for (double h2 : o.strain2) row.push_back(h2 > 0 ? short_number(std::sqrt(h2), "{:.2g}") : "-");
    table.rows.push_back(row);
  }
  return table.rows.empty() ? "No ghost meets an object.\n" : aligned(table);
}

std::string sums_text(GhostReport const& report) {
  std::string text = fmt::format(
      "Recoupled, each ghost once where it comes into line: {:.3g} with the main beam, {:.3g} against it, back to the "
      "launch.\n",
      report.recoupled_with, report.recoupled_against);
  if (report.has_port && report.families == 0) return text + fmt::format("No ghost comes to port {}.\n", report.port);
  if (report.has_port)
    text += fmt::format(
        "At port {}: {:.3g} of the main mode in {} families of equal levers, {} within each. Powers added: {:.3g}; "
        "fields with the phases as drawn (eq. 10.5): {:.3g}; worst case of all phases: {:.3g}.\n",
        report.port, report.share, report.families, report.sum == GhostSum::coherent ? "fields added" : "powers added",
        report.incoherent, report.coherent, report.worst);
  if (report.has_noise)
    text += fmt::format("h from ghosts at 10, 30, 100 Hz: {:.3g}, {:.3g}, {:.3g} /sqrt(Hz){}.\n", report.strain[0],
                        report.strain[1], report.strain[2],
                        report.sum == GhostSum::coherent && report.families > 1 ? ", families added as fields" : "");
  return text;
}

}  // namespace

std::string ghost_text(GhostReport const& report, std::size_t objects_shown) {
  std::string const of = report.passes < 1 ? fmt::format("{} that leave the cavity of the circulating {}",
                                                         watts(report.passes, report.power), watts(1, report.power))
                                           : "the launched " + watts(1, report.power);
  std::string text = fmt::format("Beam {}: {} above {:g} of {}{}{}\n", report.beam, counted(report.ghosts, "ghost"),
                                 report.floor, of, report.ghosts > 0 ? ": " : "", orders_text(report));
  if (report.ledger.stopped > 0)
    text += fmt::format("Stopped early: {} of the light was not followed; sums and rows are of the rest.\n",
                        watts(report.ledger.stopped, report.power));
  text +=
      rows_text(report) + '\n' + objects_text(report, objects_shown) + '\n' + sums_text(report) + ledger_text(report);
  for (std::string const& warning : report.warnings) text += "Warning: " + warning + ".\n";
  for (std::string const& note : report.notes) text += note + '\n';
  return text;
}

}  // namespace straytrace
