// SPDX-License-Identifier: BSD-3-Clause
// Do the surfaces of a filled volume close, with normals out of it? By the divergence theorem a closed body has
//   integral n dA = 0   and   integral x_i n_j dA = V delta_ij   with V > 0
// for normals n that point out. The integrals are sums over the samples of each surface at points of a regular lattice.
// A few samples settle it for most bodies; those that they leave open are asked with many.
#include <fmt/format.h>

#include <cmath>

#include "world/build/read_parts.hpp"

namespace straytrace {
namespace {

constexpr int few = 1 << 10, many = 1 << 14;  // samples per surface
constexpr double tolerance = 0.01;            // of the integrals of the magnitudes; `many` give them to about 1e-3
constexpr double clearly = 0.25;              // of the tolerance: `few` samples and `many` say the same

struct Sum {
  double value = 0, size = 0;  // with signs, without
  void add(double x) {
    value += x;
    size += std::fabs(x);
  }
  bool is(double wanted, double share) const { return std::fabs(value - wanted) <= share * tolerance * size; }
};

using Faces = std::vector<std::uint32_t>;

template <class Add>
void each_sample(WorldView const& view, Faces const& faces, int samples, Add const& add) {
  for (std::uint32_t const id : faces)
    view.shapes.visit(view.surfaces[id].shape, [&](auto const& shape) {
      double const share = shape.area() / samples;
      for (int i = 0; i < samples; ++i) {
        double const u = (i + 0.5) / samples, v = i * 0.6180339887498949;
        SurfacePoint const p = sample_of(shape, u, v - std::floor(v));
        add(p.point, normal_of(shape, p.point, p.piece), share);
      }
    });
}

struct Integrals {
  Sum normals[3], moments[3][3];
  double area = 0;

  Integrals(WorldView const& view, Faces const& faces, int samples) {
    Vec3 middle;
    each_sample(view, faces, few / 8, [&](Vec3 p, Vec3, double share) {
      middle = middle + share * p;
      area += share;
    });
    if (!(area > 0)) return;
    middle = (1 / area) * middle;
    each_sample(view, faces, samples, [&](Vec3 p, Vec3 n, double share) {
      Vec3 const o = p - middle;
      double const x[3] = {o.x, o.y, o.z}, along[3] = {n.x, n.y, n.z};
      for (int j = 0; j < 3; ++j) {
        normals[j].add(share * along[j]);
        for (int i = 0; i < 3; ++i) moments[i][j].add(share * x[i] * along[j]);
      }
    });
  }
  double enclosed() const { return (moments[0][0].value + moments[1][1].value + moments[2][2].value) / 3; }
  bool closed(double share) const {
    bool yes = true;
    for (int j = 0; j < 3; ++j) {
      yes = yes && std::fabs(normals[j].value) <= share * tolerance * area;
      for (int i = 0; i < 3; ++i) yes = yes && moments[i][j].is(i == j ? enclosed() : 0, share);
    }
    return yes;
  }
};

}  // namespace

std::vector<std::vector<std::uint32_t>> faces_of_volumes(World const& world) {
  std::vector<Faces> faces;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    std::uint32_t const volume = world.surfaces()[id].volume;
    if (volume == Surface::none) continue;
    if (volume >= faces.size()) faces.resize(volume + 1);
    faces[volume].push_back(id);
  }
  return faces;
}

std::string volume_fault(World const& world, std::vector<std::uint32_t> const& faces) {
  WorldView const view = world.view();
  Integrals const guess(view, faces, few);
  if (!(guess.area > 0) || (guess.closed(clearly) && guess.enclosed() > 0)) return {};
  Integrals const found(view, faces, many);
  if (!found.closed(1)) return "the faces with this medium do not close, or some of their normals point into it";
  if (!(found.enclosed() > 0)) return "the normals of the faces with this medium all point into it";
  return {};
}

bool encloses(World const& world, std::vector<std::uint32_t> const& faces) {
  return Integrals(world.view(), faces, few).enclosed() > 0 && volume_fault(world, faces).empty();
}

}  // namespace straytrace
