// SPDX-License-Identifier: BSD-3-Clause
// The table of ghosts for programs.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "report/csv.hpp"
#include "report/ghost_table.hpp"

namespace straytrace {
namespace {

using SortedJson = nlohmann::json;

SortedJson number(double x) { return std::isfinite(x) ? SortedJson(x) : SortedJson(nullptr); }

SortedJson vector_json(Vec3 v) { return {v.x, v.y, v.z}; }

SortedJson row_json(GhostReport const& report, GhostRow const& r) {
  Ghost const& g = r.ghost;
  Standing const& s = g.standing;
  SortedJson row = {{"number", g.number},
                    {"order", g.order},
                    {"route", r.route},
                    {"end", name_of(g.end)},
                    {"where", g.where.valid() ? SortedJson(report.groups.at(g.where.value)) : SortedJson(nullptr)},
                    {"side", g.front ? "front" : "back"},
                    {"power", g.power},
                    {"beside", g.clipped},
                    {"spot_major_m", g.spot.major},
                    {"spot_minor_m", g.spot.minor},
                    {"spot_axis", vector_json(g.spot.axis)},
                    {"point_m", vector_json(g.point)},
                    {"travel", vector_json(g.travel)},
                    {"path_length_m", g.path_length},
                    {"angle_rad", number(s.known ? s.angle : not_a_number)},
                    {"difference_m", number(s.known ? s.difference : not_a_number)},
                    {"against", s.against}};
  if (report.power > 0) row["power_W"] = g.power * report.power;
  if (s.recoupled.any && g.order > 0) {
    row["recoupled"] = s.recoupled.share();
    row["recoupled_against"] = s.recoupled.against;
  } else {
    row["recoupled"] = nullptr;
  }
  SortedJson steps = SortedJson::array(), points = SortedJson::array(), strain = SortedJson::object();
  for (PathStep const& step : r.steps)
    steps.push_back(fmt::format("{}·{}", report.groups.at(step.group.value), letter(step.event)));
  for (Vec3 const& p : r.points) points.push_back(vector_json(p));
  for (std::size_t i = 0; i < ghost_frequencies.size(); ++i)
    strain[fmt::format("{:g}", ghost_frequencies[i])] = number(r.strain[i]);
  row["steps"] = steps;
  row["points_m"] = points;
  if (report.has_noise) row["strain"] = strain;
  return row;
}

SortedJson ledger_json(GhostReport const& report) {
  BeamLedger const& l = report.ledger;
  SortedJson objects = SortedJson::array();
  for (std::size_t i = 0; i < l.objects.size(); ++i) {
    BeamLedger::Object const& o = l.objects[i];
    if (o.landed == 0 && o.beside == 0) continue;
    objects.push_back({{"object", report.groups[i]},
                       {"landed", double(o.landed)},
                       {"scattered", double(o.scattered)},
                       {"beside", double(o.beside)},
                       {"ghosts", double(o.ghosts)}});
  }
  return {{"objects", objects},           {"media", double(l.media)},
          {"escaped", double(l.escaped)}, {"rejoined", double(l.rejoined)},
          {"floor", double(l.floor)},     {"order", double(l.order)},
          {"longest", double(l.longest)}, {"wide", double(l.wide)},
          {"stopped", double(l.stopped)}, {"total", l.total()}};
}

SortedJson objects_json(GhostReport const& report) {
  SortedJson all = SortedJson::array();
  for (std::size_t i = 0; i < report.objects.size(); ++i) {
    GhostObject const& o = report.objects[i];
    if (!(o.ends > 0 || o.recoupled > 0)) continue;
    SortedJson entry = {{"object", report.groups[i]}, {"ghosts_end", o.ends}, {"recoupled_saved", o.recoupled}};
    if (report.has_noise)
      for (std::size_t k = 0; k < ghost_frequencies.size(); ++k)
        entry["strain_saved"][fmt::format("{:g}", ghost_frequencies[k])] = number(std::sqrt(o.strain2[k]));
    all.push_back(entry);
  }
  return all;
}

}  // namespace

std::string ghost_json(GhostReport const& report) {
  SortedJson rows = SortedJson::array();
  for (GhostRow const& r : report.rows) rows.push_back(row_json(report, r));
  SortedJson out = {{"beam", report.beam},
                    {"floor", report.floor},
                    {"passes", report.passes},
                    {"complete", !(report.ledger.stopped > 0)},
                    {"count", report.ghosts},
                    {"ghosts", rows},
                    {"objects", objects_json(report)},
                    {"ledger", ledger_json(report)},
                    {"recoupled_with", report.recoupled_with},
                    {"recoupled_against", report.recoupled_against},
                    {"warnings", report.warnings},
                    {"notes", report.notes}};
  if (report.power > 0) out["power_W"] = report.power;
  if (report.has_port)
    out["port"] = {{"name", report.port},
                   {"families", report.families},
                   {"recoupled", report.share},
                   {"sum", report.sum == GhostSum::coherent ? "coherent" : "independent"},
                   {"recoupled_as_drawn", report.coherent},
                   {"recoupled_powers_added", report.incoherent},
                   {"recoupled_worst_case", report.worst}};
  if (report.has_noise)
    for (std::size_t i = 0; i < ghost_frequencies.size(); ++i)
      out["strain"][fmt::format("{:g}", ghost_frequencies[i])] = number(report.strain[i]);
  return out.dump();
}

std::string ghost_csv_header(bool watts) {
  return fmt::format(
      "beam,number,order,route,end,where,side,power{},beside,spot_major_m,spot_minor_m,x_m,y_m,z_m,path_length_m,angle_"
      "rad,"
      "difference_m,direction,recoupled,h_10Hz,h_30Hz,h_100Hz\n",
      watts ? ",power_W" : "");
}

std::string ghost_csv(std::string const& beam, GhostRow const& r, std::string const& where, double power) {
  Ghost const& g = r.ghost;
  Standing const& s = g.standing;
  bool const back = s.recoupled.any && g.order > 0;
  std::string text = fmt::format("{},{},{},{},{},{},{},{:.17g}", csv_text(beam), g.number, g.order, csv_text(r.route),
                                 name_of(g.end), csv_text(where), g.front ? "front" : "back", g.power);
  if (power > 0) text += fmt::format(",{:.17g}", g.power * power);
  text += fmt::format(",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{},{},{},{}", g.clipped, g.spot.major,
                      g.spot.minor, g.point.x, g.point.y, g.point.z, g.path_length, csv_number(s.known, s.angle),
                      csv_number(s.known, s.difference), s.known ? (s.against ? "against" : "with") : "",
                      csv_number(back, back ? s.recoupled.share() : 0));
  for (double h : r.strain) text += ',' + csv_number(std::isfinite(h), h);
  return text + '\n';
}

}  // namespace straytrace
