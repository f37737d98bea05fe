// SPDX-License-Identifier: BSD-3-Clause
// Thin films: docs/theory/sampling.md, the transfer-matrix method against characteristic matrices and closed forms.
#include "optics/coating/film.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "base/every_module.hpp"
#include "optics/coating/specular.hpp"

namespace straytrace {
namespace {

constexpr double line = 1.064e-6;  // m
FilmLayer quarter(double n, double extinction = 0) { return {{n, extinction}, line / (4 * n)}; }
Film film_of(std::vector<FilmLayer> const& layers) {
  Film film;
  film.layers = {layers.data(), layers.size()};
  film.wavelength = line;
  return film;
}
std::vector<FilmLayer> mirror(int pairs) {  // (HL)^N H
  std::vector<FilmLayer> layers;
  for (int i = 0; i <= 2 * pairs; ++i) layers.push_back(quarter(i % 2 ? 1.45 : 2.07));
  return layers;
}
double worst(Amplitudes const& a, Amplitudes const& b) {
  return std::sqrt(
      std::fmax(std::fmax(norm(a.rs - b.rs), norm(a.rp - b.rp)), std::fmax(norm(a.ts - b.ts), norm(a.tp - b.tp))));
}

// The same stack by characteristic matrices (another algorithm, in std::complex): r and |t|^2 scaled to power.
struct Matrices {
  std::complex<double> r;
  double transmitted;
};
Matrices by_matrices(std::vector<FilmLayer> const& layers, double cos_i, double n_in, double n_out, bool p) {
  using C = std::complex<double>;
  C const i(0, 1);
  double const sine = n_in * std::sqrt(1 - cos_i * cos_i);
  auto const q_of = [&](C n) {
    C const q = std::sqrt(n * n - sine * sine);
    return q.imag() < 0 ? -q : q;
  };
  auto const y_of = [&](C n) { return p ? q_of(n) / (n * n) : q_of(n); };
  C const y_in = y_of(n_in), y_out = y_of(n_out);
  C b = 1, c = y_out;
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
    C const n(layer->index.re, layer->index.im), y = y_of(n), phase = 2 * pi * q_of(n) * layer->thickness / line;
    C const b2 = std::cos(phase) * b - i * std::sin(phase) / y * c;
    c = -i * y * std::sin(phase) * b + std::cos(phase) * c;
    b = b2;
  }
  C const r = (y_in * b - c) / (y_in * b + c), t = 2.0 * y_in / (y_in * b + c);
  return {r, std::norm(t) * (y_out / y_in).real()};
}

// Scene 7, printed digits. Controls: half-wave layer, one pair less.
TEST(optics_film, quarter_wave_numbers) {
  auto const reflect = [](std::vector<FilmLayer> const& l, double n) {
    return film_of(l).amplitudes(1, 1, n, true).reflectance();
  };
  EXPECT_NEAR(reflect({quarter(1.38)}, 1.52), 0.012601, 5e-7);
  EXPECT_GT(std::fabs(reflect({quarter(1.38), quarter(1.38)}, 1.52) - 0.012601), 1e-2);
  EXPECT_NEAR(1 - reflect(mirror(5), 1.45), 3.777e-2, 5e-6);
  EXPECT_NEAR(1 - reflect(mirror(10), 1.45), 1.0945e-3, 5e-8);
  EXPECT_NEAR(1 - reflect(mirror(18), 1.45), 3.680e-6, 5e-10);
  EXPECT_GT(std::fabs(1 - reflect(mirror(17), 1.45) - 3.680e-6), 1e-6);
}

// No layer is Fresnel, phases and all; a half-wave layer is not there. 1e-14, and 1e-12 for the layer.
TEST(optics_film, no_film_is_fresnel) {
  for (int k = 0; k < 90; ++k) {
    double const cos_i = std::cos(k * pi / 180);
    EXPECT_LT(worst(film_of({}).amplitudes(cos_i, 1, 1.45, true), Fresnel{}.amplitudes(cos_i, 1, 1.45, true)), 1e-14);
    EXPECT_LT(worst(film_of({}).amplitudes(cos_i, 1.45, 1, true), Fresnel{}.amplitudes(cos_i, 1.45, 1, true)), 1e-14);
  }
  std::vector<FilmLayer> const half{quarter(2), quarter(2)};
  Amplitudes const a = film_of(half).amplitudes(1, 1, 1.45, true), b = Fresnel{}.amplitudes(1, 1, 1.45, true);
  EXPECT_LT(norm(a.rs - b.rs), 1e-24);
  EXPECT_LT(norm(a.ts + b.ts), 1e-24);  // half a wave turns t over
  EXPECT_GT(worst(film_of({quarter(2)}).amplitudes(1, 1, 1.45, true), b), 0.1);
}

// r with phase and transmitted power against characteristic matrices, absorbing layers and total reflection included:
// 1e-11. Control: light from the other side.
TEST(optics_film, agrees_with_characteristic_matrices) {
  std::vector<FilmLayer> const lossy{quarter(2.07, 1e-3), {{1.3, 0}, 310e-9}, {{0.3, 5.0}, 8e-9}, quarter(1.45, 0.02)};
  double other_side = 0;
  for (auto const& layers : {mirror(6), lossy})
    for (double n_in : {1.0, 1.7})
      for (int k = 1; k < 200; ++k) {
        double const cos_i = k / 200.0;
        Amplitudes const a = film_of(layers).amplitudes(cos_i, n_in, 1.45, true);
        Matrices const s = by_matrices(layers, cos_i, n_in, 1.45, false),
                       p = by_matrices(layers, cos_i, n_in, 1.45, true);
        ASSERT_NEAR(a.rs.re, s.r.real(), 1e-11);
        ASSERT_NEAR(a.rs.im, s.r.imag(), 1e-11);
        ASSERT_NEAR(a.rp.re, p.r.real(), 1e-11);
        ASSERT_NEAR(a.rp.im, p.r.imag(), 1e-11);
        ASSERT_NEAR(norm(a.ts), s.transmitted, 1e-11);
        ASSERT_NEAR(norm(a.tp), p.transmitted, 1e-11);
        Amplitudes const turned = film_of(layers).amplitudes(cos_i, n_in, 1.45, false);
        other_side = std::fmax(other_side, std::fabs(turned.rs.re - s.r.real()));
      }
  EXPECT_GT(other_side, 0.1);
}

// A lossless stack is unitary from both sides at all angles (docs/theory/conventions.md): energy 1e-12, t the same both
// ways, and r_front conj(t) + t conj(r_back) = 0. Frustrated total reflection included. Control: an absorbing layer.
TEST(optics_film, unitary_without_loss) {
  auto const defect = [](std::vector<FilmLayer> const& layers, double n_front, double n_back) {
    Film const film = film_of(layers);
    double most = 0;
    for (int k = 1; k <= 500; ++k) {
      double const cos_f = k / 500.0, square = 1 - n_front * n_front / (n_back * n_back) * (1 - cos_f * cos_f);
      if (square < 1e-6) continue;
      Amplitudes const f = film.amplitudes(cos_f, n_front, n_back, true);
      Amplitudes const b = film.amplitudes(std::sqrt(square), n_back, n_front, false);
      most = std::fmax(most, std::fabs(norm(f.rs) + norm(f.ts) - 1));
      most = std::fmax(most, std::fabs(norm(f.rp) + norm(f.tp) - 1));
      most = std::fmax(most, std::sqrt(norm(f.ts - b.ts) + norm(f.tp - b.tp)));
      most = std::fmax(most, std::sqrt(norm(f.rs * conj(f.ts) + f.ts * conj(b.rs))));
      most = std::fmax(most, std::sqrt(norm(f.rp * conj(f.tp) + f.tp * conj(b.rp))));
    }
    return most;
  };
  EXPECT_LT(defect(mirror(8), 1, 1.45), 1e-11);
  EXPECT_LT(defect({{{1, 0}, 200e-9}}, 1.5, 1.5), 1e-11);  // an air gap between two prisms
  EXPECT_LT(defect({{{2.07, 0}, 300e-9}, {{1.2, 0}, 500e-9}}, 1.7, 1.45), 1e-11);
  EXPECT_GT(defect({quarter(2.07, 1e-3)}, 1, 1.45), 1e-4);
}

// Frustrated total reflection through an air gap d at 45 deg in n = 1.5, closed form T = 1/(1 + ((q^2 + k^2)/(2 q k))^2
// sinh^2(2 pi k d/lambda)) for s; thick gaps and metals neither overflow nor make light. Control: gap 10 % wider.
TEST(optics_film, evanescent_and_thick_stacks) {
  double const q = 1.5 * std::sqrt(0.5), k = std::sqrt(1.125 - 1);
  auto const exact = [&](double d) {
    double const s = std::sinh(2 * pi * k * d / line) * (q * q + k * k) / (2 * q * k);
    return 1 / (1 + s * s);
  };
  auto const through = [&](double d) {
    return norm(film_of({{{1, 0}, d}}).amplitudes(std::sqrt(0.5), 1.5, 1.5, true).ts);
  };
  for (double d : {1e-8, 2e-7, 1e-6}) {
    EXPECT_NEAR(through(d) / exact(d), 1, 1e-12) << d;
    EXPECT_GT(std::fabs(through(1.1 * d) / exact(d) - 1), 1e-4) << d;
  }
  EXPECT_NEAR(norm(film_of({{{1, 0}, 1e-2}}).amplitudes(std::sqrt(0.5), 1.5, 1.5, true).rs), 1, 1e-14);
  Amplitudes const metal = film_of({{{0.25, 7}, 1e-3}}).amplitudes(0.6, 1, 1.5, true);
  EXPECT_LT(worst(metal, Fresnel{{0.25, 7}}.amplitudes(0.6, 1, 1, true)), 1e-14);
}

// A film on an opaque body: nothing passes, and a lossless quarter wave of index sqrt(n) removes its reflection.
TEST(optics_film, on_an_opaque_body) {
  std::vector<FilmLayer> const layers{quarter(std::sqrt(2.5835))};
  Film film = film_of(layers);
  film.opaque = {2.5835, 0};
  for (bool front : {true, false}) {
    EXPECT_LT(film.amplitudes(1, 1, 1, front).reflectance(), 1e-28);
    EXPECT_EQ(film.amplitudes(1, 1, 1, front).transmittance(), 0);
  }
  film.opaque = {2.5835, 0.5};
  EXPECT_GT(film.amplitudes(1, 1, 1, true).reflectance(), 1e-3);
}

// Tables: every amplitude within the stated 1e-6 of the computed one, from both sides, in total reflection and near
// grazing; no light is made; other indices are computed. Control: a table of every 32nd entry.
TEST(optics_film, tables_keep_their_accuracy) {
  for (auto const& layers : {std::vector<FilmLayer>{quarter(1.38)}, mirror(5), mirror(18)})
    for (double back : {1.0, 1.45}) {
      Storage storage;
      Film film = film_of(layers);
      double const claimed = tabulate(film, 1, back, 1e-6, storage);
      ASSERT_LE(claimed, 1e-6);
      auto const error = [&](Film const& f) {
        double most = 0;
        for (int i = 0; i <= 3000; ++i) {
          double const c = i < 100 ? 1e-6 * i : i / 3000.0;
          for (bool front : {true, false}) {
            double const in = front ? 1 : back, out = front ? back : 1;
            Amplitudes const a = f.amplitudes(c, in, out, front);
            most = std::fmax(most, worst(a, film.computed(c, in, out, front)));
            EXPECT_LE(std::fmax(norm(a.rs) + norm(a.ts), norm(a.rp) + norm(a.tp)), 1 + 1e-15);
          }
        }
        return most;
      };
      EXPECT_LE(error(film), 1.5e-6) << layers.size() << " " << back;
      std::vector<FilmSample> few;
      for (std::size_t i = 0; i < film.passing.size; i += 32) few.push_back(film.passing[i]);
      Film coarse = film;
      coarse.passing = {few.data(), few.size()};
      if (few.size() > 4) {
        EXPECT_GT(error(coarse), 3e-6);
      }
      EXPECT_EQ(worst(film.amplitudes(0.5, 1, 1.6, true), film.computed(0.5, 1, 1.6, true)), 0);
    }
}

}  // namespace
}  // namespace straytrace
