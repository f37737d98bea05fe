// SPDX-License-Identifier: BSD-3-Clause
#include "world/search/tube.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace::world {
namespace {

double squared_below(double r, double slack) {
  double const x = r * (1 - 1e-12) - slack;
  return x > 0 ? x * x : 0;
}
double squared_above(double r, double slack) {
  double const x = r * (1 + 1e-12) + slack;
  return x * x;
}

// Long parts would be met everywhere: they get a list of their own.
double longest_short_part(std::vector<TubePart> const& parts, double length) {
  return std::max(4 * length / double(parts.size()), 1e-3 * length);
}

}  // namespace

void TubeData::add(Vec3 origin, Vec3 axis, double deviation, std::vector<TubePart> const& parts) {
  TubeRecord tube;
  tube.origin = origin;
  tube.axis = axis;
  tube.along_z = axis.x == 0 && axis.y == 0 && axis.z == 1 && origin.x == 0 && origin.y == 0;
  double low = infinity, high = -infinity, reach = 0;
  for (TubePart const& p : parts) {
    low = std::min(low, p.low);
    high = std::max(high, p.high);
    reach = std::max(reach, p.reach);
  }
  double const size = std::max({std::fabs(low), std::fabs(high), reach, length(origin)});
  double const slack = 2e-13 * size + 2 * deviation;
  tube.reach2 = squared_above(reach, slack);
  tube.far2 = 1e3 * size * size;
  double const limit = longest_short_part(parts, high - low);
  std::vector<TubePart> kinds[2];  // long, short
  for (TubePart p : parts) {
    if (!tube.along_z) p.plain_kind = 0;
    kinds[p.high - p.low <= limit].push_back(p);
  }
  if (kinds[0].size() <= 4) {
    TubeSide const side = add_side(kinds[0], false, slack);
    tube.first_wall = side.first;
    tube.walls = side.count;
    if (side.count == 1 && items[side.first].plain_kind == TubeArrays::plain_wall)
      tube.sole_wall = items[side.first].ref.surface;
    kinds[0].clear();
  }
  for (int kind = 0; kind < 2; ++kind)
    for (int down = 0; down < 2; ++down) tube.side[kind][down] = add_side(kinds[kind], down != 0, slack);
  double const pad = slack + 1e-9;
  tube.bound[0][0] = low - pad;
  tube.bound[0][1] = high + pad;
  tube.bound[1][0] = -tube.bound[0][1];
  tube.bound[1][1] = -tube.bound[0][0];
  tubes.push_back(tube);
}

TubeSide TubeData::add_side(std::vector<TubePart> parts, bool down, double slack) {
  TubeSide side;
  side.first = std::uint32_t(items.size());
  side.count = std::uint32_t(parts.size());
  side.first_start = std::uint32_t(starts.size());
  if (parts.empty()) return side;
  for (TubePart& p : parts) {
    double const low = p.low - slack - 1e-9, high = p.high + slack + 1e-9;
    p.low = down ? -high : low;
    p.high = down ? -low : high;
  }
  std::ranges::sort(parts, [](TubePart const& a, TubePart const& b) {
    return a.low != b.low ? a.low < b.low : a.ref.surface < b.ref.surface;
  });
  double high = -infinity;
  for (TubePart const& p : parts) {
    double const clear2 = squared_below(p.clear, slack);
    double const reach2 = squared_above(p.reach, slack);
    items.push_back({p.low, p.high, clear2, reach2, {clear2, clear2, clear2}, p.high, p.ref, 0, p.plain_kind});
    plain.push_back(p.plain);
    behind.push_back(high = std::max(high, p.high));
  }
  find_skips(side);
  find_starts(side);
  return side;
}

// Least apertures ahead. A run ends at what closes the aperture (end discs, mirrors), so that such an item does not
// hide the clear way up to it.
void TubeData::find_skips(TubeSide const& side) {
  TubeItem* const list = items.data() + side.first;
  std::vector<double> open;
  for (std::uint32_t k = 0; k < side.count; ++k)
    if (list[k].clear2 > 0) open.push_back(list[k].clear2);
  auto const middle = open.begin() + std::ptrdiff_t(open.size() / 2);
  if (!open.empty()) std::nth_element(open.begin(), middle, open.end());
  double const closed = open.empty() ? 0 : 0.25 * *middle;
  std::uint32_t run_end = side.count;
  for (std::uint32_t k = side.count; k-- > 0;) {
    bool const alone = k + 1 == run_end || list[k].clear2 < closed || list[k + 1].clear2 < closed;
    if (alone) run_end = k + 1;
    list[k].run_end = run_end;
    if (!alone) list[k].run_high = std::max(list[k].high, list[k + 1].run_high);
    std::uint32_t const group[3] = {k | 7u, k | 63u, run_end - 1};
    for (int level = 0; level < 3; ++level)
      if (k < group[level] && k + 1 < side.count)
        list[k].skip2[level] = std::min(list[k].clear2, list[k + 1].skip2[level]);
  }
}

// A table over heights: where to begin. Its slots are a few times narrower than the items are spaced.
void TubeData::find_starts(TubeSide& side) {
  double const* const high = behind.data() + side.first;
  std::uint32_t const slots = 4 * side.count;
  double const width = (high[side.count - 1] - high[0]) / slots;
  side.z0 = high[0];
  side.scale = width > 0 ? 1 / width : 0;
  side.slots = slots;
  for (std::uint32_t i = 0; i <= slots + 1; ++i) {  // 1e-3 of a slot: rounding of the number of a height
    double const z = i == 0 ? -infinity : side.z0 + (i - 1e-3) * width;
    starts.push_back(std::uint32_t(std::lower_bound(high, high + side.count, z) - high));
  }
}

TubeArrays TubeData::view() const {
  return {{tubes.data(), tubes.size()},
          {items.data(), items.size()},
          {plain.data(), plain.size()},
          {behind.data(), behind.size()},
          {starts.data(), starts.size()}};
}

}  // namespace straytrace::world
