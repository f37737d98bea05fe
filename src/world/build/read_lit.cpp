// SPDX-License-Identifier: BSD-3-Clause
// The key `lit` of a beam: the beam propagates through the scene and illuminates the surfaces it meets.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text/words.hpp"
#include "beams/overlap.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::world {
namespace {

constexpr double least_watts = 1e-12;     // of a beam of the network
constexpr std::size_t most_spots = 2000;  // every vertex connects to each of them

// A part of a CAD file has many faces; the first bears its name, the others are NAME/face_2 and so on.
bool names_surface(std::string const& pattern, std::string const& name) {
  return matches(pattern, name) || matches(pattern + "/face_*", name);
}

// Patterns under a key; each must match the name of a surface, or of an entry whose problem is reported.
std::vector<std::string> patterns(Node const& table, std::string_view key, Registry const& names) {
  std::vector<std::string> all, known;
  for (auto const& [name, id] : names.surfaces) known.push_back(name);
  auto const words = table.list(key);
  if (table.has(key) && words.empty())
    table[key].problem(fmt::format("'{}' names no surface", key), "name surfaces, or remove the key");
  for (Node const& word : words) {
    std::string const pattern = all.emplace_back(word.as_word());
    if (word.kind() != Node::Kind::scalar) continue;  // reported
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
  if (lit.has("behind")) {
    wish.behind = lit.word("behind");
    if (!beam["cavity"])
      lit["behind"].problem("'behind' names the port behind the input mirror of a cavity, which this beam is not",
                            "remove it: 'network' says which light of the interferometer a beam is");
  }
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

// Behind an input mirror of an arm the light is that of the network (docs/theory/recoupling.md). Remembers it for when
// all beams are read.
bool continues_in_network(BeamLaunch const& launch, Node const& beam, LitWish const& wish, Lighting const& light) {
  if (!launch.through_input_mirror() || !light.network || !light.behind) return false;
  NetworkPowers const& network = *light.network;
  std::string const port = wish.behind.empty() ? network.behind_input : wish.behind;
  auto const space = network.spaces.find(port);
  if (space == network.spaces.end()) {
    if (wish.behind.empty() || network.faulty) return false;
    std::vector<std::string> known;
    for (auto const& [name, way] : network.spaces) known.push_back(name);
    beam["lit"]["behind"].problem(fmt::format("the interferometer has no port '{}' with a space", port),
                                  known.empty() ? "its network is not solved: write 'preset: dual-recycled' or 'none'"
                                                : did_you_mean(port, known, "name a port of a component: ITM.front"));
    return true;
  }
  for (std::string const& name : {port + ".out", space->second.source})
    if (network.watts.at(name) < least_watts) {
      beam["lit"].problem(fmt::format("no light runs in the beam '{}' behind '{}'", name, launch.name),
                          "name another port by 'behind', or write 'lit: {except: [...]}'");
      return true;
    }
  light.behind->push_back({beam, light.number, wish, launch.footprint, port});
  return true;
}

}  // namespace

void light_up(Node const& beam, LitWish const& wish, Registry const& names, World& world, Lighting const& light) {
  if (!beam.healthy()) return;
  world.build_search();
  Wanted const wanted(wish, names);
  std::size_t const before = world.footprints().size();
  bool in_network = false;
  for (BeamLaunch const& launch : launches(world)) {
    if (launch.beam != light.number) continue;
    bool const cavity = !launch.cavity.empty() && !launch.span;
    Collector list(!launch.cavity.empty() && launch.arrives_at.valid(), wanted, wish.floor);
    grow_tree(world, launch, {wish.floor, wish.order}, list);
    if (list.count > 0 && continues_in_network(launch, beam, wish, light)) {
      in_network = true;
      continue;
    }
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
  if (world.footprints().size() == before && !in_network)
    beam.warning(fmt::format("'lit' finds no surface in beam '{}'", light.name),
                 "a cavity needs a mirror that transmits; a free beam something that it meets");
}

namespace {

// The beam itself from its launch to where its space of the network ends: at a splitter, at a mirror that sends it
// straight back, or after the length of the space; 1 % and 10 cm longer in a drawing.
class SpanSink final : public BeamSink {
 public:
  SpanSink(BeamLaunch const& launch, double longest) : behind_mirror_(launch.arrives_at.valid()), longest_(longest) {}
  void arrived(BeamSpot const& spot, std::uint32_t number, std::span<BeamStep const> way) override {
    if (ended_ || spot.order > 0 || is_launch(way)) return;
    if (spot.path_length > longest_) {
      ended_ = true;
      return;
    }
    last = spot;
    number_ = number;
    cuts.push_back({spot.surface, 1});
  }
  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    if (beam.order > 0 || ended_ || is_launch(way)) return;
    leaving = beam;
    if (way.empty() || !last || way.back().spot != number_) return;
    if (way.back().event == Event::reflect) folded = last->surface;
    cuts.back().share = 1 - beam.field.power() / last->power;
    double const tolerance = 5 * beam.mode.wavelength / (pi * spot(beam.mode).minor);
    ended_ = at_component = way.back().split || angle_between(way.back().out, -way.back().in) < tolerance;
  }
  struct Cut {
    SurfaceId surface;
    double share = 0;  // of the power that does not go on
  };
  std::optional<BeamSpot> last;
  LeavingBeam leaving;        // behind the last spot from which it continues
  bool at_component = false;  // the last spot
  SurfaceId folded;           // the last mirror from which it continues
  std::vector<Cut> cuts;

 private:
  bool is_launch(std::span<BeamStep const> way) const { return behind_mirror_ && way.empty(); }
  bool behind_mirror_;
  double longest_;
  std::uint32_t number_ = BeamSpot::none;
  bool ended_ = false;
};

struct Reach {
  Mode end;           // of the light, where its span ends
  SurfaceId surface;  // there; invalid: in space
  std::uint32_t piece = 0;
  BeamField field;
  double path_length = 0;                // m, optical, from the launch
  std::vector<SpanSink::Cut> cuts = {};  // before that
  SurfaceId folded{};                    // the last mirror from which it continues to an end in space
  NetworkSpan::End end_of_span() const { return {surface, end.origin, end.travel, spot(end).major}; }
};

Reach reach_of(World const& world, BeamLaunch const& launch, double length) {
  double const longest = 1.01 * length + 0.1;
  SpanSink sink(launch, longest);
  grow_tree(world, launch, {1e-6, 0}, sink);
  if (sink.last && (sink.at_component || sink.last->path_length > 0.99 * length - 0.1)) {
    sink.cuts.pop_back();
    return {sink.last->mode, sink.last->surface, sink.last->piece, sink.last->field, sink.last->path_length, sink.cuts};
  }
  LeavingBeam const& free = sink.leaving;
  double const further = std::fmax(length - free.path_length, 1e-3);
  return {propagated(free.mode, further), {}, 0, free.field, free.path_length + further, sink.cuts, sink.folded};
}

// The network has nothing between the ends of the light.
void warn_of_obstacles(Node const& at, World const& world, std::string const& light, Reach const& reach) {
  constexpr double slight = 0.02;
  for (SpanSink::Cut const& cut : reach.cuts)
    if (cut.share > slight)
      at.warning(fmt::format("'{}' stands in the light '{}' and stops {:.3g} % of it", world.name_of(cut.surface),
                             light, 100 * cut.share),
                 "the network lets all of it pass there: move the object out of the beam, give it a hole, or add its "
                 "loss to the network");
}

// Power of a beam of the network over the reference of all couplings: the first beam with a stated power, or without
// any the light on the other side of the mirror.
double share_of(World const& world, NetworkPowers const& network, BehindMirror const& b, std::string const& light) {
  double reference = world.beam_power;
  std::string const component = b.port.substr(0, b.port.rfind('.'));
  if (!(reference > 0))
    for (auto const& [name, watts] : network.watts)
      if (name.starts_with(component + ".") && name.ends_with(".out")) reference = std::fmax(reference, watts);
  return network.watts.at(light) / reference;
}

// Returns the share of its power.
double add_beam(World& world, BehindMirror const& b, std::string const& light, NetworkPowers const& network) {
  double const share = share_of(world, network, b, light);
  world.beams.push_back({light, b.number, light, share});
  world.beam_powers.push_back(world.beam_power > 0 ? network.watts.at(light) : 0);
  return share;
}

// Beams of the scene are both lights already, or one of them, with a warning.
bool is_stated(BehindMirror const& b, std::string const& out, std::string const& in, NetworkPowers const& network) {
  bool const one = network.stated.contains(out), other = network.stated.contains(in);
  if (one != other)
    b.beam["lit"].warning(
        fmt::format("a beam of the scene is '{}', so that 'lit' does not follow '{}'", one ? out : in, one ? in : out),
        fmt::format("add a beam with 'network: {}', or remove that one", one ? in : out));
  return one || other;
}

// The names belong to another mirror or beam, with a problem.
bool is_taken(BehindMirror const& b, std::string const& out, std::string const& in, World const& world) {
  for (std::string const& name : {out, in})
    if (std::ranges::find(world.beams, name, &LightBeam::name) != world.beams.end()) {
      b.beam["lit"].problem(
          fmt::format("'{}' is a beam already, and would be the light behind '{}' too", name,
                      world.name_of(world.footprints()[b.mirror].surface)),
          "light one mirror, by 'only' or 'except', name the port behind another one by 'behind', or rename the beam");
      return true;
    }
  return false;
}

// A drawing and a network that do not agree name different places.
void warn_of_other_length(BehindMirror const& b, double drawn, double length) {
  if (std::fabs(drawn - length) < 0.2 * length + 0.5) return;
  b.beam["lit"].warning(
      fmt::format("behind '{}' the drawing has a splitter or mirror after {:.3g} m, and the network a "
                  "space of {:.3g} m at '{}'",
                  b.port.substr(0, b.port.rfind('.')), drawn, length, b.port),
      "name the port that faces it by 'behind', or correct one of the lengths");
}

void light_span(BehindMirror const& b, Registry const& names, World& world, std::uint32_t number) {
  Lighting light{world.beams[number].name, number};
  light_up(b.beam, b.wish, names, world, light);
}

// Of the cavity in front of the mirror, so that light between it and the beams behind has ports.
void name_mirror_lights(BehindMirror const& b, World& world, NetworkPowers const& network) {
  std::string const component = b.port.substr(0, b.port.rfind('.') + 1);
  auto const inner = std::ranges::find_if(
      network.spaces, [&](auto const& space) { return space.first.starts_with(component) && space.first != b.port; });
  if (inner == network.spaces.end()) return;
  world.mirror_lights.push_back({b.mirror, inner->first + ".in"});
  std::string const& far = inner->second.source;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i)
    if (Footprint const& f = world.footprints()[i];
        f.standing && i != b.mirror && f.beam == world.footprints()[b.mirror].beam)
      world.mirror_lights.push_back({i, far.substr(0, far.rfind('.')) + ".in"});
}

}  // namespace

void light_behind(BehindMirror const& b, Registry const& names, World& world, NetworkPowers const& network) {
  NetworkPowers::Space const& space = network.spaces.at(b.port);
  std::string const out = b.port + ".out";
  if (!b.beam.healthy() || is_stated(b, out, space.source, network) || is_taken(b, out, space.source, world)) return;
  Footprint f = world.footprints()[b.mirror];
  std::vector<SurfaceId> mirrors;
  for (Footprint const& other : world.footprints())
    if (other.standing && other.beam == f.beam) mirrors.push_back(other.surface);
  f.standing = f.emits = f.receives = false;
  f.port = {};
  f.share = add_beam(world, b, out, network);
  f.beam = std::uint32_t(world.beams.size() - 1);
  world.spans.push_back({std::uint32_t(world.footprints().size()), b.mirror, mirrors, {}, infinity});
  world.add_footprint(f);
  Reach const reach = reach_of(world, launches(world).back(), space.length);
  warn_of_other_length(b, reach.path_length, space.length);
  NetworkSpan::End const mirror{f.surface, f.centre, -f.travel, f.radius};
  world.spans.back().ends = {reach.end_of_span(), mirror};
  world.spans.back().longest = reach.path_length;
  warn_of_obstacles(b.beam["lit"], world, out, reach);
  light_span(b, names, world, f.beam);

  Mode const returns = reversed(reach.end);
  Footprint in = footprint_of(returns, world.wavelength / returns.wavelength);
  in.polarisation = polarisation_of(reach.field);
  in.free = true;
  in.emits = in.receives = false;
  in.share = add_beam(world, b, space.source, network);
  in.beam = std::uint32_t(world.beams.size() - 1);
  in.origin = world.add_group(space.source);
  world.spans.push_back({std::uint32_t(world.footprints().size()),
                         b.mirror,
                         mirrors,
                         {reach.end_of_span(), mirror},
                         reach.path_length + 1e-3,
                         {reach.surface, reach.piece}});
  world.add_footprint(in);
  light_span(b, names, world, in.beam);
  name_mirror_lights(b, world, network);
}

void end_in_network(Node const& beam, World& world, NetworkPowers const& network, std::string const& light) {
  auto const space = network.spaces.find(light.substr(0, light.rfind('.')));
  if (space == network.spaces.end()) return;
  Footprint const& f = world.footprints().back();
  world.spans.push_back({std::uint32_t(world.footprints().size() - 1), Feed::none, {}, {}, infinity});
  world.build_search();
  Reach const reach = reach_of(world, launches(world).back(), space->second.length);
  world.spans.back().ends = {reach.end_of_span(), {{}, f.centre, -f.travel, f.radius}};
  world.spans.back().longest = reach.path_length;
  warn_of_obstacles(beam["network"], world, light, reach);
  if (reach.folded.valid())
    beam["network"].warning(
        fmt::format("the light '{}' runs on behind the mirror '{}' for the rest of its space, {:.3g} m "
                    "from where the beam starts",
                    light, world.name_of(reach.folded), reach.path_length),
        "if this mirror ends the space, start the beam where the space begins");
}

}  // namespace straytrace::world
