// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/grooves.hpp"

namespace straytrace {
namespace {

Vec3 incoming(double cosine, double cos_azimuth) {
  double const sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {sine * cos_azimuth, sine * std::sqrt((1 - cos_azimuth) * (1 + cos_azimuth)), cosine};
}

}  // namespace

Vec3 Grooves::node(int row, int column) const {
  constexpr double lowest = 1e-12;  // stands for the limit at grazing
  double const ratio = along / across, c = std::fmin(1, ratio * uncrowded(row / (azimuths - 1.0), 1 / ratio));
  double const a = width(c), cosine = a * uncrowded(column / (cosines - 1.0), 1 / a);
  return incoming(std::fmin(1, std::fmax(cosine, lowest)), c);
}

void Grooves::prepare() {
  for (int i = 0; i < azimuths; ++i)
    for (int k = 0; k < cosines; ++k) {
      Vec3 const wi = node(i, k);
      totals[i][k] = facets_total({across, along, reflectance, grazing}, wi) - factor(wi.z);
    }
  constexpr int turns = 64;
  for (int k = 0; k < AlbedoTable::size; ++k) {
    double sum = 0;
    for (int i = 0; i < turns; ++i)
      sum += albedo(incoming(AlbedoTable::cosine(k), sincos_turn(0.25 * (i + 0.5) / turns).cos));
    mean.value[k] = sum / turns;
  }
}

}  // namespace straytrace
