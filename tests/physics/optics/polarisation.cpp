// SPDX-License-Identifier: BSD-3-Clause
// Polarisation along paths: Jones and Stokes against each other and against the electric field in space.
#include "optics/polarisation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "optics/coating/film.hpp"
#include "optics/coating/fresnel.hpp"

namespace straytrace::optics_polarisation {
namespace {

struct Field {  // complex vector in space
  Vec3 re, im;
};
Field operator+(Field const& a, Field const& b) { return {a.re + b.re, a.im + b.im}; }
Field times(Complex c, Vec3 v) { return {c.re * v, c.im * v}; }
Complex along(Field const& f, Vec3 v) { return {dot(f.re, v), dot(f.im, v)}; }
double power(Field const& f) { return length2(f.re) + length2(f.im); }
Field field_of(Jones const& j, Vec3 axis, Vec3 travel) { return times(j.a, axis) + times(j.b, cross(travel, axis)); }
double difference(Field const& a, Field const& b) { return std::sqrt(length2(a.re - b.re) + length2(a.im - b.im)); }

// Fresnel's formulas for a field in space, textbook form: the s part along the common perpendicular, the p part along
// k x s of each wave. Power-scaled.
Field at_surface(Field const& in, Vec3 travel, Vec3 out, Vec3 normal, Complex s_factor, Complex p_factor) {
  Vec3 const s = unit(cross(travel, normal));
  return times(s_factor * along(in, s), s) + times(p_factor * along(in, cross(travel, s)), cross(out, s));
}

Vec3 direction(Rng& rng) { return unit({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5}); }
Jones jones(Rng& rng) {
  auto const draw = [&] { return Complex{rng.uniform() - 0.5, rng.uniform() - 0.5}; };
  return {draw(), draw()};
}
double distance(Polarisation const& a, Polarisation const& b, Vec3 travel) {
  Polarisation const c = about_axis(b, travel, a.axis);
  return std::sqrt((a.q - c.q) * (a.q - c.q) + (a.u - c.u) * (a.u - c.u) + (a.v - c.v) * (a.v - c.v));
}

struct Sequence {
  double field = 0, stokes = 0, power = 0;  // worst deviations after the last surface
};
// Random sequences of six mirrors and refracting faces: the field in space, Jones and Stokes side by side. `turn`: an
// angle by which the control turns the axes wrongly at each surface.
Sequence run_sequences(double turn) {
  Rng rng(3, 0, 0, Stream::lobe);
  Sequence worst;
  for (int path = 0; path < 200; ++path) {
    Vec3 travel = direction(rng), axis = any_normal(travel);
    Jones j = jones(rng);
    Field field = field_of(j, axis, travel);
    Polarisation state = stokes(j, axis);
    double carried = power(field);
    for (int k = 0; k < 6; ++k) {
      Vec3 normal = direction(rng);
      if (dot(normal, travel) > 0) normal = -normal;
      double const cosine = -dot(normal, travel), n = 0.6 + rng.uniform();
      bool const metal = rng.uniform() < 0.3;
      Fresnel const surface{metal ? Complex{0.3, 4} : Complex{}};
      Amplitudes const a = surface.amplitudes(cosine, 1, n, true);
      Vec3 out;
      bool const through = !metal && rng.uniform() < 0.5 && refracted(travel, normal, 1, n, out);
      if (!through) out = reflected(travel, normal);
      field = at_surface(field, travel, out, normal, through ? a.ts : a.rs, through ? a.tp : a.rp);
      PolarisedEvent const e = through ? transmitted(state, travel, normal, a) : reflected(state, travel, normal, a);
      j = through ? transmitted(j, travel, normal, a, axis) : reflected(j, travel, normal, a, axis);
      Vec3 const wrong = std::cos(turn) * axis + std::sin(turn) * cross(out, axis);
      axis = wrong;
      state = e.state;
      carried *= e.power;
      travel = out;
    }
    worst.field = std::fmax(worst.field, difference(field_of(j, axis, travel), field) / std::sqrt(power(field)));
    worst.stokes = std::fmax(worst.stokes, distance(state, stokes(j, axis), travel));
    worst.power = std::fmax(worst.power, std::fabs(carried / power(field) - 1));
  }
  return worst;
}

// Jones, Stokes and the field in space agree to 1e-10 after six surfaces, metals and total reflection included.
// Control: axes turned by 1 mrad at each surface.
TEST(optics_polarisation, sequences_against_fields_in_space) {
  Sequence const right = run_sequences(0), wrong = run_sequences(1e-3);
  EXPECT_LT(right.field, 1e-10);
  EXPECT_LT(right.stokes, 1e-10);
  EXPECT_LT(right.power, 1e-10);
  EXPECT_GT(wrong.field, 1e-3);
  EXPECT_GT(wrong.stokes, 1e-3);
}

// A glass corner cube (total reflection three times) sends light back; state against the field in space, 1e-12, and all
// power. Control: scalar mirrors, r_p = -r_s.
TEST(optics_polarisation, corner_cube) {
  Vec3 const normals[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 travel = unit({-1, -1.1, -0.95});
  Vec3 const first = travel;
  Jones const start{{0.8, 0}, {0, 0.6}};
  Field field = field_of(start, any_normal(travel), travel);
  Polarisation state = stokes(start, any_normal(travel)), scalar = state;
  double carried = 1;
  for (Vec3 const n : normals) {
    Amplitudes const a = Fresnel{}.amplitudes(-dot(n, travel), 1.45003, 1, false);
    Vec3 const out = reflected(travel, n);
    field = at_surface(field, travel, out, n, a.rs, a.rp);
    PolarisedEvent const e = reflected(state, travel, n, a);
    scalar = reflected(scalar, travel, n, unitary_amplitudes(1, 1, 0, 0)).state;
    state = e.state;
    carried *= e.power;
    travel = out;
  }
  EXPECT_LT(length(travel + first), 1e-15);
  EXPECT_NEAR(carried, 1, 1e-14);
  Vec3 const axis = any_normal(travel);
  Polarisation const exact = stokes({along(field, axis), along(field, cross(travel, axis))}, axis);
  EXPECT_LT(distance(state, exact, travel), 1e-12);
  EXPECT_GT(distance(scalar, exact, travel), 0.1);
}

// Unpolarised light reflected at Brewster's angle is fully s-polarised, 1e-12; the transmitted light is partly p. At
// 1 deg away it is not. Light polarised in the plane of incidence is not reflected at all.
TEST(optics_polarisation, brewster) {
  double const n = 1.45003, angle = std::atan(n);
  auto const state_at = [&](double a, Polarisation const& in) {
    Vec3 const travel{std::sin(a), 0, -std::cos(a)};
    return reflected(in, travel, {0, 0, 1}, Fresnel{}.amplitudes(std::cos(a), 1, n, true));
  };
  Polarisation const none{{0, 1, 0}, 0, 0, 0}, in_plane{{0, 1, 0}, -1, 0, 0};
  EXPECT_NEAR(state_at(angle, none).state.q, 1, 1e-12);
  EXPECT_LT(state_at(angle + pi / 180, none).state.q, 0.9995);
  EXPECT_LT(state_at(angle, in_plane).power, 1e-30);
  double const rs = (1 - n * n) / (1 + n * n);
  EXPECT_NEAR(state_at(angle, none).power, 0.5 * rs * rs, 1e-14);
}

// The degree of polarisation of a pure state stays 1; a total reflection turns linear into elliptic light.
TEST(optics_polarisation, pure_states_stay_pure) {
  Rng rng(4, 0, 0, Stream::lobe);
  for (int i = 0; i < 300; ++i) {
    Vec3 const travel = direction(rng);
    Vec3 normal = direction(rng);
    if (dot(normal, travel) > 0) normal = -normal;
    Polarisation const in = stokes(jones(rng), any_normal(travel));
    Polarisation const out =
        reflected(in, travel, normal, Fresnel{}.amplitudes(-dot(normal, travel), 1.45, 1, false)).state;
    ASSERT_NEAR(in.q * in.q + in.u * in.u + in.v * in.v, 1, 1e-13);
    ASSERT_NEAR(out.q * out.q + out.u * out.u + out.v * out.v, 1, 1e-12);
    ASSERT_NEAR(dot(out.axis, reflected(travel, normal)), 0, 1e-14);
  }
  Vec3 const travel{std::sqrt(0.5), 0, -std::sqrt(0.5)};
  Polarisation const diagonal{{0, 1, 0}, 0, 1, 0};
  Polarisation const out =
      reflected(diagonal, travel, {0, 0, 1}, Fresnel{}.amplitudes(std::sqrt(0.5), 1.45003, 1, false)).state;
  EXPECT_GT(std::fabs(out.v), 0.1);
}

// At normal incidence a mirror keeps linear light and turns circular light over; so does back-scatter that keeps
// polarisation. What loses it has all parameters scaled.
TEST(optics_polarisation, turning_back_and_scatter) {
  Vec3 const down{0, 0, -1}, up{0, 0, 1};
  double const angle = 0.4;
  Polarisation const in{{1, 0, 0}, std::cos(2 * angle) * 0.8, std::sin(2 * angle) * 0.8, 0.6};
  Polarisation const mirrored = reflected(in, down, up, unitary_amplitudes(1, 1, 0, 0)).state;
  Polarisation const scatter = scattered(in, down, up, false, 0);
  // the linear part lies along the same line in space: e2 has turned over with the travel
  for (Polarisation const& s : {mirrored, scatter}) {
    Polarisation const t = about_axis(s, up, {1, 0, 0});
    EXPECT_NEAR(t.q, in.q, 1e-14);
    EXPECT_NEAR(t.u, -in.u, 1e-14);
    EXPECT_NEAR(t.v, -in.v, 1e-14);
  }
  EXPECT_NEAR(about_axis(scattered(in, down, up, false, 0.25), up, {1, 0, 0}).q, 0.75 * in.q, 1e-14);
  Polarisation const lost = scattered(in, down, unit({0.3, 0.1, 0.5}), false, 1);
  EXPECT_EQ(lost.q * lost.q + lost.u * lost.u + lost.v * lost.v, 0);
  Polarisation const forward = scattered(in, down, unit({1e-9, 0, -1}), true, 0);
  EXPECT_LT(distance(forward, in, down), 1e-8);
  Polarisation const wrong = scattered(in, down, unit({1e-9, 0, -1}), false, 0);
  EXPECT_GT(distance(wrong, in, down), 0.1);
}

// (1 + s s_m)/2: the same state 1, the orthogonal one 0, unpolarised light one half (docs/theory/conventions.md), for
// any axes.
TEST(optics_polarisation, overlap_with_a_mode) {
  Rng rng(5, 0, 0, Stream::lobe);
  for (int i = 0; i < 100; ++i) {
    Vec3 const travel = direction(rng), axis = any_normal(travel);
    Jones const j = jones(rng), other{-conj(j.b), conj(j.a)};
    double const turn = rng.uniform();
    Polarisation const s = stokes(j, axis);
    Polarisation const same = about_axis(s, travel, std::cos(turn) * axis + std::sin(turn) * cross(travel, axis));
    EXPECT_NEAR(polarisation_overlap(s, same, travel), 1, 1e-13);
    EXPECT_NEAR(polarisation_overlap(s, stokes(other, axis), travel), 0, 1e-13);
    EXPECT_NEAR(polarisation_overlap({axis, 0, 0, 0}, s, travel), 0.5, 1e-15);
    Jones const mode = jones(rng);  // against the scalar product of fields
    Complex const product = j.a * conj(mode.a) + j.b * conj(mode.b);
    double const powers = (norm(j.a) + norm(j.b)) * (norm(mode.a) + norm(mode.b));
    EXPECT_NEAR(polarisation_overlap(s, stokes(mode, axis), travel), norm(product) / powers, 1e-13);
  }
  EXPECT_GT(polarisation_overlap({{1, 0, 0}, 1, 0, 0}, {{0, 1, 0}, -1, 0, 0}, {0, 0, 1}), 0.999);
  EXPECT_LT(polarisation_overlap({{1, 0, 0}, 1, 0, 0}, {{0, 1, 0}, 1, 0, 0}, {0, 0, 1}), 1e-15);
}

}  // namespace
}  // namespace straytrace::optics_polarisation
