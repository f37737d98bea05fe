// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/irradiance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "wave/heights/height_map.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

constexpr int sectors = 32;

}  // namespace

double PolarIrradiance::azimuth(int sector) const { return (sector + 0.5) * 2 * pi / sectors; }

double PolarIrradiance::cell_area(int ring) const { return 2 * pi * radius(ring) * step / sectors; }

double PolarIrradiance::ring_mean(double radius) const {
  int const ring = int(radius / step);
  if (!(radius >= 0) || ring >= rings) return 0;
  double sum = 0;
  for (int s = 0; s < sectors; ++s) sum += double(mean[std::size_t(ring * sectors + s)]);
  return sum / sectors;
}

double PolarIrradiance::power(double from, double to) const {
  double sum = 0;
  for (int ring = 0; ring < rings; ++ring) {
    double const low = std::fmax(from, ring * step), high = std::fmin(to, (ring + 1) * step);
    if (!(high > low)) continue;
    sum += pi * (high * high - low * low) * ring_mean(radius(ring));
  }
  return sum;
}

std::vector<double> PolarIrradiance::beyond(RoundHole const& hole) const {
  std::vector<double> shares;
  for (int s = 0; s < sectors; ++s) {
    double const x = std::cos(azimuth(s)), y = std::sin(azimuth(s));
    double const across = hole.x * y - hole.y * x;
    double const edge = hole.x * x + hole.y * y + std::sqrt(std::fmax(0, hole.radius * hole.radius - across * across));
    double sum = 0;
    for (int ring = 0; ring < rings; ++ring) {
      double const low = std::fmax(edge, ring * step), high = (ring + 1) * step;
      if (high > low) sum += pi * (high * high - low * low) / sectors * double(mean[std::size_t(ring * sectors + s)]);
    }
    shares.push_back(sum);
  }
  return shares;
}

PolarIrradiance const& PlaneIrradiance::of(int plane, Travel travel) const {
  return (travel == Travel::towards_mirror2 ? towards_mirror2 : towards_mirror1)[std::size_t(plane)];
}

IrradianceMeter::IrradianceMeter(Grid const& grid, std::size_t planes)
    : step_(grid.pitch()), rings_(grid.points / 2), cell_(grid.size(), -1), points_(std::size_t(rings_ * sectors)) {
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const x = grid.at(column), y = grid.at(row);
      int const ring = int(std::hypot(x, y) / step_);
      if (ring >= rings_) continue;
      double const turn = std::atan2(y, x) / (2 * pi);
      int const sector = std::min(sectors - 1, int((turn < 0 ? turn + 1 : turn) * sectors));
      std::int32_t const cell = ring * sectors + sector;
      cell_[std::size_t(row) * std::size_t(grid.points) + std::size_t(column)] = cell;
      ++points_[std::size_t(cell)];
    }
  result_.towards_mirror2.resize(planes);
  result_.towards_mirror1.resize(planes);
}

void IrradianceMeter::operator()(Arrival const& arrival) {
  std::size_t const cells = points_.size();
  std::vector<double> mean(cells), square(cells);
  for (std::size_t i = 0; i < cell_.size(); ++i) {
    if (cell_[i] < 0) continue;
    double const irradiance = std::norm(arrival.field.values[i]);
    mean[std::size_t(cell_[i])] += irradiance;
    square[std::size_t(cell_[i])] += irradiance * irradiance;
  }
  auto& side = arrival.travel == Travel::towards_mirror2 ? result_.towards_mirror2 : result_.towards_mirror1;
  PolarIrradiance& out = side[std::size_t(arrival.plane)];
  if (out.mean.empty()) out = {step_, rings_, sectors, std::vector<float>(cells), std::vector<float>(cells)};
  if (arrival.plane == 0) ++round_trips_;
  for (int ring = 0; ring < rings_; ++ring) {
    std::size_t const first = std::size_t(ring * sectors), last = first + sectors;
    bool const sparse = std::any_of(points_.begin() + std::ptrdiff_t(first), points_.begin() + std::ptrdiff_t(last),
                                    [](std::int32_t n) { return n == 0; });
    double all = 0, all_square = 0, points = 0;
    for (std::size_t i = first; i < last; ++i) {
      all += mean[i];
      all_square += square[i];
      points += points_[i];
    }
    for (std::size_t i = first; i < last; ++i) {
      out.mean[i] += float(sparse ? all / points : mean[i] / points_[i]);
      out.square[i] += float(sparse ? all_square / points : square[i] / points_[i]);
    }
  }
}

PlaneIrradiance IrradianceMeter::result() && {
  for (auto* const side : {&result_.towards_mirror2, &result_.towards_mirror1})
    for (PolarIrradiance& plane : *side)
      for (auto* const values : {&plane.mean, &plane.square})
        for (float& x : *values) x /= float(round_trips_);
  return std::move(result_);
}

namespace {

// The smallest angle to which unknown heights scatter, rad.
double unknown_from(WaveSettings::Heights heights, std::optional<HeightMap> const& map, ArmCavity const& arm) {
  switch (heights) {
    case WaveSettings::Heights::material:
      return 0;
    case WaveSettings::Heights::none:
      return arm.crossover;  // beyond it the BSDF stands for the mirror
    case WaveSettings::Heights::file:
      return std::fmin(arm.crossover, map.value().nyquist() * arm.cavity.wavelength);
  }
  return 0;
}

HaloMirror halo_mirror(World const& world, WaveSettings const& settings, ArmCavity const& arm, std::size_t i) {
  double const from = unknown_from(settings.mirrors[i].heights, arm.maps[i], arm);
  ArmMirror const& mirror = arm.mirrors[i];
  MirrorBrdf const brdf(world, mirror, (i == 0 ? -1 : 1) * arm.frame.z);
  return {mirror.spot, [brdf, from](double angle) { return angle > from ? brdf(angle) : 0; }};
}

}  // namespace

double diode_angle(ArmCavity const& arm, Photodiode const& diode) {
  int const last = int(arm.rims.size()) + 1;
  double const z = diode.plane == 0      ? 0
                   : diode.plane == last ? arm.cavity.length
                                         : arm.rims[std::size_t(diode.plane) - 1].centre.z;
  return std::atan2(diode.farthest(), diode.travel == Travel::towards_mirror2 ? z : arm.cavity.length - z);
}

void place_diodes(WaveSettings const& settings, ArmCavity& arm) {
  int const last = int(arm.rims.size()) + 1;
  for (WaveSettings::Photodiodes const& set : settings.photodiodes) {
    int plane = set.on == settings.mirrors[0].surface ? 0 : last;
    RoundHole centre;
    if (auto const rim = std::ranges::find(arm.rims, set.on, &ArmRim::surface); rim != arm.rims.end()) {
      plane = int(rim - arm.rims.begin()) + 1;
      centre = {0, rim->centre.x, rim->centre.y};
    } else if (plane == last && set.on != settings.mirrors[1].surface) {
      arm.problems.push_back({{"photodiodes"},
                              fmt::format("the photodiodes '{}' are not between the mirrors", set.name),
                              "name a baffle between them in 'on'"});
      continue;
    }
    double& lit = plane == 0      ? arm.cavity.mirror1.lit
                  : plane == last ? arm.cavity.mirror2.lit
                                  : arm.cavity.baffles[std::size_t(plane) - 1].lit;
    for (std::size_t i = 0; i < set.places.size(); ++i) {
      arm.diodes.push_back({fmt::format("{}_{}", set.name, i + 1), plane,
                            set.towards == 1 ? Travel::towards_mirror2 : Travel::towards_mirror1, centre.x, centre.y,
                            set.places[i].radius, set.places[i].azimuth, DiodeShape(int(set.shape)), set.size,
                            2 * pi / double(set.places.size())});
      lit = std::fmax(lit, arm.diodes.back().farthest());
    }
  }
  if (settings.crossover) return;
  for (Photodiode const& d : arm.diodes) arm.crossover = std::fmax(arm.crossover, 1.2 * diode_angle(arm, d));
}

DiodeExpectation expected_on_diodes(World const& world, WaveSettings const& settings, HaloMoments moments,
                                    Computing on) {
  ArmCavity const arm = arm_cavity(world, settings, planned_arm(world, settings), RandomHeights::left_out);
  on.threads = int(thread_count(unsigned(on.threads)));
  CavityWaves const waves(arm.cavity, on);
  // The tail of the mode on a diode is some 1e-4 of its amplitude; always from one start, so that parameters alone
  // change the result.
  SolveOptions solve;
  solve.loss_error = 1e-7;
  WaveMode const mode = [&] {
    try {
      return waves.mode(waves.hermite_gauss(), solve);
    } catch (NumericalError const& e) {
      throw InputError(fmt::format("wave: the mirrors hold no mode that resembles a Gaussian beam: {}", e.what()),
                       "check the mirrors, their tilts and the baffles");
    }
  }();
  DiodeExpectation out{arm.diodes, {}, {}};
  DiodeMeter meter(waves, arm.diodes);
  Field work = mode.spectrum;
  waves.round_trip(work, std::ref(meter));
  out.smooth.resize(Eigen::Index(arm.diodes.size()));
  for (std::size_t i = 0; i < arm.diodes.size(); ++i) out.smooth[Eigen::Index(i)] = meter.light()[i].power();
  out.halo = halo_on(waves, mode, {halo_mirror(world, settings, arm, 0), halo_mirror(world, settings, arm, 1)},
                     arm.diodes, moments);
  return out;
}

}  // namespace straytrace::wave
