// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/functions.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/higher_modes.hpp"
#include "wave/krylov.hpp"

namespace straytrace::wave {
namespace {

double sum_of_squares(Field const& field) {
  double sum = 0;
  for (Complex z : field.values) sum += std::norm(z);
  return sum;
}

}  // namespace

double PowerLedger::total() const {
  double sum = mirror1 + mirror2 + beyond_band;
  for (double p : towards_mirror2) sum += p;
  for (double p : towards_mirror1) sum += p;
  return sum;
}

struct CavityWaves::Parts {
  WaveCavity cavity;
  int threads;
  Transform transform;
  Mask outline1, outline2;
  Field mirror1, mirror2;
  std::vector<Mask> masks;              // one of each kind of rim
  std::vector<std::size_t> mask_index;  // of each baffle
  std::vector<Leg> legs;                // in order of place
  SpectrumDisc disc;                    // of the first leg: the fields of which modes are made

  Parts(WaveCavity c, int t)
      : cavity(std::move(c)),
        threads(t),
        transform(cavity.grid.points, threads),
        outline1(cavity.mirror1.outline, cavity.grid, transform),
        outline2(cavity.mirror2.outline, cavity.grid, transform),
        mirror1(reflection(cavity.mirror1, outline1, cavity.wavelength, cavity.grid)),
        mirror2(reflection(cavity.mirror2, outline2, cavity.wavelength, cavity.grid)) {
    make_masks();
    make_legs();
    disc = SpectrumDisc(cavity.grid, legs.front().cut() / cavity.wavelength);
  }

  void make_masks() {
    std::vector<RoundHole> kinds;
    for (WaveBaffle const& baffle : cavity.baffles) {
      auto const known = std::ranges::find(kinds, baffle.rim);
      mask_index.push_back(std::size_t(known - kinds.begin()));
      if (known != kinds.end()) continue;
      kinds.push_back(baffle.rim);
      masks.emplace_back(baffle.rim, cavity.grid, transform);
    }
  }
  void make_legs() {
    std::size_t const n = cavity.baffles.size();
    for (std::size_t j = 0; j <= n; ++j)
      legs.emplace_back(place(j + 1) - place(j), opening(j) + opening(j + 1), cavity.wavelength, cavity.grid);
  }

  // Planes: mirror 1, baffles, mirror 2.
  double place(std::size_t plane) const {
    return plane == 0 ? 0 : plane <= cavity.baffles.size() ? cavity.baffles[plane - 1].place : cavity.length;
  }
  RoundHole const& hole(std::size_t plane) const {
    return plane == 0                       ? cavity.mirror1.outline
           : plane <= cavity.baffles.size() ? cavity.baffles[plane - 1].rim
                                            : cavity.mirror2.outline;
  }
  Mask const& outline(std::size_t plane) const {
    return plane == 0 ? outline1 : plane <= cavity.baffles.size() ? masks[mask_index[plane - 1]] : outline2;
  }
  double opening(std::size_t plane) const {  // the farthest point of the opening from the axis
    return hole(plane).radius + std::hypot(hole(plane).x, hole(plane).y);
  }
  void travel(Field& spectrum, Observer const&, PowerLedger*) const;
  void pass(std::size_t plane, Field&) const;
  double taken(std::size_t plane, Field const&) const;
};

// Power that does not go on, as a sum of |values|^2.
double CavityWaves::Parts::taken(std::size_t plane, Field const& field) const {
  double const clipped = outline(plane).clipped(field);
  if (plane > 0 && plane <= cavity.baffles.size()) return clipped;
  double const scattered = (plane == 0 ? cavity.mirror1 : cavity.mirror2).scattered;
  return clipped + scattered * (sum_of_squares(field) - clipped);
}

// Through the opening of a baffle, or back from a mirror.
void CavityWaves::Parts::pass(std::size_t plane, Field& field) const {
  int const N = cavity.grid.points, rows = outline(plane).rows();
  bool const is_baffle = plane > 0 && plane <= cavity.baffles.size();
  Field const& mirror = plane == 0 ? mirror1 : mirror2;
  std::vector<double> const& mask = outline(plane).values();
  for_rows(N / 2 - rows / 2, N / 2 + rows / 2, threads, [&](int row) {
    std::size_t const from = std::size_t(row) * std::size_t(N), to = from + std::size_t(N);
    if (is_baffle)
      for (std::size_t i = from; i < to; ++i) field.values[i] *= mask[i];
    else
      for (std::size_t i = from; i < to; ++i) field.values[i] *= mirror.values[i];
  });
}

void CavityWaves::Parts::travel(Field& spectrum, Observer const& observer, PowerLedger* ledger) const {
  int const N = cavity.grid.points;
  std::size_t const n = cavity.baffles.size(), last = n + 1;
  double const plane_power = cavity.grid.pitch() * cavity.grid.pitch(), spectral_power = plane_power / double(N) / N;
  Field arriving(observer ? cavity.grid : Grid{});
  double left = ledger ? sum_of_squares(spectrum) * spectral_power : 0;
  for (std::size_t step = 1; step <= 2 * last; ++step) {
    bool const outward = step <= last;
    std::size_t const plane = outward ? step : 2 * last - step;
    Leg const& leg = legs[outward ? plane - 1 : plane];
    int const rows = outline(plane).rows();
    leg.apply(spectrum, threads);
    if (observer) arriving.values = spectrum.values;
    transform.inverse(spectrum, leg.columns(), observer || ledger ? N : rows);
    Travel const travel = outward ? Travel::towards_mirror2 : Travel::towards_mirror1;
    if (observer) observer({int(plane), travel, arriving, leg.columns(), spectrum});
    if (ledger) {
      double const arrived = sum_of_squares(spectrum) * plane_power, lost = taken(plane, spectrum) * plane_power;
      ledger->beyond_band += left - arrived;
      left = arrived - lost;
      double& entry = plane == 0      ? ledger->mirror1
                      : plane == last ? ledger->mirror2
                      : outward       ? ledger->towards_mirror2[plane - 1]
                                      : ledger->towards_mirror1[plane - 1];
      entry += lost;
    }
    pass(plane, spectrum);
    std::size_t const next = outward && plane < last ? plane : plane == 0 ? 0 : plane - 1;
    transform.forward(spectrum, rows, legs[next].columns());
  }
  if (ledger) ledger->beyond_band += left - disc.pack(spectrum).squaredNorm() * spectral_power;
}

CavityWaves::CavityWaves(WaveCavity cavity, int threads)
    : parts_(std::make_unique<Parts>(std::move(cavity), threads)) {}
CavityWaves::~CavityWaves() = default;
WaveCavity const& CavityWaves::cavity() const { return parts_->cavity; }
Transform const& CavityWaves::transform() const { return parts_->transform; }
Mask const& CavityWaves::mask(std::size_t baffle) const { return parts_->masks[parts_->mask_index[baffle]]; }

void CavityWaves::round_trip(Field& spectrum, Observer const& observer) const {
  parts_->travel(spectrum, observer, nullptr);
}

Field CavityWaves::hermite_gauss(int n, int m) const {
  WaveCavity const& c = parts_->cavity;
  double const w = cavity_mode(c.length, 1 / c.mirror1.curvature, 1 / c.mirror2.curvature, c.wavelength).w1;
  std::vector<double> across, up;  // hermite_function is exp(-x^2/2) at order 0
  for (int i = 0; i < c.grid.points; ++i) {
    across.push_back(hermite_function(n, std::sqrt(2.0) * c.grid.at(i) / w));
    up.push_back(hermite_function(m, std::sqrt(2.0) * c.grid.at(i) / w));
  }
  Field field(c.grid);
  for (int row = 0; row < c.grid.points; ++row)
    for (int column = 0; column < c.grid.points; ++column) {
      double const x = c.grid.at(column), y = c.grid.at(row);
      Complex const wavefront = turned(-(x * x + y * y) * c.mirror1.curvature / (2 * c.wavelength));
      field(row, column) = std::sqrt(2.0) / w * across[std::size_t(column)] * up[std::size_t(row)] * wavefront;
    }
  parts_->transform.forward(field, c.grid.points, parts_->legs.front().columns());
  return field;
}

namespace {

// Unit power: the sum of |spectrum|^2 is N^2/pitch^2.
WaveMode mode_of(Krylov const& krylov, RitzPair const& pair, SpectrumDisc const& disc, Grid const& grid) {
  WaveMode mode{pair.value, pair.residual, krylov.steps(), Field(grid)};
  disc.unpack(krylov.vector(pair) * (grid.points / grid.pitch()), mode.spectrum);
  return mode;
}

}  // namespace

WaveMode CavityWaves::mode(Field const& start, SolveOptions const& options) const {
  Grid const& grid = parts_->cavity.grid;
  Krylov krylov(parts_->disc.pack(start));
  Field work(grid);
  Complex before = 0;
  for (int settled = 0;;) {
    parts_->disc.unpack(krylov.last(), work);
    parts_->travel(work, {}, nullptr);
    bool const more = krylov.extend(parts_->disc.pack(work));
    RitzPair const best = krylov.ritz().front();
    double const loss = std::max(1 - std::norm(best.value), 1e-9);
    settled = std::abs(best.value - before) < std::max(0.1 * options.loss_error * loss, 1e-14) ? settled + 1 : 0;
    before = best.value;
    if (options.progress) options.progress(krylov.steps(), best.residual);
    if (!more || settled == 2) return mode_of(krylov, best, parts_->disc, grid);
    if (krylov.steps() == options.most_round_trips)
      throw NumericalError(
          fmt::format("the mode of the cavity was not found within {} round trips; the residual is {:.2g}",
                      options.most_round_trips, best.residual));
  }
}

Complex CavityWaves::overlap(Field const& departing, Field const& arriving) const {
  double const pitch = parts_->cavity.grid.pitch();
  Complex sum = 0;
  for (std::size_t i = 0; i < departing.values.size(); ++i) sum += departing.values[i] * arriving.values[i];
  return sum * (pitch * pitch);
}

PowerLedger CavityWaves::ledger(WaveMode const& mode) const {
  std::size_t const n = parts_->cavity.baffles.size();
  PowerLedger ledger{std::vector<double>(n), std::vector<double>(n)};
  Field work = mode.spectrum;
  parts_->travel(work, {}, &ledger);
  return ledger;
}

}  // namespace straytrace::wave
