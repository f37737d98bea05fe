// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/errors.hpp"
#include "base/process/threads.hpp"
#include "trace/tally/history_tally.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {
namespace {

// The footprints at the ends of a path: one, or two, which may be the same.
std::vector<std::uint32_t> ends_of(World const& world, std::uint32_t source, std::uint32_t goal) {
  if (goal < world.footprints().size()) return {source, goal};
  return {source};
}
double fed_length(World const& world, std::uint32_t source, std::uint32_t goal) {
  double sum = 0;
  for (std::uint32_t const end : ends_of(world, source, goal)) sum += world.feeds()[end].path_length;
  return sum;
}

// Siblings are followed depth first, so the vertices before the present one always belong to the same path.
class ReplaySink {
 public:
  ReplaySink(World const& world, WorldView const& view, std::uint64_t seed, std::uint32_t event, std::uint32_t number)
      : world_(world), view_(view), seed_(seed), event_(event), number_(number) {}

  void emitted(PathState const& path, Vertex const& vertex) {
    Footprint const& source = view_.lit[path.source];
    GroupId const group = source.free ? source.origin : group_of(vertex.surface);
    Vec3 const in = source.free ? path.ray.dir : source.direction(vertex.point);
    passed_ = {{vertex.surface, vertex.point, in, {}, Event::emit, source.index, 1, group}};
    length_ = {path.path_length};
  }
  void visit(PathState const& path, Vertex const& vertex) {
    passed_.resize(path.order);
    length_.resize(path.order);
    leave_towards(passed_, vertex.point, path.hop.left_by, vertex.n_in);
    length_.push_back(path.path_length);
    passed_.push_back({vertex.surface,
                       vertex.point,
                       passed_.back().out,
                       {},
                       Event::scatter,
                       vertex.n_in,
                       vertex.n_in,
                       group_of(vertex.surface)});
  }
  void score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number, Vertex const& y,
             double coupling) {
    if (found || path.event != event_ || number != number_) return;
    Route const route = route_of(view_, path, vertex, goal, number, y.surface);
    auto vertices = passed_;
    vertices.resize(path.order + 1);
    double path_length = length_[path.order];
    bool const mode = goal < view_.lit.size;
    if (!is_hit(number) || (!mode && view_.surfaces[y.surface.value].clear)) {
      bool const through = dot(y.point - vertex.point, vertex.frame.e3) < 0;
      double const index = is_hit(number) ? 1 : through ? vertex.n_out : vertex.n_in;
      leave_towards(vertices, y.point, is_hit(number) ? path.hop.left_by : Event::scatter, index);
      path_length += index * length(y.point - vertices.back().point);
      vertices.push_back(
          {y.surface, y.point, vertices.back().out, {}, Event::scatter, index, index, group_of(y.surface)});
    }
    finish(path.source, goal, std::move(vertices), path_length, route.other, coupling);
  }
  void score_halo(PathState const& path, Vertex const& x, Vertex const& y, std::uint32_t source, bool connected,
                  double coupling) {
    if (found || path.event != event_ || number_ != number_halo(view_, source, connected)) return;
    auto vertices = passed_;
    vertices.resize(path.order + 1);
    double path_length = length_[path.order];
    bool const through = dot(y.point - x.point, x.frame.e3) < 0;
    if (connected) go_to(vertices, path_length, y, Event::scatter, through ? x.n_out : x.n_in);
    std::uint32_t const goal = view_.halo.sources[source].footprint;
    Footprint const& mode = view_.lit[goal];
    go_to(vertices, path_length, make_vertex(view_, mode.surface, mode.centre, mode.travel), Event::scatter,
          mode.index);
    finish(path.source, goal, std::move(vertices), path_length, route_halo(view_, path, x, y, source, connected).other,
           coupling);
  }
  void score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                     std::uint32_t goal, Vertex const& end, double power) {
    if (found || path.event != event_ || number_ != number_through(view_, chain.ends, goal)) return;
    auto vertices = passed_;
    vertices.resize(path.order + 1);
    double path_length = length_[path.order];
    bool const through = dot(z.point - vertex.point, vertex.frame.e3) < 0;
    go_to(vertices, path_length, z, Event::scatter, through ? vertex.n_out : vertex.n_in);
    go_behind(path, vertices, path_length, chain.hops, goal, end);
    bool const other = route_through(view_, path, vertex, z, chain, goal).other;
    finish(path.source, goal, std::move(vertices), path_length, other, power);
  }
  void score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain, std::uint32_t goal,
                 Vertex const& end, double power) {
    if (found || path.event != event_ || number_ != number_lit(view_, source, chain.hops, goal)) return;
    Footprint const& beam = view_.lit[source];
    std::vector<PassedVertex> vertices;
    double path_length = 0;
    if (beam.free) {
      Footprint::Passing const light = beam.passing(z.point);
      vertices.push_back({{}, light.start, light.travel, {}, Event::emit, 1, 1, beam.origin});
      path_length = beam.lag(light.start);
      go_to(vertices, path_length, z, Event::scatter, z.n_in);
    } else {
      vertices.push_back(
          {z.surface, z.point, beam.direction(z.point), {}, Event::emit, beam.index, 1, group_of(z.surface)});
    }
    go_behind(path, vertices, path_length, chain.hops, goal, end);
    finish(source, goal, std::move(vertices), path_length, route_lit(view_, source, z, chain, goal).other, power);
  }
  void book(BalanceTerm, double) {}
  bool hears(std::uint32_t event) const { return event == event_; }

  std::optional<ReplayedPath> found;

 private:
  void go_to(std::vector<PassedVertex>& vertices, double& path_length, Vertex const& v, Event left_by,
             double index) const {
    leave_towards(vertices, v.point, left_by, index);
    path_length += index * length(v.point - vertices.back().point);
    vertices.push_back(
        {v.surface, v.point, vertices.back().out, {}, Event::scatter, index, index, group_of(v.surface)});
  }
  // From the last vertex by `hops` vertices, found again by the sub-path, to the goal.
  void go_behind(PathState const& path, std::vector<PassedVertex>& vertices, double& path_length, std::uint32_t hops,
                 std::uint32_t goal, Vertex const& end) const {
    struct Passed {
      Vertex at;  // seen from the goal
      Event event;
      bool through;
    };
    BackwardNumbers numbers(view_, seed_, path.history, path.strata, goal);
    std::vector<Passed> passed;
    double last_index = 1;
    auto const sub = std::make_unique<SubPath>();
    sub->goal = goal;
    grow(
        view_, most_ends - 1, numbers, *sub,
        [&](Vertex const& at, Event event, bool through) {
          passed.push_back({at, event, through});
        },
        [&](SubVertex const& met) {
          if (met.hops == 0) last_index = met.at.n_in;
        });
    passed.resize(hops);
    Event left_by = Event::scatter;
    for (auto p = passed.rbegin(); p != passed.rend(); ++p) {
      go_to(vertices, path_length, p->at, left_by, p->through ? p->at.n_out : p->at.n_in);
      left_by = p->event;
    }
    go_to(vertices, path_length, end, left_by, last_index);
  }
  // The last vertex is on the goal.
  void finish(std::uint32_t source, std::uint32_t goal, std::vector<PassedVertex> vertices, double path_length,
              bool other, double coupling) {
    PassedVertex& last = vertices.back();
    bool const receiver = is_receiver(view_, goal);
    last.event = receiver ? Event::receive : Event::couple;
    last.out = receiver ? Vec3{} : -view_.lit[goal].direction(last.point);
    if (!receiver) last.n_out = view_.lit[goal].index;
    path_length += fed_length(world_, source, goal);
    auto phase_sensitivities = phase_sensitivities_of(world_, vertices, source, goal);
    found =
        ReplayedPath{std::move(vertices), source, goal, other, coupling, path_length, std::move(phase_sensitivities)};
  }
  GroupId group_of(SurfaceId id) const { return view_.surfaces[id.value].group; }
  static void leave_towards(std::vector<PassedVertex>& vertices, Vec3 point, Event event, double index) {
    PassedVertex& last = vertices.back();
    last.out = unit(point - last.point);
    last.n_out = index;
    if (last.event != Event::emit) last.event = event;
  }

  World const& world_;
  WorldView const& view_;
  std::uint64_t seed_;
  std::uint32_t event_, number_;
  std::vector<PassedVertex> passed_;
  std::vector<double> length_;  // m, from the source to each vertex
};

}  // namespace

namespace {

// Footprint of the cavity mirror at which light of this footprint leaves or joins the main mode, or none.
std::uint32_t mirror_of(World const& world, std::uint32_t end) {
  if (end >= world.footprints().size()) return Feed::none;  // a receiver
  return world.footprints()[end].standing ? end : world.feeds()[end].mirror;
}

// Times [s] from the hits of a path to where its light rejoins the main mode. A path and its reverse add as fields and
// meet a body as long before the end as after the start: both together after half of the way, to first order.
class Delays {
 public:
  Delays(World const& world, std::vector<PassedVertex> const& vertices, std::uint32_t source, std::uint32_t goal)
      : reverse_(has_reverse(world, vertices, source, goal)), left_(vertices.size()) {
    bool const rejoins = goal < world.footprints().size();
    double left = rejoins ? world.feeds()[goal].path_length : 0;
    for (std::size_t i = vertices.size(); i-- > 0;) {
      if (i + 1 < vertices.size()) left += vertices[i].n_out * length(vertices[i + 1].point - vertices[i].point);
      left_[i] = left / speed_of_light;
    }
    whole_ = (left + world.feeds()[source].path_length) / speed_of_light;
  }
  double of_vertex(std::size_t i) const { return reverse_ ? whole_ / 2 : left_[i]; }
  // The moment of a hit on the way of the beam to the lit surface, or on its way back, from that since its start.
  double there(double d, double since_start) const { return reverse_ ? d * whole_ / 2 : d * whole_ - since_start; }
  double back(double d, double since_start) const { return reverse_ ? d * whole_ / 2 : since_start; }
  double whole() const { return whole_; }
  // Of the main mode that arrives now, at a mirror it left this time ago: with the reverse it arrives there as well.
  double of_main(double ago) const { return reverse_ ? ago / 2 : ago; }

 private:
  bool reverse_;
  std::vector<double> left_;
  double whole_ = 0;
};

void add_feed(std::vector<PhaseSensitivity>& sum, Feed const& feed, double k, auto const& moment) {
  for (PhaseSensitivity const& fed : feed.phase_sensitivities) {
    PhaseSensitivity at{fed.body};
    for (int i = 0; i < 6; ++i) {
      at.d[i] = fed.d[i];
      at.moment[i] = moment(fed.d[i], fed.moment[i]);
    }
    phase_sensitivity_of(sum, fed.body).add(at, k);
  }
}

// The main mode itself bounces on the mirrors of a cavity: only what differs from it counts (eq. 2.5). On the mirror
// where the light rejoins it bounces without delay (eq. N.30); from another mirror of the cavity it came as light does.
void subtract_main(std::vector<PhaseSensitivity>& sum, World const& world, std::uint32_t source, std::uint32_t goal,
                   double k, Delays const& delays) {
  std::uint32_t const from = mirror_of(world, source), to = mirror_of(world, goal);
  double apart = to == Feed::none ? delays.whole() : 0;
  if (from != Feed::none && to != Feed::none)
    apart = length(world.footprints()[to].centre - world.footprints()[from].centre) / speed_of_light;
  auto const subtract = [&](std::uint32_t mirror, double delay) {
    if (mirror == Feed::none) return;
    Footprint const& f = world.footprints()[mirror];
    add_hit(sum, world, f.surface, f.centre, -2 * k * f.travel, delay);
  };
  subtract(from, delays.of_main(apart));
  if (to != from) subtract(to, from == Feed::none ? 0 : apart - delays.of_main(apart));
}

}  // namespace

bool has_reverse(World const& world, std::vector<PassedVertex> const& vertices, std::uint32_t source,
                 std::uint32_t goal) {
  auto const& beams = world.footprints();
  return world.reverse_routes && vertices.size() > 1 && goal < beams.size() && beams[source].beam == beams[goal].beam;
}

std::vector<PhaseSensitivity> phase_sensitivities_of(World const& world, std::vector<PassedVertex> const& vertices,
                                                     std::uint32_t source, std::uint32_t goal) {
  double const k = 2 * pi / world.wavelength;
  Delays const delays(world, vertices, source, goal);
  std::vector<PhaseSensitivity> sum;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    PassedVertex const& v = vertices[i];
    if (v.surface.valid())
      add_hit(sum, world, v.surface, v.point, k * (v.n_in * v.in - v.n_out * v.out), delays.of_vertex(i));
  }
  // The path of the beam to the lit surface and, for light that rejoins, the path back.
  add_feed(sum, world.feeds()[source], k, [&](double d, double since) { return delays.there(d, since); });
  if (goal < world.footprints().size())
    add_feed(sum, world.feeds()[goal], k, [&](double d, double since) { return delays.back(d, since); });
  subtract_main(sum, world, source, goal, k, delays);
  std::ranges::sort(sum, [](PhaseSensitivity const& a, PhaseSensitivity const& b) { return a.body < b.body; });
  return sum;
}

Replay::Replay(SteeredWorld const& world, std::uint64_t seed)
    : world_(world), view_(world.view()), seed_(seed), again_(std::make_unique<History>()) {}

std::optional<ReplayedPath> Replay::operator()(std::uint64_t history, std::uint32_t event, std::uint32_t connection) {
  ReplaySink sink(world_, view_, seed_, event, connection);
  History& again = *again_;
  again.begin(history);
  if (!begin(view_, seed_, again, sink)) return std::move(sink.found);
  do {
    while (!sink.found && step(view_, seed_, again, sink)) {
    }
  } while (!sink.found && next_path(view_, seed_, again, sink));
  return std::move(sink.found);
}

std::optional<ReplayedPath> replay(SteeredWorld const& world, std::uint64_t seed, std::uint64_t history,
                                   std::uint32_t event, std::uint32_t connection) {
  return Replay(world, seed)(history, event, connection);
}

std::vector<ReplayedScore> replay_scores(SteeredWorld const& world, std::uint64_t seed,
                                         std::span<ScoreAddress const> scores, unsigned threads) {
  constexpr std::size_t at_once = 1024;
  std::vector<ReplayedScore> all(scores.size());
  in_parallel((scores.size() + at_once - 1) / at_once, threads, [&](std::size_t part) {
    Replay replay(world, seed);
    for (std::size_t i = part * at_once; i < std::min((part + 1) * at_once, scores.size()); ++i) {
      ScoreAddress const& score = scores[i];
      auto path = replay(score.history, score.event, score.connection);
      if (!path || path->coupling != score.coupling)
        throw NumericalError(
            fmt::format("history {} event {} does not replay to the same score", score.history, score.event));
      all[i] = {path->source, path->goal, path->path_length, std::move(path->phase_sensitivities)};
    }
  });
  return all;
}

}  // namespace straytrace::trace
