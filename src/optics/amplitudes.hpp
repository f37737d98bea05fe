// SPDX-License-Identifier: BSD-3-Clause
// Field coefficients of a smooth interface for the two polarisations.
#pragma once

#include "base/math/functions.hpp"

namespace straytrace::optics {

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

}  // namespace straytrace::optics
