// SPDX-License-Identifier: BSD-3-Clause
// Measured BSDF: log(BSDF) against the offset |alpha - alpha_0|, one curve per measured incidence, interpolated in the
// sine of incidence. Reciprocity (docs/theory/surfaces.md, eq. 3.2) is enforced: the mean of the values for the
// incident and for the outgoing direction as incidence. Page: docs/reference/scatter/table.md.
#pragma once

#include <vector>

#include "optics/lobes/lobe_table.hpp"

namespace straytrace::optics {

struct Measured : SampledByLobe<Measured, OffsetRings> {
  static constexpr int most_incidences = 16, points = 160;
  double incidences = 0;                           // how many
  double sine[most_incidences] = {};               // increasing
  double first = 1e-3, last = 1;                   // offsets of the first and the last point, even in their log
  double dark_inside = 0;                          // offsets nearer to the specular direction than this get nothing
  double log_value[most_incidences][points] = {};  // of BSDF in 1/sr; below -700: zero
  double slope[most_incidences] = {};              // log-log, beyond the last point
  LobeTable<OffsetRings> lobe;                     // set by prepare()
  static constexpr char const* key = "table";

  void prepare();  // host

  STRAY_HD double curve(int k, int i, double share, double above) const {
    double const value = log_value[k][i] + share * (log_value[k][i + 1] - log_value[k][i]) + slope[k] * above;
    return value;
  }
  // Where an offset lies in the curves.
  struct Place {
    int i = 0;
    double share = 0, above = 0;
  };
  STRAY_HD Place place(double offset) const {
    double const step = log_positive(last / first) / (points - 1);
    double x = offset > first ? log_positive(offset / first) / step : 0, above = 0;
    if (x > points - 1) {
      above = (x - (points - 1)) * step;
      x = points - 1;
    }
    int const i = x < points - 1 ? static_cast<int>(x) : points - 2;
    return {i, x - i, above};
  }
  // BSDF for an incidence of this sine, before symmetrisation.
  STRAY_HD double one_way(double sin_i, Place const& at) const {
    int k = 0;
    while (k + 2 < incidences && sine[k + 1] <= sin_i) ++k;
    double value = curve(k, at.i, at.share, at.above);
    if (incidences > 1) {
      double const t = (sin_i - sine[k]) / (sine[k + 1] - sine[k]), share = t < 0 ? 0 : t > 1 ? 1 : t;
      value += share * (curve(k + 1, at.i, at.share, at.above) - value);
    }
    return value > -700 ? exp_number(value) : 0;
  }
  STRAY_HD double one_way(double sin_i, double offset) const {
    return offset < dark_inside ? 0 : one_way(sin_i, place(offset));
  }
  STRAY_HD double value_at(Vec3 wi, Vec3 wo, double r2) const {
    double const offset = std::sqrt(r2);
    if (offset < dark_inside) return 0;
    Place const at = place(offset);
    double const there = one_way(std::sqrt(wi.x * wi.x + wi.y * wi.y), at);
    if (incidences == 1) return there;
    return 0.5 * (there + one_way(std::sqrt(wo.x * wo.x + wo.y * wo.y), at));
  }
};

// One line of a file, and a summary of all lines.
struct MeasuredPoint {
  double sin_i, offset, value;  // value in 1/sr, above 0
};
enum class Beyond { constant, power, zero };
struct MeasuredSummary {
  double smallest_offset = 0, largest_offset = 0;  // measured at every incidence
  double reach = 1;                                // smallest share of the offsets above the horizon, 1 + sin theta_i
  double spread = 0;                               // largest ratio of points of one incidence at the same offset
  double asymmetry = 1;                            // largest ratio of f(i, s) and f(s, i) before symmetrisation
};
// Fills everything but the lobe. At most 16 incidences with two points each.
MeasuredSummary fit_measured(Measured&, std::vector<MeasuredPoint>, Beyond);

}  // namespace straytrace::optics
