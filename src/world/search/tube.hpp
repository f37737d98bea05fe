// SPDX-License-Identifier: BSD-3-Clause
// Builds and owns the search structure for coaxial things: world/search/tube_search.hpp.
#pragma once

#include <vector>

#include "world/search/tube_search.hpp"

namespace straytrace {

// What the structure knows of a surface: heights along the tube's axis, least and largest distance from it, m.
struct TubePart {
  double low = 0, high = 0, clear = 0, reach = 0;
  SurfaceRef ref;
  std::uint32_t plain_kind = 0;  // TubeArrays::plain_disk or plain_wall
  TubePlain plain = {};
};

struct TubeData {
  std::vector<TubeRecord> tubes;
  std::vector<TubeItem> items;
  std::vector<TubePlain> plain;
  std::vector<double> behind;
  std::vector<std::uint32_t> starts;

  // Heights of the parts are measured from `origin`; `deviation`: m, of their own axes from this one.
  void add(Vec3 origin, Vec3 axis, double deviation, std::vector<TubePart> const& parts);
  TubeArrays view() const;

 private:
  TubeSide add_side(std::vector<TubePart> parts, bool down, double slack);
  void find_skips(TubeSide const&);
  void find_starts(TubeSide&);
};

}  // namespace straytrace
