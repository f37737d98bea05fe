// SPDX-License-Identifier: BSD-3-Clause
#include "wave/modes/driven.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "beams/overlap.hpp"

namespace straytrace::wave {
namespace {

// The modes of one order, found from its Hermite-Gauss modes HG(N,0), HG(N-1,1), ... as starts.
struct Family {
  std::vector<RitzPair> modes;  // with the largest share in the starts, by loss
  int starts = 0;
};

using HermiteGauss = std::function<Field(int n, int m)>;

std::vector<Eigen::VectorXcd> starts_of(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int order) {
  std::vector<Eigen::VectorXcd> starts;
  for (int m = 0; m <= order; ++m) starts.push_back(trip.band().pack(hermite_gauss(order - m, m)));
  return starts;
}

double loss_of(RitzPair const& pair) { return 1 - std::norm(pair.value); }

// What distinguishes eigenvalues, at the error of the losses.
double resolution(RitzPair const& pair, SolveOptions const& options) {
  return options.loss_error * std::max(loss_of(pair), 1e-9);
}

std::vector<RitzPair> modes_in(Krylov const& krylov) {
  std::vector<RitzPair> modes = krylov.ritz();
  modes.resize(std::size_t(krylov.starts()));
  std::ranges::stable_sort(modes, {}, loss_of);
  return modes;
}

bool unchanged(std::vector<RitzPair> const& now, std::vector<RitzPair> const& before, SolveOptions const& options) {
  if (before.size() != now.size()) return false;
  for (RitzPair const& pair : now) {
    double nearest = infinity;
    for (RitzPair const& other : before) nearest = std::min(nearest, std::abs(pair.value - other.value));
    if (!(nearest < std::max(0.1 * resolution(pair, options), 1e-14))) return false;
  }
  return true;
}

// Until two more round trips of each start change no eigenvalue.
Family family_of(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int order, SolveOptions const& options) {
  Krylov krylov(starts_of(trip, hermite_gauss, order), trip.threads());
  Field work(trip.trip().grid);
  Family family{{}, krylov.starts()};
  int quiet = 0;
  for (int trips = 1; trips <= options.most_round_trips && quiet < 2; ++trips) {
    bool more = true;
    for (int i = 0; i < krylov.starts() && more; ++i) {
      trip.band().unpack(krylov.next(), work);
      trip.travel(work);
      more = krylov.extend(trip.band().pack(work));
    }
    std::vector<RitzPair> modes = modes_in(krylov);
    quiet = unchanged(modes, family.modes, options) ? quiet + 1 : 0;
    family.modes = std::move(modes);
    if (options.progress) options.progress(trips, family.modes.back().residual);
    if (!more) break;
  }
  std::erase_if(family.modes, [](RitzPair const& mode) { return mode.overlap * mode.overlap < 0.5; });
  return family;
}

// Numbers of modes that have one eigenvalue, one after the other in the order of their loss.
std::vector<int> alike_in(std::vector<RitzPair> const& modes, SolveOptions const& options) {
  std::vector<int> sizes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    bool const with_last = i > 0 && std::abs(modes[i].value - modes[i - 1].value) < resolution(modes[i], options);
    if (with_last)
      ++sizes.back();
    else
      sizes.push_back(1);
  }
  return sizes;
}

// Orthonormal columns that span the modes of a group in the modes of the starts: HG(N,0), HG(N-1,1), ...
Eigen::MatrixXcd span_of(std::vector<RitzPair> const& modes, std::size_t first, int count, int starts) {
  Eigen::MatrixXcd whole(modes[first].coordinates.size(), count);
  for (int i = 0; i < count; ++i) whole.col(i) = modes[first + std::size_t(i)].coordinates;
  return orthonormal_columns(whole).topRows(starts);
}

// Named modes by what they have in the span, the largest `count`.
std::vector<ModeLine::Named> largest(std::vector<ModeLine::Named> named, int count) {
  std::ranges::stable_sort(named, std::ranges::greater{}, [](auto const& n) { return std::round(1e6 * n.shared); });
  named.resize(std::size_t(count));
  return named;
}

std::vector<ModeLine::Named> hermite_shares(Eigen::MatrixXcd const& span, int order) {
  std::vector<ModeLine::Named> named;
  for (int m = 0; m <= order; ++m) named.push_back({order - m, m, span.row(m).squaredNorm()});
  return named;
}

std::vector<ModeLine::Named> laguerre_shares(Eigen::MatrixXcd const& span, int order) {
  std::vector<ModeLine::Named> named;
  for (int l = order; l >= -order; l -= 2) named.push_back({(order - std::abs(l)) / 2, l, 0});
  for (Eigen::Index i = 0; i < span.cols(); ++i) {
    beams::ModeCoefficients hermite(order);
    for (int m = 0; m <= order; ++m) hermite(order - m, m) = span(m, i);
    beams::LaguerreCoefficients const laguerre(hermite);
    for (ModeLine::Named& n : named) n.shared += std::norm(laguerre(n.one, n.two));
  }
  return named;
}

void add_lines(std::vector<ModeLine>& lines, Family const& family, int order, Complex fundamental,
               SolveOptions const& options) {
  std::size_t first = 0;
  for (int const count : alike_in(family.modes, options)) {
    Eigen::MatrixXcd const span = span_of(family.modes, first, count, family.starts);
    auto const hermite = largest(hermite_shares(span, order), count),
               laguerre = largest(laguerre_shares(span, order), count);
    for (int i = 0; i < count; ++i) {
      RitzPair const& mode = family.modes[first + std::size_t(i)];
      double const turns = std::arg(mode.value / fundamental) / (2 * pi);
      lines.push_back({order, hermite[std::size_t(i)], laguerre[std::size_t(i)], mode.overlap * mode.overlap,
                       loss_of(mode), turns, mode.residual, count});
    }
    first += std::size_t(count);
  }
}

}  // namespace

std::vector<ModeLine> mode_table(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int highest_order,
                                 SolveOptions const& options) {
  std::vector<ModeLine> lines;
  Complex fundamental = 1;
  for (int order = 0; order <= highest_order; ++order) {
    Family const family = family_of(trip, hermite_gauss, order, options);
    if (order == 0 && !family.modes.empty()) fundamental = family.modes.front().value;
    add_lines(lines, family, order, fundamental, options);
  }
  return lines;
}

namespace {

// sqrt(W) per element of a packed spectrum: the sum of |values|^2 is the power.
double amplitude_scale(Grid const& grid) { return grid.pitch() / grid.points; }

// The input behind the input mirror: within its outline, band-limited.
Eigen::VectorXcd entering(RoundTrip const& trip, Field field) {
  Grid const& grid = trip.trip().grid;
  trip.transform().inverse(field, grid.points, grid.points);
  std::vector<double> const& mask = trip.mask(trip.trip().stops.size() - 1).values();
  for (std::size_t i = 0; i < field.values.size(); ++i) field.values[i] *= mask[i];
  trip.transform().forward(field, grid.points, grid.points);
  return trip.band().pack(field) * amplitude_scale(grid);
}

std::vector<DrivenMirror> both_mirrors(CavityWaves const& waves, std::array<MirrorCoating, 2> const& coatings) {
  std::size_t const baffles = waves.cavity().baffles.size();
  return {{baffles, coatings[1]}, {2 * baffles + 1, coatings[0]}};
}

double amplitude(double power) { return std::sqrt(std::max(power, 0.0)); }

constexpr int least_round_trips = 4, trips_between_checks = 2;

}  // namespace

DrivenCavity::DrivenCavity(RoundTrip const& trip, std::vector<DrivenMirror> mirrors, HermiteGauss const& hermite_gauss,
                           Complex resonance, Field const& input, std::vector<double> const& detunings,
                           DrivenOptions const& options)
    : DrivenCavity(trip, std::move(mirrors), hermite_gauss, resonance, entering(trip, input), detunings, options) {}

DrivenCavity::DrivenCavity(CavityWaves const& waves, std::array<MirrorCoating, 2> const& coatings, Complex resonance,
                           Field const& input, std::vector<double> const& detunings, DrivenOptions const& options)
    : DrivenCavity(
          waves.trip(), both_mirrors(waves, coatings), [&](int n, int m) { return waves.hermite_gauss(n, m); },
          resonance, input, detunings, options) {}

DrivenCavity::DrivenCavity(RoundTrip const& trip, std::vector<DrivenMirror> mirrors, HermiteGauss const& hermite_gauss,
                           Complex resonance, Eigen::VectorXcd const& entering, std::vector<double> const& detunings,
                           DrivenOptions const& options)
    : trip_(trip),
      input_(mirrors.back().coating),
      resonance_(resonance),
      entered_(entering.norm()),
      krylov_(entering, trip.threads()) {
  for (DrivenMirror const& m : mirrors) {
    if (&m != &mirrors.back()) ports_.push_back({m.stop, m.coating.transmission * size_ * size_, {}, {}});
    size_ *= amplitude(m.coating.reflectivity());
  }
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
  find_orders(options.highest_order, hermite_gauss);
}

void DrivenCavity::advance() {
  Field work(trip_.trip().grid);
  trip_.band().unpack(krylov_.next() / amplitude_scale(work.grid), work);
  auto const port_at = [&](std::size_t stop) { return std::ranges::find(ports_, stop, &Port::stop); };
  trip_.travel(work, {[&](std::size_t stop, Field const& arriving) { add_transmitted(*port_at(stop), arriving); },
                      [&](std::size_t stop) { return port_at(stop) != ports_.end(); }});
  krylov_.extend(trip_.band().pack(work) * amplitude_scale(work.grid));
}

// With the mask as weight, so that a product is the power that passes (eq. W.24).
void DrivenCavity::add_transmitted(Port& port, Field const& arriving) {
  Mask const& mask = trip_.mask(port.stop);
  int const N = arriving.grid.points, rows = mask.rows() / 2, columns = mask.columns() / 2;
  Eigen::VectorXcd here(Eigen::Index(2 * rows) * (2 * columns)), weighted(here.size());
  Eigen::Index i = 0;
  for (int row = N / 2 - rows; row < N / 2 + rows; ++row)
    for (int column = N / 2 - columns; column < N / 2 + columns; ++column, ++i) {
      here[i] = trip_.trip().grid.pitch() * arriving(row, column);
      weighted[i] = here[i] * mask.values()[std::size_t(row) * std::size_t(N) + std::size_t(column)];
    }
  port.arriving.push_back(std::move(here));
  auto const n = Eigen::Index(port.arriving.size());
  port.power.conservativeResizeLike(Eigen::MatrixXcd::Zero(n, n));
  for (Eigen::Index j = 0; j < n; ++j) {
    port.power(j, n - 1) = port.arriving[std::size_t(j)].dot(weighted);
    port.power(n - 1, j) = std::conj(port.power(j, n - 1));
  }
}

void DrivenCavity::triangularise() {
  SchurForm schur = schur_form(krylov_.matrix().topRows(krylov_.steps()));
  triangle_ = std::move(schur.triangle);
  basis_ = std::move(schur.basis);
}

Complex DrivenCavity::factor(double detuning) const {
  return size_ * turned(detuning) * std::abs(resonance_) / resonance_;
}

// eq. W.50 in the Krylov space, and eq. W.51.
DrivenCavity::Solution DrivenCavity::solution(double detuning) const {
  Complex const a = factor(detuning);
  Eigen::Index const m = triangle_.rows();
  Eigen::MatrixXcd shifted = -a * triangle_;
  shifted.diagonal().array() += 1;
  double const pumped = amplitude(input_.transmission) * entered_;
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

void DrivenCavity::find_orders(int highest_order, HermiteGauss const& hermite_gauss) {
  std::vector<Eigen::VectorXcd> const& vectors = krylov_.vectors();
  Eigen::Index const m = krylov_.steps();
  for (int order = 0; order <= highest_order; ++order) {
    Eigen::MatrixXcd amplitudes(order + 1, m);
    for (int n = 0; n <= order; ++n) {
      Eigen::VectorXcd const mode = trip_.band().pack(hermite_gauss(n, order - n)) * amplitude_scale(trip_.trip().grid);
      for (Eigen::Index j = 0; j < m; ++j) amplitudes(n, j) = mode.dot(vectors[std::size_t(j)]);
    }
    orders_.push_back(std::move(amplitudes));
  }
}

DrivenPowers DrivenCavity::at(double detuning) const {
  Solution const found = solution(detuning);
  Eigen::VectorXcd const& y = found.y;
  double const t1 = amplitude(input_.transmission), r1 = amplitude(input_.reflectivity());
  DrivenPowers powers{detuning, y.squaredNorm(), 0, 0, {}, {}, found.error};
  // What returns to the input mirror is known by its reflection, which keeps 1 - scattered of it (eq. W.52).
  double const kept = amplitude(1 - trip_.trip().stops.back().mirror->scattered);
  Eigen::VectorXcd outwards = t1 / (r1 * kept) * y;
  outwards[0] -= (r1 + t1 * t1 / (r1 * kept)) * entered_;
  powers.reflected = outwards.squaredNorm();
  for (Port const& port : ports_) {
    powers.ports.push_back(port.passes * (y.adjoint() * port.power * y).value().real());
    powers.transmitted += powers.ports.back();
  }
  for (Eigen::MatrixXcd const& order : orders_) powers.orders.push_back((order * y).squaredNorm() / powers.circulating);
  return powers;
}

Field DrivenCavity::field(double detuning) const {
  Grid const& grid = trip_.trip().grid;
  Eigen::VectorXcd const y = solution(detuning).y;
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(krylov_.vectors().front().size());
  for (Eigen::Index i = 0; i < y.size(); ++i) sum += y[i] * krylov_.vectors()[std::size_t(i)];
  Field spectrum(grid);
  trip_.band().unpack(sum / amplitude_scale(grid), spectrum);
  return spectrum;
}

void DrivenScan::take(DrivenCavity const& cavity, std::vector<double> const& at, DrivenOptions const& options) {
  entered = cavity.entered();
  round_trips = cavity.round_trips();
  for (double const detuning : at) {
    detunings.push_back(cavity.at(detuning));
    error = std::max(error, detunings.back().error);
  }
  if (error > options.error)
    warnings.push_back(fmt::format(
        "wave: after {} round trips, fields at some detunings are known to {:.2g} of themselves only: resonances of "
        "modes that the input barely excites",
        round_trips, error));
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
