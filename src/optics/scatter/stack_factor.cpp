// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/stack_factor.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace::optics {
namespace {

// Tangential fields at one depth: the one that continues as `first`, and its partner.
struct Tangential {
  Complex first, second;
};

// From the lower to the upper face of a layer, where a wave downwards has second = admittance first.
Tangential lifted(Tangential at, Complex q, Complex admittance, double thickness_in_wavelengths) {
  Complex const turns = thickness_in_wavelengths * q, e = exp_turns(turns), back = exp_turns(-turns);
  Complex const cosine = 0.5 * (e + back), sine = 0.5 * (e - back);  // sine: i sin
  return {cosine * at.first - sine * (at.second / admittance), cosine * at.second - sine * (admittance * at.first)};
}

double largest(InterfaceField const& f) { return std::sqrt(std::max({norm(f.s), norm(f.along), norm(f.across)})); }

}  // namespace

Complex RoughStack::permittivity(std::size_t medium) const {
  if (medium == 0) return {1, 0};
  Complex const n = medium <= layers.size() ? layers[medium - 1].index : behind;
  return n * n;
}

std::vector<InterfaceField> RoughStack::fields(double cosine) const {
  std::size_t const count = layers.size() + 1;
  double const sin2 = (1 - cosine) * (1 + cosine);
  std::vector<InterfaceField> f(count);
  auto const root = [&](std::size_t medium) {
    Complex const q = upper_root(permittivity(medium) - Complex{sin2, 0});
    return norm(q) > 1e-24 ? q : Complex{1e-12, 0};
  };
  Complex const q_last = root(count);
  Tangential s{{1, 0}, q_last}, p{{1, 0}, q_last / permittivity(count)};  // E and H; H and E along the surface
  for (std::size_t j = count; j-- > 0;) {
    f[j] = {s.first, p.second, p.first};
    if (j == 0) break;
    Complex const q = root(j);
    double const turns = layers[j - 1].thickness / wavelength;
    s = lifted(s, q, q, turns);
    p = lifted(p, q, q / permittivity(j), turns);
    if (norm(s.first) + norm(p.first) < 1e200) continue;
    for (std::size_t k = j; k < count; ++k)  // an opaque layer: what lies below it stays dark
      f[k] = {1e-100 * f[k].s, 1e-100 * f[k].along, 1e-100 * f[k].across};
    s = {1e-100 * s.first, 1e-100 * s.second};
    p = {1e-100 * p.first, 1e-100 * p.second};
  }
  Complex const s_in = cosine * s.first + s.second, p_in = cosine * p.first + p.second;
  for (std::size_t j = 0; j < count; ++j) {
    Complex const above = permittivity(j), below = permittivity(j + 1), step = upper_root(below - above);
    f[j] = {step * f[j].s / s_in, step * f[j].along / p_in, step / upper_root(above * below) * f[j].across / p_in};
  }
  return f;
}

double RoughStack::factor(double cos_i, double cos_s, double cos_phi) const {
  double const sines = std::sqrt((1 - cos_i) * (1 + cos_i) * (1 - cos_s) * (1 + cos_s));
  auto const in = fields(cos_i), out = fields(cos_s);
  StackSum sum;
  for (std::size_t j = 0; j < in.size(); ++j) sum.add(in[j], out[j], sines);
  return sum.factor(cos_phi, common);
}

std::vector<InterfaceField> RoughStack::nodes(std::int64_t count) const {
  std::vector<InterfaceField> all;
  for (std::int64_t i = 0; i < count; ++i) {
    auto const here = fields(double(i) / double(count - 1));
    all.insert(all.end(), here.begin(), here.end());
  }
  return all;
}

StackFactor RoughStack::tabulated(Storage& storage) const {
  constexpr double tolerance = 1e-3;
  StackFactor f;
  f.interfaces = std::int64_t(layers.size()) + 1;
  f.common = common;
  for (f.nodes = 257;; f.nodes = 2 * f.nodes - 1) {
    auto table = nodes(f.nodes);
    f.table = {table.data(), table.size()};
    double error = 0, most = 0;
    for (std::int64_t i = 0; i + 1 < f.nodes && f.nodes < 8193; ++i) {
      double const cosine = (double(i) + 0.5) / double(f.nodes - 1);
      auto const exact = fields(cosine);
      StackFactor::Row const row(f, cosine);
      for (std::int64_t j = 0; j < f.interfaces; ++j) {
        InterfaceField const a = exact[std::size_t(j)], b = row.at(j);
        most = std::max(most, largest(a));
        error = std::max(error, largest({a.s - b.s, a.along - b.along, a.across - b.across}));
      }
    }
    if (error > tolerance * most) continue;
    f.table = storage.keep_large(std::move(table));
    return f;
  }
}

}  // namespace straytrace::optics
