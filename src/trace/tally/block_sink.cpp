// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/block_sink.hpp"

#include <cmath>

#include "trace/tally/route.hpp"

namespace straytrace {

BlockSink::BlockSink(WorldView const& world, std::uint64_t seed, std::size_t groups, int replica)
    : world_(world), seed_(seed), replica_(replica) {
  sums_.blocks = 1;
  sums_.arrived.resize(groups);
}

void BlockSink::begin(std::uint64_t history) {
  history_ = history;
  emitted_ = 0;
  for (double& column : ledger_) column = 0;
  totals_.clear();
  arrivals_.clear();
}

void BlockSink::visit(PathState const& path, Vertex const& vertex) {
  ++sums_.bounces;
  ++sums_.rays;
  if (!(vertex.wi.z > 0) || !std::isfinite(path.power)) ++sums_.lost;
  std::uint32_t const group = world_.surfaces[vertex.surface.value].group.value;
  for (Arrival& a : arrivals_)
    if (a.group == group) {
      a.power += path.power;
      return;
    }
  arrivals_.push_back({group, path.power});
}

void BlockSink::score(PathState const& path, Vertex const& vertex, std::uint32_t lit, std::uint32_t connection,
                      Vertex const&, double coupling) {
  if (!std::isfinite(coupling)) {
    ++sums_.lost;
    return;
  }
  std::uint64_t const route = route_of(world_, path, vertex, lit, connection).hash;
  std::uint32_t const port = world_.lit[lit].port.value;
  bool known = false;
  for (Total& t : totals_)
    if (t.route == route) {
      t.sum += coupling;
      known = true;
      break;
    }
  if (!known) totals_.push_back({route, port, coupling});

  Rng rng(seed_, path.history, path.event, Stream::record);
  double u = rng.uniform();
  for (std::uint32_t i = 0; i < connection; ++i) u = rng.uniform();
  ClassSums& sums = classes_[route];
  double const priority = coupling / u;
  if (priority <= sums.threshold) return;
  sums.kept.push_back({path.history, path.event, connection, coupling, priority});
  if (sums.kept.size() >= 4 * records_per_class) keep_largest(sums);
}

void BlockSink::end() {
  ++sums_.histories;
  for (Total const& t : totals_) {
    ClassSums& sums = classes_[t.route];
    sums.port = t.port;
    sums.moments.add(t.sum, history_);
  }
  sums_.emitted.add(emitted_, history_);
  for (int f = 0; f < fate_count; ++f) sums_.ledger[f].add(ledger_[f], history_);
  for (Arrival const& a : arrivals_) sums_.arrived[a.group].add(a.power, history_);
}

BlockSums BlockSink::finish() {
  auto const close = [](Moments& m) { m.block_sum2 = m.sum * m.sum; };
  for (auto& [route, sums] : classes_) {
    keep_largest(sums);
    sums.replica_sum[replica_] = sums.moments.sum;
    close(sums.moments);
    sums_.classes.emplace(route, std::move(sums));
  }
  close(sums_.emitted);
  for (Moments& m : sums_.ledger) close(m);
  for (Moments& m : sums_.arrived) close(m);
  return std::move(sums_);
}

}  // namespace straytrace
