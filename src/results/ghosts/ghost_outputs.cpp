// SPDX-License-Identifier: BSD-3-Clause
// The table of ghosts as text, CSV and JSON.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "results/ghosts/ghost_table.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {
namespace {

std::string watts(double share, double power) {
  return power > 0 ? fmt::format("{:.3g} W", share * power) : fmt::format("{:.3g}", share);
}

std::string spot_text(Spot const& s) {
  return s.major < 1.005 * s.minor ? fmt::format("{:.3g}", 1e3 * s.major)
                                   : fmt::format("{:.3g}x{:.3g}", 1e3 * s.major, 1e3 * s.minor);
}

}  // namespace

// A ghost of a beam of some power [W], 0: not stated.
struct GhostLine {
  std::string const& beam;
  GhostRow const& row;
  std::string const& where;
  double power;
  std::vector<std::string> const& bodies;

  Ghost const& ghost() const { return row.ghost; }
  GhostAlignment const& alignment() const { return row.ghost.standing; }
  bool back() const { return alignment().recoupled.any && ghost().order > 0; }
  double recoupled() const { return back() ? alignment().recoupled.share() : not_a_number; }
};

namespace {

using GhostList = std::vector<TableColumn<GhostLine>>;
using GhostJson = nlohmann::ordered_json;

std::string angle_text(GhostLine const& l) {
  GhostAlignment const& s = l.alignment();
  double const angle = s.angle > 1e-12 ? s.angle : 0;  // below: rounding
  return s.known ? fmt::format("{:.4g}{}", 1e3 * angle, s.against ? " back" : "") : "-";
}

GhostJson vector_json(Vec3 v) { return {v.x, v.y, v.z}; }

// clang-format off

void add_ghost_names(GhostList& all) {
  all.push_back({.key = "beam", .kind = ColumnKind::text, .help = "that is launched",
    .value = [](GhostLine const& l) { return l.beam; }, .csv = {10}});
  all.push_back({.key = "number", .kind = ColumnKind::count, .help = "in the order of their search",
    .value = [](GhostLine const& l) { return l.ghost().number; }, .csv = {20}, .json = {10}});
  all.push_back({.key = "order", .kind = ColumnKind::count,
    .help = "partial reflections and transmissions; 0: main beam",
    .value = [](GhostLine const& l) { return std::uint64_t{l.ghost().order}; },
    .text = {10}, .csv = {30}, .json = {10}, .page = {10}});
  all.push_back({.key = "route", .kind = ColumnKind::text, .help = "departures, and ways taken at splitters",
    .value = [](GhostLine const& l) { return l.row.route; },
    .text = {200}, .csv = {40}, .json = {10}, .page = {20}, .left = true});
  all.push_back({.key = "end", .kind = ColumnKind::text, .help = "how it ends",
    .value = [](GhostLine const& l) { return std::string(name_of(l.ghost().end)); }, .csv = {50}, .json = {10}});
  all.push_back({.key = "end_where", .kind = ColumnKind::text, .help = "how and on which object it ends",
    .value = [](GhostLine const& l) {
      return std::string(name_of(l.ghost().end)) + (l.where.empty() ? "" : " " + l.where); }, .page = {30, "end"}});
  all.push_back({.key = "where", .kind = ColumnKind::text, .help = "object on which it ends",
    .value = [](GhostLine const& l) { return l.where; }, .csv = {60}, .json = {10},
    .as_json = [](GhostLine const& l) { return l.where.empty() ? GhostJson(nullptr) : GhostJson(l.where); }});
  all.push_back({.key = "side", .kind = ColumnKind::text, .help = "of that object",
    .value = [](GhostLine const& l) { return std::string(l.ghost().front ? "front" : "back"); },
    .csv = {70}, .json = {10}});
}

// `watts`: with a column of watts.
void add_ghost_powers(GhostList& all, bool watts) {
  int const of_watts = watts;
  all.push_back({.key = "power", .unit = "1", .help = "over that of the launched beam",
    .value = [](GhostLine const& l) { return l.ghost().power; },
    .text = {30, "relative"}, .csv = {80}, .json = {10}, .page = {40, "power / launched"}});
  all.push_back({.key = "power_W", .unit = "W", .help = "power",
    .value = [](GhostLine const& l) { return l.ghost().power * l.power; },
    .text = {20 * of_watts, "power/W"}, .csv = {90 * of_watts}, .json = {10 * of_watts},
    .page = {50 * of_watts, "power [W]"}});
  all.push_back({.key = "beside", .unit = "1", .help = "fraction of its power that passes beside the last surface",
    .value = [](GhostLine const& l) { return l.ghost().clipped; },
    .text = {50}, .csv = {100}, .json = {10}, .format = "{:.2g}",
    .as_text = [](GhostLine const& l) {
      return l.ghost().clipped > 1e-12 ? fmt::format("{:.2g}", l.ghost().clipped) : "-"; }});
  all.push_back({.key = "recoupled", .unit = "1", .help = "fraction of it that returns into the mode",
    .value = [](GhostLine const& l) { return l.recoupled(); },
    .text = {80}, .csv = {190}, .json = {10}, .page = {80, "recoupled fraction"}});
  all.push_back({.key = "recoupled_against", .kind = ColumnKind::flag,
    .help = "whether it returns against the main beam",
    .json = {10}, .as_json = [](GhostLine const& l) {
      return l.back() ? GhostJson(l.alignment().recoupled.against) : GhostJson(GhostJson::value_t::discarded); }});
}

void add_ghost_shape(GhostList& all) {
  all.push_back({.key = "spot", .unit = "mm", .help = "1/e^2 radii where it ends", .text = {40, "spot/mm"},
    .as_text = [](GhostLine const& l) { return spot_text(l.ghost().spot); }});
  all.push_back({.key = "spot_major_m", .unit = "m", .help = "larger 1/e^2 radius where it ends",
    .value = [](GhostLine const& l) { return l.ghost().spot.major; },
    .csv = {110}, .json = {10}, .page = {60, "spot [mm]", 1000}});
  all.push_back({.key = "spot_minor_m", .unit = "m", .help = "smaller 1/e^2 radius where it ends",
    .value = [](GhostLine const& l) { return l.ghost().spot.minor; }, .csv = {120}, .json = {10}});
  all.push_back({.key = "spot_axis", .kind = ColumnKind::list, .help = "direction of the larger radius", .json = {10},
    .as_json = [](GhostLine const& l) { return vector_json(l.ghost().spot.axis); }});
  constexpr double Vec3::*components[] = {&Vec3::x, &Vec3::y, &Vec3::z};
  for (std::size_t i = 0; i < 3; ++i)
    all.push_back({.key = std::string(1, "xyz"[i]) + "_m", .unit = "m", .help = "place where it ends",
      .value = [c = components[i]](GhostLine const& l) { return l.ghost().point.*c; }, .csv = {130}});
  all.push_back({.key = "point_m", .kind = ColumnKind::list, .unit = "m", .help = "place where it ends", .json = {10},
    .as_json = [](GhostLine const& l) { return vector_json(l.ghost().point); }});
  all.push_back({.key = "travel", .kind = ColumnKind::list, .help = "direction of travel there", .json = {10},
    .as_json = [](GhostLine const& l) { return vector_json(l.ghost().travel); }});
  all.push_back({.key = "points_m", .kind = ColumnKind::list, .unit = "m", .help = "its way from the launch",
    .json = {10},
    .as_json = [](GhostLine const& l) {
      GhostJson points = GhostJson::array();
      for (Vec3 const& p : l.row.points) points.push_back(vector_json(p));
      return points; }});
}

void add_ghost_alignment(GhostList& all) {
  all.push_back({.key = "path_length_m", .unit = "m", .help = "optical path from the launch",
    .value = [](GhostLine const& l) { return l.ghost().path_length; },
    .csv = {140}, .json = {10}, .page = {70, "path [m]", 1, 6}});
  all.push_back({.key = "angle_rad", .unit = "rad", .help = "to the main beam",
    .value = [](GhostLine const& l) { return l.alignment().known ? l.alignment().angle : not_a_number; },
    .text = {60, "angle/mrad"}, .csv = {150}, .json = {10}, .as_text = angle_text});
  all.push_back({.key = "difference_m", .unit = "m", .help = "optical path over that of the main beam",
    .value = [](GhostLine const& l) { return l.alignment().known ? l.alignment().difference : not_a_number; },
    .text = {70, "difference/mm"}, .csv = {160}, .json = {10},
    .as_text = [](GhostLine const& l) {
      return l.alignment().known ? fmt::format("{:.5g}", 1e3 * l.alignment().difference) : "-"; }});
  all.push_back({.key = "direction", .kind = ColumnKind::text, .help = "with or against the main beam",
    .value = [](GhostLine const& l) {
      return std::string(!l.alignment().known ? "" : l.alignment().against ? "against" : "with"); }, .csv = {170}});
  all.push_back({.key = "against", .kind = ColumnKind::flag, .help = "whether it travels against the main beam",
    .value = [](GhostLine const& l) { return l.alignment().against; }, .json = {10}});
}

// The largest part of one kind, and the coordinate that it belongs to.
struct LargestLever {
  std::complex<double> value = 0;
  std::string coordinate;  // "BS ry"; empty: none
};
LargestLever largest_lever(GhostLine const& l, bool turns) {
  static constexpr char const* names[] = {"x", "y", "z", "rx", "ry", "rz"};
  LargestLever largest;
  for (OverlapLever const& lever : l.row.levers)
    for (std::size_t i = turns ? 3 : 0; i < (turns ? 6u : 3u); ++i)
      if (std::abs(lever.d[i]) > 1.001 * std::abs(largest.value))
        largest = {lever.d[i], fmt::format("{} {}", l.bodies.at(lever.body.value), names[i])};
  return largest;
}

std::string lever_text(GhostLine const& l) {
  double const amplitude = l.back() ? largest_lever(l, true).value.real() : 0;
  return std::fabs(amplitude) > 0.5 ? fmt::format("{:.2g}", amplitude) : "-";
}

// Re and Im of all six coordinates, by body.
GhostJson levers_json(GhostLine const& l) {
  GhostJson all = GhostJson::object();
  for (OverlapLever const& lever : l.row.levers) {
    GhostJson& of_body = all[l.bodies.at(lever.body.value)] = GhostJson::array();
    for (std::complex<double> const d : lever.d) of_body.push_back({d.real(), d.imag()});
  }
  return all;
}

// `shown`: in the text; some row has one.
void add_ghost_levers(GhostList& all, bool shown) {
  all.push_back({.key = "lever", .kind = ColumnKind::text, .unit = "1/rad",
    .help = "change of ln |s| by the rotation that changes ln s most, without the phase at the hits (eq. N.27)",
    .text = {85 * shown, "lever*rad"}, .as_text = lever_text});
  all.push_back({.key = "lever_of", .kind = ColumnKind::text, .help = "body and axis of that rotation",
    .value = [](GhostLine const& l) { return l.back() ? largest_lever(l, true).coordinate : std::string(); },
    .csv = {195}});
  for (bool const turns : {false, true})
    for (bool const real : {true, false})
      all.push_back({.key = fmt::format("lever_{}_{}", turns ? "rotation" : "shift", real ? "re" : "im"),
        .unit = turns ? "1/rad" : "1/m",
        .help = fmt::format("{} part of the largest change of ln s by a {}", real ? "real" : "imaginary",
                            turns ? "rotation" : "translation"),
        .value = [turns, real](GhostLine const& l) {
          if (!l.back()) return not_a_number;
          std::complex<double> const d = largest_lever(l, turns).value;
          return real ? d.real() : d.imag(); },
        .csv = {195}});
  all.push_back({.key = "levers", .kind = ColumnKind::list, .unit = "1/m, 1/rad",
    .help = "complex levers beyond the phase at the hits, by body: x, y, z, then rotations, each [Re, Im]",
    .json = {10}, .as_json = [](GhostLine const& l) {
      return l.back() ? levers_json(l) : GhostJson(GhostJson::value_t::discarded); }});
}

void add_ghost_strain(GhostList& all, bool noise) {
  for (std::size_t i = 0; i < ghost_frequencies.size(); ++i) {
    double const hz = ghost_frequencies[i];
    all.push_back({.key = fmt::format("h_{:g}Hz", hz), .unit = "1/√Hz", .help = "strain ASD of this ghost alone",
      .value = [i](GhostLine const& l) { return l.row.strain[i]; },
      .text = {90 * noise, fmt::format("h({:g} Hz)", hz)}, .csv = {200},
      .page = {90 * noise, fmt::format("h({:g} Hz) [1/√Hz]", hz)}, .format = "{:.2g}"});
  }
  all.push_back({.key = "strain", .kind = ColumnKind::list, .unit = "1/√Hz", .help = "by frequency in Hz",
    .json = {10 * noise}, .as_json = [](GhostLine const& l) {
      GhostJson strain;
      for (std::size_t i = 0; i < ghost_frequencies.size(); ++i)
        strain[fmt::format("{:g}", ghost_frequencies[i])] = l.row.strain[i];
      return strain; }});
}

// clang-format on

GhostList ghost_columns(bool watts, bool noise, bool levers = false) {
  GhostList all;
  add_ghost_names(all);
  add_ghost_powers(all, watts);
  add_ghost_shape(all);
  add_ghost_alignment(all);
  add_ghost_levers(all, levers);
  add_ghost_strain(all, noise);
  return all;
}

GhostLine line_of(GhostReport const& report, GhostRow const& r) {
  static std::string const none;
  return {report.beam, r, r.ghost.where.valid() ? report.groups.at(r.ghost.where.value) : none, report.power,
          report.bodies};
}

std::string rows_text(GhostReport const& report) {
  constexpr double faint = 1e-12;  // of the strongest: its lever does not matter
  double strongest = 0;
  for (GhostRow const& r : report.rows) strongest = std::fmax(strongest, line_of(report, r).recoupled());
  bool const levers = std::ranges::any_of(report.rows, [&](GhostRow const& r) {
    GhostLine const line = line_of(report, r);
    return line.recoupled() > faint * strongest && lever_text(line) != "-";
  });
  TableWriter<GhostLine> const list(ghost_columns(report.power > 0, report.has_noise, levers));
  Columns table = list.text_head();
  std::uint64_t main = 0;
  for (GhostRow const& r : report.rows) {
    main += r.ghost.order == 0;
    table.rows.push_back(list.text_row(line_of(report, r)));
  }
  std::uint64_t const ends = report.by_order.empty() ? 0 : report.by_order[0], ghosts = report.rows.size() - main;
  std::string more;
  if (ends > main)
    more += counted(ends - main, "weaker end") +
            (ends - main == 1 ? " of the main beam is not shown. " : " of the main beam are not shown. ");
  if (report.ghosts > ghosts) more += counted(report.ghosts - ghosts, "more ghost") + "; --show N has more rows.";
  std::string const shortened = shorten_routes(table) ? explanation_of_shortened : "";
  return aligned(table) + shortened + more + (more.empty() ? "" : "\n");
}

std::string orders_text(GhostReport const& report) {
  std::string text;
  for (std::size_t order = 1; order < report.by_order.size(); ++order)
    text += fmt::format("{}{} of order {} ({})", order > 1 ? ", " : "", report.by_order[order], order,
                        watts(report.power_by_order[order], report.power));
  return text;
}

std::string energy_balance_text(GhostReport const& report) {
  BeamEnergyBalance const& l = report.energy_balance;
  double landed = 0, beside = 0;
  for (BeamEnergyBalance::Object const& o : l.objects) {
    landed += o.landed;
    beside += o.beside;
  }
  auto const part = [&](double share) { return watts(std::fabs(share) < 1e-15 ? 0 : share, report.power); };
  return fmt::format(
      "Energy balance of {}: {} absorbed or scattered on objects, {} outside their edges, {} absorbed in media, {} "
      "left the scene, {} back in the cavity or its mode; not followed: {} below the floor, {} beyond the order, {} "
      "beyond {} surfaces{}. Sum less 1: {:.1e}.\n",
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
  Columns table{{"mitigation ranking", report.power > 0 ? "ghosts end there/W" : "ghosts end there", "recoupled saved"},
                {true},
                {}};
  if (report.has_noise)
    for (double hz : ghost_frequencies) table.titles.push_back(fmt::format("h({:g} Hz) saved", hz));
  for (std::size_t const i : order) {
    GhostObject const& o = report.objects[i];
    bool const ends = o.ends > rounding;
    if (table.rows.size() >= show || !(ends || o.recoupled > 0)) continue;
    std::vector<std::string> row = {report.groups[i],
                                    ends ? finite_text(o.ends * (report.power > 0 ? report.power : 1), "{:.3g}") : "-",
                                    o.recoupled > 0 ? finite_text(o.recoupled, "{:.3g}") : "-"};
    if (report.has_noise)
      for (double h2 : o.strain2) row.push_back(h2 > 0 ? finite_text(std::sqrt(h2), "{:.2g}") : "-");
    table.rows.push_back(row);
  }
  return table.rows.empty() ? "No ghost meets an object.\n" : aligned(table);
}

std::string sums_text(GhostReport const& report) {
  std::string text = fmt::format(
      "Recoupled, each ghost once where it aligns: {:.3g} with the main beam, {:.3g} against it, back to the "
      "launch.\n",
      report.recoupled_with, report.recoupled_against);
  if (report.has_port && report.families == 0) return text + fmt::format("No ghost reaches port {}.\n", report.port);
  if (report.has_port)
    text += fmt::format(
        "At port {}: {:.3g} of the main mode in {} families of equal phase sensitivities, {} within each. Powers "
        "added: {:.3g}; "
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
  if (report.energy_balance.stopped > 0)
    text += fmt::format("Stopped early: {} of the light was not followed; sums and rows are of the rest.\n",
                        watts(report.energy_balance.stopped, report.power));
  text += rows_text(report) + '\n' + objects_text(report, objects_shown) + '\n' + sums_text(report) +
          energy_balance_text(report);
  for (std::string const& warning : report.warnings) text += "Warning: " + warning + ".\n";
  for (std::string const& note : report.notes) text += note + '\n';
  return text;
}

// The table of ghosts for programs.

namespace {

using SortedJson = nlohmann::json;

SortedJson number(double x) { return std::isfinite(x) ? SortedJson(x) : SortedJson(nullptr); }

SortedJson row_json(TableWriter<GhostLine> const& list, GhostReport const& report, GhostRow const& r) {
  SortedJson row(list.json_row(line_of(report, r)));
  row["steps"] = SortedJson::array();
  for (PathStep const& step : r.steps)
    row["steps"].push_back(fmt::format("{}·{}", report.groups.at(step.group.value), letter(step.event)));
  return row;
}

SortedJson energy_balance_json(GhostReport const& report) {
  BeamEnergyBalance const& l = report.energy_balance;
  SortedJson objects = SortedJson::array();
  for (std::size_t i = 0; i < l.objects.size(); ++i) {
    BeamEnergyBalance::Object const& o = l.objects[i];
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
  TableWriter<GhostLine> const list(ghost_columns(report.power > 0, report.has_noise));
  for (GhostRow const& r : report.rows) rows.push_back(row_json(list, report, r));
  SortedJson out = {{"beam", report.beam},
                    {"floor", report.floor},
                    {"passes", report.passes},
                    {"complete", !(report.energy_balance.stopped > 0)},
                    {"count", report.ghosts},
                    {"ghosts", rows},
                    {"objects", objects_json(report)},
                    {"energy_balance", energy_balance_json(report)},
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
  return json_text(out);
}

nlohmann::ordered_json ghost_page_table(GhostReport const& report) {
  std::vector<GhostLine> lines;
  for (GhostRow const& r : report.rows) lines.push_back(line_of(report, r));
  return TableWriter<GhostLine>(ghost_columns(report.power > 0, report.has_noise)).page_table(lines);
}

struct GhostCsv::List : TableWriter<GhostLine> {
  using TableWriter::TableWriter;
};

GhostCsv::GhostCsv(bool watts) : list_(std::make_unique<List>(ghost_columns(watts, false))) {}
GhostCsv::~GhostCsv() = default;

std::string GhostCsv::head() const { return list_->csv_head(); }

std::string GhostCsv::row(std::string const& beam, GhostRow const& row, std::string const& where, double power,
                          std::vector<std::string> const& bodies) const {
  return list_->csv_row({beam, row, where, power, bodies});
}

}  // namespace straytrace::results
