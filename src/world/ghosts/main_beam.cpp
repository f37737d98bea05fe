// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/main_beam.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "beams/overlap.hpp"
#include "geometry/shapes/shape.hpp"
#include "world/ghosts/apertures.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {
namespace {

RayShift operator+(RayShift const& a, RayShift const& b) { return {a.shift + b.shift, a.turn + b.turn}; }

Vec3 part_across(Vec3 v, Vec3 direction) { return v - dot(v, direction) * direction; }

// What a surface does to rays near the chief ray.
class Bend {
 public:
  Bend(World const& world, BeamStep const& step) : step_(step) {
    WorldView const view = world.view();
    normal_ = view.normal(step.surface, step.point, step.piece);
    curvature_ = view.shapes.visit(view.surfaces[step.surface.value].shape,
                                   [&](auto const& s) { return curvature_of(s, step.point, step.piece); });
    Vec3 const change = step.n_in * step.in - step.n_out * step.out;
    along_normal_ = dot(change, normal_);
    grating_ = change - along_normal_ * normal_;
  }

  // `moved`, `turned`: of the surface at the point of the chief ray.
  RayShift passed(RayShift const& in, Vec3 moved, Vec3 turned) const {
    double const ahead = dot(normal_, moved - in.shift) / dot(normal_, step_.in);
    Vec3 const meets = in.shift + ahead * step_.in;
    Vec3 const normal = cross(turned, normal_) - bent(meets - moved);  // its change
    Vec3 const change = step_.n_in * in.turn - along_normal_ * normal - cross(turned, grating_);
    double const longer = dot(change, step_.out) / dot(normal_, step_.out);
    return {part_across(meets, step_.out), (1 / step_.n_out) * (change - longer * normal_)};
  }

 private:
  Vec3 bent(Vec3 v) const {  // K v
    SurfaceCurvature const& c = curvature_;
    double const a = dot(v, c.a), b = dot(v, c.b);
    return (c.aa * a + c.ab * b) * c.a + (c.ab * a + c.bb * b) * c.b;
  }

  BeamStep const& step_;
  Vec3 normal_, grating_;  // grating_: the part of n_in a - n_out b along the surface
  SurfaceCurvature curvature_;
  double along_normal_ = 0;
};

// Displacement and rotation of a surface point by a coordinate of its body (eq. 2.1).
struct SurfaceMotion {
  Vec3 moved, turned;
};
SurfaceMotion motion_by(int coordinate, Vec3 from_pivot) {
  Vec3 const axis{double(coordinate % 3 == 0), double(coordinate % 3 == 1), double(coordinate % 3 == 2)};
  return coordinate < 3 ? SurfaceMotion{axis, {}} : SurfaceMotion{cross(axis, from_pivot), axis};
}

MovedRay& ray_of(std::vector<MovedRay>& rays, BodyId body) {
  auto const at = std::ranges::find(rays, body, &MovedRay::body);
  return at != rays.end() ? *at : rays.emplace_back(MovedRay{body});
}

void fly(std::vector<MovedRay>& rays, double distance) {
  for (MovedRay& r : rays)
    for (RayShift& s : r.by) s.shift = s.shift + distance * s.turn;
}

}  // namespace

std::vector<MovedRay> moved_rays(World const& world, std::span<BeamStep const> way, Vec3 at) {
  std::vector<MovedRay> rays;
  for (std::size_t i = 0; i < way.size(); ++i) {
    BeamStep const& step = way[i];
    if (i > 0) fly(rays, dot(step.point - way[i - 1].point, step.in));
    Bend const bend(world, step);
    for (MovedRay& r : rays)
      for (RayShift& s : r.by) s = bend.passed(s, {}, {});
    BodyId const body = world.surfaces()[step.surface.value].body;
    if (!body.valid()) continue;
    MovedRay& own = ray_of(rays, body);
    for (int q = 0; q < 6; ++q) {
      SurfaceMotion const m = motion_by(q, step.point - world.bodies()[body.value].pivot);
      own.by[std::size_t(q)] = own.by[std::size_t(q)] + bend.passed({}, m.moved, m.turned);
    }
  }
  if (!way.empty()) fly(rays, dot(at - way.back().point, way.back().out));
  return rays;
}

namespace {

constexpr double in_line = 0.2;  // rad: beams farther apart have negligible overlap

// Field as a vector of space.
struct Field {
  std::complex<double> x, y, z;
};
Field in_space(Jones const& j, Vec3 axis, Vec3 travel) {
  Vec3 const other = cross(travel, axis);
  std::complex<double> const a(j.a.re, j.a.im), b(j.b.re, j.b.im);
  return {a * axis.x + b * other.x, a * axis.y + b * other.y, a * axis.z + b * other.z};
}
std::complex<double> product(Field const& u, Field const& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
Field conjugate(Field const& u) { return {std::conj(u.x), std::conj(u.y), std::conj(u.z)}; }

std::complex<double> turned(double phase) { return std::polar(1.0, phase); }

// Relative to the main beam that leaves with it: E_main* . E_ghost over |E_main|, by state. Rims apart.
std::array<std::complex<double>, 2> with_main(LeavingBeam const& ghost, LeavingBeam const& main, double k) {
  std::complex<double> const shape =
      overlap(ghost.mode, main.mode) * turned(k * (ghost.path_length - main.path_length) - (ghost.gouy - main.gouy));
  double const power = main.field.power() * main.field.states;
  std::array<std::complex<double>, 2> field{};
  for (std::size_t i = 0; i < std::size_t(main.field.states); ++i) {
    Jones const& j = main.field.state[i];
    double const size = norm(j.a) + norm(j.b);
    if (!(size > 0)) continue;
    field[i] = shape / std::sqrt(size * power) *
               product(conjugate(in_space(j, main.field.axis, main.mode.travel)),
                       in_space(ghost.field.state[i], ghost.field.axis, ghost.mode.travel));
  }
  return field;
}

using Complex = std::complex<double>;

// p of eq. N.11's t^p, where t is the share of the power that a rim takes and t^p the part of the field that it takes
// from the mode `heard` there; 1: the same mode.
Complex power_of_shadow(RimCut const& cut, Mode const& heard) {
  auto const mean = [](Mode const& m) { return 0.5 * (m.q11 + m.q22); };
  Complex const sent = mean(cut.mode);
  return Complex(0, -0.5) * (sent - std::conj(mean(heard))) / sent.imag();
}

// What a rim leaves of the field in the mode `heard` there, both about one axis, over the root of the share of the
// power that it leaves. Of a round hole exactly: integral of u_heard* u over its inside, eq. 5.7 and N.11.
Complex kept_by(RimCut const& cut, Mode const& heard) {
  double const left = cut.reflected ? cut.taken : 1 - cut.taken;
  if (!(left > 0)) return 0;
  if (cut.again) return 1 / std::sqrt(left);
  Complex const shadow = std::exp(power_of_shadow(cut, heard) * std::log(cut.taken));
  return (cut.reflected ? shadow : 1.0 - shadow) / std::sqrt(left);
}

// d ln(1 - t^p)/dt, or of t^p; `p` as power_of_shadow.
RimSlope slope_of(RimCut const& cut, Complex p) {
  RimSlope slope{cut.by, cut.mode, cut.taken, 0};
  if (cut.again || !(cut.taken > 0)) return slope;
  Complex const shadow = std::exp(p * std::log(cut.taken)), change = p * shadow / cut.taken;
  slope.of_taken = cut.reflected ? p / cut.taken : -change / (1.0 - shadow);
  return slope;
}

Mode along(Mode m, Vec3 travel, Vec3 origin) {
  m.origin = origin;
  m.travel = travel;
  m.e1 = unit(m.e1 - dot(m.e1, travel) * travel);
  m.e2 = cross(travel, m.e1);
  return m;
}

// The mode that becomes `target` behind the last surface, where the rim cuts the beam. Gratings: that of the beam.
Mode heard_at(WorldView const& view, RimCut const& cut, Mode const& target, std::span<BeamStep const> way) {
  Mode back = reversed(target);
  for (std::size_t i = way.size(); i-- > cut.steps;) {
    BeamStep const& step = way[i];
    if (step.event == Event::diffract) return cut.mode;
    back = along(back, -step.out, step.point);
    Vec3 const normal = view.normal(step.surface, step.point, step.piece);
    SurfaceCurvature const curvature = view.shapes.visit(view.surfaces[step.surface.value].shape, [&](auto const& s) {
      return curvature_of(s, step.point, step.piece);
    });
    if (step.event == Event::reflect)
      back = reflected(back, normal, curvature);
    else if (step.n_in != step.n_out)
      back = refracted(back, normal, curvature, step.n_out, step.n_in);
    Vec3 const before = i > cut.steps ? way[i - 1].point : cut.mode.origin;
    back = propagated(back, length(step.point - before));
  }
  return reversed(back);
}

// Of the main beam, into its own mode.
double kept_of_main(RimCut const& cut, bool again) {
  double const root = std::sqrt(std::max(1 - cut.taken, 1e-300));
  return again || cut.again ? 1 / root : root;
}

// Of ln of a field that has passed the rims.
struct RimFactor {
  Complex factor = 1;
  std::vector<RimSlope> slopes;
  void ghost(RimCut const& cut, Mode const& heard) {
    factor *= kept_by(cut, heard);
    slopes.push_back(slope_of(cut, power_of_shadow(cut, heard)));
  }
  void main(RimCut const& cut, double kept, double sign) {
    factor *= sign > 0 ? kept : 1 / kept;
    slopes.push_back(slope_of(cut, 1));
    slopes.back().of_taken *= sign;
  }
};

// With the main beam: rims that both have passed are in both.
RimFactor rims_with(WorldView const& view, LeavingBeam const& ghost, LeavingBeam const& main,
                    std::span<BeamStep const> way) {
  std::size_t both = 0;
  while (both < ghost.cuts.size() && both < main.cuts.size() && ghost.cuts[both].by == main.cuts[both].by &&
         ghost.cuts[both].at == main.cuts[both].at && !ghost.cuts[both].reflected)
    ++both;
  RimFactor all;
  for (std::size_t i = both; i < ghost.cuts.size(); ++i)
    all.ghost(ghost.cuts[i], heard_at(view, ghost.cuts[i], main.mode, way));
  for (std::size_t i = both; i < main.cuts.size(); ++i) all.main(main.cuts[i], kept_of_main(main.cuts[i], false), -1);
  return all;
}

// Against it: the rims of the main beam cut the mode again on the way back, but for one just passed, K^2 = K.
RimFactor rims_against(WorldView const& view, LeavingBeam const& ghost, BeamSpot const& main,
                       std::span<BeamStep const> way) {
  RimFactor all;
  for (RimCut const& cut : ghost.cuts) all.ghost(cut, heard_at(view, cut, reversed(main.mode), way));
  for (std::size_t i = 0; i < main.cuts.size(); ++i) {
    RimCut const& cut = main.cuts[i];
    bool const sharp =
        i + 1 == main.cuts.size() && !ghost.cuts.empty() &&
        ghost.cuts.back().repeats_in(cut, ghost.path_length - ghost.cuts.back().at + main.path_length - cut.at);
    all.main(cut, kept_of_main(cut, sharp), 1);
    if (sharp) all.slopes.back().of_taken = 0;
  }
  return all;
}

// Into the reversed main beam, as it arrives at the plane of the launch: by reciprocity E_main . E_ghost at the
// surface, without a conjugate. Rims apart.
std::array<std::complex<double>, 2> against_main(LeavingBeam const& ghost, BeamSpot const& main, double k) {
  std::complex<double> const shape = overlap(ghost.mode, reversed(main.mode)) *
                                     turned(k * (ghost.path_length + main.path_length) - (ghost.gouy + main.gouy));
  std::array<std::complex<double>, 2> field{};
  for (std::size_t i = 0; i < std::size_t(main.field.states); ++i)
    field[i] = shape / std::sqrt(double(main.field.states)) *
               product(in_space(main.field.state[i], main.field.axis, main.mode.travel),
                       in_space(ghost.field.state[i], ghost.field.axis, ghost.mode.travel));
  return field;
}

bool same_medium(Mode const& a, Mode const& b) { return std::fabs(a.wavelength / b.wavelength - 1) < 1e-9; }

// Collects the main beam, which is all of order 0.
class MainSink final : public BeamSink {
 public:
  MainSink(World const& world, std::vector<MainNode>& nodes, std::vector<MainNode>& screens)
      : world_(world), nodes_(nodes), screens_(screens) {}
  void arrived(BeamSpot const& spot, std::uint32_t number, std::span<BeamStep const> way) override {
    if (nodes_.size() >= MainBeam::most_nodes) {
      complete = false;
      return;
    }
    node_of_spot_[number] = std::uint32_t(nodes_.size());
    MainNode node;
    node.spot = spot;
    node.way.assign(way.begin(), way.end());
    node.phase_sensitivities = phase_sensitivities_of_way(world_, way, 2 * pi / world_.wavelength);
    node.moved = moved_rays(world_, way, spot.mode.origin);
    nodes_.push_back(std::move(node));
  }
  // A place where what the screen reflects may come into line.
  void screened(ScreenSpot const& s, std::span<BeamStep const> way) override {
    if (screens_.size() >= MainBeam::most_nodes) return;
    MainNode node;
    node.screen = true;
    node.spot.surface = s.screen.surface;
    node.spot.mode = s.screen.mode;
    node.spot.index = s.index;
    node.spot.power = s.power;
    node.spot.field = s.field;
    node.spot.cuts = s.cuts;
    node.spot.path_length = s.path_length;
    node.spot.gouy = s.gouy;
    node.way.assign(way.begin(), way.end());
    node.phase_sensitivities = phase_sensitivities_of_way(world_, way, 2 * pi / world_.wavelength);
    node.moved = moved_rays(world_, way, s.screen.mode.origin);
    screens_.push_back(std::move(node));
  }
  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    if (way.empty()) return;
    auto const at = node_of_spot_.find(way.back().spot);
    if (at == node_of_spot_.end()) return;
    nodes_[at->second].ways.push_back({beam, way.back().event, way.back().diffracted,
                                       phase_sensitivities_of_way(world_, way, 2 * pi / world_.wavelength),
                                       moved_rays(world_, way, beam.mode.origin)});
  }
  bool complete = true;

 private:
  World const& world_;
  std::vector<MainNode>&nodes_, &screens_;
  std::map<std::uint32_t, std::uint32_t> node_of_spot_;
};

void add(std::vector<PhaseSensitivity>& to, std::vector<PhaseSensitivity> const& what, double factor) {
  for (PhaseSensitivity const& l : what) phase_sensitivity_of(to, l.body).add(l, factor);
}

// Moments of a way of this length with the time to its end, from those with the time since its start.
std::vector<PhaseSensitivity> until_the_end(std::vector<PhaseSensitivity> way, double length) {
  for (PhaseSensitivity& s : way)
    for (int i = 0; i < 6; ++i) s.moment[i] = s.d[i] * length / speed_of_light - s.moment[i];
  return way;
}

// A ghost and its reverse add as fields and meet a body as long before the end as after the start: in the mean after
// half of the way (docs/theory/time_domain.md).
void delay_by_half(std::vector<PhaseSensitivity>& way, double length) {
  for (PhaseSensitivity& s : way)
    for (int i = 0; i < 6; ++i) s.moment[i] = s.d[i] * length / (2 * speed_of_light);
}

}  // namespace

MainBeam::MainBeam(World const& world, BeamLaunch const& launch, TreeLimits limits) : world_(world), launch_(launch) {
  limits.order = 0;
  std::vector<MainNode> screens;
  MainSink sink(world, nodes_, screens);
  grow_tree(world, launch, limits, sink);
  complete_ = sink.complete;
  std::size_t const surfaces = nodes_.size();
  for (MainNode& s : screens) {
    on_screen_.emplace(s.spot.surface.value, std::uint32_t(nodes_.size()));
    nodes_.push_back(std::move(s));
  }
  for (std::uint32_t i = 0; i < surfaces; ++i) on_surface_.emplace(nodes_[i].spot.surface.value, i);
}

// The lines it aligns with at one surface, and the nearest in direction.
struct MainBeam::Candidate {
  WorldView view;
  std::span<BeamStep const> way;  // of the ghost
  GhostAlignment best;
  bool found = false, already = false;  // a new line; the one it is in already

  void look(GhostAlignment const& at, bool same, double k, LeavingBeam const& ghost, MainNode const& node) {
    if (!best.known || at.angle < best.angle) {
      Recoupling const kept = best.recoupled;
      best = at;
      best.recoupled = kept;
    }
    Recoupling r = at.recoupled;
    Mode const& main = r.against ? node.spot.mode : node.ways[r.way].beam.mode;
    if (!(at.angle < in_line) || !same_medium(ghost.mode, main)) return;
    if (same) {
      already = true;
      return;
    }
    r.field = r.against ? against_main(ghost, node.spot, k) : with_main(ghost, node.ways[r.way].beam, k);
    RimFactor rims =
        r.against ? rims_against(view, ghost, node.spot, way) : rims_with(view, ghost, node.ways[r.way].beam, way);
    for (Complex& state : r.field) state *= rims.factor;
    if (found && !(r.share() > best.recoupled.share())) return;
    found = true;
    Mode const heard = r.against ? reversed(main) : main;
    r.ghost = overlap_slope(ghost.mode, heard);
    r.main = overlap_slope(heard, ghost.mode);
    r.rims = std::move(rims.slopes);
    best.recoupled = std::move(r);
  }
};

GhostAlignment MainBeam::standing(GhostAlignment const& before, LeavingBeam const& ghost,
                                  std::span<BeamStep const> way) const {
  if (ghost.order == 0 || way.empty()) return {};
  BeamStep const& step = way.back();
  double const k = 2 * pi / world_.wavelength;
  auto const [first, last] = (step.off_screen ? on_screen_ : on_surface_).equal_range(step.surface.value);
  Candidate all{world_.view(), way, {}};
  for (auto at = first; at != last; ++at) {
    MainNode const& node = nodes_[at->second];
    bool const split = node.ways.size() > 1;
    bool goes_so = false;
    for (std::uint32_t w = 0; w < node.ways.size(); ++w) {
      MainNode::Way const& main = node.ways[w];
      bool const same = main.event == step.event && main.diffracted == step.diffracted;
      goes_so = goes_so || same;
      GhostAlignment s{true,
                       false,
                       angle_between(ghost.mode.travel, main.beam.mode.travel),
                       ghost.path_length - main.beam.path_length,
                       {true, false, at->second, w, way.size(), {}}};
      all.look(s, same && !split, k, ghost, node);
    }
    GhostAlignment s{true,
                     true,
                     angle_between(ghost.mode.travel, -node.spot.mode.travel),
                     ghost.path_length + node.spot.path_length,
                     {true, true, at->second, 0, way.size(), {}}};
    all.look(s, goes_so && !split, k, ghost, node);
  }
  if (first == last) {  // not a surface of the main beam: light departing here is separate
    GhostAlignment s = before;
    if (step.departure || step.weaker) s.recoupled = {};  // light that splits later has aligned once
    return s;
  }
  if (!all.found) all.best.recoupled = all.already ? before.recoupled : Recoupling{};
  return all.best;
}

std::vector<PhaseSensitivity> MainBeam::phase_sensitivities(Recoupling const& r, std::span<BeamStep const> way) const {
  if (!r.any) return {};
  auto phase_sensitivities = phase_sensitivities_of_way(world_, way.first(r.steps), 2 * pi / world_.wavelength);
  MainNode const& node = nodes_[r.node];
  double const length = r.steps > 0 ? way[r.steps - 1].path_length : 0;
  if (r.against) {
    add(phase_sensitivities, node.phase_sensitivities, 1);  // the return path: each hit adds the same again
    delay_by_half(phase_sensitivities, length + node.spot.path_length);
    if (!launch_.cavity.empty() && !launch_.span)  // the mode itself is reflected there
      add_hit(phase_sensitivities, world_, launch_.arrives_at, launch_.mode.origin,
              -4 * pi / world_.wavelength * launch_.mode.travel);
  } else {
    phase_sensitivities = until_the_end(std::move(phase_sensitivities), length);
    MainNode::Way const& main = node.ways[r.way];
    add(phase_sensitivities, until_the_end(main.phase_sensitivities, main.beam.path_length), -1);
  }
  std::ranges::sort(phase_sensitivities,
                    [](PhaseSensitivity const& a, PhaseSensitivity const& b) { return a.body < b.body; });
  return phase_sensitivities;
}

namespace {

OverlapLever& lever_of(std::vector<OverlapLever>& all, BodyId body) {
  auto const at = std::ranges::find(all, body, &OverlapLever::body);
  return at != all.end() ? *at : all.emplace_back(OverlapLever{body});
}

// The round edge that cuts a beam: of the hole of a screen, or the outline of a surface that it meets.
std::optional<Aperture> round_rim(World const& world, RimSlope const& cut) {
  std::vector<Aperture> edges;
  if (auto const hole = rim_of(world, cut.by); hole && hole->tooth_depth == 0)
    edges.push_back({hole->centre, hole->axis, hole->radius});
  for (FlatRim const& f : flat_rims(world.view(), cut.by)) {
    bool const round = f.outer.sides == 0 && f.outer.semi_x == f.outer.semi_y;
    if (round) edges.push_back({f.centre, f.axis, f.outer.semi_x});
  }
  for (Aperture const& edge : edges)  // that which takes this share
    if (std::fabs(clipped_share(edge, cut.mode) / cut.taken - 1) < 0.05) return edge;
  return {};
}

Aperture displaced(Aperture rim, Vec3 pivot, int coordinate, double by) {
  Vec3 const axis{double(coordinate % 3 == 0), double(coordinate % 3 == 1), double(coordinate % 3 == 2)};
  if (coordinate < 3) {
    rim.centre = rim.centre + by * axis;
    return rim;
  }
  rim.centre = rim.centre + by * cross(axis, rim.centre - pivot);
  rim.normal = unit(rim.normal + by * cross(axis, rim.normal));
  return rim;
}

// By the motion of a rim, eq. 5.6 with differences of second order.
void add_rim(std::vector<OverlapLever>& levers, World const& world, RimSlope const& cut) {
  BodyId const body = world.surfaces()[cut.by.value].body;
  if (!body.valid() || cut.of_taken == 0.0) return;
  std::optional<Aperture> const rim = round_rim(world, cut);
  if (!rim) return;
  Vec3 const pivot = world.bodies()[body.value].pivot;
  double const w = spot(cut.mode).minor, shift = 1e-3 * std::min(w, w * w / (4 * rim->radius)),
               turn = shift / std::max(length(rim->centre - pivot), rim->radius);
  OverlapLever& lever = lever_of(levers, body);
  for (int i = 0; i < 6; ++i) {
    double const step = i < 3 ? shift : turn;
    double const change = clipped_share(displaced(*rim, pivot, i, step), cut.mode) -
                          clipped_share(displaced(*rim, pivot, i, -step), cut.mode);
    if (std::fabs(change) > 1e-9 * cut.taken) lever.d[std::size_t(i)] += cut.of_taken * change / (2 * step);
  }
}

}  // namespace

std::vector<RimSlope> MainBeam::rims_without_lever(Recoupling const& r) const {
  std::vector<RimSlope> some;
  for (RimSlope const& cut : r.rims)
    if (cut.of_taken != 0.0 && world_.surfaces()[cut.by.value].body.valid() && !round_rim(world_, cut))
      some.push_back(cut);
  return some;
}

std::vector<OverlapLever> MainBeam::overlap_levers(Recoupling const& r, std::span<BeamStep const> way) const {
  std::vector<OverlapLever> levers;
  if (!r.any || r.steps == 0) return levers;
  std::span<BeamStep const> const passed = way.first(r.steps);
  MainNode const& node = nodes_[r.node];
  for (MovedRay const& ray : moved_rays(world_, passed, passed.back().point))
    for (std::size_t i = 0; i < 6; ++i) lever_of(levers, ray.body).d[i] += r.ghost.of(ray.by[i].shift, ray.by[i].turn);
  double const side = r.against ? -1 : 1;  // the reversed mode turns the other way
  for (MovedRay const& ray : r.against ? node.moved : node.ways[r.way].moved)
    for (std::size_t i = 0; i < 6; ++i)
      lever_of(levers, ray.body).d[i] += std::conj(r.main.of(ray.by[i].shift, side * ray.by[i].turn));
  for (RimSlope const& cut : r.rims) add_rim(levers, world_, cut);
  double const rounding = 1e-9 * 2 * pi / world_.wavelength;
  for (OverlapLever& lever : levers)
    for (Complex& d : lever.d)
      d = {std::fabs(d.real()) > rounding ? d.real() : 0, std::fabs(d.imag()) > rounding ? d.imag() : 0};
  std::ranges::sort(levers, {}, [](OverlapLever const& l) { return l.body.value; });
  return levers;
}

namespace {

class Rows final : public BeamSink {
 public:
  Rows(World const& world, MainBeam const& main, std::function<void(Ghost const&)> const& each)
      : world_(world), main_(main), each_(each) {}

  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    standing_.resize(way.size() + 1);
    if (!way.empty()) standing_.back() = main_.standing(standing_[way.size() - 1], beam, way);
  }
  void ended(BeamEnd how, BeamSpot const* spot, LeavingBeam const& beam, std::span<BeamStep const> way) override {
    Ghost ghost;
    ghost.number = ++count_;
    ghost.end = how;
    ghost.order = beam.order;
    if (spot) {
      ghost.where = world_.surfaces()[spot->surface.value].group;
      ghost.front = spot->front;
      ghost.clipped = spot->clipped;
    }
    ghost.point = beam.mode.origin;
    ghost.travel = beam.mode.travel;
    ghost.power = beam.field.power();
    ghost.spot = beams::spot(beam.mode);
    ghost.path_length = beam.path_length;
    if (way.size() < standing_.size()) ghost.standing = standing_[way.size()];
    ghost.way = way;
    each_(ghost);
  }

 private:
  World const& world_;
  MainBeam const& main_;
  std::function<void(Ghost const&)> const& each_;
  std::vector<GhostAlignment> standing_;  // behind each surface of the way; the first: as launched
  std::uint64_t count_ = 0;
};

}  // namespace

BeamEnergyBalance find_ghosts(World const& world, BeamLaunch const& launch, TreeLimits const& limits,
                              MainBeam const& main, std::function<void(Ghost const&)> const& each) {
  Rows rows(world, main, each);
  return grow_tree(world, launch, limits, rows);
}

}  // namespace straytrace::world
