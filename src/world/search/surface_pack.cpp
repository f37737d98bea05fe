// SPDX-License-Identifier: BSD-3-Clause
#include "world/search/surface_pack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace straytrace {
namespace {

float outward(double x, float towards) { return std::nextafter(float(x), towards); }

}  // namespace

void SurfacePack::set(int lane, SearchItem const& item, Vec3 origin, double largest, double widen) {
  constexpr float far = std::numeric_limits<float>::infinity();
  Vec3 const from = item.reference - origin;
  double const where[3] = {from.x, from.y, from.z}, along[3] = {item.axis.x, item.axis.y, item.axis.z};
  double const reach = std::max({std::fabs(from.x), std::fabs(from.y), std::fabs(from.z), largest});
  // The rounded axis and centre: heights and radii change by less than 2^-23 of the coordinates.
  double const pad = 0x1p-18 * reach * widen;
  for (int k = 0; k < 3; ++k) {
    centre[k][lane] = float(where[k]);
    axis[k][lane] = float(along[k]);
  }
  double const inner = std::max(item.r_min - pad, 0.0), outer = item.r_max + pad;
  low[lane] = outward(item.low - pad, -far);
  high[lane] = outward(item.high + pad, far);
  inner2[lane] = inner > 0 ? outward(inner * inner, -far) : 0;
  outer2[lane] = outward(outer * outer, far);
  ref[lane] = item.ref;
}

}  // namespace straytrace
