// SPDX-License-Identifier: BSD-3-Clause
#include "wave/ring/ring_waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "wave/arm/arm_solver.hpp"
#include "wave/cavity_rims.hpp"
#include "wave/ring/ring_cavity.hpp"
#include "wave/transform.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

struct ComplexVec {
  std::array<Complex, 3> v{};
  void add(Complex size, Vec3 along) {
    v[0] += size * along.x;
    v[1] += size * along.y;
    v[2] += size * along.z;
  }
};

// Both along the axes of the scene.
struct Levers {
  ComplexVec displacement, rotation;  // about the point where the axis meets the plane
  Complex widening{};
};

// A plane that the light passes or is reflected by: the axis, and the coordinates of the light that comes and that
// goes.
struct StopFrame {
  Vec3 point;
  CrossFrame in, out;
  double hand;  // 1 where x, y and the travel of the light that comes are right-handed, else -1
};

StopFrame frame_at(RingCavity const& ring, std::size_t i) {
  std::size_t mirror = i;
  while (!ring.stops[mirror].mirror) ++mirror;  // the last is one
  MirrorFrame const& at = ring.frame_at(mirror);
  CrossFrame const& in = at.frame;
  double const left = ring.stops[mirror].along - ring.stops[i].along;
  return {at.point - left * in.travel, in, mirror == i ? in.behind(at.normal) : in,
          dot(cross(in.x, in.y), in.travel) < 0 ? -1.0 : 1.0};
}

// Fields that arrive at a stop from both sides, on its grid, in the coordinates of the light that comes. Times
// exp(i pi curvature rho^2/lambda) and over the scale they are those of the light (eq. W.54).
struct BothFields {
  Field forward, backward;
  double curvature_forward, curvature_backward, scale;
};

// A field without the spherical wave, and the derivatives that it has with it, across the light.
struct Slopes {
  Field value, dx, dy, laplacian;

  Slopes(Field const& field, double curvature, double wavelength, Transform const& transform)
      : value(field), dx(field), dy(field), laplacian(field) {
    Grid const& grid = field.grid;
    int const N = grid.points;
    transform.forward(dx, N, N);
    dy = laplacian = dx;
    for (int row = 0; row < N; ++row)
      for (int column = 0; column < N; ++column) {
        double const fx = 2 * pi * grid.frequency(column), fy = 2 * pi * grid.frequency(row);
        dx(row, column) *= Complex{0, fx};
        dy(row, column) *= Complex{0, fy};
        laplacian(row, column) *= -(fx * fx + fy * fy);
      }
    for (Field* f : {&dx, &dy, &laplacian}) transform.inverse(*f, N, N);
    if (curvature == 0) return;
    Complex const bend{0, 2 * pi / wavelength * curvature};  // i k c
    for (int row = 0; row < N; ++row)
      for (int column = 0; column < N; ++column) {
        double const x = grid.at(column), y = grid.at(row);
        Complex const z = value(row, column);
        laplacian(row, column) +=
            2.0 * bend * (x * dx(row, column) + y * dy(row, column)) + (2.0 * bend + bend * bend * (x * x + y * y)) * z;
        dx(row, column) += bend * x * z;
        dy(row, column) += bend * y * z;
      }
  }
};

double wave_number(Trip const& trip) { return 2 * pi / trip.wavelength; }
Grid grid_at(Trip const& trip, std::size_t i) { return {trip.grid.points, trip.grid.window * trip.stops[i].scale}; }

// M of a mirror with the spherical waves that the grid follows.
Field factor_of(Trip const& trip, std::size_t i, Mask const& outline) {
  return reflection(*trip.stops[i].mirror, outline, trip.wavelength, grid_at(trip, i),
                    followed_before(trip, i) - followed_behind(trip, i));
}

// eq. W.57, without 1/B: the fields on both sides of a mirror, moved against it.
Levers of_mirror(Trip const& trip, StopFrame const& at, Field const& factor, BothFields const& both,
                 Transform const& transform) {
  double const k = wave_number(trip);
  Slopes const f(both.forward, both.curvature_forward, trip.wavelength, transform),
      b(both.backward, both.curvature_backward, trip.wavelength, transform);
  Complex in_x, out_x, y, in_z, out_z, centre_x, centre_y, in_turn, out_turn;
  Grid const& grid = both.forward.grid;
  double const area = std::pow(trip.grid.pitch(), 2);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const at_x = grid.at(column), at_y = grid.at(row);
      Complex const m = area * factor(row, column), mf = m * f.value(row, column), mb = m * b.value(row, column);
      in_x += mb * f.dx(row, column);
      out_x += mf * b.dx(row, column);
      y += mb * f.dy(row, column) + mf * b.dy(row, column);
      in_z += mb * f.laplacian(row, column);
      out_z += mf * b.laplacian(row, column);
      centre_x += mf * b.value(row, column) * at_x;
      centre_y += mf * b.value(row, column) * at_y;
      in_turn += mb * (at_x * f.dy(row, column) - at_y * f.dx(row, column));
      out_turn += mf * (at_x * b.dy(row, column) - at_y * b.dx(row, column));
    }
  Complex const along{0, 1 / (2 * k)}, phase{0, k * at.hand};
  Levers levers;
  levers.displacement.add(in_x, at.in.x);
  levers.displacement.add(out_x, at.out.x);
  levers.displacement.add(y, at.in.y);
  levers.displacement.add(along * in_z, at.in.travel);
  levers.displacement.add(-along * out_z, at.out.travel);
  levers.rotation.add(at.hand * in_turn, at.in.travel);
  levers.rotation.add(-at.hand * out_turn, at.out.travel);  // a mirror image
  levers.rotation.add(phase * centre_y, at.in.x + at.out.x);
  levers.rotation.add(-2.0 * phase * centre_x, at.in.y);
  return levers;
}

// The edge as points on it and steps along it, counter-clockwise about the travel of the light, in the scene.
std::vector<RimPoint> rim_in_scene(InnerRim const& rim, Vec3 travel, int count) {
  double const sense = dot(cross(rim.e1, rim.e2), travel) > 0 ? 1 : -1;
  std::vector<RimPoint> points;
  if (!(rim.tooth_depth > 0)) {
    Vec3 const about = sense * 2 * pi / count * cross(rim.e1, rim.e2);
    for (int i = 0; i < count; ++i) {
      Vec3 const p = rim_point(rim, sense * 2 * pi * i / count);
      points.push_back({p, cross(about, p - rim.centre)});
    }
    return points;
  }
  int const flanks = std::max(1, int(2 * rim.teeth));  // whole ones, with two points on each at least
  count = flanks * std::max(2, count / flanks + 1);
  double const first = rim.phase;
  Vec3 last = rim_point(rim, first);
  for (int i = 1; i <= count; ++i) {
    Vec3 const next = rim_point(rim, first + sense * 2 * pi * i / count);
    points.push_back({0.5 * (last + next), next - last});
    last = next;
  }
  return points;
}

std::vector<WaveValue> values_on(std::vector<Vec3> const& places, Field const& field, double curvature, double scale,
                                 double wavelength, int threads) {
  std::vector<WaveValue> values = Sampler(field).at(places, threads);
  Complex const bend{0, 2 * pi / wavelength * curvature};
  for (std::size_t i = 0; i < values.size(); ++i) {
    WaveValue& v = values[i];
    double const x = places[i].x, y = places[i].y;
    Complex const wave = turned(curvature * (x * x + y * y) / (2 * wavelength)) / scale;
    v = {wave * v.value, wave * (v.dx + bend * x * v.value), wave * (v.dy + bend * y * v.value)};
  }
  return values;
}

// eq. W.14 with each light passing once, without 1/B; vectors of the scene, whose mirror images need no sign.
Levers of_edge(Trip const& trip, StopFrame const& at, InnerRim const& rim, BothFields const& both, int threads) {
  double const pitch = both.forward.grid.pitch(), k = wave_number(trip);
  std::vector<RimPoint> const points = rim_in_scene(rim, at.in.travel, points_along(2 * pi * rim.radius, pitch));
  std::vector<Vec3> places;
  for (RimPoint const& p : points)
    places.push_back({dot(p.place - at.point, at.in.x), dot(p.place - at.point, at.in.y), 0});
  auto const f = values_on(places, both.forward, both.curvature_forward, both.scale, trip.wavelength, threads),
             b = values_on(places, both.backward, both.curvature_backward, both.scale, trip.wavelength, threads);
  Complex const half{0, -1 / (2 * k)};  // 1/2ik
  Levers levers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 const step = points[i].step, from_axis = points[i].place - at.point;
    auto const add = [&](Complex size, Vec3 flux) {
      Vec3 const pull = cross(step, flux);
      levers.displacement.add(size, pull);
      levers.rotation.add(size, cross(from_axis, pull));
    };
    add(half * (b[i].value * f[i].dx - f[i].value * b[i].dx), at.in.x);  // eq. W.13
    add(half * (b[i].value * f[i].dy - f[i].value * b[i].dy), at.in.y);
    add(f[i].value * b[i].value, at.in.travel);
    levers.widening += length(step) * f[i].value * b[i].value;
  }
  return levers;
}

// x to -x on the grid. The column of the largest -x has no partner.
void turn_around(Field& field) {
  for (int row = 0; row < field.grid.points; ++row)
    std::reverse(&field(row, 0) + 1, &field(row, 0) + field.grid.points);
}

RimLevers sum_of(RimLevers a, Levers const& more, Vec3 from_reference, Complex overlap) {
  for (int i = 0; i < 3; ++i) {
    int const next = (i + 1) % 3, last = (i + 2) % 3;
    double const arm[] = {from_reference.x, from_reference.y, from_reference.z};
    auto const& t = more.displacement.v;
    a.displacement[i] += t[i] / overlap;
    a.rotation[i] += (more.rotation.v[i] + arm[next] * t[last] - arm[last] * t[next]) / overlap;
  }
  return a;
}

Vec3 vertex_of(World const& world, SurfaceId id) {
  return world.view().shapes.visit(world.surfaces()[id.value].shape,
                                   [](auto const& s) -> Vec3 { return s.reference(); });
}

// The integrals of the stops, as fields arrive the other way around.
class LeverSums {
 public:
  LeverSums(World const& world, RingCavity const& ring, RoundTrip const& way, std::vector<Field> forward)
      : world_(world), ring_(ring), way_(way), forward_(std::move(forward)), levers_(ring.stops.size()) {}

  void add(std::size_t i, Field backward) {
    Trip const& trip = ring_.trip;
    Grid const grid = grid_at(trip, i);
    BothFields both{std::move(forward_[i]), std::move(backward), followed_before(trip, i), -followed_behind(trip, i),
                    trip.stops[i].scale};
    both.forward.grid = both.backward.grid = grid;
    StopFrame const at = frame_at(ring_, i);
    if (ring_.stops[i].mirror) {
      Field const factor = factor_of(trip, i, way_.mask(i));
      if (i + 1 == ring_.stops.size()) overlap_ = overlap_of(factor, both);
      levers_[i] = of_mirror(trip, at, factor, both, way_.transform());
    } else {
      levers_[i] = of_edge(trip, at, *rim_of(world_, ring_.stops[i].surface), both, way_.threads());
    }
  }
  RingLevers result() const {
    RingLevers all{overlap_, {}, 0, {}};
    for (std::size_t i = 0; i < ring_.stops.size(); ++i) {
      RingStop const& stop = ring_.stops[i];
      auto found = std::ranges::find(all.surfaces, stop.surface, &SurfaceLevers::surface);
      if (found == all.surfaces.end()) {
        Vec3 const reference = stop.mirror ? vertex_of(world_, stop.surface) : rim_of(world_, stop.surface)->centre;
        found = all.surfaces.insert(found, {stop.surface, stop.mirror, reference, {}, {}});
      }
      found->levers = sum_of(found->levers, levers_[i], frame_at(ring_, i).point - found->reference, overlap_);
      found->widening += levers_[i].widening / overlap_;
    }
    return all;
  }

 private:
  // B is the same at every plane; of one where the spherical waves are in the factor.
  Complex overlap_of(Field const& factor, BothFields const& both) const {
    Complex sum = 0;
    for (std::size_t i = 0; i < factor.values.size(); ++i)
      sum += factor.values[i] * both.forward.values[i] * both.backward.values[i];
    return sum * std::pow(ring_.trip.grid.pitch(), 2);
  }

  World const& world_;
  RingCavity const& ring_;
  RoundTrip const& way_;
  std::vector<Field> forward_;
  std::vector<Levers> levers_;
  Complex overlap_;
};

}  // namespace

Trip reversed(Trip const& trip) {
  Trip back = trip;
  std::size_t const n = trip.stops.size();
  for (std::size_t i = 0; i < n; ++i) {
    back.stops[i] = trip.stops[i + 1 < n ? n - 2 - i : n - 1];
    back.stops[i].leg = trip.stops[n - 1 - i].leg;
  }
  if (!trip.mirrored) return back;
  TripStop& last = back.stops.back();
  last.opening.x = -last.opening.x;
  WaveMirror& mirror = *last.mirror;
  mirror.outline.x = last.opening.x;
  mirror.tilt_x = -mirror.tilt_x;
  int const N = trip.grid.points;
  for (auto line = mirror.height.begin(); line != mirror.height.end(); line += N) std::reverse(line + 1, line + N);
  return back;
}

RimLevers levers_about(SurfaceLevers const& surface, Vec3 point) {
  Levers same;
  std::ranges::copy(surface.levers.displacement, same.displacement.v.begin());
  std::ranges::copy(surface.levers.rotation, same.rotation.v.begin());
  return sum_of({}, same, surface.reference - point, 1);
}

RingLevers ring_levers(World const& world, RingCavity const& ring, RoundTrip const& way, WaveMode const& mode,
                       SolveOptions const& options) {
  std::size_t const n = ring.stops.size();
  RoundTrip const back(reversed(ring.trip), way.computing());
  auto const against = [&](std::size_t axis) {
    AxisBeam const& arriving = ring.stops.back().arriving[axis];
    return AxisBeam{arriving.radius, -arriving.curvature};
  };
  WaveMode const other = back.mode(back.hermite_gauss(against(0), against(1)), options);
  std::vector<Field> forward;
  Field work = mode.spectrum;
  way.travel(work, {[&](std::size_t, Field const& arriving) { forward.push_back(arriving); }, {}});
  LeverSums sums(world, ring, way, std::move(forward));
  work = other.spectrum;
  back.travel(work, {[&](std::size_t stop, Field const& arriving) {
                       if (stop + 1 < n) return sums.add(n - 2 - stop, arriving);
                       Field once = arriving;  // a round trip later, in the coordinates behind the mirror
                       if (ring.trip.mirrored) turn_around(once);
                       for (Complex& z : once.values) z /= other.eigenvalue;
                       sums.add(n - 1, std::move(once));
                     },
                     {}});
  RingLevers levers = sums.result();
  levers.eigenvalue = other.eigenvalue;
  levers.residual = other.residual;
  if (!std::isfinite(std::abs(levers.overlap)) || !(std::abs(levers.overlap) > 0))
    throw NumericalError("the levers of a ring are not finite: the fields of both directions do not overlap");
  return levers;
}

namespace {

void report(ArmOptions const& options, std::string const& what) {
  if (options.progress) options.progress(what);
}

RingWaves solve_planned(World const& world, WaveSettings const& settings, RingCavity ring, ArmOptions const& options) {
  throw_errors(ring.problems);
  add_ring_heights(ring, world, settings);
  RoundTrip trip(ring.trip, {int(thread_count(unsigned(options.threads))), options.device});
  auto const pure = [&](int n, int m) { return trip.hermite_gauss(ring.start[0], ring.start[1], n, m); };
  SolveOptions solve;
  solve.loss_error = 1e-7;  // of first order in the residual: the round trip is not symmetric
  solve.progress = [&](int trips, double residual) {
    report(options, fmt::format("round trip {}, residual {:.1e}", trips, residual));
  };
  WaveMode mode = [&] {
    try {
      return trip.mode(pure(0, 0), solve);
    } catch (NumericalError const& e) {
      throw InputError(fmt::format("wave: the cavity holds no mode that resembles a Gaussian beam: {}", e.what()),
                       "enlarge the mirrors and the openings of baffles, or change the curvatures");
    }
  }();
  if (mode.loss() > 0.01)
    ring.warnings.push_back(
        fmt::format("wave: the mode loses {:.2g} of its power per round trip: mirrors or baffles clip the beam itself",
                    mode.loss()));
  std::vector<ModeLine> modes;
  if (options.highest_order >= 0) {
    SolveOptions coarse;
    coarse.loss_error = 1e-2;
    coarse.progress = [&](int, double residual) {
      report(options, fmt::format("higher modes, residual {:.1e}", residual));
    };
    modes = mode_table(trip, pure, options.highest_order, coarse);
  }
  report(options, "balance of power");
  TripLosses losses = trip.losses(mode);
  solve.progress = [&](int trips, double residual) {
    report(options, fmt::format("the other way around, round trip {}, residual {:.1e}", trips, residual));
  };
  RingLevers levers = ring_levers(world, ring, trip, mode, solve);
  for (TripStop& stop : ring.trip.stops)
    if (stop.mirror) stop.mirror->height = {};  // the round trip has them
  return {
      std::move(ring), std::move(trip), std::move(mode), std::move(modes), std::move(losses), std::move(levers), {}};
}

// Of the displacements of all edges, or of all mirrors: the largest change over the rms.
double largest_change(RingLevers const& coarse, RingLevers const& finer, bool mirrors) {
  double largest = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < coarse.surfaces.size(); ++i) {
    if (coarse.surfaces[i].mirror != mirrors) continue;
    double change = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Complex const before = coarse.surfaces[i].levers.displacement[axis];
      change += std::norm(finer.surfaces[i].levers.displacement[axis] - before);
      squares += std::norm(before);
    }
    largest = std::fmax(largest, std::sqrt(change));
    ++count;
  }
  return squares > 0 ? largest / std::sqrt(squares / count) : not_a_number;
}

RingGridCheck difference(RingWaves const& finer, RingWaves const& coarse) {
  RingGridCheck check;
  check.points = finer.ring.trip.grid.points;
  check.loss = finer.mode.loss() - coarse.mode.loss();
  check.losses = finer.losses;
  for (std::size_t i = 0; i < check.losses.taken.size(); ++i) check.losses.taken[i] -= coarse.losses.taken[i];
  check.losses.beyond_band -= coarse.losses.beyond_band;
  check.phase = coarse.modes.empty() ? not_a_number : 0;
  for (std::size_t i = 0; i < std::min(finer.modes.size(), coarse.modes.size()); ++i)
    check.phase = std::fmax(check.phase, std::fabs(std::remainder(finer.modes[i].phase - coarse.modes[i].phase, 1.0)));
  check.edges = largest_change(coarse.levers, finer.levers, false);
  check.mirrors = largest_change(coarse.levers, finer.levers, true);
  return check;
}

}  // namespace

RingWaves solve_ring(World const& world, WaveSettings const& settings, RingCavity planned, ArmOptions const& options) {
  std::optional<WaveSettings> finer;  // first, since it may not exist
  if (options.grid_check) finer = finer_settings(settings, planned.crossover, planned.trip.grid);
  RingWaves waves = solve_planned(world, settings, std::move(planned), options);
  if (!finer) return waves;
  ArmOptions second = options;
  second.progress = [&](std::string const& what) { report(options, "finer grid, " + what); };
  waves.grid_check = difference(solve_planned(world, *finer, planned_ring(world, *finer), second), waves);
  return waves;
}

namespace {

struct DrivingBeam {
  Field spectrum;
  std::vector<double> orders;  // its shares in the modes of the mirrors
};

DrivingBeam driving_beam(WaveSettings::Input const& input, RingWaves const& waves, int highest_order) {
  auto const& start = waves.ring.start;
  auto const along = [&](std::size_t axis) {
    return AxisBeam{input.radius.value_or(start[axis].radius),
                    input.wavefront_curvature.value_or(start[axis].curvature), input.shift[axis], input.tilt[axis]};
  };
  DrivingBeam beam{waves.trip.hermite_gauss(along(0), along(1)), {}};
  Grid const& grid = waves.ring.trip.grid;
  double const unit_power = std::pow(grid.pitch() / grid.points, 2);
  for (int order = 0; order <= highest_order; ++order) {
    double share = 0;
    for (int m = 0; m <= order; ++m) {
      Field const mode = waves.trip.hermite_gauss(start[0], start[1], order - m, m);
      Complex sum = 0;
      for (std::size_t i = 0; i < mode.values.size(); ++i) sum += std::conj(mode.values[i]) * beam.spectrum.values[i];
      share += std::norm(sum * unit_power);
    }
    beam.orders.push_back(share);
  }
  return beam;
}

void check_entered(double entered, std::string const& mirror, std::vector<std::string>& warnings) {
  constexpr double most = 0.99, least = 0.01;
  if (entered >= most) return;
  std::string const what = fmt::format("only {:.2g} of the power of the input beam falls on '{}'", entered, mirror);
  if (entered < least) throw InputError(what, "check 'radius' and 'shift' of 'input', and their units");
  warnings.push_back("wave: " + what);
}

}  // namespace

DrivenScan drive_ring(World const& world, WaveSettings const& settings, RingWaves const& waves,
                      std::vector<MirrorCoating> const& coatings, std::vector<double> const& detunings,
                      DriveOptions const& options) {
  RingCavity const& ring = waves.ring;
  auto const coating_of = [&](SurfaceId surface) {
    auto const at = std::ranges::find(settings.mirrors, surface, &WaveSettings::Mirror::surface);
    return coatings[std::size_t(at - settings.mirrors.begin())];
  };
  std::vector<DrivenMirror> mirrors;
  DrivenScan driven;
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    if (!ring.stops[i].mirror) continue;
    mirrors.push_back({i, coating_of(ring.stops[i].surface)});
    driven.surfaces.push_back(ring.stops[i].surface);
    driven.coatings.push_back(mirrors.back().coating);
  }
  std::rotate(driven.surfaces.begin(), driven.surfaces.end() - 1, driven.surfaces.end());  // the last: the input mirror
  std::rotate(driven.coatings.begin(), driven.coatings.end() - 1, driven.coatings.end());
  driven.free_spectral_range = speed_of_light / ring.length();
  Field input = waves.mode.spectrum;
  if (settings.input) {
    DrivingBeam beam = driving_beam(*settings.input, waves, options.highest_order);
    driven.input_orders = std::move(beam.orders);
    input = std::move(beam.spectrum);
  }
  DrivenOptions const solve = solve_options(options);
  auto const pure = [&](int n, int m) { return waves.trip.hermite_gauss(ring.start[0], ring.start[1], n, m); };
  DrivenCavity const cavity(waves.trip, std::move(mirrors), pure, waves.mode.eigenvalue, input, detunings, solve);
  if (settings.input) check_entered(cavity.entered(), world.name_of(driven.surfaces[0]), driven.warnings);
  driven.take(cavity, detunings, solve);
  return driven;
}

}  // namespace straytrace::wave
