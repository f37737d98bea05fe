// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/speckled_rim.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/bessel.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/gauss_points.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/cavity_rims.hpp"

namespace straytrace::wave {
namespace {

constexpr int most_harmonic = 24;

double patches(SpeckledRim const& rim, double spot, double distance) {
  return std::pow(pi * rim.radius * spot / (rim.wavelength * distance), 2);
}

// The light of one mirror at the rim by harmonics: <|f|^2>, <f' f*> and <|f'|^2> of the field f and its derivative f'
// along the radius, with 0 beyond the harmonics held.
class EdgeLight {
 public:
  explicit EdgeLight(RingField const& wave) : most_(wave.most()) {
    for (int m = -most_; m <= most_; ++m) {
      Complex const f = wave.at(m), slope = wave.slope_at(m);
      add(std::norm(f), slope * std::conj(f), std::norm(slope));
    }
  }
  // Speckle of a Gaussian spot, exp(ik a^2/2l) times a random field x with <x(a) x*(a')> = power
  // exp(-s (a^2 + a'^2)/2) I_m(s a a'), s = kappa/a^2.
  EdgeLight(int most, double power, double kappa, double radius, double bend) : most_(most) {
    std::vector<double> const bessel = scaled_bessels(most + 2, kappa);
    auto const order = [&](int m) { return bessel[std::size_t(std::abs(m))]; };
    double const s = kappa / (radius * radius), sa = kappa / radius;
    Complex const turn{0, bend};  // of the spherical wave
    for (int m = -most; m <= most; ++m) {
      double const i0 = order(m), i1 = (order(m - 1) + order(m + 1)) / 2,
                   i2 = (order(m - 2) + 2 * i0 + order(m + 2)) / 4;
      double const even = power * i0, mixed = power * sa * (i1 - i0),
                   slopes = power * (sa * sa * (i0 - 2 * i1 + i2) + s * i1);
      add(even, mixed + turn * even, slopes + bend * bend * even);
    }
  }
  double value(int m) const { return held(m) ? value_[place(m)] : 0; }
  Complex mixed(int m) const { return held(m) ? mixed_[place(m)] : 0; }
  double slope(int m) const { return held(m) ? slope_[place(m)] : 0; }
  int most() const { return most_; }

 private:
  bool held(int m) const { return std::abs(m) <= most_; }
  std::size_t place(int m) const { return std::size_t(m + most_); }
  void add(double value, Complex mixed, double slope) {
    value_.push_back(value);
    mixed_.push_back(mixed);
    slope_.push_back(slope);
  }

  int most_;
  std::vector<double> value_, slope_;
  std::vector<Complex> mixed_;
};

// Products of harmonics of two lights. Harmonics m and -m make s and A_z, m and +-1 - m make A_x.
struct Products {
  double field = 0, transverse = 0, longitudinal = 0;
};
Products products(EdgeLight const& f, EdgeLight const& b) {
  Products sum;
  for (int m = -f.most(); m <= f.most(); ++m) {
    sum.field += f.value(m) * b.value(-m);
    sum.transverse += f.value(m) * (b.value(1 - m) + b.value(-1 - m));
    sum.longitudinal +=
        f.slope(m) * b.value(-m) + f.value(m) * b.slope(-m) - 2 * std::real(f.mixed(m) * std::conj(b.mixed(-m)));
  }
  return sum;
}

// Of the speckle of both mirrors, over all harmonics.
Products of_speckle(SpeckledRim const& rim) {
  double const k = 2 * pi / rim.wavelength, a = rim.radius, l1 = rim.distance1, l2 = rim.distance2;
  double const x = rim.kappa(), i0 = scaled_bessel(0, x), i1 = scaled_bessel(1, x);
  double const power = rim.brdf1 * rim.brdf2 / std::pow(l1 * l2, 2);
  // Differences of the slopes of both fields across the rim: of their wavefronts, and of speckle about them.
  double const wavefronts = std::pow(a / l1 - a / l2, 2);
  double const unequal = k * k * (std::pow(rim.spot1 / (2 * l1), 2) - std::pow(rim.spot2 / (2 * l2), 2));
  double const bend = x > 0 ? 2 * (i0 - i1) - i1 / x : 0;
  double const slopes = k * k * wavefronts * i0 + x * i1 / (a * a) + std::pow(a * unequal, 2) * bend;
  return {power * i0, 2 * power * i1, power * slopes};
}

EdgeLight speckle_of(SpeckledRim const& rim, bool first, int most) {
  double const l = first ? rim.distance1 : rim.distance2;
  return {most, (first ? rim.brdf1 : rim.brdf2) / (l * l), patches(rim, first ? rim.spot1 : rim.spot2, l), rim.radius,
          2 * pi * rim.radius / (rim.wavelength * l)};
}

}  // namespace

double SpeckledRim::kappa() const { return patches(*this, spot1, distance1) + patches(*this, spot2, distance2); }

double RingField::irradiance() const {
  double sum = 0;
  for (Complex const f : value) sum += std::norm(f);
  return sum;
}

namespace {

// From more than 2 `most` values at equal steps of the azimuth.
RingField harmonics(std::vector<Complex> const& values, std::vector<Complex> const& slopes, int most) {
  std::size_t const count = values.size();
  std::vector<Complex> turns;
  for (std::size_t i = 0; i < count; ++i) turns.push_back(turned(-double(i) / double(count)) / double(count));
  RingField field;
  for (int m = -most; m <= most; ++m) {
    Complex value = 0, slope = 0;
    std::size_t const step = std::size_t(m + int(count)) % count;
    for (std::size_t i = 0, turn = 0; i < count; ++i, turn = (turn + step) % count) {
      value += turns[turn] * values[i];
      slope += turns[turn] * slopes[i];
    }
    field.value.push_back(value);
    field.slope.push_back(slope);
  }
  return field;
}

}  // namespace

RingField field_on_ring(Sampler const& field, Vec3 centre, double radius, int most) {
  int const count = 2 * most + 2;
  std::vector<Complex> values, slopes;
  for (int i = 0; i < count; ++i) {
    SinCos const turn = sincos_turn(double(i) / count);
    WaveValue const psi = field.at(centre.x + radius * turn.cos, centre.y + radius * turn.sin);
    values.push_back(psi.value);
    slopes.push_back(turn.cos * psi.dx + turn.sin * psi.dy);
  }
  return harmonics(values, slopes, most);
}

RingField leaving_outline(Sampler const& arriving, WaveMirror const& mirror, double wavelength, int count) {
  RoundHole const& hole = mirror.outline;
  double const k = 2 * pi / wavelength;
  std::vector<Complex> values, slopes;
  for (int i = 0; i < count; ++i) {
    SinCos const turn = sincos_turn(double(i) / count);
    double const x = hole.x + hole.radius * turn.cos, y = hole.y + hole.radius * turn.sin;
    WaveValue const psi = arriving.at(x, y);
    double const tilt_x = 2 * (x * mirror.curvature - mirror.tilt_x),
                 tilt_y = 2 * (y * mirror.curvature - mirror.tilt_y);  // of the way that the mirror adds
    double const way = (x * x + y * y) * mirror.curvature - 2 * (mirror.tilt_x * x + mirror.tilt_y * y);
    Complex const reflected = turned(-way / wavelength), bent{0, -k * (turn.cos * tilt_x + turn.sin * tilt_y)};
    values.push_back(psi.value * reflected);
    slopes.push_back((turn.cos * psi.dx + turn.sin * psi.dy) * reflected + bent * values.back());
  }
  return harmonics(values, slopes, most_harmonic);
}

// The field behind a straight edge over that without it, by auxiliary functions of Fresnel's integrals to 2e-3
// (Abramowitz and Stegun, 7.3.32). v > 0: the edge leaves the straight way free.
Complex behind_edge(double v) {
  double const x = std::fabs(v), f = (1 + 0.926 * x) / (2 + 1.792 * x + 3.104 * x * x),
               g = 1 / (2 + 4.142 * x + 3.492 * x * x + 6.670 * x * x * x);
  // (1 - i)/2 times the integral of exp(i pi t^2/2) from x on
  Complex const shadow = Complex{0.5, -0.5} * Complex{g, f} * std::polar(1.0, pi * x * x / 2);
  return v < 0 ? shadow : 1.0 - shadow;
}

Complex passed(std::vector<PassedEdge> const& edges, double wavelength, double off_axis, double a, double l) {
  Complex product = 1;
  for (PassedEdge const& e : edges) {
    double const clear = e.radius - off_axis - (a - off_axis) * e.distance / l;
    product *= behind_edge(clear * std::sqrt(2 * l / (wavelength * e.distance * (l - e.distance))));
  }
  return product;
}

double share_passed(std::vector<PassedEdge> const& edges, double wavelength, double w, double a, double l) {
  constexpr double deviations = 3;
  static GaussPoints const gauss(16);
  double sum = 0, all = 0;
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    double const x = deviations * (2 * gauss.at[i] - 1), weight = gauss.weight[i] * std::exp(-x * x / 2);
    sum += weight * std::norm(passed(edges, wavelength, x * w / 2, a, l));
    all += weight;
  }
  return sum / all;
}

RingField diffracted(RingField const& leaving, double outline, double wavelength, double a, double l,
                     std::vector<PassedEdge> const& edges) {
  double const k = 2 * pi / wavelength, x = k * a * outline / l;
  RingField field = leaving;
  Complex const far = passed(edges, wavelength, -outline, a, l), near = passed(edges, wavelength, outline, a, l);
  for (int m = -leaving.most(); m <= leaving.most(); ++m) {
    std::size_t const i = std::size_t(m + leaving.most());
    Complex const there = leaving.value[i];
    field.value[i] = field.slope[i] = 0;
    if (there == Complex{} || m * m > 8 * x) continue;
    double const order = (4.0 * m * m - 1) / (8 * x);
    for (double const side : {-1, 1}) {
      // J_m = sqrt(2/pi x) cos(x - m pi/2 - pi/4 + order); the integral over the mirror by its end at the outline.
      Complex const phase = std::polar(1.0, side * (x - m * pi / 2 - pi / 4 + order));
      Complex const change = leaving.slope[i] / there + Complex{1 / (2 * outline), k * (outline + side * a) / l};
      Complex const wave = k / l * outline / std::sqrt(2 * pi * x) * phase * there / change * (side > 0 ? far : near);
      field.value[i] += wave;
      field.slope[i] += wave * Complex{-1 / (2 * a), k * (a + side * outline * (1 - order / x)) / l};
    }
  }
  return field;
}

SpeckleMeans speckle_means(SpeckledRim const& rim) {
  double const l1 = rim.distance1, l2 = rim.distance2, k = 2 * pi / rim.wavelength;
  EdgeLight const edge1(rim.edge1), edge2(rim.edge2);
  Products sum = of_speckle(rim);
  auto const add = [&](EdgeLight const& f, EdgeLight const& b) {
    Products const more = products(f, b);
    sum.field += more.field;
    sum.transverse += more.transverse;
    sum.longitudinal += more.longitudinal;
  };
  add(edge1, edge2);
  add(edge1, speckle_of(rim, false, edge1.most() + 1));
  add(speckle_of(rim, true, edge2.most() + 1), edge2);
  double const round = std::pow(2 * pi * rim.radius, 2);
  return {std::pow(2 * rim.wavelength * l1 * l2 / (l1 + l2), 2) * sum.field, round * sum.transverse,
          round / (k * k) * sum.longitudinal};
}

namespace {

// Nothing of the mode itself meets the rim, and the grid holds the light of this mirror there but not that of the
// other.
bool held(ArmCavity const& arm, ArmRim const& rim, std::size_t mirror) {
  return !rim.in_band && clear_of_mode(arm, rim) && (mirror == 0 ? rim.angle1 : rim.angle2) <= arm.crossover;
}

// Light from a mirror, whose points lie within R of the axis of a ring of radius a, has harmonics up to kaR/l on it,
// and an Airy tail beyond.
int harmonics_on(ArmCavity const& arm, ArmRim const& rim, std::size_t mirror) {
  WaveCavity const& cavity = arm.cavity;
  RoundHole const& hole = (mirror == 0 ? cavity.mirror1 : cavity.mirror2).outline;
  double const distance = mirror == 0 ? rim.centre.z : cavity.length - rim.centre.z;
  double const farthest = hole.radius + std::hypot(hole.x - rim.centre.x, hole.y - rim.centre.y);
  double const x = 2 * pi / cavity.wavelength * rim.rim.radius * farthest / distance;
  return int(std::ceil(x + 4 * std::cbrt(x))) + 8;
}

// By light of a mirror on its way to a rim.
std::vector<PassedEdge> edges_before(ArmCavity const& arm, std::size_t rim, std::size_t mirror) {
  auto const distance = [&](ArmRim const& r) { return mirror == 0 ? r.centre.z : arm.cavity.length - r.centre.z; };
  std::vector<PassedEdge> edges;
  for (ArmRim const& r : arm.rims)
    if (distance(r) < distance(arm.rims[rim])) edges.push_back({distance(r), r.rim.radius});
  return edges;
}

}  // namespace

LightMeter::LightMeter(ArmCavity const& arm, WaveCavity const& cavity) : arm_(arm), cavity_(cavity) {
  light_.at_rims.resize(arm.rims.size());
}

void LightMeter::operator()(Arrival const& arrival) {
  int const last = int(arm_.rims.size()) + 1;
  if (arrival.plane == 0 || arrival.plane == last) {
    WaveMirror const& mirror = arrival.plane == 0 ? cavity_.mirror1 : cavity_.mirror2;
    int const points = points_along(2 * pi * mirror.outline.radius, cavity_.grid.pitch());
    light_.outlines[arrival.plane == 0 ? 0 : 1] =
        leaving_outline(Sampler(arrival.field), mirror, cavity_.wavelength, points);
    return;
  }
  std::size_t const rim = std::size_t(arrival.plane - 1), from = arrival.travel == Travel::towards_mirror2 ? 0 : 1;
  ArmRim const& lit = arm_.rims[rim];
  if (held(arm_, lit, from))
    light_.at_rims[rim][from] =
        field_on_ring(Sampler(arrival.field), lit.centre, lit.rim.radius, harmonics_on(arm_, lit, from));
}

ExpectedLevers::ExpectedLevers(World const& world, ArmCavity const& arm) : arm_(arm) {
  for (std::size_t const i : {0, 1}) brdf_.emplace_back(world, arm.mirrors[i], i == 0 ? -arm.frame.z : arm.frame.z);
}

SpeckledRim ExpectedLevers::lit(std::size_t number, LightOfMirrors const& light) const {
  ArmRim const& rim = arm_.rims[number];
  SpeckledRim s{arm_.cavity.wavelength, rim.rim.radius, rim.centre.z, arm_.cavity.length - rim.centre.z};
  s.spot1 = arm_.mirrors[0].spot;
  s.spot2 = arm_.mirrors[1].spot;
  for (std::size_t const i : {0, 1}) {
    RingField& wave = i == 0 ? s.edge1 : s.edge2;
    double& brdf = i == 0 ? s.brdf1 : s.brdf2;
    if (held(arm_, rim, i)) {
      wave = light.at_rims[number][i];
      continue;
    }
    double const distance = i == 0 ? s.distance1 : s.distance2;
    std::vector<PassedEdge> const edges = edges_before(arm_, number, i);
    wave = diffracted(light.outlines[i], arm_.mirrors[i].radius, s.wavelength, s.radius, distance, edges);
    brdf = brdf_[i](i == 0 ? rim.angle1 : rim.angle2);
    if (clear_of_mode(arm_, rim)) brdf *= share_passed(edges, s.wavelength, arm_.mirrors[i].spot, s.radius, distance);
  }
  return s;
}

SpeckleMeans ExpectedLevers::operator()(std::size_t rim, LightOfMirrors const& light) const {
  return speckle_means(lit(rim, light));
}

SpeckleMeans ExpectedLevers::operator()(std::size_t rim, std::vector<LightOfMirrors> const& draws) const {
  SpeckleMeans mean;
  double const share = 1 / double(draws.size());
  for (LightOfMirrors const& light : draws) {
    SpeckleMeans const means = (*this)(rim, light);
    mean.field += share * means.field;
    mean.transverse += share * means.transverse;
    mean.longitudinal += share * means.longitudinal;
  }
  return mean;
}

}  // namespace straytrace::wave
