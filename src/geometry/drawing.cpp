// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/drawing.hpp"

#include <algorithm>

namespace straytrace::geometry {
namespace {

double area_of(Drawing const& d, std::array<std::uint32_t, 3> const& t) {
  return 0.5 * length(cross(d.points[t[1]] - d.points[t[0]], d.points[t[2]] - d.points[t[0]]));
}

}  // namespace

double Drawing::area() const {
  double sum = 0;
  for (auto const& t : triangles) sum += area_of(*this, t);
  return sum;
}

void Drawing::drop_collapsed() {
  double const least = 1e-12 * area() / double(std::max<std::size_t>(triangles.size(), 1));
  std::erase_if(triangles, [&](auto const& t) { return !(area_of(*this, t) > least); });
}

}  // namespace straytrace::geometry
