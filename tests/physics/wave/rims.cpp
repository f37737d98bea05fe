// SPDX-License-Identifier: BSD-3-Clause
// Levers of rims (docs/theory/wave.md, eq. W.13, W.14 and W.22) against two spherical waves, eq. 8.11 to 8.13 of
// docs/theory/diffraction.md, moved openings and random fields: validation cases V5 and V7. The negative controls are
// waves without a gradient, another reference point and a spot radius taken for a standard deviation.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "base/math/rng.hpp"
#include "support/recorded.hpp"
#include "support/statistics.hpp"
#include "wave/arm/speckled_rim.hpp"
#include "wave/cavity_rims.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave_rims {
namespace {

using testing::deviation;
using wave::Complex;
using wave::RimLevers;
using wave::RimPoint;
using wave::SpeckledRim;
using wave::WaveAt;
using wave::WaveValue;

constexpr double nd_yag = 1.064e-6;  // m
constexpr double k = 2 * pi / nd_yag;
constexpr int many = 512;  // points along a rim

// Paraxial spherical wave from a point on the axis, 1/l at the distance l: mirrors that scatter 1/sr.
WaveAt spherical(double source) {
  return [=](Vec3 const& p) {
    double const l = std::fabs(p.z - source);
    Complex const u = std::polar(1 / l, k * (p.x * p.x + p.y * p.y) / (2 * l));
    return WaveValue{u, Complex{0, k * p.x / l} * u, Complex{0, k * p.y / l} * u};
  };
}

WaveAt without_gradient(WaveAt const& wave) {
  return [=](Vec3 const& p) { return WaveValue{wave(p).value, 0, 0}; };
}

// Two mirrors that face each other, unit overlap of the fields in the mode.
struct Pair {
  double length;
  WaveAt first, second;
  explicit Pair(double l) : length(l), first(spherical(0)), second(spherical(l)) {}
  RimLevers levers(std::vector<RimPoint> const& rim, Vec3 reference) const {
    return rim_levers(rim, first, second, nd_yag, 1, reference);
  }
  Pair blind() const {
    Pair pair = *this;
    pair.first = without_gradient(first);
    pair.second = without_gradient(second);
    return pair;
  }
  // Stray field of an infinite opening.
  Complex unobstructed() const { return 2.0 * Complex{0, nd_yag / length}; }
};

// A closed rim as a function of the azimuth, and its derivative.
struct Curve {
  std::function<Vec3(double)> place, slope;

  std::vector<RimPoint> points() const {
    std::vector<RimPoint> rim;
    for (int i = 0; i < many; ++i) {
      double const azimuth = 2 * pi * i / many;
      rim.push_back({place(azimuth), (2 * pi / many) * slope(azimuth)});
    }
    return rim;
  }
  Curve moved(Vec3 by) const {
    return {[=, p = place](double a) { return p(a) + by; }, slope};
  }
  Curve turned(Vec3 by, Vec3 about) const {  // to first order
    return {[=, p = place](double a) { return p(a) + cross(by, p(a) - about); },
            [=, s = slope](double a) { return s(a) + cross(by, s(a)); }};
  }
};

Curve circle(double radius, Vec3 centre) {
  return {[=](double a) {
            return centre + radius * Vec3{std::cos(a), std::sin(a), 0};
          },
          [=](double a) {
            return radius * Vec3{-std::sin(a), std::cos(a), 0};
          }};
}

// Tilted and bent like a saddle, by metres, and not round.
Curve bent() {
  return {[](double a) {
            return Vec3{0.004 + 0.05 * std::cos(a), -0.003 + 0.06 * std::sin(a),
                        400 + 10 * std::cos(a) + 7 * std::sin(2 * a)};
          },
          [](double a) {
            return Vec3{-0.05 * std::sin(a), 0.06 * std::cos(a), -10 * std::sin(a) + 14 * std::cos(2 * a)};
          }};
}

// s of an opening: the flux of eq. W.13 through the cone from its rim to an apex.
Complex through(Pair const& pair, Curve const& rim, Vec3 apex) {
  GaussPoints const along(160);
  Complex sum = 0;
  for (int i = 0; i < many; ++i) {
    Vec3 const edge = rim.place(2 * pi * i / many) - apex;
    Vec3 const area = (2 * pi / many) * cross(edge, rim.slope(2 * pi * i / many));
    for (std::size_t j = 0; j < along.at.size(); ++j) {
      Vec3 const p = apex + along.at[j] * edge;
      WaveValue const f = pair.first(p), b = pair.second(p);
      Complex const across_x = b.value * f.dx - f.value * b.dx, across_y = b.value * f.dy - f.value * b.dy;
      sum += along.weight[j] * along.at[j] *
             ((area.x * across_x + area.y * across_y) / Complex{0, 2 * k} + area.z * f.value * b.value);
    }
  }
  return 2.0 * sum;
}

double apart(Complex a, Complex b) { return std::abs(a - b) / std::abs(b); }

Vec3 axis(int i, double size) { return size * Vec3{i == 0 ? 1. : 0., i == 1 ? 1. : 0., i == 2 ? 1. : 0.}; }

// V5: twice eq. 8.11 to 8.13, for both directions are in eq. W.14.
TEST(RimLevers, TwoSphericalWavesGiveTheEdgeWaveV5) {
  double const a = 0.42, l1 = 4000, l2 = 6000, d = 1.3e-3, between = l1 * l2 / (l1 + l2);
  Pair const pair(l1 + l2);
  double const edge = 2 * nd_yag / (l1 + l2);
  Complex const s = through(pair, circle(a, {0, 0, l1}), {0, 0, l1}) - pair.unobstructed();
  EXPECT_LT(deviation(std::abs(s), 2.128e-10), 1e-9);
  EXPECT_LT(deviation(std::abs(s), edge), 1e-9);
  Complex const aside = through(pair, circle(a, {d, 0, l1}), {d, 0, l1}) - pair.unobstructed();
  EXPECT_LT(deviation(std::abs(aside), edge * std::cyl_bessel_j(0, k * a * d / between)), 1e-5);

  RimLevers const offset = pair.levers(wave::round_rim(a, {d, 0, l1}, many), {d, 0, l1});
  EXPECT_LT(deviation(std::abs(offset.displacement[0]), 1.168072e-7), 1e-6);
  EXPECT_LT(
      deviation(std::abs(offset.displacement[0]), edge * k * a / between * std::cyl_bessel_j(1, k * a * d / between)),
      1e-9);
  EXPECT_LT(std::abs(offset.displacement[1]), 1e-9 * std::abs(offset.displacement[0]));

  double const phase_per_metre = k * a * a / 2 * (1 / (l2 * l2) - 1 / (l1 * l1));  // eq. 8.13
  auto const centred = wave::round_rim(a, {0, 0, l1}, many);
  Complex const relative = pair.levers(centred, {0, 0, l1}).displacement[2] / s;
  EXPECT_LT(deviation(relative.imag(), -0.0180848), 1e-5);
  EXPECT_LT(deviation(relative.imag(), phase_per_metre), 1e-9);
  EXPECT_LT(std::fabs(relative.real()), 1e-9 * std::fabs(phase_per_metre));
  Complex const blind = pair.blind().levers(centred, {0, 0, l1}).displacement[2] / s;
  EXPECT_GT(deviation(blind.imag(), phase_per_metre), 0.9);  // F across the axis left out
}

// Eq. W.13: the flux through an opening depends on its rim alone.
TEST(RimLevers, FluxDoesNotDependOnTheSurface) {
  Pair const pair(1000);
  Complex const flat = through(pair, bent(), {0, 0, 400});
  EXPECT_LT(apart(through(pair, bent(), {0.01, -0.02, 425}), flat), 1e-9);
  EXPECT_GT(apart(through(pair.blind(), bent(), {0.01, -0.02, 425}), through(pair.blind(), bent(), {0, 0, 400})), 1e-4);
}

// Eq. W.14 for a bent rim, in all six coordinates, against the flux through the moved opening; complex, so that the
// signs count.
TEST(RimLevers, BentRimAgainstTheMovedOpening) {
  Pair const pair(1000);
  Curve const rim = bent();
  Vec3 const about{0.02, 0.01, 380}, apex{0, 0, 400};
  RimLevers const levers = pair.levers(rim.points(), about), blind = pair.blind().levers(rim.points(), about);
  for (int i = 0; i < 3; ++i) {
    double const move = i < 2 ? 2e-7 : 1e-3, turn = i < 2 ? 1e-8 : 1e-6;
    Complex const moved =
        (through(pair, rim.moved(axis(i, move)), apex) - through(pair, rim.moved(axis(i, -move)), apex)) / (2 * move);
    Complex const turned = (through(pair, rim.turned(axis(i, turn), about), apex) -
                            through(pair, rim.turned(axis(i, -turn), about), apex)) /
                           (2 * turn);
    EXPECT_LT(apart(levers.displacement[i], moved), 1e-5) << i;
    EXPECT_LT(apart(levers.rotation[i], turned), 1e-5) << i;
    EXPECT_GT(apart(blind.displacement[i], moved), 1e-4) << i;
    EXPECT_GT(apart(blind.rotation[i], turned), 1e-4) << i;
  }
}

TEST(RimLevers, RotationOfARoundRim) {
  Pair const pair(10000);
  Vec3 const centre{1.3e-3, -0.4e-3, 4000}, far{0.3, -0.7, 3900};
  auto const rim = wave::round_rim(0.42, centre, many);
  RimLevers const own = pair.levers(rim, centre), distant = pair.levers(rim, far);
  double const size = std::abs(own.displacement[0]);
  EXPECT_LT(std::abs(own.rotation[2]), 1e-12 * 0.42 * size);  // it turns into itself
  EXPECT_GT(std::abs(distant.rotation[2]), 0.1 * size);
  Vec3 const arm = centre - far;
  auto const& t = own.displacement;
  Complex const carried[3] = {arm.y * t[2] - arm.z * t[1], arm.z * t[0] - arm.x * t[2], arm.x * t[1] - arm.y * t[0]};
  for (int i = 0; i < 3; ++i) EXPECT_LT(apart(distant.rotation[i] - own.rotation[i], carried[i]), 1e-9) << i;
}

TEST(RimLevers, NoOverlapIsAnError) {
  Pair const pair(1000);
  EXPECT_THROW(rim_levers(circle(0.05, {0, 0, 400}).points(), pair.first, pair.second, nd_yag, 0, {}), NumericalError);
}

// exp(-kappa) I_n(kappa) by its integral over the azimuth.
double bessel_by_integral(int n, double kappa) {
  double sum = 0;
  int const points = 20000;
  for (int i = 0; i < points; ++i) {
    double const half = std::sin(pi * i / points);
    sum += std::exp(-2 * kappa * half * half) * std::cos(2 * pi * n * i / points) / points;
  }
  return sum;
}

// Two distances, equal spots, 1/sr; the radius gives kappa.
SpeckledRim speckled(double kappa) {
  SpeckledRim rim{nd_yag, 1, 4000, 6000, 0.12, 0.10, 1, 1};
  rim.radius = std::sqrt(kappa / rim.kappa());
  return rim;
}

struct ScaledBessels {
  double zero, one;
  explicit ScaledBessels(SpeckledRim const& rim) {
    wave::SpeckleMeans const means = speckle_means(rim);
    double const l1 = rim.distance1, l2 = rim.distance2, betas = rim.brdf1 * rim.brdf2;
    zero = means.field / (betas * std::pow(2 * rim.wavelength / (l1 + l2), 2));
    one = means.transverse * std::pow(l1 * l2, 2) / (8 * std::pow(pi * rim.radius, 2) * betas);
  }
};

// V7: numbers of eq. W.22.
TEST(SpeckledRim, NumbersV7) {
  ScaledBessels const small(speckled(222.1));
  EXPECT_LT(deviation(small.zero, 2.6782e-2), 1e-4);
  EXPECT_LT(deviation(small.one / 2, 1.3361e-2), 1e-4);

  double const beta = 3.2145e-9 * std::pow(0.42 / 5000, -2.3986);  // the mirrors of ET-HF
  SpeckledRim rim{nd_yag, 0.42, 5000, 5000, 0.120467, 0.120467, beta, beta};
  EXPECT_LT(deviation(rim.kappa(), 1785.4), 1e-4);
  EXPECT_LT(deviation(ScaledBessels(rim).zero, 9.4421e-3), 1e-4);
  EXPECT_LT(deviation(std::sqrt(speckle_means(rim).transverse), 2.7837e-7), 1e-4);
  rim.spot1 = rim.spot2 = 2 * 0.120467;  // the radius taken for a standard deviation
  EXPECT_GT(deviation(std::sqrt(speckle_means(rim).transverse), 2.7837e-7), 0.2);
}

TEST(SpeckledRim, EveryKappa) {
  for (double const kappa : {1e-3, 1., 49.9, 50.1, 1785.4, 1e5}) {
    ScaledBessels const found(speckled(kappa));
    EXPECT_LT(deviation(found.zero, bessel_by_integral(0, kappa)), 1e-9) << kappa;
    EXPECT_LT(deviation(found.one, bessel_by_integral(1, kappa)), 1e-9) << kappa;
  }
  EXPECT_LT(deviation(ScaledBessels(speckled(1e9)).zero, 1 / std::sqrt(2 * pi * 1e9)), 1e-6);
  SpeckledRim smooth = speckled(1);
  smooth.spot1 = smooth.spot2 = 0;  // eq. 8.11, twice
  EXPECT_LT(deviation(std::sqrt(speckle_means(smooth).field), 2 * nd_yag / 10000), 1e-9);
}

// A spherical wave times the speckle of a Gaussian spot, with the mean irradiance 1/l^2.
WaveAt speckle(double source, double spot, Rng& random) {
  constexpr int scatterers = 12;
  struct Scatterer {
    double x, y, phase;
  };
  std::vector<Scatterer> all;
  for (int i = 0; i < scatterers; ++i) {
    double const r = spot / 2 * std::sqrt(-2 * std::log(random.uniform())), at = 2 * pi * random.uniform();
    all.push_back({r * std::cos(at), r * std::sin(at), 2 * pi * random.uniform()});
  }
  return [=](Vec3 const& p) {
    double const l = std::fabs(p.z - source);
    WaveValue sum{};
    for (Scatterer const& s : all) {
      double const x = p.x / 2 - s.x, y = p.y / 2 - s.y;
      Complex const u = std::polar(1 / (l * std::sqrt(double(scatterers))), s.phase + k / l * (x * p.x + y * p.y));
      sum.value += u;
      sum.dx += Complex{0, k * (p.x - s.x) / l} * u;
      sum.dy += Complex{0, k * (p.y - s.y) / l} * u;
    }
    return sum;
  };
}

// V7: eq. W.22 against random fields.
TEST(SpeckledRim, RandomFieldsV7) {
  SpeckledRim const setting = speckled(222.1);
  wave::SpeckleMeans const expected = speckle_means(setting);
  double const l1 = setting.distance1, l2 = setting.distance2;
  auto const rim = wave::round_rim(setting.radius, {0, 0, l1}, 256);
  testing::Sampler field, transverse, longitudinal;
  for (std::uint64_t draw = 0; draw < 3000; ++draw) {
    Rng random(7, draw, 0, Stream::source);
    WaveAt const first = speckle(0, setting.spot1, random), second = speckle(l1 + l2, setting.spot2, random);
    RimLevers const levers = rim_levers(rim, first, second, nd_yag, 1, {0, 0, l1});
    for (int i = 0; i < 2; ++i) transverse.add(std::norm(levers.displacement[i]) / expected.transverse);
    longitudinal.add(std::norm(levers.displacement[2]) / expected.longitudinal);
    Complex sum = 0;  // the wave from the edge, which is twice eq. 8.11 without speckle
    for (RimPoint const& p : rim) sum += first(p.place).value * second(p.place).value / double(rim.size());
    field.add(std::norm(2 * nd_yag * l1 * l2 / (l1 + l2) * sum) / expected.field);
  }
  testing::expect_mean("field", field.mean(), 1, 0.22);
  testing::expect_mean("transverse", transverse.mean(), 1, 0.15);
  testing::expect_mean("longitudinal", longitudinal.mean(), 1, 0.22);

  SpeckledRim wide = setting;  // the radii of the spots taken for standard deviations
  wide.spot1 *= 2;
  wide.spot2 *= 2;
  testing::expect_rejected("transverse", transverse.mean(), speckle_means(wide).transverse / expected.transverse);
  // The longitudinal lever of smooth waves, lowered like their field, lacks the slopes of speckle.
  double const smooth = 4 * std::pow(pi * setting.radius, 2) / std::pow(l1 * l2, 2) *
                        std::pow(setting.radius * (1 / l1 - 1 / l2), 2) * ScaledBessels(setting).zero;
  testing::expect_rejected("longitudinal", longitudinal.mean(), smooth / expected.longitudinal);
}

WaveAt sum_of(WaveAt const& a, WaveAt const& b, double share) {
  return [=](Vec3 const& p) {
    WaveValue const u = a(p), v = b(p);
    double const size = std::sqrt(share);
    return WaveValue{u.value + size * v.value, u.dx + size * v.dx, u.dy + size * v.dy};
  };
}

// The same wave on the rim.
wave::RingField even_wave(SpeckledRim const& rim, double l, double share) {
  Complex const u = std::polar(std::sqrt(share) / l, k * rim.radius * rim.radius / (2 * l));
  return {{u}, {Complex{0, k * rim.radius / l} * u}};
}

// eq. W.22 with a coherent wave from each mirror beside its speckle.
TEST(SpeckledRim, RandomFieldsBesideSmoothWaves) {
  SpeckledRim setting = speckled(222.1);
  constexpr double share1 = 0.3, share2 = 0.2;
  setting.edge1 = even_wave(setting, setting.distance1, share1);
  setting.edge2 = even_wave(setting, setting.distance2, share2);
  wave::SpeckleMeans const expected = speckle_means(setting);
  double const l1 = setting.distance1, l = l1 + setting.distance2;
  auto const rim = wave::round_rim(setting.radius, {0, 0, l1}, 256);
  testing::Sampler transverse, longitudinal;
  for (std::uint64_t draw = 0; draw < 1500; ++draw) {
    Rng random(8, draw, 0, Stream::source);
    WaveAt const first = sum_of(speckle(0, setting.spot1, random), spherical(0), share1),
                 second = sum_of(speckle(l, setting.spot2, random), spherical(l), share2);
    RimLevers const levers = rim_levers(rim, first, second, nd_yag, 1, {0, 0, l1});
    for (int i = 0; i < 2; ++i) transverse.add(std::norm(levers.displacement[i]) / expected.transverse);
    longitudinal.add(std::norm(levers.displacement[2]) / expected.longitudinal);
  }
  testing::expect_mean("transverse", transverse.mean(), 1, 0.22);
  testing::expect_mean("longitudinal", longitudinal.mean(), 1, 0.3);
  testing::expect_rejected("transverse", transverse.mean(),
                           speckle_means(speckled(222.1)).transverse / expected.transverse);
}

// A field on a mirror with the harmonic m, its derivative, and the light it sends to a rim by the Kirchhoff integral
// (-i)^(m+1) k/l exp(ik a^2/2l) of J_m(k r a/l) exp(ik r^2/2l) field r dr.
struct OnMirror {
  int m;
  double outline, curvature, width;  // m, 1/m, m
  Complex at(double r) const {
    return std::pow(r / outline, m) * std::exp(-r * r / (width * width)) * std::polar(1.0, -k * r * r * curvature / 2);
  }
  wave::RingField leaving() const {
    wave::RingField field{std::vector<Complex>(2 * m + 1), std::vector<Complex>(2 * m + 1)};
    field.value.back() = at(outline);
    field.slope.back() =
        field.value.back() * Complex{m / outline - 2 * outline / (width * width), -k * outline * curvature};
    return field;
  }
  Complex sent(double a, double l) const {
    constexpr int steps = 6000;
    Complex sum = 0;
    for (int j = 0; j < steps; ++j) {
      double const r = outline * (j + 0.5) / steps;
      sum += at(r) * std::cyl_bessel_j(m, k * r * a / l) * r * outline / double(steps) *
             std::polar(1.0, k * r * r / (2 * l));
    }
    return k / l * sum;
  }
};

// eq. W.28, with its fringes and its derivative by the radius of the rim: of the clipped mode of ET-HF, and of light
// that the other mirror scatters onto the outline. The control has the wavefront of the mode bent the other way.
TEST(SpeckledRim, WaveFromTheOutlineOfAMirror) {
  double const spot = 0.1205, outline = 0.31, roc = 5070, step = 1e-6;
  for (double const l : {2000., 4250., 6500.})
    for (OnMirror const& light : {OnMirror{0, outline, 1 / roc, spot}, OnMirror{3, outline, 2 / roc - 1e-4, 1.}}) {
      double const a = 0.42;
      wave::RingField const edge = wave::diffracted(light.leaving(), outline, nd_yag, a, l);
      double const exact = std::norm(light.sent(a, l));
      EXPECT_LT(deviation(edge.irradiance(), exact), 0.05) << l << ' ' << light.m;
      double const slope = (std::norm(light.sent(a + step, l)) - std::norm(light.sent(a - step, l))) / (2 * step);
      Complex const value = edge.at(light.m), change = edge.slope_at(light.m);
      EXPECT_LT(std::fabs(2 * std::real(change * std::conj(value)) - slope), 0.03 * k * outline / l * exact) << l;
      OnMirror wrong = light;
      wrong.curvature *= -1;
      EXPECT_GT(deviation(wave::diffracted(wrong.leaving(), outline, nd_yag, a, l).irradiance(), exact), 0.1) << l;
    }
}

// Eq. W.30: the pattern of Fresnel behind a straight edge has 1/4 of the irradiance in the line of the edge, its
// largest maximum 1.3704 at v = 1.2172 and the minimum 0.7783 after it at 1.8725 (Born and Wolf, 8.7.3). The light goes
// from 0.1 m off the axis of the mirror to the rim; the control takes it from the axis.
TEST(SpeckledRim, LightPassesOtherEdges) {
  double const a = 0.4, l = 2000, d = 1000, off = 0.1, per_metre = std::sqrt(2 * l / (nd_yag * d * (l - d)));
  auto const behind = [&](double v, double from) {
    return std::norm(wave::passed({{d, (a + off) / 2 + v / per_metre}}, nd_yag, from, a, l));
  };
  EXPECT_LT(deviation(behind(0, off), 0.25), 1e-9);
  EXPECT_LT(deviation(behind(1.2172, off), 1.3704), 5e-3);
  EXPECT_LT(deviation(behind(1.8725, off), 0.7783), 5e-3);
  EXPECT_GT(deviation(behind(1.2172, 0), 1.3704), 0.1);
  EXPECT_LT(behind(-3, off), 0.01);
  EXPECT_EQ(wave::passed({}, nd_yag, off, a, l), Complex(1));
  // A wide spot averages the pattern to its irradiance far from the shadow.
  EXPECT_LT(deviation(wave::share_passed({{d, 0.28}}, nd_yag, 0.1, a, l), 1), 0.05);
  EXPECT_LT(deviation(wave::share_passed({{d, 0.2}}, nd_yag, 1e-6, a, l), 0.25), 1e-4);
}

// A field of plane waves on a grid that they repeat on.
struct PlaneWaves {
  static constexpr wave::Grid grid{64, 0.64};
  wave::Field field{grid};

  // exp(2 pi i (n x + m y)/W) times `strength`
  void add(int n, int m, Complex strength) {
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column)
        field(row, column) += strength * wave::turned((n * grid.at(column) + m * grid.at(row)) / grid.window);
  }
};

// Eq. W.63 by the expansion of Jacobi and Anger: a plane wave along x has the harmonics i^m J_m(qa) about any centre,
// up to the phase there, and the derivatives i^m q J_m'(qa). The control is the wave along y.
TEST(SpeckledRim, PlaneWaveByHarmonics) {
  constexpr int n = 9, most = 24;
  double const a = 0.1, q = 2 * pi * n / PlaneWaves::grid.window;
  Vec3 const centre{0.013, -0.02, 0};
  PlaneWaves along, across;
  along.add(n, 0, 1);
  across.add(0, n, 1);
  wave::RingField const ring = wave::field_on_ring(wave::Sampler(along.field), centre, a, most),
                        turned = wave::field_on_ring(wave::Sampler(across.field), centre, a, most);
  EXPECT_LT(deviation(ring.irradiance(), 1), 1e-9);
  double difference = 0;
  for (int m = -most; m <= most; ++m) {
    auto const bessel = [&](int order) {
      return (order < 0 && order % 2 ? -1 : 1) * std::cyl_bessel_j(double(std::abs(order)), q * a);
    };
    Complex const phase = std::polar(1.0, q * centre.x) * std::pow(Complex{0, 1}, m);
    EXPECT_LT(std::abs(ring.at(m) - phase * bessel(m)), 1e-8) << m;
    EXPECT_LT(std::abs(ring.slope_at(m) - phase * q * 0.5 * (bessel(m - 1) - bessel(m + 1))), 1e-6 * q) << m;
    difference = std::fmax(difference, std::abs(turned.at(m) - phase * bessel(m)));
  }
  EXPECT_GT(difference, 0.1);
}

// eq. W.29 of two lights that a grid holds is the mean of eq. W.14 over the turns of one of them. The control has all
// light in the harmonic 0.
TEST(SpeckledRim, KnownLightsAgainstTheMeanOverRolls) {
  constexpr int most = 44, rolls = 2 * most + 2, waves = 12;
  double const a = 0.1, l1 = 400, l2 = 600;
  PlaneWaves first, second;
  Rng random(3, 0, 0, Stream::source);
  for (int i = 0; i < waves; ++i)
    for (PlaneWaves* const light : {&first, &second}) {
      int const n = int(21 * random.uniform()) - 10, m = int(21 * random.uniform()) - 10;
      light->add(n, m, std::polar(random.uniform(), 2 * pi * random.uniform()));
    }
  wave::Sampler const one(first.field), two(second.field);
  SpeckledRim rim{nd_yag, a, l1, l2, 0.02, 0.02, 0, 0};
  rim.edge1 = wave::field_on_ring(one, {}, a, most);
  rim.edge2 = wave::field_on_ring(two, {}, a, most);
  wave::SpeckleMeans const expected = speckle_means(rim);
  double transverse = 0, longitudinal = 0;
  for (int roll = 0; roll < rolls; ++roll) {
    double const c = std::cos(2 * pi * roll / rolls), s = std::sin(2 * pi * roll / rolls);
    WaveAt const turned = [&](Vec3 const& p) {
      WaveValue const v = two.at(c * p.x + s * p.y, c * p.y - s * p.x);
      return WaveValue{v.value, c * v.dx - s * v.dy, s * v.dx + c * v.dy};
    };
    RimLevers const levers =
        rim_levers(wave::round_rim(a, {}, 256), [&](Vec3 const& p) { return one.at(p.x, p.y); }, turned, nd_yag, 1, {});
    transverse += (std::norm(levers.displacement[0]) + std::norm(levers.displacement[1])) / (2 * rolls);
    longitudinal += std::norm(levers.displacement[2]) / rolls;
  }
  EXPECT_LT(deviation(expected.transverse, transverse), 1e-6);
  EXPECT_LT(deviation(expected.longitudinal, longitudinal), 1e-6);
  rim.edge2 = {{std::sqrt(rim.edge2.irradiance())}, {0}};
  EXPECT_GT(deviation(speckle_means(rim).transverse, transverse), 0.1);
}

}  // namespace
}  // namespace straytrace::wave_rims
