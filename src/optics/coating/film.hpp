// SPDX-License-Identifier: BSD-3-Clause
// Thin-film stack between two media by the transfer of admittances (docs/theory/surfaces.md, eq. 3.25 at every
// boundary), with phase, for s and p, from both sides, in total reflection too. The recursion runs from the far side
// and holds only factors exp(i k z) that decay: stable for any thickness. Page: docs/reference/interfaces/film.md.
#pragma once

#include "base/memory/storage.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::optics {

struct FilmLayer {
  Complex index;         // n + i k; k > 0 absorbs
  double thickness = 0;  // m
};

// r from the rarer and from the denser side (front and back when they are equal), and t over 2 sqrt(q_in q_out), where
// q = n cos: smooth functions of the angle.
struct FilmSample {
  Complex rare[2], dense[2], through[2];  // s, p
};

struct Film {
  View<FilmLayer const> layers;  // from the front, the side the normal points to, to the back
  double wavelength = 1.064e-6;  // m, vacuum
  // n + i k of an opaque body behind the film, seen from either side with the layers in their order. Zero: the film
  // lies between the media of the scene.
  Complex opaque;

  // Tables for one pair of media, made by tabulate(). `passing` is evenly spaced in the cosine on the rarer side;
  // `total`, in total reflection, in k/(k0 + m cos) from 0 to 1, where m is the ratio of the indices, k^2 = m^2 sin^2 -
  // 1 and k0^2 = m^2 - 1: half the angle on the circle k^2 + (m cos)^2 = k0^2, so smooth at both ends.
  View<FilmSample const> passing, total;
  double front_index = 0, back_index = 0;

  static constexpr char const* key = "film";
  static constexpr bool yields_to_scatter = true;

  STRAY_HD Amplitudes amplitudes(double cos_i, double n_in, double n_out, bool front) const {
    bool const tabulated =
        passing.size > 0 && n_in == (front ? front_index : back_index) && n_out == (front ? back_index : front_index);
    return tabulated ? from_table(cos_i, n_in, n_out, front) : computed(cos_i, n_in, n_out, front);
  }
  STRAY_HD double scattered(double /*cos_i*/) const { return -1; }
  template <class F>
  void numbers(F&& f) const {
    for (std::size_t i = 0; i < layers.size; ++i)
      for (double x : {layers[i].index.re, layers[i].index.im, layers[i].thickness}) f(x);
    for (double x : {wavelength, opaque.re, opaque.im, front_index, back_index}) f(x);
    f(double(passing.size));
  }

  // Without tables.
  STRAY_HD Amplitudes computed(double cos_i, double n_in, double n_out, bool front) const {
    Amplitudes a;
    bool const ends = opaque.re > 0 || opaque.im > 0;
    Complex const last = ends ? opaque : Complex{n_out, 0};
    cos_i = std::fmax(cos_i, 1e-15);
    double const q_in = n_in * cos_i;
    // q = n cos in a layer, from n^2 - n_in^2 + q_in^2: without cancellation where the indices are equal.
    auto const q_of = [&](Complex n) {
      return upper_root((n - Complex{n_in, 0}) * (n + Complex{n_in, 0}) + Complex{q_in * q_in, 0});
    };
    Complex const square = last * last, q_last = q_of(last);
    Wave s{q_last}, p{q_last / square};
    bool const backwards = !front && !ends;
    for (std::size_t k = 0; k < layers.size; ++k) {
      FilmLayer const& layer = layers[backwards ? k : layers.size - 1 - k];
      Complex const n2 = layer.index * layer.index, q = q_of(layer.index);
      Complex const phase = exp_turns((layer.thickness / wavelength) * q);
      s.add(q, phase);
      p.add(q / n2, phase);
    }
    s.finish(q_in);
    p.finish(q_in / (n_in * n_in));
    a.rs = s.r;
    a.rp = p.r;
    if (ends || !(q_last.re > 0)) return a;
    a.ts = 2 * std::sqrt(q_in * q_last.re) * s.t;
    a.tp = 2 * std::sqrt(q_in * q_last.re) / (n_in * n_out) * p.t;
    return a;
  }

  // From table entries, by cubic interpolation.
  STRAY_HD Amplitudes from_table(double cos_i, double n_in, double n_out, bool front) const {
    double const rare = n_in < n_out ? n_in : n_out, dense = n_in < n_out ? n_out : n_in;
    bool const from_dense = n_in > n_out || (n_in == n_out && !front);
    double const square =
        from_dense ? 1 - dense * dense / (rare * rare) * (1 - cos_i * cos_i) : cos_i * cos_i;  // cos^2 when rarer
    Amplitudes a;
    if (from_dense && square <= 0 && total.size > 0) {
      double const most = std::sqrt(dense * dense / (rare * rare) - 1);
      FilmSample const f = interpolated(total, std::sqrt(-square) / (most + dense / rare * cos_i));
      a.rs = f.dense[0];
      a.rp = f.dense[1];
      bound(a.rs, a.ts);
      bound(a.rp, a.tp);
      return a;
    }
    double const cosine = std::sqrt(std::fmax(0.0, square));
    FilmSample const f = interpolated(passing, cosine);
    double const q_rare = rare * cosine;
    double const q_dense = std::sqrt(dense * dense - rare * rare + q_rare * q_rare),
                 gain = 2 * std::sqrt(q_rare * q_dense);
    a.rs = from_dense ? f.dense[0] : f.rare[0];
    a.rp = from_dense ? f.dense[1] : f.rare[1];
    a.ts = gain * f.through[0];
    a.tp = gain * f.through[1];
    bound(a.rs, a.ts);
    bound(a.rp, a.tp);
    return a;
  }

 private:
  // Limits the sum of the powers to 1 after interpolation.
  STRAY_HD static void bound(Complex& r, Complex& t) {
    double const sum = norm(r) + norm(t);
    if (!(sum > 1)) return;
    r = (1 / std::sqrt(sum)) * r;
    t = (1 / std::sqrt(sum)) * t;
  }
  // One polarisation on its way to the front; y is the admittance, q for s and q/n^2 for p. t is that of the tangential
  // field over 2 y_in.
  struct Wave {
    Complex y, r{}, t{1, 0};

    // Puts a boundary and a layer of admittance `next` in front.
    STRAY_HD void add(Complex next, Complex phase) {
      Complex const sum = next + y, down = sum + (next - y) * r;
      r = ((next - y) + sum * r) / down;
      t = 2 * (next * t) / down * phase;
      r = r * phase * phase;
      y = next;
    }
    STRAY_HD void finish(double first) {
      Complex const in{first, 0}, sum = in + y, down = sum + (in - y) * r;
      r = ((in - y) + sum * r) / down;
      t = t / down;
      y = in;
    }
  };

  // Lagrange's cubic through the four nearest entries at x in [0, 1].
  STRAY_HD static FilmSample interpolated(View<FilmSample const> table, double x) {
    double const at = std::fmin(std::fmax(x, 0.0), 1.0) * double(table.size - 1);
    std::size_t const last = table.size - 4;
    std::size_t first = at >= 1 ? static_cast<std::size_t>(at) - 1 : 0;
    if (first > last) first = last;
    double const d = at - double(first), a = d - 1, b = d - 2, c = d - 3;
    double const w[4] = {-a * b * c / 6, d * b * c / 2, -d * a * c / 2, d * a * b / 6};
    FilmSample out;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 2; ++i) {
        FilmSample const& f = table[first + k];
        out.rare[i] = out.rare[i] + w[k] * f.rare[i];
        out.dense[i] = out.dense[i] + w[k] * f.dense[i];
        out.through[i] = out.through[i] + w[k] * f.through[i];
      }
    return out;
  }
};

// Gives the film the coarsest tables for these indices that keep every amplitude within `tolerance` (absolute) of the
// computed one. Returns the largest error found; infinity, with the film unchanged, when 8192 steps do not suffice (a
// stack of very high finesse).
double tabulate(Film&, double front_index, double back_index, double tolerance, Storage&);

}  // namespace straytrace::optics
