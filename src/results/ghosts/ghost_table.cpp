// SPDX-License-Identifier: BSD-3-Clause
#include "results/ghosts/ghost_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/text/words.hpp"
#include "results/text/columns.hpp"

namespace straytrace {
namespace {

// The last main-beam surface counts: one row is greater than the other when it is stronger, or the earlier one.
bool stronger(GhostRow const& a, GhostRow const& b) {
  return a.key != b.key ? a.key > b.key : a.ghost.number < b.ghost.number;
}

std::uint32_t group_of(World const& world, BeamStep const& step) {
  return world.surfaces()[step.surface.value].group.value;
}

std::string end_of(World const& world, Ghost const& g) {
  if (g.end == BeamEnd::escaped) return "out";
  if (g.end == BeamEnd::rejoined) return "cavity";
  std::string const name = world.groups()[g.where.value];
  return name + (g.end == BeamEnd::landed  ? "·land"
                 : g.end == BeamEnd::faint ? "·faint"
                 : g.end == BeamEnd::wide  ? "·wide"
                                           : "·long");
}

// Departures, and the ways taken at splitters.
std::string route_of(World const& world, Ghost const& g) {
  std::string text = "main";
  for (BeamStep const& s : g.way)
    if (s.departure || s.split) text += fmt::format(" > {}·{}", world.groups()[group_of(world, s)], letter(s.event));
  return text + " > " + end_of(world, g);
}

// Calls f(group) once for each group that the ghost has left from its first departure to where it recouples.
template <class F>
void for_each_met(World const& world, Ghost const& g, F&& f) {
  std::set<std::uint32_t> seen;
  bool away = false;
  for (BeamStep const& s : g.way.first(std::min(g.way.size(), g.standing.recoupled.steps))) {
    away = away || s.departure;
    if (away && seen.insert(group_of(world, s)).second) f(group_of(world, s));
  }
}

// Whether a way there and back is its own reverse.
bool is_own_reverse(std::vector<PathStep> const& steps) {
  return std::equal(steps.begin(), steps.begin() + std::ptrdiff_t(steps.size() / 2), steps.rbegin());
}

}  // namespace

std::optional<PortId> ghost_port(World const& world, BeamLaunch const& launch, MainBeam const& main) {
  std::optional<PortId> best;
  double nearest = infinity;
  for (Footprint const& f : world.footprints()) {
    if (!f.port.valid() || f.beam != launch.beam) continue;
    for (MainNode const& node : main.nodes()) {
      bool const here = node.spot.surface == f.surface && dot(node.spot.mode.travel, f.travel) > 0.9 &&
                        length(node.spot.mode.origin - f.centre) < 1e-3 + f.radius;
      if (!here || node.spot.path_length >= nearest) continue;
      best = f.port;
      nearest = node.spot.path_length;
    }
  }
  return best;
}

GhostFamilies::GhostFamilies(World const& world, BeamLaunch const& launch, MainBeam const& main,
                             std::optional<PortId> port, GhostSum sum)
    : world_(world), main_(main), port_(port), sum_(sum), beam_share_(world.footprints()[launch.footprint].share) {}

std::optional<double> GhostFamilies::share_at_port(Ghost const& g) const {
  Recoupling const& r = g.standing.recoupled;
  if (!port_ || !r.any || !r.against || g.order == 0) return {};
  return beam_share_ * beam_share_ * r.share();
}

// Phase sensitivities to a millionth of the wave number; those that cancel are none.
GhostFamilies::Key GhostFamilies::key_of(std::vector<PhaseSensitivity> const& phase_sensitivities) const {
  double const unit = 1e-6 * 2 * pi / world_.wavelength;
  Key key;
  for (PhaseSensitivity const& l : phase_sensitivities)
    for (int i = 0; i < 6; ++i)
      if (long long const n = std::llround(l.d[i] / unit); n != 0)
        key.insert(key.end(), {static_cast<long long>(l.body.value) * 6 + i, n});
  return key;
}

void GhostFamilies::add(Ghost const& g) {
  auto const share = share_at_port(g);
  if (!share || !(*share > 0)) return;
  Recoupling const& r = g.standing.recoupled;
  std::vector<PhaseSensitivity> phase_sensitivities = main_.phase_sensitivities(r, g.way);
  Key const key = key_of(phase_sensitivities);
  auto at = place_.find(key);
  if (at == place_.end()) {
    if (families_.size() >= most) {
      ++left_out;
      left_out_share += *share;
      return;
    }
    at = place_.emplace(key, families_.size()).first;
    families_.emplace_back().phase_sensitivities = std::move(phase_sensitivities);
    families_.back().sum = sum_;
  }
  GhostFamily& f = families_[at->second];
  std::vector<PathStep> steps = there_and_back(g);
  double const reverse = is_own_reverse(steps) ? 1 : 2;  // C_rev: the reverse is another ghost with the same phase
  for (std::size_t i : {0, 1}) f.field[i] += beam_share_ * r.field[i];
  f.incoherent += reverse * *share;
  f.root_sum += std::sqrt(*share);
  ++f.ghosts;
  for_each_met(world_, g, [&](std::uint32_t group) { f.through[group] += reverse * *share; });
  if (*share <= f.largest) return;
  f.largest = *share;
  f.strongest = g.number;
  f.path_length = g.standing.difference;
  f.steps = std::move(steps);
}

std::vector<PathStep> GhostFamilies::there_and_back(Ghost const& g) const {
  Recoupling const& r = g.standing.recoupled;
  std::vector<PathStep> steps;
  for (BeamStep const& s : g.way.first(r.steps)) steps.push_back({{group_of(world_, s)}, s.event});
  std::vector<BeamStep> const& back = main_.nodes()[r.node].way;  // along the main beam, to the launch
  for (auto s = back.rbegin(); s != back.rend(); ++s) steps.push_back({{group_of(world_, *s)}, s->event});
  return steps;
}

GhostStrain GhostFamilies::strain_of(Ghost const& g) const {
  GhostStrain strain = {not_a_number, not_a_number, not_a_number};
  auto const share = share_at_port(g);
  if (!share) return strain;
  auto const at = place_.find(key_of(main_.phase_sensitivities(g.standing.recoupled, g.way)));
  if (at == place_.end()) return strain;
  for (std::size_t i = 0; i < strain.size(); ++i)
    strain[i] = std::sqrt(*share) * families_[at->second].per_root_power[i];
  return strain;
}

GhostTable::GhostTable(World const& world, BeamLaunch const& launch, GhostFamilies const& families, GhostRank rank,
                       std::size_t show)
    : world_(world), launch_(launch), families_(families), rank_(rank), show_(show), met_(world.groups().size()) {}

GhostRow GhostTable::row(Ghost const& g) const {
  GhostRow r;
  r.ghost = g;
  r.route = route_of(world_, g);
  r.end = end_of(world_, g);
  r.points.push_back(launch_.mode.origin);
  for (BeamStep const& s : g.way) {
    r.steps.push_back({{group_of(world_, s)}, s.event});
    r.points.push_back(s.point);
  }
  r.points.push_back(g.point);
  r.strain = families_.strain_of(g);
  return r;
}

void GhostTable::add(Ghost const& g) {
  if (by_order_.size() <= g.order) {
    by_order_.resize(g.order + 1);
    power_by_order_.resize(g.order + 1);
  }
  ++by_order_[g.order];
  power_by_order_[g.order] += g.power;
  Recoupling const& r = g.standing.recoupled;
  double const share = g.order > 0 && r.any ? r.share() : 0;
  if (g.order > 0) ++ghosts_;
  if (share > 0) {
    (r.against ? recoupled_against_ : recoupled_with_) += share;
    for_each_met(world_, g, [&](std::uint32_t group) { met_[group] += share; });
  }
  if (g.order == 0) return keep(main_, main_shown, g.power, g);
  double key = rank_ == GhostRank::power ? g.power : share;
  if (rank_ == GhostRank::strain) {
    GhostStrain const h = families_.strain_of(g);
    key = h[0];
    for (double x : h) key = std::fmax(key, x);
    if (std::isnan(key)) key = 0;
  }
  keep(heap_, show_, key, g);
}

void GhostTable::keep(std::vector<GhostRow>& heap, std::size_t most, double key, Ghost const& g) const {
  if (most == 0) return;
  bool const full = heap.size() >= most;
  GhostRow const* const least = full ? &heap.front() : nullptr;
  if (full && (key < least->key || (key == least->key && g.number > least->ghost.number))) return;
  GhostRow made = row(g);
  made.key = key;
  if (full) {
    std::pop_heap(heap.begin(), heap.end(), stronger);
    heap.pop_back();
  }
  heap.push_back(std::move(made));
  std::push_heap(heap.begin(), heap.end(), stronger);
}

std::vector<GhostRow> GhostTable::rows() const {
  auto sorted = heap_, main = main_;
  std::sort(sorted.begin(), sorted.end(), stronger);
  std::sort(main.begin(), main.end(), stronger);
  main.insert(main.end(), sorted.begin(), sorted.end());
  return main;
}

std::vector<GhostObject> GhostTable::objects(BeamEnergyBalance const& energy_balance) const {
  std::vector<GhostObject> objects(met_.size());
  for (std::size_t g = 0; g < met_.size(); ++g) {
    objects[g].ends = energy_balance.objects[g].ghosts;
    objects[g].recoupled = met_[g];
  }
  for (GhostFamily const& f : families_.all())
    for (auto const& [group, share] : f.through)
      for (std::size_t i = 0; i < 3; ++i)
        objects[group].strain2[i] += share * f.per_root_power[i] * f.per_root_power[i];
  return objects;
}

void GhostTable::fill(GhostReport& report) const {
  report.rows = rows();
  report.objects = objects(report.energy_balance);
  report.ghosts = ghosts_;
  report.by_order = by_order_;
  report.power_by_order = power_by_order_;
  report.recoupled_with = recoupled_with_;
  report.recoupled_against = recoupled_against_;
}

// The table of ghosts for people.

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
  GhostAlignment const& s = g.standing;
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

std::string energy_balance_text(GhostReport const& report) {
  BeamEnergyBalance const& l = report.energy_balance;
  double landed = 0, beside = 0;
  for (BeamEnergyBalance::Object const& o : l.objects) {
    landed += o.landed;
    beside += o.beside;
  }
  auto const part = [&](double share) { return watts(std::fabs(share) < 1e-15 ? 0 : share, report.power); };
  return fmt::format(
      "Energy balance of {}: {} absorbed or scattered on objects, {} beside their rims, {} absorbed in media, {} left "
      "the "
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

SortedJson vector_json(Vec3 v) { return {v.x, v.y, v.z}; }

SortedJson row_json(GhostReport const& report, GhostRow const& r) {
  Ghost const& g = r.ghost;
  GhostAlignment const& s = g.standing;
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
  for (GhostRow const& r : report.rows) rows.push_back(row_json(report, r));
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
  GhostAlignment const& s = g.standing;
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
