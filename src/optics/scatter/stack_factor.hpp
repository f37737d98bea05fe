// SPDX-License-Identifier: BSD-3-Clause
// Factor Q of roughness scatter from all interfaces of a thin-film stack in vacuum, first order in their heights
// (docs/theory/surfaces.md, eq. 3.29 to 3.31). Page: docs/reference/scatter/interfaces.md.
#pragma once

#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/storage.hpp"
#include "optics/coating/film.hpp"

namespace straytrace::optics {

// At one interface, for a wave of unit amplitude from the vacuum, over 2 cos and times the root of the step of the
// permittivity: the field s across the plane of incidence; for p the field along the surface, and the displacement
// across it over sin and over the root of both permittivities.
struct InterfaceField {
  Complex s, along, across;
};

// Sums over interfaces for one pair of directions.
struct StackSum {
  Complex ss, sp, ps, cc, zz;         // of heights in common
  double a = 0, b = 0, c = 0, d = 0;  // of independent heights

  STRAY_HD void add(InterfaceField const& in, InterfaceField const& out, double sines) {
    Complex const one[] = {in.s * out.s, in.s * out.along, in.along * out.s, in.along * out.along,
                           sines * (in.across * out.across)};
    a += norm(one[0]) + norm(one[3]);
    b += norm(one[1]) + norm(one[2]);
    c += one[3].re * one[4].re + one[3].im * one[4].im;
    d += norm(one[4]);
    ss = ss + one[0], sp = sp + one[1], ps = ps + one[2], cc = cc + one[3], zz = zz + one[4];
  }
  // Q, the mean over the incident and the sum over the outgoing polarisations. phi: azimuth between the plane of
  // incidence and that of scatter, 0 forward. `common`: share of the height spectrum that all interfaces have in
  // common.
  STRAY_HD double factor(double cos_phi, double common) const {
    double const square = cos_phi * cos_phi, rest = std::fmax(0.0, 1 - square);
    double const together = square * norm(ss) + norm(cos_phi * cc - zz) + rest * (norm(sp) + norm(ps));
    double const apart = square * a + rest * b - 2 * cos_phi * c + d;
    return 0.5 * std::fmax(0.0, common * together + (1 - common) * apart);
  }
};

STRAY_HD double cos_of_azimuth(Vec3 wi, Vec3 wo, double sines) {
  return sines > 1e-12 ? -(wi.x * wo.x + wi.y * wo.y) / sines : 1;
}

// The fields in a table, even in the cosine from 0 to 1, by Lagrange's cubic.
struct StackFactor {
  View<InterfaceField const> table;  // interfaces of node 0, then of node 1 ...; none: no stack
  std::int64_t nodes = 0, interfaces = 0;
  double common = 1;

  STRAY_HD double mean(Vec3 wi, Vec3 wo) const {
    double const sines = std::sqrt((wi.x * wi.x + wi.y * wi.y) * (wo.x * wo.x + wo.y * wo.y));
    Row const in(*this, wi.z), out(*this, wo.z);
    StackSum sum;
    for (std::int64_t j = 0; j < interfaces; ++j) sum.add(in.at(j), out.at(j), sines);
    return sum.factor(cos_of_azimuth(wi, wo, sines), common);
  }

  struct Row {
    InterfaceField const* first;
    std::int64_t step;
    double weight[4];

    STRAY_HD Row(StackFactor const& f, double cosine) : step(f.interfaces) {
      double const x = cosine * double(f.nodes - 1);
      std::int64_t const left = static_cast<std::int64_t>(x) - 1, last = f.nodes - 4,
                         from = left < 0      ? 0
                                : left > last ? last
                                              : left;
      double const y = x - double(from);
      weight[0] = -(y - 1) * (y - 2) * (y - 3) / 6;
      weight[1] = y * (y - 2) * (y - 3) / 2;
      weight[2] = -y * (y - 1) * (y - 3) / 2;
      weight[3] = y * (y - 1) * (y - 2) / 6;
      first = f.table.data + from * step;
    }
    STRAY_HD InterfaceField at(std::int64_t j) const {
      InterfaceField sum;
      for (int i = 0; i < 4; ++i) {
        InterfaceField const& f = first[i * step + j];
        sum.s = sum.s + weight[i] * f.s;
        sum.along = sum.along + weight[i] * f.along;
        sum.across = sum.across + weight[i] * f.across;
      }
      return sum;
    }
  };
};

// What one stack scatters, host only. `behind`: index of the body behind it, n + i k.
struct RoughStack {
  std::vector<FilmLayer> layers;  // from the front inwards
  Complex behind;
  double wavelength = 1.064e-6;  // m, vacuum
  double common = 1;             // share of the height spectrum that all interfaces have in common

  std::vector<InterfaceField> fields(double cosine) const;
  double factor(double cos_i, double cos_s, double cos_phi) const;  // Q without a table
  // Halves the step of the table until fields are right to 1e-3 of their largest; 8193 nodes at most.
  StackFactor tabulated(Storage&) const;

 private:
  Complex permittivity(std::size_t medium) const;  // 0: vacuum; then the layers; then the body
  std::vector<InterfaceField> nodes(std::int64_t count) const;
};

}  // namespace straytrace::optics
