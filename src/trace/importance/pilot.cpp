// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "trace/importance/steering_tables.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {

namespace {

constexpr std::uint64_t first_history = 1ull << 63;

// Siblings are followed depth first, so the sides before the present one always belong to the same path.
class PilotSink {
 public:
  PilotSink(WorldView const& view, Pilot& sums) : view_(view), sums_(sums) {}

  void emitted(PathState const&, Vertex const&) { passed_.clear(); }
  void visit(PathState const& path, Vertex const& vertex) {
    passed_.resize(path.order - 1);
    passed_.push_back(vertex.side());
    sums_.arrived[vertex.side()] += path.power;
    ++sums_.visits[vertex.side()];
  }
  // A receiver adds nothing for a path that has arrived on it: that light has been counted.
  void score(PathState const& path, Vertex const&, std::uint32_t goal, std::uint32_t number, Vertex const&,
             double coupling) {
    bool const arrived = goal >= view_.lit.size && is_hit(number);
    for (std::uint32_t i = 0; i + (arrived ? 1 : 0) < path.order; ++i) sums_.scored[goal][passed_[i]] += coupling;
  }
  void score_through(PathState const& path, Vertex const& vertex, Vertex const&, Chain const&, std::uint32_t goal,
                     Vertex const& end, double power) {
    score(path, vertex, goal, connection_number(0), end, power);
  }
  void book(BalanceTerm, double) {}

 private:
  WorldView const& view_;
  Pilot& sums_;
  std::vector<std::uint32_t> passed_;  // side of each vertex after the source
};

}  // namespace

Pilot run_pilot(World const& world, std::uint64_t histories) {
  WorldView view = world.view();
  view.halo = {};                   // whose field may not be known yet
  view.block_size = largest_block;  // not that of the run, which changes as it grows
  std::size_t const sides = view.steering.sides.size;
  Pilot pilot{std::vector<std::uint64_t>(sides), std::vector<double>(sides),
              std::vector<std::vector<double>>(view.lit.size + view.receivers.size, std::vector<double>(sides))};
  PilotSink sink(view, pilot);
  History history;
  for (std::uint64_t h = 0; h < histories; ++h) trace_history(view, 0, first_history + h, history, sink);
  return pilot;
}

namespace {

// Numbers of histories that neither the trace nor the pilot of the adjoints uses.
constexpr std::uint64_t first_of_maps = 3ull << 62, histories = 1 << 14;
// Arrivals count whatever their power: otherwise one with most of the power would leave a single cell.
constexpr double most_arrivals_in_cell = 12;
constexpr std::size_t most_cells = 512, most_arrivals = 1 << 17;

class ArrivalSink : public NullSink {
 public:
  explicit ArrivalSink(WorldView const& view) : view_(view), places_(view.receivers.size) {}

  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const& y, double power) {
    add(goal, y, power);
  }
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal,
                     Vertex const& end, double power) {
    add(goal, end, power);
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t goal, Vertex const& end,
                 double power) {
    add(goal, end, power);
  }
  std::vector<WeightedPlace> const& places(std::uint32_t receiver) const { return places_[receiver]; }

 private:
  void add(std::uint32_t goal, Vertex const& y, double power) {
    if (!is_receiver(view_, goal)) return;
    Receiver const& r = receiver_of(view_, goal);
    std::vector<WeightedPlace>& all = places_[place_of(view_, goal)];
    if (!r.by_light || !(power > 0) || all.size() >= most_arrivals) return;
    MapPlace const p = place_in(r.chart, r.frame.local_point(y.point));
    if (r.inside(p)) all.push_back({p});
  }

  WorldView const& view_;
  std::vector<std::vector<WeightedPlace>> places_;
};

}  // namespace

void find_map_cells(World& world) {
  auto const& receivers = world.receivers();
  if (std::ranges::none_of(receivers, [](Receiver const& r) { return r.by_light; })) return;
  WorldView view = world.view();
  view.halo = {};
  view.block_size = largest_block;  // not that of the run
  ArrivalSink sink(view);
  History history;
  for (std::uint64_t h = 0; h < histories; ++h) trace_history(view, 0, first_of_maps + h, history, sink);
  for (std::uint32_t i = 0; i < receivers.size(); ++i) {
    if (!receivers[i].by_light) continue;
    CellTree tree(receivers[i].chart, receivers[i].whole);
    tree.refine(sink.places(i), most_arrivals_in_cell, most_cells);
    world.set_map_cells(i, tree);
  }
}

}  // namespace straytrace::trace
