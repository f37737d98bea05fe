// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/coupling_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "base/errors.hpp"
#include "base/process/threads.hpp"
#include "trace/step/path.hpp"
#include "trace/tally/history_tally.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::trace {

namespace {

// Light of one beam of a network that joins another. The response holds the reverse (docs/theory/interferometer.md, eq.
// N.12), so that where both are traced they are two estimates of one coupling. Routes without names may begin or end at
// either mirror of a cavity: their response is not known.
void describe_pair(MadeClass& made, World const& world, Footprint const& source, Footprint const& goal, bool other) {
  PortId const port = world.port_between(source, goal);
  if (port == goal.port) return;
  made.row.port = other && (source.standing || goal.standing) ? PortId{} : port;
  bool const both = source.receives && source.port.valid() && goal.emits && !source.free && !goal.free;
  if (both) made.row.reverse = 0.5;
}

// Properties common to all paths of a route. A path that rejoins the mode it left adds in amplitude to its reverse.
void describe(MadeClass& made, World const& world, ReplayedPath const& path) {
  CouplingClass& c = made.row;
  auto const& beams = world.footprints();
  Footprint const& source = beams[path.source];
  Footprint const* const goal = path.goal < beams.size() ? &beams[path.goal] : nullptr;
  bool const two_ways = path.vertices.size() > 1 && goal && source.beam == goal->beam;
  c.reverse = has_reverse(world, path.vertices, path.source, path.goal) ? 2 : 1;
  if (goal && source.beam != goal->beam) describe_pair(made, world, source, *goal, path.other);
  made.beam = source.beam;
  made.back = source.port;
  if (path.other) return;
  for (PassedVertex const& v : path.vertices) c.steps.push_back({v.group, v.event});
  if (source.free) c.steps.front().event = Event::start;
  made.reversible = two_ways && !source.free && backwards(c.steps) != c.steps;
}
// One group may hold footprints of several ports: then the reverse is more than one class.
bool turns_round(World const& world, MadeClass const& made, ReplayedScore const& path) {
  Footprint const &source = world.footprints()[path.source], &goal = world.footprints()[path.goal];
  return source.receives && source.port.valid() && source.port == made.back && goal.emits && !goal.free;
}

// `paths`: of the kept scores; their phase sensitivities go to the records.
MadeClass make_class(SteeredWorld const& steered, std::uint64_t hash, ClassSums const& sums, BlockSums const& total,
                     std::uint64_t seed, std::span<ReplayedScore> paths) {
  World const& world = steered;
  MadeClass made;
  made.moments = sums.moments;
  CouplingClass& c = made.row;
  c.hash = hash;
  c.port = {sums.port};
  c.coupling = estimate_of_light(sums.moments, total.histories, total.blocks);
  c.off_list = sums.off_list / double(total.histories);
  c.replica_sum = sums.replica_sum;
  double weights = 0;
  for (ScoreAddress const& kept : sums.kept) weights += std::max(kept.coupling, sums.threshold);
  if (!sums.kept.empty()) {
    ScoreAddress const& first = sums.kept.front();
    describe(made, world, replay(steered, seed, first.history, first.event, first.connection).value());
  }
  c.records.reserve(sums.kept.size());
  for (std::size_t i = 0; i < sums.kept.size(); ++i) {
    ScoreAddress const& kept = sums.kept[i];
    ReplayedScore& path = paths[i];
    made.reversible = made.reversible && turns_round(world, made, path);
    c.records.push_back({kept.history, kept.event, kept.connection, kept.coupling,
                         std::max(kept.coupling, sums.threshold) / weights * c.coupling.mean, path.path_length,
                         std::move(path.phase_sensitivities)});
    std::uint32_t const beam = world.footprints()[path.source].beam;
    c.records.back().beam = beam < world.beams.size() ? world.beams[beam].entry : beam;
  }
  c.phase_sensitivities =
      phase_sensitivity_moments(c, sums.phase_sensitivities, sums.threshold == 0, total.histories, steered.block_size);
  return made;
}

std::vector<MadeClass> make_classes(SteeredWorld const& steered, BlockSums const& total, std::uint64_t seed,
                                    unsigned threads, ReplayScores const& replay) {
  struct Route {
    std::uint64_t hash;
    ClassSums const* sums;
    std::size_t first;  // of its scores
  };
  std::vector<Route> routes;
  std::vector<ScoreAddress> scores;
  for (auto const& [hash, sums] : total.classes) {
    routes.push_back({hash, &sums, scores.size()});
    scores.insert(scores.end(), sums.kept.begin(), sums.kept.end());
  }
  std::vector<ReplayedScore> paths = replay(scores);
  std::vector<MadeClass> made(routes.size());
  in_parallel(routes.size(), threads, [&](std::size_t i) {
    auto const& [hash, sums, first] = routes[i];
    made[i] = make_class(steered, hash, *sums, total, seed, std::span(paths).subspan(first, sums->kept.size()));
  });
  return made;
}

// Routes that are not resolved on their own, of one port: one row whose error comes from the replicas, so that scores
// of one history in several of them are not taken for independent. Replicas do not reveal a heavy tail that they share:
// where most of the row comes from routes rejected for their tail, it is rejected too.
class Leftover {
 public:
  void take(CouplingClass const& c, Moments const& moments) {
    if (merged_.records.empty()) {
      merged_.hash = hash_of_other(c.port.value, c.reverse);
      merged_.port = c.port;
      merged_.reverse = c.reverse;
    }
    merged_.off_list += c.off_list;
    moments_ = merged(moments_, moments);
    for (int r = 0; r < replica_count; ++r) merged_.replica_sum[r] += c.replica_sum[r];
    take_records(c);
    if (c.phase_sensitivities.empty() && c.coupling.mean > 0) moments_known_ = false;
    if (moments_known_) moments_known_ = add_moments(merged_.phase_sensitivities, c.phase_sensitivities);
    ++merged_.folded_routes;
    note(c);
    weigh(c);
  }
  CouplingClass row(BlockSums const& total, CouplingTable const& table) {
    bool const several = merged_.folded_routes > 1;
    if (several) {  // several routes have no tail in common, and their sums over blocks are not summed here
      moments_.tail.clear();
      moments_.first_sum = not_a_number;
    }
    merged_.coupling = estimate_of_light(moments_, total.histories, total.blocks);
    if (several && total.blocks >= replica_count) {
      double const n = double(total.histories);
      double between = 0;
      for (int r = 0; r < replica_count; ++r) {
        double const off = merged_.replica_sum[r] - merged_.coupling.mean * double(table.replica_histories[r]);
        between += off * off;
      }
      merged_.coupling.std_error = std::sqrt(between * replica_count / (replica_count - 1)) / n;
    }
    if (several) doubt(table);
    if (!moments_known_) merged_.phase_sensitivities.clear();
    return std::move(merged_);
  }

 private:
  // Light on receivers makes no noise, so that its paths need no routes.
  void take_records(CouplingClass const& c) {
    bool const to_port = c.port.value < first_receiver_end;
    for (PathRecord const& r : c.records) {
      merged_.records.push_back(r);
      if (to_port) merged_.records.back().member = std::uint32_t(merged_.members.size());
    }
    if (to_port && !c.records.empty()) merged_.members.push_back({c.steps});
  }

  // Keeps the largest, with the reason for each.
  void note(CouplingClass const& c) {
    FoldedRoute const route{c.hash,
                            c.steps,
                            c.coupling.mean,
                            c.coupling.std_error,
                            c.coupling.trusted,
                            c.steps.empty() ? "more vertices than 'route_vertices' names" : c.coupling.why_not};
    auto const larger = [](FoldedRoute const& a, FoldedRoute const& b) {
      return a.mean != b.mean ? a.mean > b.mean : a.hash < b.hash;
    };
    auto& list = merged_.folded;
    list.insert(std::upper_bound(list.begin(), list.end(), route, larger), route);
    if (list.size() > folded_kept) list.pop_back();
  }

  void weigh(CouplingClass const& c) {
    std::string const why = tail_objection(c.coupling);
    if (why.empty()) return;
    heavy_sum_ += c.coupling.mean;
    ++heavy_routes_;
    if (c.coupling.mean > heaviest_.mean) heaviest_ = {c.hash, c.steps, c.coupling.mean, 0, false, why};
  }
  void doubt(CouplingTable const& table) {
    Estimate& e = merged_.coupling;
    if (!e.trusted || !(heavy_sum_ > 0.5 * e.mean)) return;
    e.trusted = false;
    e.why_not = fmt::format("mostly {}{}: {}", folded_name(table, heaviest_),
                            heavy_routes_ > 1 ? fmt::format(" and {} more", heavy_routes_ - 1) : "", heaviest_.why);
  }

  CouplingClass merged_;
  Moments moments_;
  bool moments_known_ = true;  // second moments of the phase sensitivities of all routes so far
  double heavy_sum_ = 0;       // of the means of routes rejected for their tail
  std::uint64_t heavy_routes_ = 0;
  FoldedRoute heaviest_;
};

// Light by directions without a target, by its end and its last surface.
class OffList {
 public:
  void take(CouplingClass const& c, CouplingTable const& table) {
    if (c.by_reverse) return;
    total_[c.port.value] += c.coupling.mean;
    std::size_t const n = c.steps.size();
    missed_[{c.port.value, n < 2 ? "long routes" : table.groups[c.steps[n - 2].group.value]}] += c.off_list;
  }
  std::vector<std::string> warnings(CouplingTable const& table) const {
    std::vector<std::string> list;
    for (auto const& [place, power] : missed_) {
      double const share = power / total_.at(place.first);
      if (!(share > 0.01)) continue;
      bool const port = place.first < first_receiver_end;
      list.push_back(fmt::format(
          "{:.0f} % of {} comes from '{}', which is not a target of importance sampling: its error falls slowly, "
          "and more histories are needed",
          100 * share,
          port ? "port " + table.ports[place.first] : "receiver " + table.receivers[place.first - first_receiver_end],
          place.second));
    }
    return list;
  }

 private:
  std::map<std::uint32_t, double> total_;
  std::map<std::pair<std::uint32_t, std::string>, double> missed_;
};

void warn_of_unpaired(double unpaired, CouplingTable& table) {
  double counted = 0;
  for (CouplingClass const& c : table.classes) counted += c.coupling.mean;
  if (unpaired > 1e-9 * counted)
    table.warnings.push_back(fmt::format(
        "{:.2g} of the light is scattered from a beam of the interferometer's network into another beam, or "
        "back, and is not counted (docs/theory/recoupling.md)",
        unpaired));
}

}  // namespace

CouplingTable make_coupling_table(SteeredWorld const& steered, BlockSums const& total, std::uint64_t seed,
                                  unsigned threads, ReplayScores const& replay) {
  World const& world = steered;
  CouplingTable table;
  table.groups = world.groups();
  table.bodies = world.body_names();
  table.ports = world.ports();
  table.histories = total.histories;
  table.seed = seed;
  table.wavelength = world.wavelength;
  table.block_size = steered.block_size;
  table.reverse_routes = world.reverse_routes;
  for (std::size_t r = 0; r < replica_count; ++r)
    table.replica_histories[r] = total.replica_blocks[r] * steered.block_size;
  table.receivers = world.receiver_names();
  for (ReceiverSums const& r : total.receivers)
    table.received_power.push_back(estimate_of_light(r.power, total.histories, total.blocks));
  std::map<std::pair<std::uint32_t, double>, Leftover> others;  // by end and C_rev
  OffList off_list;
  auto const list_of = [&](CouplingClass const& c) -> std::vector<CouplingClass>& {
    return c.port.value < first_receiver_end ? table.classes : table.received;
  };
  std::vector<MadeClass> made = make_classes(steered, total, seed, threads, replay);
  mirror_poorly_sampled(made);
  std::ranges::sort(made, [](auto const& a, auto const& b) { return a.row.hash < b.row.hash; });
  double unpaired = 0;
  for (auto& [c, moments, beam, back, reversible] : made) {
    if (!c.port.valid()) {
      unpaired += c.coupling.mean;
      continue;
    }
    off_list.take(c, table);
    bool const direct = c.steps.size() == 1 || c.steps.size() == 2;  // separate: mirror to mirror
    if (direct || (c.coupling.trusted && !c.steps.empty()))
      list_of(c).push_back(std::move(c));
    else
      others[{c.port.value, c.reverse}].take(c, moments);
  }
  for (auto& [place, leftover] : others) {
    CouplingClass c = leftover.row(total, table);
    list_of(c).push_back(std::move(c));
  }
  for (auto* list : {&table.classes, &table.received})
    std::sort(list->begin(), list->end(), [](auto const& a, auto const& b) { return a.hash < b.hash; });
  for (CouplingClass& c : table.received) c.port.value -= first_receiver_end;
  table.warnings = off_list.warnings(table);
  warn_of_unpaired(unpaired, table);
  return table;
}

char letter(Event event) {
  switch (event) {
    case Event::reflect:
      return 'R';
    case Event::transmit:
      return 'T';
    case Event::receive:
      return 'D';
    case Event::start:
      return 'B';
    case Event::diffract:
      return 'E';
    default:
      return 'S';
  }
}

std::string received_name(CouplingTable const& table, CouplingClass const& c) {
  return c.steps.empty() ? fmt::format("other > {}", table.receivers[c.port.value]) : route_name(table, c);
}

namespace {

std::string name_of_steps(CouplingTable const& table, std::vector<PathStep> const& steps) {
  std::string name;
  for (PathStep const& s : steps)
    name += fmt::format("{}{}·{}", name.empty() ? "" : " > ", table.groups[s.group.value], letter(s.event));
  return name;
}

}  // namespace

std::string route_name(CouplingTable const& table, CouplingClass const& c) {
  if (c.steps.empty()) return fmt::format("other > {}", table.ports[c.port.value]);
  return name_of_steps(table, c.steps) + (c.folded_routes > 1 ? fmt::format(" and {} more", c.folded_routes - 1) : "");
}

std::string folded_name(CouplingTable const& table, FoldedRoute const& route) {
  return route.steps.empty() ? "long routes" : name_of_steps(table, route.steps);
}

namespace {

// The reversed route of `made`, with its numbers.
MadeClass mirrored(MadeClass const& made, std::uint64_t hash) {
  MadeClass other = made;
  other.row.hash = hash;
  other.row.steps = backwards(made.row.steps);
  other.row.port = made.back;
  other.row.by_reverse = true;
  other.back = made.row.port;
  return other;
}

bool better(CouplingClass const& a, CouplingClass const& b) {
  if (a.coupling.trusted != b.coupling.trusted) return a.coupling.trusted;
  return a.coupling.scored > b.coupling.scored;
}

}  // namespace

std::uint64_t hash_of_route(std::vector<PathStep> const& steps, std::uint32_t beam, std::uint32_t end) {
  std::uint64_t name = 0;
  for (PathStep const& s : steps) name = extended(name, s.group, s.event == Event::emit ? Event::scatter : s.event);
  return hash_of_ends(beam, name, end);
}

std::uint64_t hash_of_other(std::uint32_t end, double reverse) {
  constexpr std::uint64_t word = 0x6f74686572;  // "other"
  return mixed(hash_of_ends(0, mixed(word), end) + std::uint64_t(reverse));
}

std::vector<PathStep> backwards(std::vector<PathStep> steps) {
  std::ranges::reverse(steps);
  steps.front().event = Event::emit;
  steps.back().event = Event::couple;
  return steps;
}

void mirror_poorly_sampled(std::vector<MadeClass>& classes) {
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (std::size_t i = 0; i < classes.size(); ++i) place[classes[i].row.hash] = i;
  std::size_t const sampled = classes.size();
  for (std::size_t i = 0; i < sampled; ++i) {
    if (!classes[i].reversible) continue;
    std::uint64_t const hash = hash_of_route(backwards(classes[i].row.steps), classes[i].beam, classes[i].back.value);
    auto const at = place.find(hash);
    if (at == place.end()) {
      classes.push_back(mirrored(classes[i], hash));
      continue;
    }
    MadeClass& other = classes[at->second];
    bool const settled = classes[i].row.by_reverse || other.row.by_reverse ||
                         (classes[i].row.coupling.trusted && other.row.coupling.trusted);
    if (!settled && better(classes[i].row, other.row)) other = mirrored(classes[i], hash);
  }
}

CouplingClass deterministic_class(ClassKind kind, std::vector<PathStep> steps, PortId port, double reverse,
                                  std::vector<PathRecord> records, std::string statement) {
  CouplingClass c;
  c.kind = kind;
  c.hash = mixed(hash_of_route(steps, 0, port.value) + std::uint64_t(kind));
  c.port = port;
  c.steps = std::move(steps);
  c.reverse = reverse;
  c.records = std::move(records);
  c.statement = std::move(statement);
  for (PathRecord const& r : c.records) c.coupling.mean += r.weight;
  if (!std::isfinite(c.coupling.mean)) throw NumericalError("the coupling of a deterministic route is not finite");
  c.coupling.trusted = true;
  return c;
}

void add_deterministic(CouplingTable& table, std::vector<CouplingClass> const& classes) {
  if (classes.empty()) return;
  table.classes.insert(table.classes.end(), classes.begin(), classes.end());
  std::ranges::sort(table.classes, [](auto const& a, auto const& b) { return a.hash < b.hash; });
  auto const twice =
      std::ranges::adjacent_find(table.classes, [](auto const& a, auto const& b) { return a.hash == b.hash; });
  if (twice != table.classes.end()) throw NumericalError("two routes have the same hash: " + route_name(table, *twice));
}

}  // namespace straytrace::trace
