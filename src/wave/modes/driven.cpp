// SPDX-License-Identifier: BSD-3-Clause
#include "wave/modes/driven.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace straytrace::wave {
namespace {

// sqrt(W) per element of a packed spectrum: the sum of |values|^2 is the power.
double amplitude_scale(Grid const& grid) { return grid.pitch() / grid.points; }

// The input behind mirror 1: within its outline, band-limited.
Eigen::VectorXcd entering(CavityWaves const& waves, Field field) {
  Grid const& grid = waves.cavity().grid;
  Transform const& transform = waves.transform();
  transform.inverse(field, grid.points, grid.points);
  std::vector<double> const& mask = waves.outline1().values();
  for (std::size_t i = 0; i < field.values.size(); ++i) field.values[i] *= mask[i];
  transform.forward(field, grid.points, grid.points);
  return waves.band().pack(field) * amplitude_scale(grid);
}

double amplitude(double power) { return std::sqrt(std::max(power, 0.0)); }

constexpr int least_round_trips = 4, trips_between_checks = 2;

}  // namespace

DrivenCavity::DrivenCavity(CavityWaves const& waves, std::array<MirrorCoating, 2> coatings, Complex resonance,
                           Field const& input, std::vector<double> const& detunings, DrivenOptions const& options)
    : DrivenCavity(waves, coatings, resonance, entering(waves, input), detunings, options) {}

DrivenCavity::DrivenCavity(CavityWaves const& waves, std::array<MirrorCoating, 2> coatings, Complex resonance,
                           Eigen::VectorXcd const& entering, std::vector<double> const& detunings,
                           DrivenOptions const& options)
    : waves_(waves),
      coatings_(coatings),
      resonance_(resonance),
      entered_(entering.norm()),
      krylov_(entering, waves.threads()) {
  for (;;) {
    advance();
    int const trips = krylov_.steps();
    bool const closed = trips == int(krylov_.vectors().size()), last = trips >= options.most_round_trips;
    if (!closed && !last && (trips < least_round_trips || trips % trips_between_checks != 0)) continue;
    triangularise();
    double const error = worst(detunings);
    if (options.progress) options.progress(trips, error);
    if (closed || last || error < options.error) break;
  }
  find_orders(options.highest_order);
}

void DrivenCavity::advance() {
  Field work(waves_.cavity().grid);
  waves_.band().unpack(krylov_.next() / amplitude_scale(work.grid), work);
  waves_.round_trip(
      work, [&](Arrival const& arrival) { add_transmitted(arrival.field); },
      [&](int plane, Travel) { return plane == int(waves_.cavity().baffles.size()) + 1; });
  krylov_.extend(waves_.band().pack(work) * amplitude_scale(work.grid));
}

// With the mask as weight, so that a product is the power that passes (eq. W.24).
void DrivenCavity::add_transmitted(Field const& arriving) {
  Mask const& mask = waves_.outline2();
  int const N = arriving.grid.points, half = mask.rows() / 2;
  Eigen::VectorXcd here(Eigen::Index(2 * half) * (2 * half)), weighted(here.size());
  Eigen::Index i = 0;
  for (int row = N / 2 - half; row < N / 2 + half; ++row)
    for (int column = N / 2 - half; column < N / 2 + half; ++column, ++i) {
      here[i] = arriving.grid.pitch() * arriving(row, column);
      weighted[i] = here[i] * mask.values()[std::size_t(row) * std::size_t(N) + std::size_t(column)];
    }
  behind_.push_back(std::move(here));
  auto const n = Eigen::Index(behind_.size());
  passed_.conservativeResizeLike(Eigen::MatrixXcd::Zero(n, n));
  for (Eigen::Index j = 0; j < n; ++j) {
    passed_(j, n - 1) = behind_[std::size_t(j)].dot(weighted);
    passed_(n - 1, j) = std::conj(passed_(j, n - 1));
  }
}

void DrivenCavity::triangularise() {
  Eigen::ComplexSchur<Eigen::MatrixXcd> const schur(krylov_.matrix().topRows(krylov_.steps()));
  triangle_ = schur.matrixT();
  basis_ = schur.matrixU();
}

Complex DrivenCavity::factor(double detuning) const {
  double const size = amplitude(coatings_[0].reflectivity()) * amplitude(coatings_[1].reflectivity());
  return size * turned(detuning) * std::abs(resonance_) / resonance_;
}

// eq. W.50 in the Krylov space, and eq. W.51.
DrivenCavity::Solution DrivenCavity::solution(double detuning) const {
  Complex const a = factor(detuning);
  Eigen::Index const m = triangle_.rows();
  Eigen::MatrixXcd shifted = -a * triangle_;
  shifted.diagonal().array() += 1;
  double const pumped = amplitude(coatings_[0].transmission) * entered_;
  Eigen::VectorXcd const z =
      shifted.triangularView<Eigen::Upper>().solve(Eigen::VectorXcd(pumped * basis_.row(0).adjoint()));
  Solution found{basis_ * z, 0};
  auto const& matrix = krylov_.matrix();
  double const rest = matrix.rows() > m ? std::abs(a) * (matrix.bottomRows(matrix.rows() - m) * found.y).norm() : 0;
  found.error = rest / ((1 - std::abs(a)) * found.y.norm());
  return found;
}

double DrivenCavity::worst(std::vector<double> const& detunings) const {
  double error = 0;
  for (double d : detunings) error = std::max(error, solution(d).error);
  return error;
}

void DrivenCavity::find_orders(int highest_order) {
  std::vector<Eigen::VectorXcd> const& vectors = krylov_.vectors();
  Eigen::Index const m = krylov_.steps();
  for (int order = 0; order <= highest_order; ++order) {
    Eigen::MatrixXcd amplitudes(order + 1, m);
    for (int n = 0; n <= order; ++n) {
      Eigen::VectorXcd const mode =
          waves_.band().pack(waves_.hermite_gauss(n, order - n)) * amplitude_scale(waves_.cavity().grid);
      for (Eigen::Index j = 0; j < m; ++j) amplitudes(n, j) = mode.dot(vectors[std::size_t(j)]);
    }
    orders_.push_back(std::move(amplitudes));
  }
}

DrivenPowers DrivenCavity::at(double detuning) const {
  Solution const found = solution(detuning);
  Eigen::VectorXcd const& y = found.y;
  auto const& [one, two] = coatings_;
  double const t1 = amplitude(one.transmission), r1 = amplitude(one.reflectivity());
  DrivenPowers powers{detuning, y.squaredNorm(), 0, 0, {}, found.error};
  // What returns to mirror 1 is known by its reflection, which keeps 1 - scattered of it (eq. W.52).
  double const kept = amplitude(1 - waves_.cavity().mirror1.scattered);
  Eigen::VectorXcd outwards = t1 / (r1 * kept) * y;
  outwards[0] -= (r1 + t1 * t1 / (r1 * kept)) * entered_;
  powers.reflected = outwards.squaredNorm();
  powers.transmitted = two.transmission * (y.adjoint() * passed_ * y).value().real();
  for (Eigen::MatrixXcd const& order : orders_) powers.orders.push_back((order * y).squaredNorm() / powers.circulating);
  return powers;
}

Field DrivenCavity::field(double detuning) const {
  Grid const& grid = waves_.cavity().grid;
  Eigen::VectorXcd const y = solution(detuning).y;
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(krylov_.vectors().front().size());
  for (Eigen::Index i = 0; i < y.size(); ++i) sum += y[i] * krylov_.vectors()[std::size_t(i)];
  Field spectrum(grid);
  waves_.band().unpack(sum / amplitude_scale(grid), spectrum);
  return spectrum;
}

Field gaussian_field(CavityWaves const& waves, beams::Mode const& beam) {
  Grid const& grid = waves.cavity().grid;
  Field field(grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      Vec3 const p{grid.at(column), grid.at(row), 0};
      field(row, column) = beams::field(beam, p);
    }
  waves.transform().forward(field, grid.points, grid.points);
  return field;
}

}  // namespace straytrace::wave
