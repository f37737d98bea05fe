// SPDX-License-Identifier: BSD-3-Clause
#include "wave/diodes/photodiode.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "wave/heights/height_map.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {
namespace {

// Of Gauss and Legendre for an integrand without structure below `finest`: a wave of 2 pi/finest over a length takes
// half its phase and some more.
GaussPoints gauss_over(double length, double finest) {
  return GaussPoints(std::clamp(int(std::ceil(pi * length / finest / 2)) + 4, 4, 400));
}

}  // namespace

double Photodiode::area() const {
  switch (shape) {
    case DiodeShape::square:
      return size * size;
    case DiodeShape::round:
      return pi * size * size / 4;
    case DiodeShape::sector:
      return width * radius * size;
  }
  return 0;
}

double Photodiode::farthest() const {
  double const half = size / 2;
  double const own = shape == DiodeShape::square ? std::hypot(radius + half, half) : radius + half;
  return own + std::hypot(x, y);
}

std::vector<DiodePoint> points_of(Photodiode const& d, double finest) {
  std::vector<DiodePoint> points;
  double const cosine = std::cos(d.azimuth), sine = std::sin(d.azimuth);
  auto const add = [&](double along, double across, double weight) {  // along the radius, from the centre of the ring
    points.push_back({d.x + along * cosine - across * sine, d.y + along * sine + across * cosine, weight});
  };
  GaussPoints const radial = gauss_over(d.size, finest);
  std::size_t const n = radial.at.size();
  if (d.shape == DiodeShape::square)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        add(d.radius + d.size * (radial.at[i] - 0.5), d.size * (radial.at[j] - 0.5),
            d.size * d.size * radial.weight[i] * radial.weight[j]);
  if (d.shape == DiodeShape::round) {
    std::size_t const turns = 2 * n;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < turns; ++j) {
        double const r = d.size / 2 * radial.at[i], turn = 2 * pi * (double(j) + 0.5) / double(turns);
        add(d.radius + r * std::cos(turn), r * std::sin(turn),
            d.size / 2 * radial.weight[i] * r * 2 * pi / double(turns));
      }
  }
  if (d.shape == DiodeShape::sector) {
    GaussPoints const around = gauss_over((d.radius + d.size / 2) * d.width, finest);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < around.at.size(); ++j) {
        double const r = d.radius + d.size * (radial.at[i] - 0.5), turn = d.width * (around.at[j] - 0.5);
        add(r * std::cos(turn), r * std::sin(turn), d.size * radial.weight[i] * r * d.width * around.weight[j]);
      }
  }
  return points;
}

double DiodeLight::power() const {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += points[i].weight * std::norm(field[i]);
  return sum;
}

// |psi|^2 holds twice the frequencies of psi, whose largest is 0.7 of Nyquist's.
DiodeMeter::DiodeMeter(CavityWaves const& waves, std::vector<Photodiode> const& diodes, double finest)
    : diodes_(diodes) {
  double const of_grid = waves.cavity().grid.pitch() / 0.7;
  for (Photodiode const& d : diodes) light_.push_back({points_of(d, std::fmax(finest, of_grid)), {}});
}

void DiodeMeter::operator()(Arrival const& arrival) {
  auto const meets = [&](Photodiode const& d) { return d.plane == arrival.plane && d.travel == arrival.travel; };
  if (std::ranges::none_of(diodes_, meets)) return;
  Sampler const field(arrival.field);
  for (std::size_t i = 0; i < diodes_.size(); ++i) {
    if (!meets(diodes_[i])) continue;
    light_[i].field.clear();
    for (DiodePoint const& p : light_[i].points) light_[i].field.push_back(field.at(p.x, p.y).value);
  }
}

namespace {

constexpr int most_reflections = 10;
constexpr double weakest_path = 1e-4;  // of the mean irradiance of all

double opening_radius(WaveCavity const& cavity, int plane) {
  std::size_t const n = cavity.baffles.size();
  return plane == 0       ? cavity.mirror1.outline.radius
         : plane > int(n) ? cavity.mirror2.outline.radius
                          : cavity.baffles[std::size_t(plane) - 1].rim.radius;
}
double place_of(WaveCavity const& cavity, int plane) {
  return plane == 0                           ? 0
         : plane > int(cavity.baffles.size()) ? cavity.length
                                              : cavity.baffles[std::size_t(plane) - 1].place;
}
WaveMirror const& mirror_of(WaveCavity const& cavity, int mirror) {
  return mirror == 0 ? cavity.mirror1 : cavity.mirror2;
}

// Backwards from a plane: the matrix of the way from an earlier plane to it.
struct RayMatrix {
  double a = 1, b = 0, c = 0, d = 1;
  void after_space(double length) { b += a * length, d += c * length; }
  void after_mirror(double curvature) { a -= 2 * curvature * b, c -= 2 * curvature * d; }
};

// One plane on the way, seen from the end: the matrix from just behind it to the end.
struct Stage {
  int plane;
  RayMatrix to_end;
};

}  // namespace

std::vector<HaloPath> halo_paths(WaveCavity const& cavity, int plane, Travel travel, double distance) {
  std::vector<HaloPath> paths;
  std::vector<Stage> passed;
  RayMatrix to_end;
  int at = plane, step = travel == Travel::towards_mirror2 ? -1 : 1;
  int const last = int(cavity.baffles.size()) + 1;
  for (int reflections = 0; reflections <= most_reflections;) {
    int const before = at + step;
    to_end.after_space(std::fabs(place_of(cavity, at) - place_of(cavity, before)));
    at = before;
    if (at != 0 && at != last) {
      passed.push_back({at, to_end});
      continue;
    }
    int const mirror = at == 0 ? 0 : 1;
    HaloPath path{mirror, to_end.a, to_end.b, to_end.d, {}};
    bool reaches = std::fabs(path.b) > 0;
    // From the source to a stage: the inverse of stage-to-end after source-to-end, with determinants of one.
    for (Stage const& s : passed) {
      RayMatrix const& e = s.to_end;
      HaloPath::Opening const o{opening_radius(cavity, s.plane), e.d * to_end.a - e.b * to_end.c,
                                e.d * to_end.b - e.b * to_end.d};
      reaches = reaches && std::fabs(o.b / path.b) * distance < 1.5 * o.radius;
      path.openings.push_back(o);
    }
    if (reaches) paths.push_back(path);
    // On through the mirror, on which the light fell before it was reflected.
    RayMatrix const behind = to_end;
    to_end.after_mirror(mirror_of(cavity, mirror).curvature);
    passed.push_back({at, behind});
    step = -step;
    ++reflections;
  }
  return paths;
}

ModeAxis axis_of(CavityWaves const& waves, Arrival const& arrival) {
  Grid const& grid = waves.cavity().grid;
  double sum = 0, x = 0, y = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const power = std::norm(arrival.field(row, column));
      sum += power;
      x += power * grid.at(column);
      y += power * grid.at(row);
    }
  ModeAxis axis{x / sum, y / sum, 0, 0, 0};
  WaveValue const v = Sampler(arrival.field).at(axis.x, axis.y);
  double const k = 2 * pi / waves.cavity().wavelength;
  axis.field = v.value;
  axis.slope_x = (v.dx / v.value).imag() / k;
  axis.slope_y = (v.dy / v.value).imag() / k;
  return axis;
}

namespace {

// A way of light with all that its irradiance and coherence need.
class HaloWay {
 public:
  HaloWay(WaveCavity const& cavity, HaloPath path, HaloMirror const& source, ModeAxis const& axis)
      : path_(std::move(path)),
        source_(source),
        k_(2 * pi / cavity.wavelength),
        curvature_(mirror_of(cavity, path_.mirror).curvature),
        focus_(path_.a / path_.b - curvature_) {
    double const w = source.spot;
    Complex const beam = Complex{-curvature_, cavity.wavelength / (pi * w * w)};
    start_ = std::arg(axis.field * (path_.a + path_.b * beam));
    slope_x_ = axis.slope_x;
    slope_y_ = axis.slope_y;
  }
  // Mean of |psi|^2 at a distance from the axis (eq. W.17 behind a paraxial system), 1/m^2.
  double irradiance(double distance) const {
    double const visible = visible_share(distance);
    if (visible == 0) return 0;
    double const length = std::fabs(path_.b);
    return visible * mean_irradiance(source_.brdf, source_.spot, 1 / length - focus_, length, distance);
  }
  // Of a point at (x, y) from the axis with the phase of light from the middle of the spot.
  Complex phase(double x, double y) const {
    return std::polar(1.0, k_ * (path_.d * (x * x + y * y) / (2 * path_.b) + slope_x_ * x + slope_y_ * y));
  }
  // eq. W.42: of two points `apart`, over the roots of their irradiances and their phases.
  double coherence(double apart_squared) const {
    double const s = k_ * source_.spot / path_.b;
    return std::exp(-s * s * apart_squared / 8);
  }
  // eq. W.42: of two points with the sum of places `sum`, the same.
  Complex mirrored(double sum_squared) const {
    double const q = 2 / (source_.spot * source_.spot);
    Complex const spread{q, -k_ * focus_};
    return std::polar(1.0, 2 * start_) * q / spread *
           std::exp(-k_ * k_ * sum_squared / (path_.b * path_.b) / 4.0 / spread);
  }

 private:
  // Over the spot, with the weight of the BRDF: the light that no opening on the way stops.
  double visible_share(double distance) const {
    if (path_.openings.empty()) return 1;
    GaussPoints const radial(6);
    constexpr int turns = 12;
    double seen = 0, all = 0;
    for (double const u : radial.at) {  // in exp(-2 rho^2/w^2), so that all points have weights of the rule alone
      double const rho = source_.spot * std::sqrt(-0.5 * std::log(u));
      for (int i = 0; i < turns; ++i) {
        double const x = rho * std::cos(2 * pi * (i + 0.5) / turns), y = rho * std::sin(2 * pi * (i + 0.5) / turns);
        // Angle from the specular direction, towards x' = distance; the beam has the slope -curvature rho.
        double const tx = distance / path_.b - focus_ * x, ty = -focus_ * y;
        double const weight = source_.brdf(std::hypot(tx, ty));
        all += weight;
        if (std::ranges::all_of(path_.openings, [&](HaloPath::Opening const& o) {
              double const own = o.a - o.b * curvature_;
              return std::hypot(own * x + o.b * tx, own * y + o.b * ty) < o.radius;
            }))
          seen += weight;
      }
    }
    return all > 0 ? seen / all : 0;
  }

  HaloPath path_;
  HaloMirror const& source_;
  double k_, curvature_, focus_;  // rad/m; 1/m; A/B - 1/RoC, 1/m
  double start_ = 0;              // phase of the mode on the mirror, as it arrives at the plane, rad
  double slope_x_ = 0, slope_y_ = 0;
};

// Diodes of one plane and travel.
struct DiodePlane {
  std::vector<std::size_t> diodes;
  ModeAxis axis;
  std::vector<DiodeLight> light;  // at points that speckle needs
};

struct HaloPoint {
  std::size_t diode;
  double x, y, weight;        // from the axis, m; m^2
  Complex field;              // that is not scattered
  std::vector<Complex> halo;  // of each way: root of the irradiance with the phase
};

std::vector<HaloWay> ways_to(WaveCavity const& cavity, std::array<HaloMirror, 2> const& mirrors, int plane,
                             Travel travel, ModeAxis const& axis, double nearest, double farthest) {
  std::vector<std::pair<HaloWay, double>> found;
  double all = 0;
  for (HaloPath& path : halo_paths(cavity, plane, travel, nearest)) {
    HaloMirror const& source = mirrors[std::size_t(path.mirror)];
    HaloWay const way(cavity, std::move(path), source, axis);
    double const size = std::fmax(way.irradiance(nearest), way.irradiance(farthest));
    all += size;
    found.emplace_back(way, size);
  }
  std::vector<HaloWay> ways;
  for (auto const& [way, size] : found)
    if (size > weakest_path * all) ways.push_back(way);
  return ways;
}

// Covariance of |psi|^2 at two points, of fields with a normal distribution that is not circular.
double covariance_of(HaloPoint const& a, HaloPoint const& b, std::vector<HaloWay> const& ways) {
  double const apart = (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
  double const sum = (a.x + b.x) * (a.x + b.x) + (a.y + b.y) * (a.y + b.y);
  Complex same = 0, mirrored = 0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    same += a.halo[i] * std::conj(b.halo[i]) * ways[i].coherence(apart);
    mirrored += a.halo[i] * b.halo[i] * ways[i].mirrored(sum);
  }
  double const direct = 2 * (std::conj(a.field) * (same * b.field + mirrored * std::conj(b.field))).real();
  return std::norm(same) + std::norm(mirrored) + direct;
}

void add_plane(CavityWaves const& smooth, std::array<HaloMirror, 2> const& mirrors,
               std::vector<Photodiode> const& diodes, DiodePlane const& plane, HaloMoments moments,
               HaloStatistics& out) {
  Photodiode const& first = diodes[plane.diodes.front()];
  double nearest = infinity, farthest = 0;
  for (DiodeLight const& light : plane.light)
    for (DiodePoint const& p : light.points) {
      double const r = std::hypot(p.x - plane.axis.x, p.y - plane.axis.y);
      nearest = std::fmin(nearest, r);
      farthest = std::fmax(farthest, r);
    }
  auto const ways = ways_to(smooth.cavity(), mirrors, first.plane, first.travel, plane.axis, nearest, farthest);
  std::vector<HaloPoint> points;
  for (std::size_t i = 0; i < plane.diodes.size(); ++i)
    for (std::size_t j = 0; j < plane.light[i].points.size(); ++j) {
      DiodePoint const& p = plane.light[i].points[j];
      HaloPoint point{plane.diodes[i], p.x - plane.axis.x, p.y - plane.axis.y, p.weight, plane.light[i].field[j], {}};
      for (HaloWay const& way : ways) {
        double const irradiance = way.irradiance(std::hypot(point.x, point.y));
        out.mean[Eigen::Index(point.diode)] += p.weight * irradiance;
        point.halo.push_back(std::sqrt(irradiance) * way.phase(point.x, point.y));
      }
      points.push_back(std::move(point));
    }
  if (moments == HaloMoments::mean) return;
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      double const share = points[a].weight * points[b].weight * covariance_of(points[a], points[b], ways);
      auto const i = Eigen::Index(points[a].diode), j = Eigen::Index(points[b].diode);
      out.covariance(i, j) += share;
      if (a != b) out.covariance(j, i) += share;
    }
}

}  // namespace

HaloStatistics halo_on(CavityWaves const& smooth, WaveMode const& mode, std::array<HaloMirror, 2> const& mirrors,
                       std::vector<Photodiode> const& diodes, HaloMoments moments) {
  auto const n = Eigen::Index(diodes.size());
  HaloStatistics out{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  WaveCavity const& cavity = smooth.cavity();
  double const widest = std::fmax(mirrors[0].spot, mirrors[1].spot);
  std::map<std::pair<int, Travel>, DiodePlane> planes;
  for (std::size_t i = 0; i < diodes.size(); ++i) planes[{diodes[i].plane, diodes[i].travel}].diodes.push_back(i);
  Field work = mode.spectrum;
  auto const see = [&](Arrival const& arrival) {
    DiodePlane& plane = planes.at({arrival.plane, arrival.travel});
    plane.axis = axis_of(smooth, arrival);
    double const place = place_of(cavity, arrival.plane);
    double const length = arrival.travel == Travel::towards_mirror2 ? place : cavity.length - place;
    double const speckle = cavity.wavelength * length / (pi * widest);
    std::vector<Photodiode> mine;
    for (std::size_t const i : plane.diodes) mine.push_back(diodes[i]);
    DiodeMeter meter(smooth, mine, speckle);
    meter(arrival);
    plane.light = meter.light();
  };
  smooth.round_trip(work, see, [&](int plane, Travel travel) { return planes.contains({plane, travel}); });
  for (auto const& [where, plane] : planes) add_plane(smooth, mirrors, diodes, plane, moments, out);
  return out;
}

}  // namespace straytrace::wave
