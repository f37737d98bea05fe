// SPDX-License-Identifier: BSD-3-Clause
#include "beams/eigenmode.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/linear_algebra.hpp"
#include "optics/coating/fresnel.hpp"

namespace straytrace::beams {

namespace {

Eigen::Matrix2d seen_across(Vec3 e1, Vec3 e2, SurfaceCurvature const& c) {
  Eigen::Matrix2d m;
  m << dot(e1, c.a), dot(e1, c.b), dot(e2, c.a), dot(e2, c.b);
  return m;
}

Eigen::Matrix2d tensor(SurfaceCurvature const& c) {
  Eigen::Matrix2d k;
  k << c.aa, c.ab, c.ab, c.bb;
  return k;
}

}  // namespace

FaceMap mirror_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const& curvature, double n) {
  FaceMap face;
  face.travel = unit(reflected(travel, normal));
  face.e1 = unit(reflected(e1, normal));
  face.e2 = cross(face.travel, face.e1);  // a mirror image is left-handed: minus the image of e2
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = n * (dot(travel, normal) - dot(face.travel, normal)) * tensor(curvature);
  return face;
}

FaceMap refracting_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const& curvature, double n_in,
                        double n_out) {
  FaceMap face;
  double const cosine = dot(travel, normal);
  if (!optics::refracted(travel, cosine < 0 ? normal : -normal, n_in, n_out, face.travel))
    throw NumericalError(
        fmt::format("a beam meets the face between index {:.4g} and {:.4g} beyond the critical angle: incidence {:.4g} "
                    "degrees",
                    n_in, n_out, std::acos(std::fabs(cosine)) * 180 / pi));
  // The rotation in the plane of incidence that takes `travel` to its new direction.
  Vec3 const both = travel + face.travel;
  face.e1 = unit(e1 - (dot(e1, face.travel) / (1 + dot(travel, face.travel))) * both);
  face.e2 = cross(face.travel, face.e1);
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = (n_in * cosine - n_out * dot(face.travel, normal)) * tensor(curvature);
  return face;
}

FaceMap grating_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 out, Vec3 normal, SurfaceCurvature const& curvature,
                     double n_in, double n_out) {
  FaceMap face;
  face.travel = out;
  Vec3 const near = std::fabs(dot(e1, out)) < std::fabs(dot(e2, out)) ? e1 : e2;
  face.e1 = unit(near - dot(near, out) * out);
  face.e2 = cross(out, face.e1);
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = (n_in * dot(travel, normal) - n_out * dot(out, normal)) * tensor(curvature);
  return face;
}

RayMatrix both_axes(AxisMatrix const& x, AxisMatrix const& y) {
  RayMatrix m = RayMatrix::Zero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      m(2 * i, 2 * j) = x(i, j);
      m(2 * i + 1, 2 * j + 1) = y(i, j);
    }
  return m;
}

namespace {

constexpr double miss = 1e-7;  // of the distance flown: the curvature is that at the point

RayMatrix ray_flight(double length, double n) {
  AxisMatrix const axis{{1, length / n}, {0, 1}};
  return both_axes(axis, axis);
}

RayMatrix ray_face(FaceMap const& face) {
  Eigen::Matrix2d const from = face.before.inverse(), to = face.after.inverse().transpose();
  RayMatrix m = RayMatrix::Zero();
  m.topLeftCorner<2, 2>() = face.after * from;
  m.bottomLeftCorner<2, 2>() = to * face.power * from;
  m.bottomRightCorner<2, 2>() = to * face.before.transpose();
  return m;
}

}  // namespace

Eigen::Matrix2cd transformed(RayMatrix const& m, Eigen::Matrix2cd const& n_q) {
  Eigen::Matrix2cd const offset = m.topLeftCorner<2, 2>() + m.topRightCorner<2, 2>() * n_q;
  Eigen::Matrix2cd const slope = m.bottomLeftCorner<2, 2>() + m.bottomRightCorner<2, 2>() * n_q;
  return slope * offset.inverse();
}

OpticalElement spherical_mirror(Vec3 point, Vec3 normal, double roc) {
  Frame const f = Frame::around(normal);
  return {point, normal, {f.e1, f.e2, 1 / roc, 0, 1 / roc}, true, 1};
}

std::vector<OpticalElement> mirrors_through(std::span<Vec3 const> points, std::span<double const> roc, bool closed) {
  std::vector<OpticalElement> mirrors;
  std::size_t const n = points.size(), count = closed ? n : n - 2;
  for (std::size_t i = 1; i <= count; ++i) {
    Vec3 const here = points[i % n], before = points[i - 1], after = points[(i + 1) % n];
    mirrors.push_back(spherical_mirror(here, unit(unit(before - here) + unit(after - here)), roc[i % n]));
  }
  return mirrors;
}

BeamPath follow(Mode const& start, double index, std::span<OpticalElement const> elements) {
  BeamPath path;
  path.mode = start;
  path.index = index;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    OpticalElement const& e = elements[i];
    Mode const& from = path.mode;
    double const distance = dot(e.point - from.origin, from.travel);
    double const off = length(e.point - from.origin - distance * from.travel);
    if (!(distance >= 0 && off <= miss * distance))
      throw NumericalError(fmt::format("element {} of the path: the chief ray passes it at {:.3g} m, {:.6g} m on",
                                       i + 1, off, distance));
    path.gouy += gouy(from, distance);
    path.optical_length += path.index * distance;
    Mode arriving = propagated(from, distance);
    arriving.origin = e.point;
    double const after = e.reflects ? path.index : e.index_after;
    FaceMap const face = e.reflects
                             ? mirror_face(from.e1, from.e2, from.travel, e.normal, e.curvature, after)
                             : refracting_face(from.e1, from.e2, from.travel, e.normal, e.curvature, path.index, after);
    path.rays = (ray_face(face) * ray_flight(distance, path.index) * path.rays).eval();
    path.mode = e.reflects ? reflected(arriving, e.normal, e.curvature)
                           : refracted(arriving, e.normal, e.curvature, path.index, after);
    path.index = after;
    path.arriving.push_back(arriving);
  }
  return path;
}

namespace {

constexpr double edge = 1e-12;       // of half the trace to 1, where the two are the same
constexpr double growth = 1e-7;      // of a ray per round trip that rounding can feign, for a pair of equal phases
constexpr double unrelated = 1e-12;  // coupling of the axes, relative, that is rounding
constexpr double repeats = 1e-6;     // relative change of the mode per round trip

double turn_of(std::complex<double> factor) {
  double const angle = std::arg(factor);
  return angle < 0 ? angle + 2 * pi : angle;
}

AxisMatrix one_axis(RayMatrix const& m, int axis) {
  return AxisMatrix{{m(axis, axis), m(axis, axis + 2)}, {m(axis + 2, axis), m(axis + 2, axis + 2)}};
}

// The same rays with offset and slope in units that make them alike in size.
RayMatrix scaled(RayMatrix const& m, double unit_length) {
  Eigen::Vector4d const units{1, 1, 1 / unit_length, 1 / unit_length};
  return units.cwiseInverse().asDiagonal() * m * units.asDiagonal();
}
double unit_length(RayMatrix const& m) {
  double const b = m.topRightCorner<2, 2>().norm(), c = m.bottomLeftCorner<2, 2>().norm();
  return b > 0 && c > 0 ? std::sqrt(b / c) : 1;
}

bool independent_axes(RayMatrix const& m) {
  double coupling = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if ((i + j) % 2) coupling = std::max(coupling, std::fabs(m(i, j)));
  return coupling <= unrelated * m.norm();
}

RayEigenmode coupled_eigenmode(RayMatrix const& round_trip, double size) {
  Eigen::EigenSolver<RayMatrix> const solver(scaled(round_trip, size));
  Eigen::Matrix2cd offset, slope;
  RayEigenmode found;
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    // Of each pair of conjugate rays the one of a beam: Im of offset* slope is positive, as Im Q is.
    Eigen::Vector4cd const ray = solver.eigenvectors().col(i);
    if (!(ray.head<2>().dot(ray.tail<2>()).imag() > 0)) continue;
    if (count == 2) throw NumericalError("the eigenmode of the cavity is not unique: two of its phases are opposite");
    offset.col(count) = ray.head<2>();
    slope.col(count) = ray.tail<2>() / size;
    found.gouy[static_cast<std::size_t>(count++)] = turn_of(solver.eigenvalues()(i));
  }
  if (count != 2) throw NumericalError("the eigenmode of the cavity is not unique: two of its phases are opposite");
  found.n_q = slope * offset.inverse();
  found.n_q = (0.5 * (found.n_q + found.n_q.transpose())).eval();
  return found;
}

}  // namespace

std::string instability(AxisMatrix const& m) {
  double const half_trace = 0.5 * m.trace();
  if (std::fabs(half_trace) < 1 - edge) return {};
  return fmt::format("half the trace of the round-trip matrix is {:.6g}, must lie between -1 and 1", half_trace);
}

std::string instability(RayMatrix const& m) {
  RayMatrix const round_trip = scaled(m, unit_length(m));
  if (independent_axes(round_trip)) {
    for (int axis = 0; axis < 2; ++axis)
      if (auto const why = instability(one_axis(m, axis)); !why.empty())
        return fmt::format("{} axis: {}", axis == 0 ? "first" : "second", why);
    return {};
  }
  Eigen::EigenSolver<RayMatrix> const solver(round_trip, false);
  double const largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  if (largest < 1 + growth) return {};
  return fmt::format("the axes are coupled and a ray grows by a factor of {:.6g} per round trip", largest);
}

AxisEigenmode eigenmode(AxisMatrix const& m) {
  if (auto const why = instability(m); !why.empty()) throw NumericalError("the cavity is unstable: " + why);
  // q = (A q + B)/(C q + D), z_R > 0.
  double const half_trace = 0.5 * m.trace(), root = std::sqrt(1 - half_trace * half_trace);
  BeamParameter const q = BeamParameter(0.5 * (m(0, 0) - m(1, 1)), std::copysign(root, m(1, 0))) / m(1, 0);
  return {q, turn_of({half_trace, std::copysign(root, m(0, 1))})};
}

RayEigenmode eigenmode(RayMatrix const& m) {
  if (auto const why = instability(m); !why.empty()) throw NumericalError("the cavity is unstable: " + why);
  double const size = unit_length(m);
  RayEigenmode found;
  if (independent_axes(scaled(m, size))) {
    AxisEigenmode const x = eigenmode(one_axis(m, 0)), y = eigenmode(one_axis(m, 1));
    found.n_q << std::conj(1.0 / x.q), 0, 0, std::conj(1.0 / y.q);
    found.gouy = {x.gouy, y.gouy};
  } else {
    found = coupled_eigenmode(m, size);
  }
  if (!((transformed(m, found.n_q) - found.n_q).norm() < repeats * found.n_q.norm()))
    throw NumericalError("the eigenmode of the cavity is not unique: the phases of two axes are equal or opposite");
  return found;
}

CavityEigenmode cavity_eigenmode(Mode const& start, double index, std::span<OpticalElement const> elements) {
  Mode any = start;  // of any curvature: only rays are followed
  any.q11 = any.q22 = {0, 1};
  any.q12 = 0;
  BeamPath path = follow(any, index, elements);
  double const off = length(path.mode.origin - start.origin), turned = length(path.mode.travel - start.travel);
  if (!(off <= 1e-7 * path.optical_length && turned < 1e-7))
    throw NumericalError(
        fmt::format("the elements do not close a round trip: the chief ray ends {:.3g} m and {:.3g} rad from its start",
                    off, turned));
  // From the frame that comes back to that of the start.
  Mode const& end = path.mode;
  AxisMatrix const same{{dot(start.e1, end.e1), dot(start.e1, end.e2)}, {dot(start.e2, end.e1), dot(start.e2, end.e2)}};
  RayMatrix turn = RayMatrix::Zero();
  turn.topLeftCorner<2, 2>() = same;
  turn.bottomRightCorner<2, 2>() = same;
  RayEigenmode const found = eigenmode(RayMatrix(turn * path.rays));

  CavityEigenmode cavity;
  cavity.gouy = found.gouy;
  cavity.mode = start;
  cavity.mode.q11 = found.n_q(0, 0) / index;
  cavity.mode.q12 = found.n_q(0, 1) / index;
  cavity.mode.q22 = found.n_q(1, 1) / index;
  path = follow(cavity.mode, index, elements);
  cavity.tem00_gouy = path.gouy;
  cavity.optical_length = path.optical_length;
  return cavity;
}

namespace {

constexpr int most_steps = 40;
constexpr double settled = 1e-12;   // step over the length of the way
constexpr double singular = 1e-9;   // smallest pivot over the largest: the axis is not determined
constexpr double collinear = 1e-6;  // sine of the angle between legs below which they have no plane

// A mirror in its own coordinates: x and y from its vertex.
struct Face {
  SphericalMirror mirror;
  Frame frame;

  explicit Face(SphericalMirror const& m) : mirror(m), frame(Frame::around(m.axis)) {}
  double root(double x, double y) const {
    double const square = 1 - mirror.curvature * mirror.curvature * (x * x + y * y);
    if (!(square > 0)) throw NumericalError("no ray closes on itself: it passes beside a mirror");
    return std::sqrt(square);
  }
  Vec3 point(double x, double y) const {
    double const sag = mirror.curvature * (x * x + y * y) / (1 + root(x, y));
    return mirror.vertex + x * frame.e1 + y * frame.e2 + sag * mirror.axis;
  }
  std::array<Vec3, 2> tangents(double x, double y) const {
    double const slope = mirror.curvature / root(x, y);
    return {frame.e1 + (slope * x) * mirror.axis, frame.e2 + (slope * y) * mirror.axis};
  }
};

struct Way {
  std::vector<Face> faces;

  std::vector<Vec3> points(Eigen::VectorXd const& at) const {
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < faces.size(); ++i)
      all.push_back(faces[i].point(at[2 * Eigen::Index(i)], at[2 * Eigen::Index(i) + 1]));
    return all;
  }
  // Of the length of the closed way.
  Eigen::VectorXd gradient(Eigen::VectorXd const& at) const {
    std::vector<Vec3> const p = points(at);
    std::size_t const n = p.size();
    Eigen::VectorXd g(2 * Eigen::Index(n));
    for (std::size_t i = 0; i < n; ++i) {
      auto const k = 2 * Eigen::Index(i);
      Vec3 const both = unit(p[i] - p[(i + n - 1) % n]) + unit(p[i] - p[(i + 1) % n]);
      auto const [along_x, along_y] = faces[i].tangents(at[k], at[k + 1]);
      g[k] = dot(both, along_x);
      g[k + 1] = dot(both, along_y);
    }
    return g;
  }
  double length_of(std::vector<Vec3> const& p) const {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += length(p[(i + 1) % p.size()] - p[i]);
    return sum;
  }
};

// The plane of the two legs that enclose the largest angle.
Vec3 plane_of(std::vector<Vec3> const& legs) {
  Vec3 normal{};
  for (std::size_t i = 0; i < legs.size(); ++i) {
    Vec3 const across = cross(legs[i], legs[(i + 1) % legs.size()]);
    if (length(across) > length(normal)) normal = across;
  }
  if (length(normal) < collinear) {
    Vec3 const up = std::fabs(legs[0].y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    normal = up - dot(up, legs[0]) * legs[0];
  }
  normal = unit(normal);
  double largest = normal.x;
  for (double c : {normal.y, normal.z})
    if (std::fabs(c) > std::fabs(largest)) largest = c;
  return largest < 0 ? -normal : normal;
}

}  // namespace

std::vector<Vec3> closed_axis(std::span<SphericalMirror const> mirrors) {
  Way way;
  for (SphericalMirror const& m : mirrors) way.faces.emplace_back(m);
  auto const unknowns = 2 * Eigen::Index(mirrors.size());
  Eigen::VectorXd at = Eigen::VectorXd::Zero(unknowns);
  double const scale = way.length_of(way.points(at)), step = 1e-5 * scale / double(mirrors.size());
  if (!(scale > 0)) throw NumericalError("the mirrors are all at one place");
  for (int i = 0; i < most_steps; ++i) {
    Eigen::MatrixXd second(unknowns, unknowns);
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      Eigen::VectorXd more = at, less = at;
      more[k] += step;
      less[k] -= step;
      second.col(k) = (way.gradient(more) - way.gradient(less)) / (2 * step);
    }
    auto const change = solve_regular(second, way.gradient(at), singular);
    if (!change) throw NumericalError("no single ray closes on itself: the mirrors do not determine the axis");
    if (!change->allFinite()) break;
    at -= *change;
    if (change->cwiseAbs().maxCoeff() < settled * scale) return way.points(at);
  }
  throw NumericalError("no ray near the vertices of the mirrors closes on itself");
}

ClosedCavity closed_cavity(std::span<SphericalMirror const> mirrors, double wavelength) {
  std::vector<Vec3> const points = closed_axis(mirrors);
  std::size_t const n = points.size();
  std::vector<double> roc;
  for (SphericalMirror const& m : mirrors) roc.push_back(1 / m.curvature);
  std::vector<Vec3> legs;
  for (std::size_t i = 0; i < n; ++i) legs.push_back(unit(points[(i + 1) % n] - points[i]));
  ClosedCavity cavity;
  cavity.normal = plane_of(legs);
  for (Vec3 const& leg : legs) cavity.out_of_plane = std::fmax(cavity.out_of_plane, std::fabs(dot(leg, cavity.normal)));
  Mode const any = elliptic_mode(points[0], unit(cross(cavity.normal, legs[0])), legs[0], {1, 1}, {0, 0}, wavelength);
  std::vector<OpticalElement> const elements = mirrors_through(points, roc, true);
  CavityEigenmode const found = cavity_eigenmode(any, 1, elements);
  cavity.start = found.mode;
  cavity.gouy = found.gouy;
  cavity.length = found.optical_length;
  cavity.arriving = follow(found.mode, 1, elements).arriving;
  std::rotate(cavity.arriving.begin(), cavity.arriving.end() - 1, cavity.arriving.end());
  return cavity;
}

std::complex<double> curvature_along(Mode const& mode, Vec3 across) {
  double const x = dot(across, mode.e1), y = dot(across, mode.e2);
  return x * x * mode.q11 + 2 * x * y * mode.q12 + y * y * mode.q22;
}

}  // namespace straytrace::beams
