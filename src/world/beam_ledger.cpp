// SPDX-License-Identifier: BSD-3-Clause
// Sums and lists of what a beam tree brings.
#include <algorithm>

#include "world/beam_tree.hpp"

namespace straytrace {
namespace {

class SpotList final : public BeamSink {
 public:
  explicit SpotList(std::size_t most) : most_(most) {}
  void arrived(BeamSpot const& spot, std::uint32_t, std::span<BeamStep const>) override {
    spots_.push_back(spot);
    if (spots_.size() >= 2 * most_) keep();
  }
  std::vector<BeamSpot> take() {
    keep();
    return std::move(spots_);
  }

 private:
  void keep() {
    std::stable_sort(spots_.begin(), spots_.end(), [](BeamSpot const& a, BeamSpot const& b) {
      return a.order != b.order ? a.order < b.order : a.power > b.power;
    });
    if (spots_.size() > most_) spots_.resize(most_);
  }
  std::size_t most_;
  std::vector<BeamSpot> spots_;
};

}  // namespace

char const* name_of(BeamEnd end) {
  static constexpr char const* names[] = {"landed", "escaped", "rejoined", "faint", "longest", "wide"};
  return names[std::size_t(end)];
}

double BeamLedger::total() const {
  LongSum sum;
  for (double column : {double(media), double(escaped), double(rejoined), double(floor), double(order), double(longest),
                        double(wide), double(stopped)})
    sum += column;
  for (Object const& o : objects) {
    sum += o.landed;
    sum += o.beside;
  }
  return sum;
}

std::vector<BeamSpot> beam_spots(World const& world, BeamLaunch const& launch, TreeLimits const& limits,
                                 std::size_t most) {
  SpotList list(most);
  grow_tree(world, launch, limits, list);
  return list.take();
}

}  // namespace straytrace
