// SPDX-License-Identifier: BSD-3-Clause
#include "optics/coating/film.hpp"

#include <algorithm>
#include <vector>

namespace straytrace::optics {
namespace {

void sample(Film const& film, double cosine, bool from_dense, FilmSample& into) {
  double const rare = std::min(film.front_index, film.back_index), dense = std::max(film.front_index, film.back_index);
  double const n_in = from_dense ? dense : rare, n_out = from_dense ? rare : dense;
  bool const front = (film.front_index <= film.back_index) != from_dense;
  Amplitudes const a = film.computed(cosine, n_in, n_out, front);
  (from_dense ? into.dense : into.rare)[0] = a.rs;
  (from_dense ? into.dense : into.rare)[1] = a.rp;
  if (from_dense) return;
  double const q_rare = rare * cosine, q_dense = std::sqrt(dense * dense - rare * rare + q_rare * q_rare);
  double const gain = 2 * std::sqrt(q_rare * q_dense);
  into.through[0] = (1 / gain) * a.ts;
  into.through[1] = (1 / gain) * a.tp;
}

constexpr double least_cosine = 1e-9;  // t over its root needs t > 0

std::vector<FilmSample> passing_table(Film const& film, std::size_t steps) {
  double const rare = std::min(film.front_index, film.back_index), dense = std::max(film.front_index, film.back_index);
  std::vector<FilmSample> table(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i) {
    double const cosine = std::max(double(i) / double(steps), least_cosine);
    double const q_dense = std::sqrt(dense * dense - rare * rare * (1 - cosine * cosine));
    sample(film, cosine, false, table[i]);
    sample(film, q_dense / dense, true, table[i]);
  }
  return table;
}

// Empty when the indices are equal: then there is no total reflection.
std::vector<FilmSample> total_table(Film const& film, std::size_t steps) {
  double const rare = std::min(film.front_index, film.back_index), dense = std::max(film.front_index, film.back_index);
  double const ratio = rare / dense, most = std::sqrt(1 / (ratio * ratio) - 1);
  std::vector<FilmSample> table(rare < dense ? steps + 1 : 0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    double const half = double(i) / double(steps);
    sample(film, ratio * most * (1 - half * half) / (1 + half * half), true, table[i]);
  }
  return table;
}

double distance(Amplitudes const& a, Amplitudes const& b) {
  double worst = 0;
  for (auto member : {&Amplitudes::rs, &Amplitudes::rp, &Amplitudes::ts, &Amplitudes::tp})
    worst = std::max(worst, norm(a.*member - b.*member));
  return std::sqrt(worst);
}

// Largest error of the tables between their entries; stops at the first error above `enough`.
double error_of(Film const& film, double enough) {
  double const front = film.front_index, back = film.back_index;
  double worst = 0;
  std::size_t const looks = 4 * film.passing.size;
  for (std::size_t i = 1; i < looks && worst <= enough; ++i) {
    double const cosine = double(i) / double(looks);
    worst =
        std::max(worst, distance(film.amplitudes(cosine, front, back, true), film.computed(cosine, front, back, true)));
    worst = std::max(worst,
                     distance(film.amplitudes(cosine, back, front, false), film.computed(cosine, back, front, false)));
  }
  return worst;
}

}  // namespace

double tabulate(Film& film, double front_index, double back_index, double tolerance, Storage& storage) {
  Film with = film;
  with.front_index = front_index;
  with.back_index = back_index;
  for (std::size_t steps = 32; steps <= 8192; steps *= 2) {
    auto passing = passing_table(with, steps), total = total_table(with, steps);
    with.passing = {passing.data(), passing.size()};
    with.total = {total.data(), total.size()};
    double const error = error_of(with, tolerance);
    if (!(error <= tolerance)) continue;
    with.passing = storage.keep(std::move(passing));
    with.total = storage.keep(std::move(total));
    film = with;
    return error;
  }
  return infinity;
}

}  // namespace straytrace::optics
