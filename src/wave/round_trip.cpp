// SPDX-License-Identifier: BSD-3-Clause
#include "wave/round_trip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/math/functions.hpp"
#include "base/math/linear_algebra.hpp"
#include "base/process/threads.hpp"
#include "beams/overlap.hpp"

namespace straytrace::wave {
namespace {

// Transform of a disc of radius a, 2 pi a J1(qa)/q with q = 2 pi sqrt(m^2 + n^2)/W, for 0 <= n <= m < N/2; of an
// ellipse of half axes a c and a: c times that with q = 2 pi sqrt((c m)^2 + n^2)/W, for 0 <= m, n < N/2. m^2
class DiscSpectrum {
 public:
  DiscSpectrum(RoundHole const& hole, Grid const& grid) : half_(hole.cosine == 1 ? 0 : grid.points / 2) {
    double const radius = hole.radius;
    for (int m = 0; m < grid.points / 2; ++m)
      for (int n = 0; n <= (half_ ? half_ - 1 : m); ++n) {
        double const q = 2 * pi * std::hypot(m * hole.cosine, n) / grid.window;
        double const disc = m || n ? 2 * pi * radius * bessel_j(1, q * radius) / q : pi * radius * radius;
        values_.push_back(hole.cosine * disc);
      }
  }
  double operator()(int m, int n) const {
    m = std::abs(m);
    n = std::abs(n);
    if (half_) return values_[std::size_t(m) * std::size_t(half_) + std::size_t(n)];
    int const small = std::min(m, n), large = std::max(m, n);
    return values_[std::size_t(large) * std::size_t(large + 1) / 2 + std::size_t(small)];
  }

 private:
  int half_;  // 0: symmetric in m and n
  std::vector<double> values_;
};

constexpr int ripple_reach = 24;  // points
constexpr int taper_steps = 8192;

}  // namespace

Mask::Mask(RoundHole const& hole, Grid const& grid, Transform const& transform) : values_(grid.size()) {
  int const N = grid.points;
  DiscSpectrum const disc(hole, grid);
  Field spectrum(grid);
  for (int row = 0; row < N; ++row)
    for (int column = 0; column < N; ++column) {
      int const n = row < N / 2 ? row : row - N, m = column < N / 2 ? column : column - N;
      if (n == -N / 2 || m == -N / 2) continue;  // without partner of opposite frequency
      // The axis is at point N/2: a sign for odd frequencies.
      double const turns = 0.5 * ((m + n) & 1) - (m * hole.x + n * hole.y) / grid.window;
      spectrum(row, column) = disc(m, n) / (grid.pitch() * grid.pitch()) * turned(turns);
    }
  transform.inverse(spectrum, N, N);
  std::ranges::transform(spectrum.values, values_.begin(), [](Complex z) { return z.real(); });
  auto const across = [&](double reach) {
    return int(std::min(2 * (std::ceil(reach / grid.pitch()) + ripple_reach), double(N)));
  };
  rows_ = across(std::abs(hole.y) + hole.radius);
  columns_ = across(std::abs(hole.x) + hole.cosine * hole.radius);
}

double Mask::clipped(Field const& field) const {
  double sum = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) sum += (1 - values_[i]) * std::norm(field.values[i]);
  return sum;
}

Field reflection(WaveMirror const& mirror, Mask const& outline, double wavelength, Grid const& grid, double wavefront) {
  Field factor(grid);
  double const kept = std::sqrt(1 - mirror.scattered), cosine = mirror.outline.cosine;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const x = grid.at(column), y = grid.at(row);
      std::size_t const i = std::size_t(row) * std::size_t(grid.points) + std::size_t(column);
      double const height = mirror.height.empty() ? 0 : mirror.height[i];
      double const on_mirror = x / cosine;
      double const path = (on_mirror * on_mirror + y * y) * (mirror.curvature * cosine) + 2 * height * cosine -
                          2 * (mirror.tilt_x * x + mirror.tilt_y * y) - (x * x + y * y) * (wavefront / 2);
      factor.values[i] = kept * outline.values()[i] * turned(-path / wavelength);
    }
  return factor;
}

Leg::Leg(double length, double reach, double wavelength, Grid const& grid) : length_(length) {
  double const k = 2 * pi / wavelength, nyquist = grid.largest_angle(wavelength);
  double const fresnel = std::sqrt(wavelength / length);
  keep_ = std::min(reach / length + fresnel, 0.6 * nyquist);
  cut_ = std::min({keep_ + 4 * fresnel, 0.7 * nyquist, (grid.window - reach) / length});
  if (!(cut_ > keep_))
    throw InputError(fmt::format(
        "a window of {:g} m is too narrow for a leg of {:g} m: light within {:.3g} m of the axis at both ends wraps "
        "around it",
        grid.window, length, reach / 2));
  angle_step_ = wavelength / grid.window;
  columns_ = std::min(2 * (int(std::floor(cut_ / angle_step_)) + 1), grid.points);
  for (int i = 0; i < grid.points; ++i) {
    double const angle = grid.frequency(i) * wavelength;
    Complex const factor = turned(-length * angle * angle / (2 * wavelength));
    paraxial_.insert(paraxial_.end(), {factor.real(), factor.imag()});
  }
  double const largest = k * std::pow(cut_, 4) * length / 8;
  quartic_ = largest > 1e-7 ? k * length / 8 : 0;
  for (int i = 0; i <= taper_steps; ++i) {
    double const angle = std::sqrt(keep_ * keep_ + (cut_ * cut_ - keep_ * keep_) * i / taper_steps);
    taper_.push_back(0.5 * std::erfc(4 * ((angle - keep_) / (cut_ - keep_) - 0.5)));
  }
  taper_.push_back(taper_.back());
}

LegTables Leg::tables() const {
  double const keep2 = keep_ * keep_, cut2 = cut_ * cut_;
  return {paraxial_.data(), taper_.data(), taper_steps, keep2, cut2, taper_steps / (cut2 - keep2),
          angle_step_,      quartic_};
}

void Leg::apply(Field& spectrum, int threads) const {
  int const N = spectrum.grid.points, half = columns_ / 2;
  LegTables const tables = this->tables();
  for_rows(0, N, threads, [&](int row) {
    Complex* const line = &spectrum(row, 0);
    std::fill(line + half, line + N - half, Complex{});
    line_kernels->leg_row(tables, N, row < N / 2 ? row : row - N, half, reinterpret_cast<double*>(line));
  });
}

namespace {

constexpr double rounding = 1e-14;    // of an image with nothing new in it
constexpr double least_start = 1e-6;  // of a start beside the others
constexpr Eigen::Index slice = 1024;  // elements of a vector that stay in the cache

}  // namespace

SpectrumDisc::SpectrumDisc(Grid const& grid, double largest_frequency) {
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      if (std::hypot(grid.frequency(row), grid.frequency(column)) < largest_frequency)
        at_.push_back(std::size_t(row) * std::size_t(grid.points) + std::size_t(column));
}

Eigen::VectorXcd SpectrumDisc::pack(Field const& spectrum) const {
  Eigen::VectorXcd packed(Eigen::Index(at_.size()));
  for (std::size_t i = 0; i < at_.size(); ++i) packed[Eigen::Index(i)] = spectrum.values[at_[i]];
  return packed;
}

void SpectrumDisc::unpack(Eigen::VectorXcd const& packed, Field& spectrum) const {
  std::ranges::fill(spectrum.values, Complex{});
  for (std::size_t i = 0; i < at_.size(); ++i) spectrum.values[at_[i]] = packed[Eigen::Index(i)];
}

Krylov::Krylov(std::vector<Eigen::VectorXcd> const& starts, int threads) : threads_(unsigned(std::max(0, threads))) {
  for (Eigen::VectorXcd const& start : starts) {
    Eigen::VectorXcd rest = start.normalized();
    orthogonalise(rest);
    if (rest.norm() > least_start) vectors_.push_back(rest.normalized());
  }
  starts_ = int(vectors_.size());
}

// Classical Gram-Schmidt, twice: the second removes the rounding of the first. Slice by slice, so that the vectors are
// read from memory three times in all.
Eigen::VectorXcd Krylov::orthogonalise(Eigen::VectorXcd& image) const {
  auto const count = Eigen::Index(vectors_.size());
  Eigen::MatrixXcd parts(count, (image.size() + slice - 1) / slice);  // of the shares, by slice
  auto const sweep = [&](Eigen::VectorXcd const* subtracted, bool measured) {
    in_parallel(std::size_t(parts.cols()), threads_, [&](std::size_t s) {
      Eigen::Index const first = Eigen::Index(s) * slice, size = std::min(slice, image.size() - first);
      auto here = image.segment(first, size);
      for (Eigen::Index i = 0; subtracted && i < count; ++i)
        here -= (*subtracted)[i] * vectors_[std::size_t(i)].segment(first, size);
      for (Eigen::Index i = 0; measured && i < count; ++i)
        parts(i, Eigen::Index(s)) = vectors_[std::size_t(i)].segment(first, size).dot(here);
    });
  };
  auto const summed = [&] {
    Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(count);
    for (Eigen::Index s = 0; s < parts.cols(); ++s) sum += parts.col(s);
    return sum;
  };
  sweep(nullptr, true);
  Eigen::VectorXcd const shares = summed();
  sweep(&shares, true);
  Eigen::VectorXcd const rounded = summed();
  sweep(&rounded, false);
  return shares + rounded;
}

bool Krylov::extend(Eigen::VectorXcd image) {
  Eigen::Index const m = matrix_.cols();
  Eigen::VectorXcd const shares = orthogonalise(image);
  double const rest = image.norm();
  if (rest > rounding) vectors_.emplace_back(image / rest);
  matrix_.conservativeResizeLike(Eigen::MatrixXcd::Zero(Eigen::Index(vectors_.size()), m + 1));
  matrix_.col(m).head(shares.size()) = shares;
  if (rest > rounding) matrix_(shares.size(), m) = rest;
  return m + 1 < Eigen::Index(vectors_.size());
}

std::vector<RitzPair> Krylov::ritz() const {
  Eigen::Index const m = matrix_.cols(), in_starts = std::min(Eigen::Index(starts_), m);
  ComplexModes const solved = complex_modes(matrix_.topRows(m));
  std::vector<RitzPair> pairs;
  for (Eigen::Index i = 0; i < m; ++i) {
    Eigen::VectorXcd const y = solved.vectors.col(i).normalized();
    double const residual = (matrix_.bottomRows(matrix_.rows() - m) * y).norm();
    pairs.push_back({solved.values[i], residual, y.head(in_starts).norm(), y});
  }
  std::ranges::stable_sort(pairs, std::ranges::greater{}, &RitzPair::overlap);
  return pairs;
}

Eigen::VectorXcd Krylov::vector(RitzPair const& pair) const {
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(vectors_.front().size());
  for (Eigen::Index i = 0; i < pair.coordinates.size(); ++i) sum += pair.coordinates[i] * vectors_[std::size_t(i)];
  return sum;
}

namespace {

double sum_of_squares(Field const& field) {
  double sum = 0;
  for (Complex z : field.values) sum += std::norm(z);
  return sum;
}

// The mask of an opening between two spherical waves; `wavefront`: difference of their curvatures, 1/m.
Field phase_mask(Mask const& mask, double wavefront, double wavelength, Grid const& grid) {
  Field factor(grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const x = grid.at(column), y = grid.at(row);
      std::size_t const i = std::size_t(row) * std::size_t(grid.points) + std::size_t(column);
      factor.values[i] = mask.values()[i] * turned((x * x + y * y) * wavefront / (2 * wavelength));
    }
  return factor;
}

// Real parts, then imaginary parts.
std::vector<double> parts_of(Field const& field) {
  std::vector<double> parts;
  parts.reserve(2 * field.values.size());
  for (Complex z : field.values) parts.push_back(z.real());
  for (Complex z : field.values) parts.push_back(z.imag());
  return parts;
}

// x to -x: the frequency of an element changes sign.
void mirror_image(Field& spectrum, int threads) {
  int const N = spectrum.grid.points;
  for_rows(0, N, threads, [&](int row) {
    Complex* const line = &spectrum(row, 0);
    std::reverse(line + 1, line + N);
  });
}

}  // namespace

double TripLosses::total() const {
  double sum = beyond_band;
  for (double p : taken) sum += p;
  return sum;
}

struct RoundTrip::Parts {
  // A leg between two stops of the way, in either direction.
  struct Way {
    double length, reach, window;
    bool operator==(Way const&) const = default;
  };
  struct Opening {
    RoundHole hole;
    double scale;
    bool operator==(Opening const&) const = default;
  };
  static constexpr std::size_t none = std::size_t(-1);
  struct Stop {
    std::size_t leg, mask, factor = none;  // with a factor, that of the mask is in it
  };

  Trip trip;
  int threads;
  std::shared_ptr<WaveDevice> device;  // none: the host
  Transform transform;
  std::vector<Mask> masks;                   // one of each kind
  std::vector<std::vector<double>> factors;  // real parts, then imaginary parts
  std::vector<Leg> legs;
  std::vector<Stop> stops;
  SpectrumDisc disc;  // of the first leg: the fields of which modes are made
  std::optional<HostTrip> host_trip;
  std::unique_ptr<DeviceTrip> on_device;

  Parts(Trip t, Computing const& on)
      : trip(std::move(t)), threads(on.threads), device(on.device), transform(trip.grid.points, threads) {
    make_masks();
    make_legs();
    make_factors();
    disc = SpectrumDisc(trip.grid, first_leg().cut() / trip.wavelength);
    make_host_trip();
  }

  Leg const& first_leg() const { return legs[stops.front().leg]; }
  TripStop const& before(std::size_t stop) const { return trip.stops[stop > 0 ? stop - 1 : trip.stops.size() - 1]; }
  TripStop const& after(std::size_t stop) const { return trip.stops[stop + 1 < trip.stops.size() ? stop + 1 : 0]; }
  Grid grid_at(TripStop const& stop) const { return {trip.grid.points, trip.grid.window * stop.scale}; }
  // The farthest point of the opening from the axis.
  static double reach(TripStop const& stop) { return stop.opening.radius + std::hypot(stop.opening.x, stop.opening.y); }
  // From the axis up to which light that arrives is wanted; the same for both directions of a leg, so that the round
  // trip of a linear cavity stays symmetric (eq. W.11).
  static double seen(TripStop const& stop) { return std::max(reach(stop), stop.lit); }
  // How much wider the grid becomes on the way to a stop.
  double widening(std::size_t stop) const { return trip.stops[stop].scale / before(stop).scale; }
  // Of the spherical wave that the grid follows from a stop to the next less that to it (eq. W.54), 1/m.
  double wavefront(std::size_t stop) const {
    std::size_t const next = stop + 1 < trip.stops.size() ? stop + 1 : 0;
    double const here = widening(stop), there = widening(next);
    return (here - 1) / (here * trip.stops[stop].leg) - (there - 1) / trip.stops[next].leg;
  }

  void make_masks() {
    std::vector<Opening> kinds;
    for (TripStop const& stop : trip.stops) {
      auto const known = std::ranges::find(kinds, Opening{stop.opening, stop.scale});
      stops.push_back({0, std::size_t(known - kinds.begin())});
      if (known != kinds.end()) continue;
      kinds.push_back({stop.opening, stop.scale});
      masks.emplace_back(stop.opening, grid_at(stop), transform);
    }
  }
  void make_legs() {
    std::vector<Way> kinds;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      double const wider = widening(i);
      Grid const grid = grid_at(before(i));
      Way const way{
          trip.stops[i].leg / wider,
          std::max(reach(before(i)) + seen(trip.stops[i]) / wider, seen(before(i)) + reach(trip.stops[i]) / wider),
          grid.window};
      auto const known = std::ranges::find(kinds, way);
      stops[i].leg = std::size_t(known - kinds.begin());
      if (known != kinds.end()) continue;
      kinds.push_back(way);
      legs.emplace_back(way.length, way.reach, trip.wavelength, grid);
    }
  }
  void make_factors() {
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if (!trip.stops[i].mirror && wavefront(i) == 0) continue;
      stops[i].factor = factors.size();
      factors.push_back(parts_of(factor_on_grid(i)));
      if (trip.stops[i].mirror) trip.stops[i].mirror->height = {};  // it is in the factor
    }
  }
  Field factor_on_grid(std::size_t i) const {
    TripStop const& stop = trip.stops[i];
    Mask const& mask = masks[stops[i].mask];
    return stop.mirror ? reflection(*stop.mirror, mask, trip.wavelength, grid_at(stop), wavefront(i))
                       : phase_mask(mask, wavefront(i), trip.wavelength, grid_at(stop));
  }

  void make_host_trip() {
    std::vector<LegAndPlane> all;
    for (Stop const& stop : stops) {
      Leg const& leg = legs[stop.leg];
      all.push_back({leg.tables(), leg.columns(), factor(stop), masks[stop.mask].rows()});
    }
    if (device)
      on_device = prepared(*device, trip.grid, std::move(all));
    else
      host_trip.emplace(transform.tables(), trip.grid, std::move(all), threads);
  }
  PlaneFactor factor(Stop const& stop) const {
    if (stop.factor == none) return {masks[stop.mask].values().data()};
    double const* const re = factors[stop.factor].data();
    return {re, re + trip.grid.size()};
  }

  void travel(Field& spectrum, Watch const& watch = {}) const {
    if (on_device)
      run(*on_device, spectrum, watch);
    else
      host_trip->run(spectrum, watch);
    if (trip.mirrored) mirror_image(spectrum, threads);
  }
  double taken(std::size_t stop, Field const&) const;
};

// Power that does not go on, as a sum of |values|^2.
double RoundTrip::Parts::taken(std::size_t stop, Field const& field) const {
  double const clipped = masks[stops[stop].mask].clipped(field);
  if (!trip.stops[stop].mirror) return clipped;
  return clipped + trip.stops[stop].mirror->scattered * (sum_of_squares(field) - clipped);
}

RoundTrip::RoundTrip(Trip trip, Computing on) : parts_(std::make_unique<Parts>(std::move(trip), on)) {}
RoundTrip::~RoundTrip() = default;
RoundTrip::RoundTrip(RoundTrip&&) noexcept = default;
Trip const& RoundTrip::trip() const { return parts_->trip; }
Transform const& RoundTrip::transform() const { return parts_->transform; }
int RoundTrip::threads() const { return parts_->threads; }
Computing RoundTrip::computing() const { return {parts_->threads, parts_->device}; }
Mask const& RoundTrip::mask(std::size_t stop) const { return parts_->masks[parts_->stops[stop].mask]; }
SpectrumDisc const& RoundTrip::band() const { return parts_->disc; }

Field RoundTrip::hermite_gauss(AxisBeam x_axis, AxisBeam y_axis, int n, int m) const {
  Grid const& grid = parts_->trip.grid;
  double const wavelength = parts_->trip.wavelength;
  double const followed = (parts_->widening(0) - 1) / parts_->trip.stops.front().leg;  // eq. W.54
  auto const along = [&](AxisBeam const& beam, int quanta) {
    std::vector<Complex> values;  // hermite_function is exp(-x^2/2) at order 0
    for (int i = 0; i < grid.points; ++i) {
      double const at = grid.at(i), off = at - beam.centre;
      double const path = (beam.curvature * off * off - followed * at * at) / 2 + beam.slope * off;
      values.push_back(hermite_function(quanta, std::sqrt(2.0) * off / beam.radius) * turned(path / wavelength));
    }
    return values;
  };
  std::vector<Complex> const across = along(x_axis, n), up = along(y_axis, m);
  double const size = std::sqrt(2 / (x_axis.radius * y_axis.radius));
  Field field(grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      field(row, column) = size * across[std::size_t(column)] * up[std::size_t(row)];
  parts_->transform.forward(field, grid.points, parts_->first_leg().columns());
  return field;
}

void RoundTrip::set_height(std::size_t stop, std::vector<double> height) {
  WaveMirror& mirror = *parts_->trip.stops[stop].mirror;
  mirror.height = std::move(height);
  // In place: the legs and planes point to it.
  std::ranges::copy(parts_of(parts_->factor_on_grid(stop)), parts_->factors[parts_->stops[stop].factor].begin());
  mirror.height = {};
  if (parts_->on_device) parts_->on_device->take_tables();
}

void RoundTrip::travel(Field& spectrum, Watch const& watch) const { parts_->travel(spectrum, watch); }

namespace {

// Unit power: the sum of |spectrum|^2 is N^2/pitch^2.
WaveMode mode_of(Krylov const& krylov, RitzPair const& pair, SpectrumDisc const& disc, Grid const& grid) {
  WaveMode mode{pair.value, pair.residual, krylov.steps(), Field(grid)};
  disc.unpack(krylov.vector(pair) * (grid.points / grid.pitch()), mode.spectrum);
  return mode;
}

}  // namespace

WaveMode RoundTrip::mode(Field const& start, SolveOptions const& options) const {
  Grid const& grid = parts_->trip.grid;
  Krylov krylov(parts_->disc.pack(start), parts_->threads);
  Field work(grid);
  Complex before = 0;
  for (int settled = 0;;) {
    parts_->disc.unpack(krylov.next(), work);
    parts_->travel(work);
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

TripLosses RoundTrip::losses(WaveMode const& mode) const {
  TripLosses losses{std::vector<double>(parts_->stops.size())};
  Grid const& grid = parts_->trip.grid;
  double const plane_power = grid.pitch() * grid.pitch(), spectral_power = plane_power / double(grid.size());
  Field work = mode.spectrum;
  double left = sum_of_squares(work) * spectral_power;
  parts_->travel(work, {[&](std::size_t stop, Field const& arriving) {
                          double const arrived = sum_of_squares(arriving) * plane_power;
                          losses.taken[stop] = parts_->taken(stop, arriving) * plane_power;
                          losses.beyond_band += left - arrived;
                          left = arrived - losses.taken[stop];
                        },
                        {}});
  losses.beyond_band += left - parts_->disc.pack(work).squaredNorm() * spectral_power;
  return losses;
}

}  // namespace straytrace::wave
