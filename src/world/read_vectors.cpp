// SPDX-License-Identifier: BSD-3-Clause
// Vectors and directions of a scene. What does not name a number is reported where it stands, and only there.
#include <algorithm>
#include <cmath>

#include "world/read_parts.hpp"

namespace straytrace {

Vec3 read_vector(Node const& list, Dimension dimension) {
  auto const v = list.as_numbers(dimension, 3);
  return v.size() == 3 ? Vec3{v[0], v[1], v[2]} : Vec3{not_a_number, not_a_number, not_a_number};
}

bool some_missing(std::vector<double> const& numbers) {
  return std::any_of(numbers.begin(), numbers.end(), [](double x) { return std::isnan(x); });
}

std::optional<Vec3> read_direction(Node const& list) {
  Vec3 const v = read_vector(list, dim::plain);
  double const size = length(v);
  if (std::isnan(size)) return {};  // a number that is not there is reported
  if (size > 0 && size < infinity) return unit(v);
  list.problem(size > 0 ? "a direction too long to compute with" : "a direction of length zero",
               "write for example [0, 0, 1]");
  return {};
}

}  // namespace straytrace
