// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/map_cells.hpp"

#include <algorithm>

#include "trace/step/step.hpp"

namespace straytrace {
namespace {

// Numbers that neither production nor the pilot of the adjoints has (trace/importance/pilot.hpp).
constexpr std::uint64_t first_of_maps = 3ull << 62, histories = 1 << 14;
// Arrivals count whatever their power: one that carries most of it would otherwise leave a single cell.
constexpr double most_arrivals_in_cell = 12;
constexpr std::size_t most_cells = 512, most_arrivals = 1 << 17;

class ArrivalSink {
 public:
  explicit ArrivalSink(WorldView const& view) : view_(view), places_(view.receivers.size) {}

  template <class... T>
  void emitted(T const&...) {}
  template <class... T>
  void visit(T const&...) {}
  void book(BalanceTerm, double) {}
  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const& y, double power) {
    if (goal >= view_.lit.size) add(goal - std::uint32_t(view_.lit.size), y, power);
  }
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t receiver,
                     Vertex const& end, double power) {
    add(receiver, end, power);
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t receiver,
                 Vertex const& end, double power) {
    add(receiver, end, power);
  }
  std::vector<WeightedPlace> const& places(std::uint32_t receiver) const { return places_[receiver]; }

 private:
  void add(std::uint32_t receiver, Vertex const& y, double power) {
    Receiver const& r = view_.receivers[receiver];
    std::vector<WeightedPlace>& all = places_[receiver];
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
  if (std::none_of(receivers.begin(), receivers.end(), [](Receiver const& r) { return r.by_light; })) return;
  WorldView view = world.view();
  view.block_size = largest_block;  // of the run, which cells do not depend on
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

}  // namespace straytrace
