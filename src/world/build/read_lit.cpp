// SPDX-License-Identifier: BSD-3-Clause
// The key `lit` of a beam: the beam propagates through the scene and illuminates the surfaces it meets.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text/words.hpp"
#include "beams/overlap.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/lit_surfaces.hpp"

namespace straytrace::world {
namespace {

constexpr std::size_t most_spots = 2000;  // every vertex connects to each of them

// A part of a CAD file has many faces; the first bears its name, the others are NAME/face_2 and so on.
bool names_surface(std::string const& pattern, std::string const& name) {
  return matches(pattern, name) || matches(pattern + "/face_*", name);
}

// Patterns under a key; each must match the name of a surface, or of an entry whose problem is reported.
std::vector<std::string> patterns(Node const& table, std::string_view key, Registry const& names) {
  std::vector<std::string> all, known;
  for (auto const& [name, id] : names.surfaces) known.push_back(name);
  for (Node const& word : table.list(key)) {
    std::string const pattern = all.emplace_back(word.as_word());
    auto const fits = [&](std::string const& name) { return names_surface(pattern, name); };
    if (is_refused(pattern, names) || std::ranges::any_of(known, fits)) continue;
    word.problem(fmt::format("'{}' is not a surface of the scene", pattern),
                 did_you_mean(pattern, known, "name entries of 'scene', or write a pattern such as \"bench/*\""));
  }
  return all;
}

class Wanted {
 public:
  Wanted(LitWish const& wish, Registry const& names) {
    for (auto const& [name, id] : names.surfaces) {
      auto const fits = [&name = name](std::string const& pattern) { return names_surface(pattern, name); };
      if (std::ranges::any_of(wish.only, fits)) only_.insert(id.value);
      if (std::ranges::any_of(wish.except, fits)) except_.insert(id.value);
    }
    all_ = wish.only.empty();
  }
  bool operator()(SurfaceId id) const { return (all_ || only_.contains(id.value)) && !except_.contains(id.value); }

 private:
  bool all_ = true;
  std::set<std::uint32_t> only_, except_;
};

}  // namespace

LitWish read_lit(Node const& beam, Registry const& names) {
  LitWish wish;
  if (!beam.has("lit")) return wish;
  Node const lit = beam["lit"];
  if (lit.kind() != Node::Kind::table) {
    wish.wanted = beam.flag("lit", false);
    return wish;
  }
  wish.wanted = true;
  wish.floor = lit.number("floor", dim::plain, wish.floor, 1e-15, 1);
  wish.order = std::uint32_t(lit.whole("order", wish.order, 0, 8));
  wish.only = patterns(lit, "only", names);
  wish.except = patterns(lit, "except", names);
  lit.refuse_unknown("'lit'");
  return wish;
}

namespace {

class Collector final : public BeamSink {
 public:
  struct Met {
    BeamSpot spot;
    std::vector<BeamStep> way;
  };
  struct Touched {
    ScreenSpot spot;
    std::vector<BeamStep> way;
  };
  Collector(bool behind_mirror, Wanted const& wanted, double floor)
      : behind_mirror_(behind_mirror), wanted_(wanted), floor_(floor) {}
  void arrived(BeamSpot const& spot, std::uint32_t, std::span<BeamStep const> way) override {
    if (behind_mirror_ && way.empty()) return;  // the mirror itself, lit by the mode of the cavity
    if (!wanted_(spot.surface)) return;
    if (++count <= most_spots) met.push_back({spot, {way.begin(), way.end()}});
  }
  void screened(ScreenSpot const& spot, std::span<BeamStep const> way) override {
    if (!wanted_(spot.screen.surface) || !(spot.power * spot.screen.share > floor_)) return;
    if (++count <= most_spots) touched.push_back({spot, {way.begin(), way.end()}});
  }
  std::vector<Met> met;
  std::vector<Touched> touched;
  std::size_t count = 0;

 private:
  bool behind_mirror_;
  Wanted const& wanted_;
  double floor_;
};

// Spots of the beam itself on one surface in one mode: the beam recombines there (a Michelson).
void warn_of_recombining(Node const& beam, std::string const& name, World const& world,
                         std::vector<Collector::Met> const& met) {
  constexpr double alike = 0.1;  // share of power in the other mode
  std::set<std::string> surfaces;
  for (std::size_t i = 0; i < met.size(); ++i)
    for (std::size_t j = i + 1; j < met.size(); ++j) {
      BeamSpot const &a = met[i].spot, &b = met[j].spot;
      if (a.order != 0 || b.order != 0 || a.surface != b.surface || a.front != b.front) continue;
      if (!(dot(a.mode.travel, b.mode.travel) > 0.9) || !(power_overlap(a.mode, b.mode) > alike)) continue;
      surfaces.insert(world.name_of(a.surface));
    }
  if (surfaces.empty()) return;
  std::string names;
  for (std::string const& s : surfaces) names += (names.empty() ? "'" : ", '") + s + "'";
  beam.warning(
      fmt::format("{} lit by '{}' on two ways that run together: their powers are added, not their fields",
                  names + (surfaces.size() == 1 ? " is" : " are"), name),
      "how fields add depends on path lengths that no drawing knows: leave one way, or state the light by 'on'");
}

// The worst spot of the beam itself on each object that is too small for it.
void warn_of_light_beside(Node const& beam, std::string const& name, World const& world,
                          std::vector<Collector::Met> const& met) {
  std::map<std::uint32_t, std::pair<double, int>> worst;  // by group: share beside it, spots
  for (auto const& [spot, way] : met) {
    if (spot.order > 0 || !(spot.clipped > 1e-3)) continue;
    auto& [share, spots] = worst[world.surfaces()[spot.surface.value].group.value];
    share = std::max(share, spot.clipped);
    ++spots;
  }
  for (auto const& [group, most] : worst)
    beam.warning(
        fmt::format("{}{:.2g} of the light of '{}' falls beside '{}'{}", most.second > 1 ? "up to " : "", most.first,
                    name, world.groups()[group], most.second > 1 ? fmt::format(", in {} spots", most.second) : ""),
        "enlarge it or move it into the beam: light that misses it is ignored");
}

}  // namespace

void light_up(Node const& beam, LitWish const& wish, Registry const& names, World& world, Lighting const& light) {
  if (!beam.healthy()) return;
  world.build_search();
  Wanted const wanted(wish, names);
  std::size_t const before = world.footprints().size();
  for (BeamLaunch const& launch : launches(world)) {
    if (launch.beam != light.number) continue;
    bool const cavity = !launch.cavity.empty();
    Collector list(cavity, wanted, wish.floor);
    grow_tree(world, launch, {wish.floor, wish.order}, list);
    if (list.count > most_spots)
      beam["lit"].problem(fmt::format("'{}' produces {} spots; the limit is {}", light.name, list.count, most_spots),
                          "raise 'floor', lower 'order', or restrict surfaces with 'only'");
    warn_of_recombining(beam, light.name, world, list.met);
    double const share = world.footprints()[launch.footprint].share;
    for (auto const& [spot, way] : list.met)
      add_lit_surface(world, light.number, share, cavity ? launch.footprint : Feed::none, spot, way);
    warn_of_light_beside(beam, light.name, world, list.met);
    for (auto const& [spot, way] : list.touched)
      add_lit_screen(world, light.number, share, cavity ? launch.footprint : Feed::none, spot, way);
  }
  if (world.footprints().size() == before)
    beam.warning(fmt::format("'lit' finds no surface in beam '{}'", light.name),
                 "a cavity needs a mirror that transmits; a free beam something that it meets");
}

}  // namespace straytrace::world
