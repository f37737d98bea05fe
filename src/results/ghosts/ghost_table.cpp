// SPDX-License-Identifier: BSD-3-Clause
#include "results/ghosts/ghost_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace straytrace::results {
namespace {

// The last main-beam surface counts: one row is greater than the other when it is stronger, or the earlier one.
bool stronger(GhostRow const& a, GhostRow const& b) {
  return a.key != b.key ? a.key > b.key : a.ghost.number < b.ghost.number;
}

std::uint32_t group_of(World const& world, BeamStep const& step) {
  return world.surfaces()[step.surface.value].group.value;
}

std::string end_of(World const& world, BeamLaunch const& launch, Ghost const& g) {
  if (g.end == BeamEnd::escaped) return "out";
  if (g.end == BeamEnd::rejoined) return launch.span ? "network" : "cavity";
  std::string const name = world.groups()[g.where.value];
  return name + (g.end == BeamEnd::landed  ? "·land"
                 : g.end == BeamEnd::faint ? "·faint"
                 : g.end == BeamEnd::wide  ? "·wide"
                                           : "·long");
}

// Departures, and the ways taken at splitters.
std::string route_of(World const& world, BeamLaunch const& launch, Ghost const& g) {
  std::string text = "main";
  for (BeamStep const& s : g.way)
    if (s.departure || s.split) text += fmt::format(" > {}·{}", world.groups()[group_of(world, s)], letter(s.event));
  return text + " > " + end_of(world, launch, g);
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

// Whether a round trip is its own reverse.
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
      bool const here = !node.screen && node.spot.surface == f.surface && dot(node.spot.mode.travel, f.travel) > 0.9 &&
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
    : world_(world), main_(main), port_(port), sum_(sum), beam_share_(world.footprints()[launch.footprint].share) {
  for (World::PortPair const& pair : world.port_pairs()) {
    if (pair.beam != launch.beam || !pair.forward || !port) continue;
    auto const to = std::ranges::find(world.footprints(), pair.to, &Footprint::port);
    bool const other = to->beam != launch.beam;
    forward_ = {pair.port, other ? world.beams[to->beam].share : beam_share_, other ? 0.5 : 1};
  }
}

double GhostFamilies::factor(bool against) const { return beam_share_ * (against ? beam_share_ : forward_->share); }

std::optional<double> GhostFamilies::share_at_port(Ghost const& g) const {
  Recoupling const& r = g.standing.recoupled;
  if (!port_ || !r.any || g.order == 0 || (!r.against && !forward_)) return {};
  return factor(r.against) * r.share();
}

// Phase sensitivities to a millionth of the wave number; those that cancel are none.
GhostFamilies::Key GhostFamilies::key_of(bool against, std::vector<PhaseSensitivity> const& phase_sensitivities) const {
  double const unit = 1e-6 * 2 * pi / world_.wavelength;
  Key key = {against};
  for (PhaseSensitivity const& l : phase_sensitivities)
    for (int i = 0; i < 6; ++i)
      if (long long const n = std::llround(l.d[i] / unit); n != 0)
        key.insert(key.end(), {static_cast<long long>(l.body.value) * 6 + i, n});
  return key;
}

// The delays of a family are those of its strongest ghost. A body that only one of both lists moves no phase.
void take_moments(std::vector<PhaseSensitivity>& to, std::vector<PhaseSensitivity> const& from) {
  for (PhaseSensitivity& s : to) {
    auto const at = std::ranges::find(from, s.body, &PhaseSensitivity::body);
    if (at != from.end()) std::ranges::copy(at->moment, s.moment);
  }
}

// A weaker route makes room for a stronger one and joins the rest.
void GhostFamilies::add_part(GhostFamily& f, GhostPart part, Ghost const& g) {
  auto const same = std::ranges::find(f.parts, part.steps, &GhostPart::steps);
  if (same != f.parts.end()) {
    same->share += part.share;
    if (!(part.largest > same->largest)) return;
    same->largest = part.largest;
    same->path_length = part.path_length;
    same->levers = levers_of(g);
    return;
  }
  if (f.parts.empty() || (f.parts.size() < most_parts && parts_ < most)) {
    part.levers = levers_of(g);
    f.parts.push_back(std::move(part));
    ++parts_;
    return;
  }
  auto const weakest = std::ranges::min_element(f.parts, {}, &GhostPart::share);
  if (weakest->share < part.share) {
    part.levers = levers_of(g);
    std::swap(*weakest, part);
  }
  ++f.others;
  double const share = f.rest.share + part.reverse * part.share;
  if (part.largest > f.rest.largest) f.rest = std::move(part);
  f.rest.share = share;
  f.rest.reverse = 1;
}

void GhostFamilies::add(Ghost const& g) {
  auto const share = share_at_port(g);
  if (!share || !(*share > 0)) return;
  Recoupling const& r = g.standing.recoupled;
  std::vector<PhaseSensitivity> phase_sensitivities = main_.phase_sensitivities(r, g.way);
  Key const key = key_of(r.against, phase_sensitivities);
  auto at = place_.find(key);
  if (at == place_.end()) {
    if (families_.size() >= most) {
      ++left_out;
      left_out_share += *share;
      return;
    }
    at = place_.emplace(key, families_.size()).first;
    families_.emplace_back().phase_sensitivities = phase_sensitivities;
    families_.back().sum = sum_;
    families_.back().port = r.against ? *port_ : forward_->port;
  }
  for (RimSlope const& cut : main_.rims_without_lever(r)) {
    double& largest = rims_left_out[cut.by.value];
    largest = std::max(largest, 2 * std::abs(cut.of_taken) * cut.taken * *share);
  }
  GhostFamily& f = families_[at->second];
  std::vector<PathStep> steps = steps_of(g);
  // C_rev: the reverse is another ghost with the same phase, or the same light found from the other beam.
  double const reverse = !r.against ? forward_->reverse : is_own_reverse(steps) ? 1 : 2;
  double const field = std::sqrt(factor(r.against) * (r.against ? 1 : reverse));
  for (std::size_t i : {0, 1}) f.field[i] += field * r.field[i];
  f.incoherent += reverse * *share;
  f.root_sum += std::sqrt(*share);
  ++f.ghosts;
  for_each_met(world_, g, [&](std::uint32_t group) { f.through[group] += reverse * *share; });
  add_part(f, {steps, *share, reverse, *share, g.standing.difference}, g);
  if (*share <= f.largest) return;
  f.largest = *share;
  f.strongest = g.number;
  f.levers = levers_of(g);
  f.path_length = g.standing.difference;
  take_moments(f.phase_sensitivities, phase_sensitivities);
  f.steps = std::move(steps);
}

std::vector<PathStep> GhostFamilies::steps_of(Ghost const& g) const {
  Recoupling const& r = g.standing.recoupled;
  std::vector<PathStep> steps;
  for (BeamStep const& s : g.way.first(r.steps)) steps.push_back({{group_of(world_, s)}, s.event});
  if (!r.against) return steps;
  std::vector<BeamStep> const& back = main_.nodes()[r.node].way;  // along the main beam, to the launch
  for (auto s = back.rbegin(); s != back.rend(); ++s) steps.push_back({{group_of(world_, *s)}, s->event});
  return steps;
}

GhostStrain GhostFamilies::strain_of(Ghost const& g) const {
  GhostStrain strain = {not_a_number, not_a_number, not_a_number};
  auto const share = share_at_port(g);
  if (!share) return strain;
  auto const at =
      place_.find(key_of(g.standing.recoupled.against, main_.phase_sensitivities(g.standing.recoupled, g.way)));
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
  r.route = route_of(world_, launch_, g);
  r.end = end_of(world_, launch_, g);
  r.points.push_back(launch_.mode.origin);
  for (BeamStep const& s : g.way) {
    r.steps.push_back({{group_of(world_, s)}, s.event});
    r.points.push_back(s.point);
  }
  r.points.push_back(g.point);
  r.levers = families_.levers_of(g);
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

}  // namespace straytrace::results
