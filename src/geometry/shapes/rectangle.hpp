// SPDX-License-Identifier: BSD-3-Clause
// Rectangle, with or without a rectangular hole. Keys: rectangle.cpp; page: docs/reference/shapes/rectangle.md.
#pragma once

#include "geometry/common/plane_frame.hpp"

namespace straytrace {

struct Rectangle : PlaneFrame {
  double width = 1, height = 1;            // m, full sizes along e1 and e2
  double hole_width = 0, hole_height = 0;  // m
  static constexpr char const* key = "rectangle";

  STRAY_HD double distance(Ray const& r, bool leaving) const {
    return meet(r, leaving, [this](double x, double y) {
      double const two_x = 2 * std::fabs(x), two_y = 2 * std::fabs(y);
      return two_x <= width && two_y <= height && !(two_x < hole_width && two_y < hole_height);
    });
  }
  STRAY_HD double area() const { return width * height - hole_width * hole_height; }
  // Bars of full height left and right of the hole, then bars of the width of the hole below and above it.
  STRAY_HD Vec3 sample(double u, double v) const {
    double const bars = (width - hole_width) * height, s = u * area();
    if (s < bars || hole_width == 0) {
      double const x = s / height;
      return at(x - 0.5 * width + (2 * x < width - hole_width ? 0 : hole_width), (v - 0.5) * height);
    }
    double const y = (s - bars) / hole_width;
    return at((v - 0.5) * hole_width, y - 0.5 * height + (2 * y < height - hole_height ? 0 : hole_height));
  }
  STRAY_HD void extent(double& low, double& high, double& r_min, double& r_max) const {
    low = high = 0;
    r_min = 0.5 * std::fmin(hole_width, hole_height);
    r_max = 0.5 * std::sqrt(width * width + height * height);
  }
  STRAY_HD Box bounds() const {
    Vec3 const a = 0.5 * width * e1, b = 0.5 * height * e2;
    Vec3 const side{std::fabs(a.x) + std::fabs(b.x), std::fabs(a.y) + std::fabs(b.y), std::fabs(a.z) + std::fabs(b.z)};
    return {origin - side, origin + side};
  }
};

}  // namespace straytrace
