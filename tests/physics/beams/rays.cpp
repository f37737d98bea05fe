// SPDX-License-Identifier: BSD-3-Clause
// The curvature of a beam behind a tilted, wedged lens and a tilted mirror against exact rays of its wavefront
// (docs/theory/beams.md), and ray matrices of the same surfaces.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "beams/eigenmode.hpp"
#include "support/beams_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_rays {
namespace {

using testing::ExactRay, testing::spherical_face, testing::through_sphere;
constexpr Vec3 along_z{0, 0, 1};

// Exact rays. The rays of a wavefront with Q real start normal to it and meet a lens of two spheres, tilted and
// decentred, as a wedge with curved faces. Each leaves at the point and in the direction given by the propagated Q: the
// slope against the offset, by differences of opposite rays (the error falls with the square of their distance).
struct Bench {
  Vec3 lens1, normal1, lens2, normal2, mirror, normal3;
  double roc1 = 0.8, roc2 = -0.6, roc3 = 1.1, n = 1.45;
};
// The chief ray along z and the rest of the bench about it.
Bench bench() {
  Bench b;
  b.lens1 = {0, 0, 0.3};
  b.normal1 = unit({0.3, 0.2, -1});
  ExactRay const in{{}, along_z}, glass = through_sphere(in, b.lens1, b.normal1, b.roc1, 1, b.n);
  b.lens2 = glass.point + 0.05 * glass.dir;
  b.normal2 = unit({-0.1, 0.25, -1});
  ExactRay const air = through_sphere(glass, b.lens2, b.normal2, b.roc2, b.n, 1);
  b.mirror = air.point + 0.4 * air.dir;
  b.normal3 = unit({0.2, -0.5, -1});
  return b;
}
ExactRay through(Bench const& b, ExactRay r) {
  r = through_sphere(r, b.lens1, b.normal1, b.roc1, 1, b.n);
  r = through_sphere(r, b.lens2, b.normal2, b.roc2, b.n, 1);
  return through_sphere(r, b.mirror, b.normal3, b.roc3, 1, 0);
}
BeamPath followed(Bench const& b, Mode const& m) {
  return follow(
      m, 1,
      std::array{spherical_face(b.lens1, b.normal1, b.roc1, b.n), spherical_face(b.lens2, b.normal2, b.roc2, 1),
                 spherical_mirror(b.mirror, b.normal3, b.roc3)});
}

// Slope minus Q times offset of exact rays, at the end of the bench, over the largest slope.
double slope_error(Mode const& start, Bench const& exact, Mode const& out, double size) {
  double worst = 0, largest = 0;
  for (int i = 0; i < 8; ++i) {
    std::array<double, 2> offset[2], slope[2];
    for (int side : {0, 1}) {
      double const x = (side ? -size : size) * std::cos(i * pi / 8), y = (side ? -size : size) * std::sin(i * pi / 8);
      Vec3 const bend = (start.q11.real() * x + start.q12.real() * y) * start.e1 +
                        (start.q12.real() * x + start.q22.real() * y) * start.e2;
      ExactRay r = through(exact, {start.origin + x * start.e1 + y * start.e2, unit(start.travel + bend)});
      double const along = dot(out.origin - r.point, out.travel) / dot(r.dir, out.travel);
      Vec3 const p = r.point + along * r.dir - out.origin;
      offset[side] = {dot(p, out.e1), dot(p, out.e2)};
      slope[side] = {dot(r.dir, out.e1) / dot(r.dir, out.travel), dot(r.dir, out.e2) / dot(r.dir, out.travel)};
    }
    double const u = offset[0][0] - offset[1][0], v = offset[0][1] - offset[1][1];
    double const s = slope[0][0] - slope[1][0], t = slope[0][1] - slope[1][1];
    worst = std::max({worst, std::fabs(s - out.q11.real() * u - out.q12.real() * v),
                      std::fabs(t - out.q12.real() * u - out.q22.real() * v)});
    largest = std::max({largest, std::fabs(s), std::fabs(t)});
  }
  return worst / largest;
}

TEST(beam_path, exact_rays_agree_with_the_curvature) {
  Bench const b = bench();
  Mode start = circular_mode({}, along_z, 1, 0, 1e-15);  // no diffraction: Im Q is 1e-16 of Re Q
  start.q11 += 0.4, start.q22 -= 0.7, start.q12 += 0.3;
  Mode const out = followed(b, start).mode;
  double const coarse = slope_error(start, b, out, 2e-3), fine = slope_error(start, b, out, 1e-3);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.1);  // only higher orders of the rays are left
  EXPECT_LT(slope_error(start, b, out, 2e-5), 1e-7);
  Bench flatter = b;
  flatter.roc2 = -0.61;
  EXPECT_GT(slope_error(start, b, followed(flatter, start).mode, 1e-3), 1e-3);
  Bench untilted = b;  // the same lens met straight on
  untilted.normal1 = {0, 0, -1};
  Mode const straight = refracted(propagated(start, 0.3), untilted.normal1,
                                  spherical_face({}, untilted.normal1, b.roc1, b.n).curvature, 1, b.n);
  Mode const tilted =
      refracted(propagated(start, 0.3), b.normal1, spherical_face({}, b.normal1, b.roc1, b.n).curvature, 1, b.n);
  EXPECT_GT(std::abs(straight.q11 - tilted.q11), 1e-2);
}

// How far M is from symplectic: M^T J M = J.
double not_symplectic(RayMatrix const& m) {
  RayMatrix j = RayMatrix::Zero();
  j.topRightCorner<2, 2>().setIdentity();
  j.bottomLeftCorner<2, 2>() = -j.topRightCorner<2, 2>();
  return (m.transpose() * j * m - j).norm();
}

TEST(ray_matrix, is_symplectic_and_carries_the_curvature) {
  testing::Dice dice(9);
  for (int i = 0; i < 30; ++i) {
    Vec3 const normal = dice.near({0, 0, -1}, 0.7);
    OpticalElement const first{{0, 0, 1}, normal, dice.curved(normal, 0.5), i % 2 == 0, 1.7};
    Mode const start = testing::twisted_mode(dice, {}, along_z, 1e-3, 1e-6);
    BeamPath const one = follow(start, 1, std::array{first});
    Vec3 const next = dice.near(-one.mode.travel, 0.4);
    bool const mirror = i % 4 == 1;  // also one inside the glass of the first face
    OpticalElement const second{one.mode.origin + 0.6 * one.mode.travel, next, dice.curved(next, 0.3), mirror, 1.1};
    BeamPath const path = follow(start, 1, std::array{first, second});
    EXPECT_LT(not_symplectic(path.rays), 1e-12);
    Eigen::Matrix2cd q;
    q << start.q11, start.q12, start.q12, start.q22;
    Eigen::Matrix2cd const after = transformed(path.rays, q) / path.index;
    double const size = after.norm();
    EXPECT_LT(std::abs(after(0, 0) - path.mode.q11), 1e-11 * size);
    EXPECT_LT(std::abs(after(0, 1) - path.mode.q12), 1e-11 * size);
    EXPECT_LT(std::abs(after(1, 1) - path.mode.q22), 1e-11 * size);
    RayMatrix plain = path.rays;  // slopes without the index
    plain.bottomRows<2>() /= path.index;
    EXPECT_GT(not_symplectic(plain), 0.01);
  }
}

// Columns of the matrix are exact rays near the chief ray.
TEST(ray_matrix, columns_are_rays_traced_exactly) {
  Bench const b = bench();
  Mode const start = circular_mode({}, along_z, 1, 0, 1e-6);
  BeamPath const path = followed(b, start);
  double const step = 1e-6;
  for (int column = 0; column < 4; ++column) {
    std::array<std::array<double, 4>, 2> end;
    for (int side : {0, 1}) {
      double const s = side ? -step : step;
      Vec3 const axis = column % 2 ? start.e2 : start.e1;
      ExactRay const in{column < 2 ? s * axis : Vec3{}, column < 2 ? along_z : unit(along_z + s * axis)};
      ExactRay r = through(b, in);
      Mode const& out = path.mode;
      r.point = r.point + (dot(out.origin - r.point, out.travel) / dot(r.dir, out.travel)) * r.dir;
      Vec3 const p = r.point - out.origin;
      end[static_cast<std::size_t>(side)] = {dot(p, out.e1), dot(p, out.e2), dot(r.dir, out.e1), dot(r.dir, out.e2)};
    }
    for (int row = 0; row < 4; ++row) {
      auto const i = static_cast<std::size_t>(row);
      EXPECT_NEAR((end[0][i] - end[1][i]) / (2 * step), path.rays(row, column), 1e-8) << row << column;
    }
    EXPECT_GT(std::fabs(path.rays(column, (column + 1) % 2)), 1e-3);  // the axes are coupled: not two 2x2 matrices
  }
}

TEST(beam_path, errors_name_where_the_chief_ray_misses) {
  Mode const start = circular_mode({}, along_z, 1e-3, 0, 1e-6);
  auto const at = [](Vec3 p) { return std::array{spherical_mirror(p, {0, 0, -1}, 1)}; };
  EXPECT_NO_THROW(follow(start, 1, at({0, 0, 2})));
  EXPECT_THROW(follow(start, 1, at({1e-3, 0, 2})), NumericalError);
  EXPECT_THROW(follow(start, 1, at({0, 0, -2})), NumericalError);
}

// B13: rings about the beam of LHO, seen at about 20 degrees: light of the arm on the bevel of the input mirror (45
// degrees assumed, n 1.45) leaves by its flat back. Snell twice: asin(n sin(45 deg - asin(sin 45 deg/n))) = 23.3 deg.
double ring_angle(Vec3 bevel, Vec3 back) {
  Mode const beam = circular_mode({0, 0, -1}, along_z, 0.05, 0, 1.064e-6);
  OpticalElement const in = spherical_face({}, bevel, infinity, 1.45);
  Mode const glass = follow(beam, 1, std::array{in}).mode;
  OpticalElement const out = spherical_face(glass.origin + 0.2 * glass.travel, back, infinity, 1);
  return std::acos(follow(beam, 1, std::array{in, out}).mode.travel.z) * 180 / pi;
}

TEST(beam_path, bevel_of_an_input_mirror_b13) {
  Vec3 const bevel = unit({1, 0, -1}), flat{0, 0, -1};
  double const within = pi / 4 - std::asin(std::sin(pi / 4) / 1.45);
  EXPECT_NEAR(ring_angle(bevel, flat), std::asin(1.45 * std::sin(within)) * 180 / pi, 1e-9);
  EXPECT_NEAR(ring_angle(bevel, flat), 20, 4);
  EXPECT_NEAR(ring_angle(bevel, bevel), 0, 1e-6);  // control: a back parallel to the bevel makes no ring
}

}  // namespace
}  // namespace straytrace::beams_rays
