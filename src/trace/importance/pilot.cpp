// SPDX-License-Identifier: BSD-3-Clause
#include "trace/importance/pilot.hpp"

#include "trace/step/step.hpp"

namespace straytrace {
namespace {

constexpr std::uint64_t first_history = 1ull << 63;

// Siblings are followed depth first, so the sides before the one a path stands on are always its own.
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
  // A receiver is worth nothing to a path that stands on it: what arrives there has been counted.
  void score(PathState const& path, Vertex const&, std::uint32_t goal, std::uint32_t number, Vertex const&,
             double coupling) {
    bool const arrived = goal >= view_.lit.size && is_hit(number);
    for (std::uint32_t i = 0; i + (arrived ? 1 : 0) < path.order; ++i) sums_.scored[goal][passed_[i]] += coupling;
  }
  void score_through(PathState const& path, Vertex const& vertex, Vertex const&, Chain const&, std::uint32_t receiver,
                     Vertex const& end, double power) {
    score(path, vertex, goal_of_receiver(view_, receiver), connection_number(0), end, power);
  }
  void book(BalanceTerm, double) {}

 private:
  WorldView const& view_;
  Pilot& sums_;
  std::vector<std::uint32_t> passed_;  // side of each vertex after the source
};

}  // namespace

Pilot run_pilot(World const& world, std::uint64_t histories) {
  WorldView const view = world.view();
  std::size_t const sides = view.steering.sides.size;
  Pilot pilot{std::vector<std::uint64_t>(sides), std::vector<double>(sides),
              std::vector<std::vector<double>>(view.lit.size + view.receivers.size, std::vector<double>(sides))};
  PilotSink sink(view, pilot);
  History history;
  for (std::uint64_t h = 0; h < histories; ++h) trace_history(view, 0, first_history + h, history, sink);
  return pilot;
}

}  // namespace straytrace
