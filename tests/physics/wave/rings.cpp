// SPDX-License-Identifier: BSD-3-Clause
// Fields of ring and folded cavities by Fourier propagation (docs/theory/wave.md, eq. W.24, W.53 to W.55), against the
// Hankel transform (eq. W.10) of the equivalent cavity of two mirrors, against ray matrices (docs/theory/beams.md), and
// on grids that follow the beam against grids of constant pitch.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/eigenmode.hpp"
#include "support/recorded.hpp"
#include "wave/round_trip.hpp"

namespace straytrace::wave_rings {
namespace {

using testing::deviation;
using wave::Complex;

constexpr double nd_yag = 1.064e-6;  // m

TripStop mirror_stop(double leg, double curvature, RoundHole outline) {
  return {leg, outline, WaveMirror{curvature, outline, 0, 0, {}, 0}};
}
// Phase over that of another mode, in turns: -0.5 to 0.5.
double turns(WaveMode const& mode, WaveMode const& other) {
  return std::arg(mode.eigenvalue / other.eigenvalue) / (2 * pi);
}
double wrapped(double t) { return t - std::round(t); }
double overlap(Field const& a, Field const& b) {  // power shared, of fields of any size
  Complex sum = 0;
  double one = 0, two = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    sum += std::conj(a.values[i]) * b.values[i];
    one += std::norm(a.values[i]);
    two += std::norm(b.values[i]);
  }
  return std::norm(sum) / (one * two);
}
SolveOptions exact() {
  SolveOptions options;
  options.loss_error = 1e-7;
  return options;
}

// One curved mirror of 50 mm, 1 km around, and two flat ones so near to it that their rims take no light that comes
// back. Along each axis a passage is half a round trip between two such mirrors 1 km apart, whose losses are those of
// case V2.
Trip kilometre_ring() {
  Trip trip{nd_yag, {500, 0.48}, {}, true};
  trip.stops = {mirror_stop(20, 1 / 2500., {0.05}), mirror_stop(20, 0, {0.08}), mirror_stop(960, 0, {0.08})};
  return trip;
}
// The mode of that ring behind its last mirror, 480 m behind its waist.
AxisBeam kilometre_start() {
  double const rayleigh = std::sqrt(500.0 * (2500 - 500)), z = 480;
  return {std::sqrt(nd_yag * rayleigh / pi) * std::hypot(1, z / rayleigh), z / (z * z + rayleigh * rayleigh)};
}

TEST(WaveRings, OneApertureLosesHalfOfTwo) {
  RoundTrip const ring(kilometre_ring());
  auto const half = [](double both) { return 1 - std::sqrt(1 - both); };
  auto const mode = [&](int n, int m) {
    return ring.mode(ring.hermite_gauss(kilometre_start(), kilometre_start(), n, m), exact());
  };
  WaveMode const fundamental = mode(0, 0), along = mode(1, 0), across = mode(0, 1);
  EXPECT_LT(deviation(fundamental.loss(), half(38.3338e-6)), 2e-4);
  EXPECT_LT(deviation(along.loss(), half(493.301e-6)), 2e-4);
  EXPECT_GT(deviation(fundamental.loss(), 38.3338e-6), 0.4);  // two mirrors with rims
  // Per passage, orders lag by 2 arctan(L/2 z_R); along x the odd number of mirrors changes the sign.
  double const gouy = 2 * std::atan(500 / 1000.0) / (2 * pi);
  EXPECT_NEAR(turns(across, fundamental), -gouy, 1e-5);
  EXPECT_NEAR(turns(along, fundamental), 0.5 - gouy, 1e-5);
}

TEST(WaveRings, WithoutTheFlipOddOrdersAlongThePlaneAreInPhase) {
  Trip trip = kilometre_ring();
  trip.mirrored = false;
  RoundTrip const ring(trip);
  AxisBeam const start = kilometre_start();
  WaveMode const fundamental = ring.mode(ring.hermite_gauss(start, start)),
                 along = ring.mode(ring.hermite_gauss(start, start, 1, 0));
  EXPECT_NEAR(turns(along, fundamental), -std::atan(0.5) / pi, 1e-4);
}

TEST(WaveRings, LedgerOfSurfacesClosesW24) {
  Trip trip = kilometre_ring();
  trip.stops.insert(trip.stops.begin() + 2, {200, {0.045, 4e-3, -2e-3}, {}});
  trip.stops[3].leg = 760;
  trip.stops[1].mirror->scattered = 20e-6;
  RoundTrip const ring(trip);
  SolveOptions options = exact();
  options.loss_error = 1e-9;
  WaveMode const mode = ring.mode(ring.hermite_gauss(kilometre_start(), kilometre_start()), options);
  TripLosses const losses = ring.losses(mode);
  ASSERT_EQ(losses.taken.size(), 4u);
  EXPECT_LT(deviation(losses.total(), mode.loss()), 1e-8);
  EXPECT_GT(losses.taken[1], 19.9e-6);
  EXPECT_LT(losses.taken[1], 21e-6);
  EXPECT_GT(losses.taken[0], 1e-6);
  EXPECT_GT(losses.taken[2], 1e-6);
  EXPECT_GT(deviation(losses.total() - losses.taken[2], mode.loss()), 1e-2);
}

// A flat fold mirror at 45 degrees leaves the cavity of two mirrors as it is.
TEST(WaveRings, FoldedCavityIsThatOfTwoMirrors) {
  double const tilted = std::sqrt(0.5);
  Trip trip{nd_yag, {384, 0.45}, {}, false};
  trip.stops = {mirror_stop(400, 0, {0.12, 0, 0, tilted}), mirror_stop(600, 1 / 2500., {0.05}),
                mirror_stop(600, 0, {0.12, 0, 0, tilted}), mirror_stop(400, 1 / 2500., {0.05})};
  RoundTrip const folded(trip);
  AxisBeam const start{std::sqrt(nd_yag * 1000 / (pi * 0.8)), -1 / 2500.};
  WaveMode const mode = folded.mode(folded.hermite_gauss(start, start));
  EXPECT_LT(deviation(mode.loss(), 38.3338e-6), 2e-4);
  trip.stops[0].opening.cosine = trip.stops[2].opening.cosine = 0.4;  // narrower than the beam's own opening
  trip.stops[0].mirror->outline = trip.stops[2].mirror->outline = trip.stops[0].opening;
  RoundTrip const narrow(trip);
  EXPECT_GT(deviation(narrow.mode(narrow.hermite_gauss(start, start)).loss(), 38.3338e-6), 0.01);
}

// An elliptic opening of a beam that is as elliptic passes 1 - exp(-2 a^2/w^2).
TEST(WaveRings, ObliqueOutlineIsAnEllipse) {
  Grid const grid{256, 0.06};
  Transform const transform(grid.points);
  double const cosine = 0.6, a = 6e-3, w = 4e-3;
  auto const clipped = [&](RoundHole const& hole) {
    Mask const mask(hole, grid, transform);
    Field field(grid);
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column) {
        double const x = (grid.at(column) - 1e-3) / (cosine * w), y = (grid.at(row) + 2e-3) / w;
        field(row, column) = std::sqrt(2 / (pi * cosine)) / w * std::exp(-x * x - y * y);
      }
    return mask.clipped(field) * grid.pitch() * grid.pitch();
  };
  EXPECT_LT(deviation(clipped({a, 1e-3, -2e-3, cosine}), std::exp(-2 * a * a / (w * w))), 1e-6);
  EXPECT_GT(deviation(clipped({a, 1e-3, -2e-3, 1}), std::exp(-2 * a * a / (w * w))), 0.1);
}

// A triangle with one curved mirror at 30 degrees, whose mode has two radii and two Gouy phases.
struct Triangle {
  std::vector<SphericalMirror> mirrors;
  ClosedCavity axis;
  double legs[3] = {};

  Triangle() {
    Vec3 const points[] = {{-2, 0, 0}, {2, 0, 0}, {0, 0, 2 * std::sqrt(3.0)}};
    double const roc[] = {infinity, infinity, 20};
    for (int i = 0; i < 3; ++i) {
      Vec3 const back = points[(i + 2) % 3] - points[i], on = points[(i + 1) % 3] - points[i];
      mirrors.push_back({points[i], unit(unit(back) + unit(on)), 1 / roc[i]});
      legs[(i + 1) % 3] = length(on);
    }
    axis = closed_cavity(mirrors, nd_yag);
  }
  Trip trip(double cosine, int points = 128) const {
    Trip trip{nd_yag, {points, 0.024}, {}, true};
    for (int i : {1, 2, 0})
      trip.stops.push_back(mirror_stop(legs[i], mirrors[std::size_t(i)].curvature, {8e-3, 0, 0, cosine}));
    return trip;
  }
  std::array<AxisBeam, 2> start() const {
    std::array<AxisBeam, 2> beams;
    for (std::size_t i : {0, 1}) {
      Complex const q = curvature_along(axis.start, i == 0 ? axis.start.e1 : axis.start.e2);
      beams[i] = {std::sqrt(nd_yag / (pi * q.imag())), q.real()};
    }
    return beams;
  }
};

TEST(WaveRings, AstigmaticModeIsThatOfTheRayMatrix) {
  Triangle const triangle;
  auto const [x, y] = triangle.start();
  ASSERT_GT(deviation(x.radius, y.radius), 0.01);
  RoundTrip const ring(triangle.trip(std::cos(pi / 6)));
  Field const pure = ring.hermite_gauss(x, y);
  WaveMode const mode = ring.mode(pure, exact());
  EXPECT_GT(overlap(pure, mode.spectrum), 1 - 1e-6);
  EXPECT_NEAR(turns(ring.mode(ring.hermite_gauss(x, y, 1, 0), exact()), mode),
              wrapped(-triangle.axis.gouy[0] / (2 * pi)), 1e-6);
  EXPECT_NEAR(turns(ring.mode(ring.hermite_gauss(x, y, 0, 1), exact()), mode),
              wrapped(-triangle.axis.gouy[1] / (2 * pi)), 1e-6);
  // At normal incidence both axes would be alike.
  RoundTrip const normal(triangle.trip(1));
  WaveMode const round = normal.mode(normal.hermite_gauss(x, y), exact());
  EXPECT_LT(overlap(pure, round.spectrum), 1 - 1e-4);
  EXPECT_GT(std::fabs(turns(normal.mode(normal.hermite_gauss(x, y, 0, 1), exact()), round) -
                      wrapped(-triangle.axis.gouy[1] / (2 * pi))),
            1e-3);
}

// eq. W.54: a beam of 6 mm, clipped by an opening, shrinks to a third and widens again onto a lens. The grid follows
// it, or not.
Trip telescope(double scale, double opening, double focal_length = 20) {
  Trip trip{nd_yag, {512, 0.2}, {}, false};
  trip.stops = {{1e-3, {opening}, {}}, {30, {10e-3}, {}, scale}, mirror_stop(30, 1 / (2 * focal_length), {0.02})};
  return trip;
}

TEST(WaveRings, GridThatFollowsTheBeamIsTheSameW26) {
  AxisBeam const beam{6e-3, -1 / 40.0};
  auto const behind = [&](RoundTrip const& way) {
    Field field = way.hermite_gauss(beam, beam);
    way.travel(field);
    return field;
  };
  auto const power = [](Field const& field) {
    double sum = 0;
    for (Complex const z : field.values) sum += std::norm(z);
    return sum;
  };
  for (double const opening : {0.03, 0.012}) {  // the narrower one clips 3e-4
    Field const plain = behind(RoundTrip(telescope(1, opening))),
                following = behind(RoundTrip(telescope(0.25, opening)));
    EXPECT_LT(deviation(power(following), power(plain)), 1e-6);
    EXPECT_GT(overlap(plain, following), 1 - 1e-6);
    EXPECT_LT(overlap(plain, behind(RoundTrip(telescope(0.25, opening, 20.5)))), 1 - 1e-5);  // another lens
  }
}

// A cavity whose mode is eight times as wide on one mirror as on the other (eq. W.10 for the reference).
TEST(WaveRings, CavityOnAGridThatFollowsTheBeam) {
  double const length = 100, rayleigh = length / std::sqrt(63.0), roc = length + rayleigh * rayleigh / length;
  double const waist = std::sqrt(nd_yag * rayleigh / pi), wide = 8 * waist;
  RoundHole const small{6 * waist}, large{2.2 * wide};
  Trip trip{nd_yag, {256, 26 * waist}, {}, false};
  trip.stops = {mirror_stop(length, 1 / roc, large), mirror_stop(length, 0, small)};
  trip.stops[0].scale = 8;
  RoundTrip const ring(trip);
  WaveMode const mode = ring.mode(ring.hermite_gauss({waist, 0}, {waist, 0}), exact());
  RoundCavity const reference{nd_yag, 0, 1 / roc, {{0, small.radius}, {length, large.radius}}};
  EXPECT_LT(deviation(mode.loss(), round_modes(reference, 0, 1).front().loss()), 1e-3);
  trip.stops[0].scale = 1;  // the window is narrower than the far mirror
  EXPECT_ANY_THROW(RoundTrip{trip});
}

}  // namespace
}  // namespace straytrace::wave_rings
