// SPDX-License-Identifier: BSD-3-Clause
// Do the surfaces of a filled volume close, with normals out of it? By the divergence theorem a closed body has
//   integral n dA = 0   and   integral x_i n_j dA = V delta_ij   with V > 0
// for normals n that point out. The integrals are sums over the samples of each surface at points of a regular lattice.
#include <fmt/format.h>

#include <cmath>

#include "world/read_parts.hpp"

namespace straytrace {
namespace {

constexpr int samples = 1 << 14;  // per surface: integrals to about 1e-3 of the integrals of the magnitudes
constexpr double tolerance = 0.01;

struct Sum {
  double value = 0, size = 0;  // with signs, without
  void add(double x) {
    value += x;
    size += std::fabs(x);
  }
  bool is(double wanted) const { return std::fabs(value - wanted) <= tolerance * size; }
};

template <class Add>
void each_sample(WorldView const& view, std::uint32_t volume, Add const& add) {
  for (std::uint32_t id = 0; id < view.surfaces.size; ++id) {
    if (view.surfaces[id].volume != volume) continue;
    view.shapes.visit(view.surfaces[id].shape, [&](auto const& shape) {
      double const share = shape.area() / samples;
      for (int i = 0; i < samples; ++i) {
        double const u = (i + 0.5) / samples, v = i * 0.6180339887498949;
        SurfacePoint const p = sample_of(shape, u, v - std::floor(v));
        add(p.point, normal_of(shape, p.point, p.piece), share);
      }
    });
  }
}

}  // namespace

std::string volume_fault(World const& world, std::uint32_t volume) {
  WorldView const view = world.view();
  Vec3 middle;
  double area = 0;
  each_sample(view, volume, [&](Vec3 p, Vec3, double share) {
    middle = middle + share * p;
    area += share;
  });
  if (!(area > 0)) return {};
  middle = (1 / area) * middle;
  Sum normals[3], moments[3][3];
  each_sample(view, volume, [&](Vec3 p, Vec3 n, double share) {
    Vec3 const o = p - middle;
    double const x[3] = {o.x, o.y, o.z}, along[3] = {n.x, n.y, n.z};
    for (int j = 0; j < 3; ++j) {
      normals[j].add(share * along[j]);
      for (int i = 0; i < 3; ++i) moments[i][j].add(share * x[i] * along[j]);
    }
  });
  double const enclosed = (moments[0][0].value + moments[1][1].value + moments[2][2].value) / 3;
  bool closed = true;
  for (int j = 0; j < 3; ++j) {
    closed = closed && std::fabs(normals[j].value) <= tolerance * area;
    for (int i = 0; i < 3; ++i) closed = closed && moments[i][j].is(i == j ? enclosed : 0);
  }
  if (!closed) return "the faces with this medium do not close, or some of their normals point into it";
  if (!(enclosed > 0)) return "the normals of the faces with this medium all point into it";
  return {};
}

}  // namespace straytrace
