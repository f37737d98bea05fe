// SPDX-License-Identifier: BSD-3-Clause
#include "optics/grooves.hpp"

namespace straytrace {
namespace {

// Mean of eval cos/pdf over a grid of (u, v), dense at v = 1, where the steep normals of the long tail are; it is
// continuous, because G vanishes at the horizon.
double total(Grooves const& law, Vec3 wi) {
  constexpr int across = 48, around = 64;
  auto const cell = [](int j) { return double(j) * j * j * j / (double(across) * across * across * across); };
  double sum = 0;
  for (int j = 0; j < across; ++j) {
    double const x = (j + 0.5) / across, width = cell(j + 1) - cell(j);
    for (int i = 0; i < around; ++i) {
      BsdfSample const s = law.sample(wi, (i + 0.5) / around, 1 - x * x * x * x);
      if (s.pdf > 0) sum += width * law.eval(wi, s.wo) * s.wo.z / s.pdf;
    }
  }
  return sum / around;
}

Vec3 incoming(double cosine, double cos_azimuth) {
  double const sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {sine * cos_azimuth, sine * std::sqrt((1 - cos_azimuth) * (1 + cos_azimuth)), cosine};
}

}  // namespace

void Grooves::prepare() {
  constexpr double lowest = 1e-9;  // stands for the limit at grazing
  constexpr int turns = 64;
  for (int k = 0; k < AlbedoTable::size; ++k) {
    double const cosine = std::fmax(AlbedoTable::cosine(k), lowest);
    for (int i = 0; i < azimuths; ++i) totals[i].value[k] = total(*this, incoming(cosine, azimuth_cosine(i)));
    double sum = 0;
    for (int i = 0; i < turns; ++i) sum += albedo(incoming(cosine, sincos_turn(0.25 * (i + 0.5) / turns).cos));
    mean.value[k] = sum / turns;
  }
}

}  // namespace straytrace
