// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/angle_weight.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace straytrace::optics {

AngleWeight weight_of(LawPool const& pool, PoolRef ref, std::function<double(double)> const& weight) {
  constexpr int across = 256, around = 32;
  AngleWeight w;
  for (int i = 0; i < AlbedoTable::size; ++i) {
    w.root.value[i] = std::sqrt(weight(AlbedoTable::cosine(i)));
    w.most = std::max(w.most, w.root.value[i]);
  }
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double const cosine = std::max(AlbedoTable::cosine(i), 1e-9);
    Vec3 const wi{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    double plain = 0, weighted = 0;
    pool.visit(ref, [&](auto const& law) {
      for (int k = 0; k < across * around; ++k) {
        BsdfSample const s = law.sample(wi, (k % across + 0.5) / across, (k / across + 0.5) / around);
        if (!(s.pdf > 0)) continue;
        double const value = law.eval(wi, s.wo) * s.wo.z / s.pdf;
        plain += value;
        weighted += value * w.root.at(s.wo.z);
      }
      w.albedo.value[i] = plain > 0 ? law.albedo(cosine) * w.root.value[i] * weighted / plain : 0;
    });
  }
  return w;
}

namespace {

constexpr int size = AlbedoTable::size;
using Matrix = std::vector<double>;  // [i * size + j]: share of light incident at angle i that leaves near angle j

// Node of the table below a cosine.
int below(double cosine) {
  int low = 0, high = size - 1;
  while (high - low > 1) {
    int const mid = (low + high) / 2;
    (AlbedoTable::cosine(mid) <= cosine ? low : high) = mid;
  }
  return low;
}

// On a grid of the model's own samples, which resolves narrow lobes as well as wide ones.
Matrix kernel(LawPool const& pool, PoolRef ref) {
  constexpr int across = 256, around = 32;
  Matrix m(size * size, 0.0);
  for (int i = 0; i < size; ++i) {
    double const cosine = std::max(AlbedoTable::cosine(i), 1e-9);
    Vec3 const wi{std::sqrt(1 - cosine * cosine), 0, cosine};
    pool.visit(ref, [&](auto const& law) {
      for (int k = 0; k < across * around; ++k) {
        double const u = (k % across + 0.5) / across, v = (k / across + 0.5) / around;
        BsdfSample const s = law.sample(wi, u, v);
        if (!(s.pdf > 0)) continue;
        double const weight = law.eval(wi, s.wo) * s.wo.z / s.pdf / (across * around);
        int const j = below(s.wo.z);
        double const low = AlbedoTable::cosine(j), share = (s.wo.z - low) / (AlbedoTable::cosine(j + 1) - low);
        m[i * size + j] += weight * (1 - share);
        m[i * size + j + 1] += weight * share;
      }
    });
  }
  return m;
}

std::vector<double> product(Matrix const& m, std::vector<double> const& g) {
  std::vector<double> out(size, 0.0);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) out[i] += m[i * size + j] * g[j];
  return out;
}

}  // namespace

AngleWeight weight_for_share(LawPool const& pool, PoolRef ref, std::function<double(double)> const& share) {
  Matrix const m = kernel(pool, ref);
  std::vector<double> wanted(size), g(size, 1.0);
  for (int i = 0; i < size; ++i) wanted[i] = std::max(0.0, share(AlbedoTable::cosine(i)));
  for (int round = 0; round < 200; ++round) {
    std::vector<double> const sum = product(m, g);
    for (int i = 0; i < size; ++i) g[i] = sum[i] > 0 ? std::sqrt(g[i] * wanted[i] / sum[i]) : 0;
  }
  AngleWeight weight;
  std::vector<double> const sum = product(m, g);
  for (int i = 0; i < size; ++i) {
    weight.root.value[i] = g[i];
    weight.albedo.value[i] = g[i] * sum[i];
    weight.most = std::max(weight.most, g[i]);
  }
  return weight;
}

}  // namespace straytrace::optics
