// SPDX-License-Identifier: BSD-3-Clause
// ABg scatter law: BSDF = A/(B + |alpha - alpha_0|^g), alpha = projection of the outgoing direction on the surface,
// alpha_0 the same for the specular direction (physics.md eq. 3.16). Page: docs/reference/scatter/abg.md.
#pragma once

#include "optics/bsdf.hpp"

namespace straytrace {

struct Abg {
  double a = 0, b = 1, g = 2;  // 1/sr, 1, 1
  AlbedoTable table;           // set by prepare()
  // Sampling: rings of |alpha - alpha_0| with constant density inside each; cumulative[i] = share inside ring edge i.
  static constexpr int rings = 96;
  double edge[rings + 1] = {}, cumulative[rings + 1] = {};
  static constexpr char const* key = "abg";

  void prepare();  // host: rings and albedo table

  STRAY_HD double value(double offset) const { return a / (b + (offset > 0 ? power_positive(offset, g) : 0)); }
  STRAY_HD static double offset(Vec3 wi, Vec3 wo) {
    double const x = wo.x + wi.x, y = wo.y + wi.y;
    return std::sqrt(x * x + y * y);
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const { return wi.z > 0 && wo.z > 0 ? value(offset(wi, wo)) : 0; }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    return ring_density(ring_of(offset(wi, wo), edge)) * wo.z;
  }
  STRAY_HD double albedo(double cos_i) const { return table.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    int const i = ring_of(u, cumulative);
    double const share = (u - cumulative[i]) / (cumulative[i + 1] - cumulative[i]);
    double const rho = std::sqrt(edge[i] * edge[i] + share * (edge[i + 1] * edge[i + 1] - edge[i] * edge[i]));
    SinCos const azimuth = sincos_turn(v);
    double const x = -wi.x + rho * azimuth.cos, y = -wi.y + rho * azimuth.sin, z2 = 1 - x * x - y * y;
    if (!(z2 > 0)) return {};
    Vec3 const wo{x, y, std::sqrt(z2)};
    return {wo, ring_density(i) * wo.z};
  }

  // Density per unit area of direction cosines (dA = cos dOmega).
  STRAY_HD double ring_density(int i) const {
    return (cumulative[i + 1] - cumulative[i]) / (pi * (edge[i + 1] * edge[i + 1] - edge[i] * edge[i]));
  }
  STRAY_HD static int ring_of(double x, double const* edges) {
    int low = 0, high = rings;
    while (high - low > 1) {
      int const mid = (low + high) / 2;
      (edges[mid] <= x ? low : high) = mid;
    }
    return low;
  }
};

}  // namespace straytrace
