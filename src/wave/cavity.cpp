// SPDX-License-Identifier: BSD-3-Clause
#include "wave/cavity.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/functions.hpp"
#include "beams/cavity_mode.hpp"

namespace straytrace::wave {
double PowerLedger::total() const {
  double sum = mirror1 + mirror2 + beyond_band;
  for (double p : towards_mirror2) sum += p;
  for (double p : towards_mirror1) sum += p;
  return sum;
}

namespace {

// Out past the baffles to mirror 2, and back to mirror 1.
Trip there_and_back(WaveCavity const& cavity) {
  std::size_t const n = cavity.baffles.size(), last = n + 1;
  auto const place = [&](std::size_t plane) {
    return plane == 0 ? 0 : plane <= n ? cavity.baffles[plane - 1].place : cavity.length;
  };
  Trip trip{cavity.wavelength, cavity.grid, {}};
  for (std::size_t step = 1; step <= 2 * last; ++step) {
    bool const outward = step <= last;
    std::size_t const plane = outward ? step : 2 * last - step, farther = outward ? plane : plane + 1;
    double const leg = place(farther) - place(farther - 1);
    if (plane > 0 && plane < last)
      trip.stops.push_back({leg, cavity.baffles[plane - 1].rim, {}, 1, cavity.baffles[plane - 1].lit});
    else {
      WaveMirror const& mirror = plane == 0 ? cavity.mirror1 : cavity.mirror2;
      trip.stops.push_back({leg, mirror.outline, mirror, 1, mirror.lit});
    }
  }
  return trip;
}

}  // namespace

struct CavityWaves::Parts {
  WaveCavity cavity;
  RoundTrip trip;

  Parts(WaveCavity c, Computing on) : cavity(std::move(c)), trip(there_and_back(cavity), std::move(on)) {}

  // Planes: mirror 1, baffles, mirror 2. Stops: baffles, mirror 2, baffles from the last to the first, mirror 1.
  Travel travel(std::size_t stop) const {
    return stop <= cavity.baffles.size() ? Travel::towards_mirror2 : Travel::towards_mirror1;
  }
  std::size_t plane(std::size_t stop) const {
    std::size_t const last = cavity.baffles.size() + 1;
    return stop < last ? stop + 1 : 2 * last - stop - 1;
  }
};

CavityWaves::CavityWaves(WaveCavity cavity, Computing on)
    : parts_(std::make_unique<Parts>(std::move(cavity), std::move(on))) {}
CavityWaves::~CavityWaves() = default;
WaveCavity const& CavityWaves::cavity() const { return parts_->cavity; }
RoundTrip const& CavityWaves::trip() const { return parts_->trip; }
Transform const& CavityWaves::transform() const { return parts_->trip.transform(); }
int CavityWaves::threads() const { return parts_->trip.threads(); }
Mask const& CavityWaves::mask(std::size_t baffle) const { return parts_->trip.mask(baffle); }
SpectrumDisc const& CavityWaves::band() const { return parts_->trip.band(); }

void CavityWaves::set_heights(std::array<std::vector<double>, 2> heights) {
  std::size_t const baffles = parts_->cavity.baffles.size();
  parts_->trip.set_height(2 * baffles + 1, heights[0]);
  parts_->trip.set_height(baffles, heights[1]);
  parts_->cavity.mirror1.height = std::move(heights[0]);
  parts_->cavity.mirror2.height = std::move(heights[1]);
}

void CavityWaves::round_trip(Field& spectrum, Observer const& observer, Looks const& looks) const {
  if (!observer) return parts_->trip.travel(spectrum);
  Parts const& parts = *parts_;
  Watch watch{[&](std::size_t stop, Field const& arriving) {
                observer({int(parts.plane(stop)), parts.travel(stop), arriving});
              },
              {}};
  if (looks) watch.looks = [&](std::size_t stop) { return looks(int(parts.plane(stop)), parts.travel(stop)); };
  parts.trip.travel(spectrum, watch);
}

std::array<AxisShift, 2> axis_shifts(double curvature1, double curvature2, double length) {
  // Through both centres of curvature: c1 X(0) + X' and c2 X(L) - X' are the motions of the mirrors.
  double const g2 = 1 - curvature2 * length, determinant = -curvature1 * g2 - curvature2;
  return {{{-g2 / determinant, -curvature2 / determinant}, {-1 / determinant, curvature1 / determinant}}};
}

CavityAxis axis_of(WaveCavity const& c) {
  auto const shifts = axis_shifts(c.mirror1.curvature, c.mirror2.curvature, c.length);
  auto const at = [&](double z, double tilt1, double tilt2) {
    return shifts[0].at(z) * tilt1 + shifts[1].at(z) * tilt2;
  };
  return {at(0, c.mirror1.tilt_x, c.mirror2.tilt_x), at(0, c.mirror1.tilt_y, c.mirror2.tilt_y),
          at(c.length, c.mirror1.tilt_x, c.mirror2.tilt_x), at(c.length, c.mirror1.tilt_y, c.mirror2.tilt_y)};
}

Field CavityWaves::hermite_gauss(int n, int m) const {
  WaveCavity const& c = parts_->cavity;
  CavityAxis const axis = axis_of(c);
  double const w = cavity_mode(c.length, 1 / c.mirror1.curvature, 1 / c.mirror2.curvature, c.wavelength).w1;
  auto const along = [&](double at1, double at2) {
    return AxisBeam{w, -c.mirror1.curvature, at1, (at2 - at1) / c.length};
  };
  return parts_->trip.hermite_gauss(along(axis.x1, axis.x2), along(axis.y1, axis.y2), n, m);
}

WaveMode CavityWaves::mode(Field const& start, SolveOptions const& options) const {
  return parts_->trip.mode(start, options);
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
  TripLosses const losses = parts_->trip.losses(mode);
  for (std::size_t stop = 0; stop < losses.taken.size(); ++stop) {
    std::size_t const plane = parts_->plane(stop);
    double& entry = plane == 0                                        ? ledger.mirror1
                    : plane == n + 1                                  ? ledger.mirror2
                    : parts_->travel(stop) == Travel::towards_mirror2 ? ledger.towards_mirror2[plane - 1]
                                                                      : ledger.towards_mirror1[plane - 1];
    entry = losses.taken[stop];
  }
  ledger.beyond_band = losses.beyond_band;
  return ledger;
}

}  // namespace straytrace::wave
