// SPDX-License-Identifier: BSD-3-Clause
// State of polarisation along a path: Jones for a pure field, Stokes for anything. Page:
// docs/reference/interfaces/polarisation.md.
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace::optics {

// Field coefficients of a smooth interface for the two polarisations.

struct Complex {  // std::complex is host-only
  double re = 0, im = 0;
};
STRAY_HD Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
STRAY_HD Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
STRAY_HD Complex operator-(Complex a) { return {-a.re, -a.im}; }
STRAY_HD Complex operator*(double s, Complex a) { return {s * a.re, s * a.im}; }
STRAY_HD Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
STRAY_HD double norm(Complex a) { return a.re * a.re + a.im * a.im; }
STRAY_HD Complex conj(Complex a) { return {a.re, -a.im}; }
STRAY_HD Complex operator/(Complex a, Complex b) { return (1 / norm(b)) * (a * conj(b)); }
// Root in the upper half plane (Im > 0, or real and not negative): a wave that decays along its way, exp(i k z).
STRAY_HD Complex upper_root(Complex a) {
  double const size = std::sqrt(norm(a));
  double re = std::sqrt(0.5 * std::fmax(0.0, size + a.re)), im = std::sqrt(0.5 * std::fmax(0.0, size - a.re));
  if (a.re > 0)  // the smaller part without cancellation
    im = re > 0 ? 0.5 * std::fabs(a.im) / re : 0;
  else
    re = im > 0 ? 0.5 * std::fabs(a.im) / im : 0;
  return {a.im < 0 ? -re : re, im};
}
// exp(2 pi i z)
STRAY_HD Complex exp_turns(Complex z) {
  SinCos const turn = sincos_turn(z.re);
  return exp_number(-2 * pi * z.im) * Complex{turn.cos, turn.sin};
}

// s: field across the plane of incidence, p: in it. Transmission is scaled to power: |t|^2 = transmitted over incident
// power, so |r|^2 + |t|^2 = 1 without loss. Signs: r_s, r_p of docs/theory/surfaces.md, eq. 3.25 (opposite to each
// other at normal incidence, because the p field is counted along k x s of each wave, and k turns round).
struct Amplitudes {
  Complex rs, rp, ts, tp;
  STRAY_HD double reflectance() const { return 0.5 * (norm(rs) + norm(rp)); }  // of unpolarised light
  STRAY_HD double transmittance() const { return 0.5 * (norm(ts) + norm(tp)); }
};

// Interface known only by its powers: reflection i r, transmission t from both sides
// (docs/theory/conventions.md), which is unitary when nothing is lost. The field turns at reflection as on a metal: r_p
// = -r_s.
STRAY_HD Amplitudes unitary_amplitudes(double reflect_s, double reflect_p, double transmit_s, double transmit_p) {
  return {
      {0, std::sqrt(reflect_s)}, {0, -std::sqrt(reflect_p)}, {std::sqrt(transmit_s), 0}, {std::sqrt(transmit_p), 0}};
}

// Field a e1 + b e2, with e1 = axis and e2 = travel x axis; |a|^2 + |b|^2 is the power.
struct Jones {
  Complex a{1, 0}, b;
};

// Stokes parameters over the power, of length at most 1; 0: unpolarised. q: along the axis (+1) or across it (-1);
// u: along e1 + e2 or e1 - e2; v = 2 Im(conj(a) b).
struct Polarisation {
  Vec3 axis{1, 0, 0};  // unit vector across the travel
  double q = 0, u = 0, v = 0;
};

// Effect of one surface: the new state, and the ratio of the powers after and before.
struct PolarisedEvent {
  Polarisation state;
  double power = 0;
};

STRAY_HD Polarisation stokes(Jones const& j, Vec3 axis) {
  double const power = norm(j.a) + norm(j.b);
  Complex const c = j.a * conj(j.b);
  return {axis, (norm(j.a) - norm(j.b)) / power, 2 * c.re / power, -2 * c.im / power};
}

// The same state with respect to another axis across the same travel.
STRAY_HD Polarisation about_axis(Polarisation const& s, Vec3 travel, Vec3 axis) {
  double const c = dot(axis, s.axis), d = dot(axis, cross(travel, s.axis));
  double const cos2 = c * c - d * d, sin2 = 2 * c * d, scale = 1 / (c * c + d * d);  // scale: rounding of the axes
  return {axis, scale * (s.q * cos2 + s.u * sin2), scale * (s.u * cos2 - s.q * sin2), s.v};
}
STRAY_HD Jones about_axis(Jones const& j, Vec3 travel, Vec3 from, Vec3 to) {
  double const c = dot(to, from), d = dot(to, cross(travel, from)), scale = 1 / std::sqrt(c * c + d * d);
  return {scale * (c * j.a + d * j.b), scale * (c * j.b - d * j.a)};
}

// Unit vector across the plane of incidence: the s field of a vertex. At normal incidence any direction is valid:
// `fallback`, across the travel.
STRAY_HD Vec3 s_axis(Vec3 travel, Vec3 normal, Vec3 fallback) {
  Vec3 const across = cross(travel, normal);
  double const square = length2(across);
  return square > 1e-24 ? (1 / std::sqrt(square)) * across : fallback;
}

// Mueller matrix of diag(s, p), field coefficients, on a state whose axis is the s axis. The axis stays: it lies across
// the travel before and after.
STRAY_HD PolarisedEvent polarised(Polarisation const& in, Complex s, Complex p) {
  double const ss = norm(s), pp = norm(p), power = 0.5 * (ss + pp + (ss - pp) * in.q);
  if (!(power > 0)) return {{in.axis, 0, 0, 0}, 0};
  Complex const x = s * conj(p);
  return {{in.axis, 0.5 * (ss - pp + (ss + pp) * in.q) / power, (x.re * in.u + x.im * in.v) / power,
           (x.re * in.v - x.im * in.u) / power},
          power};
}

// Reflection and transmission at a surface with unit normal `normal`; `travel` is the direction before. The state
// returned belongs to the direction behind.
STRAY_HD PolarisedEvent reflected(Polarisation const& in, Vec3 travel, Vec3 normal, Amplitudes const& a) {
  return polarised(about_axis(in, travel, s_axis(travel, normal, in.axis)), a.rs, a.rp);
}
STRAY_HD PolarisedEvent transmitted(Polarisation const& in, Vec3 travel, Vec3 normal, Amplitudes const& a) {
  return polarised(about_axis(in, travel, s_axis(travel, normal, in.axis)), a.ts, a.tp);
}

// The same for a pure field, phase included; `axis` is that of `in` and becomes that of the result.
STRAY_HD Jones reflected(Jones const& in, Vec3 travel, Vec3 normal, Amplitudes const& a, Vec3& axis) {
  Vec3 const s = s_axis(travel, normal, axis);
  Jones const j = about_axis(in, travel, axis, s);
  axis = s;
  return {a.rs * j.a, a.rp * j.b};
}
STRAY_HD Jones transmitted(Jones const& in, Vec3 travel, Vec3 normal, Amplitudes const& a, Vec3& axis) {
  Vec3 const s = s_axis(travel, normal, axis);
  Jones const j = about_axis(in, travel, axis, s);
  axis = s;
  return {a.ts * j.a, a.tp * j.b};
}

// Scatter from `travel` into `out`: the polarised part turns as on small facets that reflect (`through`: refract) one
// direction into the other; the share `depolarised` becomes unpolarised.
STRAY_HD Polarisation scattered(Polarisation const& in, Vec3 travel, Vec3 out, bool through, double depolarised) {
  double const keep = 1 - depolarised;
  Vec3 const s = s_axis(travel, out, in.axis);
  Polarisation const turned = about_axis(in, travel, s);
  double const sign = through ? keep : -keep;  // a metal: r_p = -r_s
  return {s, keep * turned.q, sign * turned.u, sign * turned.v};
}

// Share of the power that a mode polarised as `mode` takes, for light that travels the same way.
STRAY_HD double polarisation_overlap(Polarisation const& light, Polarisation const& mode, Vec3 travel) {
  Polarisation const m = about_axis(mode, travel, light.axis);
  return 0.5 * (1 + light.q * m.q + light.u * m.u + light.v * m.v);
}

}  // namespace straytrace::optics
