// SPDX-License-Identifier: BSD-3-Clause
#include "trace/camera/first_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/process/threads.hpp"
#include "trace/importance/importance.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {

std::vector<Ending> endings_of(WorldView const& world) {
  std::vector<Ending> endings;
  for (std::uint32_t i = 0; i < world.lit.size; ++i)
    if (world.lit[i].receives && world.lit[i].port.valid()) endings.push_back({true, i});
  for (std::uint32_t i = 0; i < world.receivers.size; ++i) endings.push_back({false, i});
  return endings;
}

namespace {

// The mode run backwards: light leaves its surface as it would rejoin (reciprocity of the BSDF).
bool start_at_port(WorldView const& world, std::uint64_t seed, Footprint const& lit, Rng& rng, PathState& path) {
  double const u = rng.uniform(), v = rng.uniform();
  Ray const line = lit.sample(u, v);
  Crossing const met = world.cross(lit.surface.value, line, {});
  if (!(met.distance < infinity)) return false;
  Vec3 const point = line.origin + met.distance * line.dir;
  path.ray.dir = lit.direction(point);
  path.power = accepted(world, lit);
  path.polarisation = lit.polarisation;
  Vertex vertex = make_vertex(world, lit.surface, point, path.ray.dir, met.piece);
  evaluate_scattering(world, path, path.ray.dir, vertex);
  NullSink sink;
  return scatter(world, seed, path, vertex, sink, true);
}

// Uniform over the surface, by the cosine law into the half space of the sensitive side.
bool start_at_receiver(WorldView const& world, Receiver const& receiver, Rng& rng, PathState& path) {
  double const u = rng.uniform(), v = rng.uniform(), a = rng.uniform(), b = rng.uniform();
  bool const both = receiver.front && receiver.back;
  bool const front = both ? rng.uniform() < 0.5 : receiver.front;
  return world.shapes.visit(world.surfaces[receiver.surface.value].shape, [&](auto const& shape) {
    SurfacePoint const at = sample_of(shape, u, v);
    Vec3 const normal = normal_of(shape, at.point, at.piece);
    Frame const frame = Frame::around(front ? normal : -normal);
    double const sine = std::sqrt(a);
    SinCos const turn = sincos_turn(b);
    path.ray = {at.point, unit(frame.to_world({sine * turn.cos, sine * turn.sin, std::sqrt(1 - a)}))};
    path.from = {receiver.surface, at.piece};
    path.power = pi * shape.area() * (both ? 2 : 1);
    return true;
  });
}

}  // namespace

bool start_backward(WorldView const& world, std::uint64_t seed, std::uint64_t number, Ending ending, PathState& path) {
  path = {};
  path.history = first_backward_history + number;
  path.strata = {seed, path.history, world.block_size};
  Rng rng(seed, path.history, 0, Stream::backward);
  return ending.port ? start_at_port(world, seed, world.lit[ending.index], rng, path)
                     : start_at_receiver(world, world.receivers[ending.index], rng, path);
}

namespace {

constexpr std::uint32_t batches = 32;

// Sums over walks, per batch: power arriving on each side of each strip, and its scattered part.
struct Batch {
  std::map<std::uint32_t, double> arrived, scattered;
  double outside = 0, total = 0;
  std::uint64_t walks = 0;
};
using Batches = std::vector<Batch>;

template <class Start>
Batches walk_all(WorldView const& world, FirstOrderSettings const& settings, Start const& start) {
  Batches all(batches);
  in_parallel(batches, settings.threads, [&](std::size_t b) {
    Batch& batch = all[b];
    // Consecutive walks, whose dealt numbers belong together.
    for (std::uint64_t n = settings.histories * b / batches; n < settings.histories * (b + 1) / batches; ++n) {
      ++batch.walks;
      PathState path;
      if (!start(n, path)) continue;
      batch.total += path.power * path.hop.kept;
      follow_specular(
          world, settings.seed, path,
          [&](PathState const& p, Vertex const& v) {
            batch.arrived[v.side()] += p.power;
            if (v.albedo > 0) batch.scattered[v.side()] += p.power * v.albedo;
          },
          [&](double power) { batch.outside += power; });
    }
  });
  return all;
}

// Mean of a quantity that is a sum over walks.
template <class Of>
Estimate over_batches(Batches const& all, Of const& of) {
  Estimate e;
  double sum = 0, sum2 = 0, walks = 0;
  for (Batch const& b : all) {
    double const x = of(b);
    sum += x;
    walks += double(b.walks);
    if (x != 0) ++e.scored;
  }
  e.mean = walks > 0 ? sum / walks : 0;
  for (Batch const& b : all) {
    double const away = of(b) - e.mean * double(b.walks);
    sum2 += away * away;
  }
  e.std_error = walks > 0 ? std::sqrt(sum2 * batches / (batches - 1.0)) / walks : 0;
  return e;
}

double at(std::map<std::uint32_t, double> const& map, std::uint32_t key) {
  auto const found = map.find(key);
  return found == map.end() ? 0 : found->second;
}

// Per group; sums by side of a strip are joined through `group_of`.
class Lists {
 public:
  Lists(World const& world, SteeringTables const& tables, Batches const& forward)
      : world_(world), tables_(tables), forward_(forward), lit_(joined(forward)) {}

  FirstOrderList list(Ending ending, Batches const& backward) const {
    std::map<std::uint32_t, std::vector<std::uint32_t>> sides_of;  // group: sides of its strips
    std::map<std::uint32_t, bool> touched;
    Batch const seen = joined(backward);
    for (Batch const* all : {&lit_, &seen})
      for (auto const& [side, value] : all->arrived) touched[side] = true;
    for (auto const& [side, yes] : touched)
      if (side != WorldView::none) sides_of[group_of(side)].push_back(side);
    FirstOrderList out{ending,
                       {},
                       over_batches(backward, [](Batch const& b) { return b.outside; }),
                       over_batches(backward, [](Batch const& b) { return b.total; }).mean};
    for (auto const& [group, sides] : sides_of)
      out.rows.push_back(
          {{group}, arriving(forward_, sides), arriving(backward, sides), product(backward, seen, sides)});
    std::ranges::stable_sort(out.rows, [](FirstOrderRow const& a, FirstOrderRow const& b) {
      return a.product.mean != b.product.mean ? a.product.mean > b.product.mean : a.power.mean > b.power.mean;
    });
    return out;
  }

 private:
  static Batch joined(Batches const& all) {
    Batch sum;
    for (Batch const& b : all) {
      for (auto const& [side, x] : b.arrived) sum.arrived[side] += x;
      for (auto const& [side, x] : b.scattered) sum.scattered[side] += x;
      sum.walks += b.walks;
    }
    return sum;
  }
  std::uint32_t group_of(std::uint32_t side) const {
    return world_.surfaces()[tables_.strips[side / 2].surface.value].group.value;
  }
  static Estimate arriving(Batches const& all, std::vector<std::uint32_t> const& sides) {
    return over_batches(all, [&](Batch const& b) {
      double sum = 0;
      for (std::uint32_t side : sides) sum += at(b.arrived, side);
      return sum;
    });
  }
  // Forward and backward walks are independent, so the product of their means has no bias. Error: jackknife over
  // batches.
  Estimate product(Batches const& backward, Batch const& seen, std::vector<std::uint32_t> const& sides) const {
    auto const without = [&](Batch const* less_lit, Batch const* less_seen) {
      double const walks = double(lit_.walks - (less_lit ? less_lit->walks : 0)),
                   back = double(seen.walks - (less_seen ? less_seen->walks : 0));
      double sum = 0;
      for (std::uint32_t side : sides) {
        double const power = at(lit_.scattered, side) - (less_lit ? at(less_lit->scattered, side) : 0),
                     view = at(seen.arrived, side) - (less_seen ? at(less_seen->arrived, side) : 0);
        sum += power * view / (pi * tables_.strips[side / 2].area);
      }
      return walks > 0 && back > 0 ? sum / (walks * back) : 0;
    };
    Estimate e;
    e.mean = without(nullptr, nullptr);
    double mean = 0, variance = 0;
    std::vector<double> left(batches);
    for (std::uint32_t b = 0; b < batches; ++b) mean += (left[b] = without(&forward_[b], &backward[b])) / batches;
    for (double x : left) variance += (x - mean) * (x - mean);
    e.std_error = std::sqrt(variance * (batches - 1.0) / batches);
    return e;
  }

  World const& world_;
  SteeringTables const& tables_;
  Batches const& forward_;
  Batch lit_;
};

}  // namespace

std::vector<FirstOrderList> first_order(World const& world, FirstOrderSettings const& settings) {
  SteeringTables const tables = make_strips(world);
  WorldView view = world.view();
  view.steering = tables.view();  // names the strips; without targets only the BSDF chooses directions
  view.halo = {};                 // rays alone
  Batches const forward = walk_all(view, settings, [&](std::uint64_t n, PathState& path) {
    NullSink sink;
    path.history = n;
    return view.emitters.size > 0 && emit(view, settings.seed, path, sink);
  });
  Lists const lists(world, tables, forward);
  std::vector<FirstOrderList> all;
  for (Ending const ending : endings_of(view))
    all.push_back(lists.list(ending, walk_all(view, settings, [&](std::uint64_t n, PathState& path) {
                               return start_backward(view, settings.seed, n, ending, path);
                             })));
  return all;
}

}  // namespace straytrace::trace
