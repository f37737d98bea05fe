// SPDX-License-Identifier: BSD-3-Clause
// What one history scores, kept apart until its turn comes: paths of many histories are in flight at once, and a block
// adds them up in the order of their numbers.
#pragma once

#include <vector>

#include "trace/history/path.hpp"
#include "trace/result.hpp"
#include "trace/tally/route.hpp"

namespace straytrace {

class HistoryTally {
 public:
  struct Total {  // of all scores of one route
    std::uint64_t route;
    std::uint32_t port;
    double sum;
  };
  struct Score {
    std::uint64_t route;
    ScoreAddress address;
    bool off_list;  // the last walked hop met nothing that was on a list of targets
  };
  struct Arrival {
    std::uint32_t group;
    double power, absorbed;
  };
  struct Cells {  // of the maps of a receiver; Receiver::outside: none
    std::uint64_t route;
    std::uint32_t receiver, pixel, angle_pixel, quadrant;
    double power;
    bool coherent;
    double real, imaginary;  // power times cos and sin of its phase
  };

  HistoryTally(WorldView const& world, std::uint64_t seed) : world_(&world), seed_(seed) {}
  void begin(std::uint64_t history);

  // The sink of trace/history/step.hpp.
  void emitted(PathState const& path, Vertex const&) { emitted_ = path.emitted; }
  void visit(PathState const& path, Vertex const& vertex);
  void score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number, Vertex const& y,
             double coupling);
  void score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                     std::uint32_t receiver, Vertex const& end, double power);
  void score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain,
                 std::uint32_t receiver, Vertex const& end, double power);
  void wagered(double variance) { window_variance_ += variance; }
  void absorbed(GroupId group, double power);  // after the visit to the group; no group: in a medium
  void book(Fate fate, double power) { ledger_[static_cast<int>(fate)] += power; }

  std::uint64_t history() const { return history_; }
  std::uint64_t bounces() const { return bounces_; }
  std::uint64_t lost() const { return lost_; }
  double power_emitted() const { return emitted_; }
  double booked(Fate fate) const { return ledger_[static_cast<int>(fate)]; }
  double absorbed_in_media() const { return in_media_; }
  double window_variance() const { return window_variance_; }
  std::vector<Total> const& totals() const { return totals_; }
  std::vector<Score> const& scores() const { return scores_; }
  std::vector<Arrival> const& arrivals() const { return arrivals_; }
  std::vector<Cells> const& cells() const { return cells_; }

 private:
  void add(PathState const& path, Route const& route, std::uint32_t number, double coupling);
  void add_to_maps(PathState const& path, std::uint32_t receiver, Vertex const& y, std::uint64_t route, bool by_itself,
                   double power);

  WorldView const* world_;
  std::uint64_t seed_, history_ = 0, bounces_ = 0, lost_ = 0;
  double emitted_ = 0, in_media_ = 0, window_variance_ = 0;
  double ledger_[fate_count] = {};
  std::vector<Total> totals_;
  std::vector<Score> scores_;
  std::vector<Arrival> arrivals_;
  std::vector<Cells> cells_;
};

}  // namespace straytrace
