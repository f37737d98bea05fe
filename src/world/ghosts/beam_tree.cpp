// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/beam_tree.hpp"

#include <algorithm>
#include <array>

#include "geometry/shapes/shape.hpp"
#include "optics/coating/specular.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::world {
namespace {

constexpr double weaker = 0.5,
                 slight = 0.1;  // limits of a departure: relative to the other way; reflected, to the arriving power
constexpr double least_cut = 1e-6;  // share of the power below which a rim leaves the mode as it is
constexpr double least_met = 0.01;  // share of a beam that must meet a surface for it to continue

void scale(BeamField& field, double power) {
  double const factor = std::sqrt(power);
  for (Jones& j : field.state) j = {factor * j.a, factor * j.b};
}

// A pending beam, and the step by which it leaves.
struct Branch {
  LeavingBeam beam;
  BeamStep step;
  Departure from;
  MediaStack media;
  std::size_t depth = 0;  // steps on its way; 0: the launched beam
  double beside = -1;     // share of the arriving power that passes beside the next surface; < 0: unknown
};

struct Way {
  BeamField field;
  double power = 0;
  bool through = false, departure = false;
  SpecularWay order = {};  // of a grating
};

class Tree {
 public:
  Tree(World const& world, BeamLaunch const& launch, TreeLimits const& limits, BeamSink& sink)
      : view_(world.view()), screens_(view_), launch_(launch), limits_(limits), sink_(sink) {
    energy_balance_.objects.resize(world.groups().size());
  }

  BeamEnergyBalance grow() {
    Branch first;
    first.beam.mode = launch_.mode;
    first.beam.field = launch_.field;
    if (launch_.leaves.surface.valid()) first.from = launch_.leaves;
    enter_glass(first);
    if (launch_.arrives_at.valid())
      arrive(first, {launch_.arrives_at, 0, launch_.piece});
    else
      waiting_.push_back(first);
    while (!waiting_.empty() && energy_balance_.beams < limits_.beams && !(limits_.stop && *limits_.stop)) {
      Branch const branch = waiting_.back();
      waiting_.pop_back();
      follow(branch);
    }
    for (Branch const& branch : waiting_) energy_balance_.stopped += branch.beam.field.power();
    return energy_balance_;
  }

 private:
  // A launch that leaves a surface against its normal starts in the volume behind.
  void enter_glass(Branch& first) const {
    SurfaceId const id = first.from.surface;
    if (!id.valid() || view_.surfaces[id.value].volume == Surface::none) return;
    std::uint32_t const volume = view_.surfaces[id.value].volume;
    if (dot(view_.normal(id, first.beam.mode.origin, first.from.piece), first.beam.mode.travel) < 0)
      first.media.enter(volume);
  }
  void follow(Branch const& branch) {
    way_.resize(branch.depth > 0 ? branch.depth - 1 : 0);
    if (branch.depth > 0) way_.push_back(branch.step);
    sink_.left(branch.beam, way_);
    if (back_in_cavity(branch)) return end(BeamEnd::rejoined, energy_balance_.rejoined, branch);
    Mode const& mode = branch.beam.mode;
    Hit const hit = view_.closest({mode.origin, mode.travel}, branch.from);
    Branch arriving = branch;
    double const kept = kept_along(view_, branch.media, hit.surface.valid() ? hit.distance : 0);
    if (kept < 1) {
      energy_balance_.media += (1 - kept) * branch.beam.field.power();
      scale(arriving.beam.field, kept);
    }
    pass_screens(arriving, hit);
    if (joins_network(branch.beam, hit.surface.valid() ? hit.distance : infinity))
      return end(BeamEnd::rejoined, energy_balance_.rejoined, arriving);
    if (!hit.surface.valid()) return end(BeamEnd::escaped, energy_balance_.escaped, arriving);
    arrive(arriving, hit);
  }

  // Screens off the chief ray remove their share.
  void pass_screens(Branch& branch, Hit const& hit) {
    LeavingBeam& beam = branch.beam;
    double const power = beam.field.power();
    std::uint32_t const volume = branch.media.depth > 0 ? branch.media.current() : Surface::none;
    double const least = std::clamp(limits_.floor / power, 1e-17, 1e-3);
    FlightLoss const loss = screens_.loss({beam.mode, branch.from, hit, volume, least});
    branch.beside = loss.beside;
    if (loss.screens.empty()) return;
    for (Screened const& s : loss.screens) book(branch, s, power);
    add_cut(beam, loss, branch.depth);
    scale(beam.field, std::max(0.0, 1 - loss.taken()));
  }
  static void add_cut(LeavingBeam& beam, FlightLoss const& loss, std::size_t steps) {
    if (!(loss.taken() > least_cut)) return;
    Screened const& most = *std::ranges::max_element(loss.screens, {}, &Screened::share);
    RimCut cut{most.surface, most.mode, steps, beam.path_length + most.along, loss.taken()};
    cut.again = !beam.cuts.empty() && beam.cuts.back().repeats_in(cut, cut.at - beam.cuts.back().at);
    beam.cuts.push_back(cut);
  }
  void book(Branch const& branch, Screened const& screen, double power) {
    LeavingBeam const& beam = branch.beam;
    Vertex const vertex = make_vertex(view_, screen.surface, screen.point, beam.mode.travel, screen.piece);
    double const index = view_.wavelength / beam.mode.wavelength;
    reflect_off(branch, screen, vertex);
    sink_.screened({screen, vertex.front, power, beam.path_length + index * screen.along,
                    beam.gouy + gouy(beam.mode, screen.along), index, beam.field, beam.cuts, beam.order},
                   way_);
  }

  // What a flat screen reflects continues as a ghost about a chief ray in the hole; all else that it takes lands.
  void reflect_off(Branch const& branch, Screened const& screen, Vertex vertex) {
    LeavingBeam const& beam = branch.beam;
    find_media(view_, branch.media, beam.mode.travel, vertex);
    BeamSpot spot;
    spot.surface = screen.surface;
    spot.piece = screen.piece;
    spot.front = vertex.front;
    spot.normal = vertex.frame.e3;
    spot.mode = screen.mode;
    spot.index = vertex.n_in;
    spot.field = beam.field;
    scale(spot.field, screen.share);
    spot.power = spot.field.power();
    spot.path_length = beam.path_length + vertex.n_in * screen.along;
    spot.cuts = beam.cuts;
    spot.cuts.push_back({screen.surface, screen.mode, branch.depth, spot.path_length, screen.share, true});
    spot.gouy = beam.gouy + gouy(beam.mode, screen.along);
    spot.order = beam.order;
    auto [back, through] = ways(spot, vertex, false);
    bool const goes_on = !vertex.optic->diffracts && flat_rims(view_, screen.surface).size() == 1;
    double const lands = through.power + (goes_on ? 0 : back.power);
    BeamEnergyBalance::Object& object = energy_balance_.objects[view_.surfaces[screen.surface.value].group.value];
    object.landed += lands;
    if (spot.order > 0) object.ghosts += lands;
    if (!goes_on || !(back.power > 0)) return;
    back.departure = true;
    std::uint32_t const order = spot.order + 1;
    if (order > limits_.order)
      energy_balance_.order += back.power;
    else if (back.power < limits_.floor)
      energy_balance_.floor += back.power;
    else if (branch.depth >= limits_.longest)
      energy_balance_.longest += back.power;
    else {
      waiting_.push_back(leave(branch, spot, branch.step.spot, vertex, back, order, false, true));
      waiting_.back().step.point = spot.mode.origin;
      waiting_.back().step.off_screen = true;
    }
  }

  void end(BeamEnd how, LongSum& column, Branch const& branch) {
    column += branch.beam.field.power();
    ++energy_balance_.beams;
    sink_.ended(how, nullptr, branch.beam, way_);
  }

  bool is_back_of_mirror(SurfaceId surface, bool front) const {
    auto const& mirrors = launch_.cavity;
    return !front && std::ranges::find(mirrors, surface) != mirrors.end();
  }
  bool back_in_cavity(Branch const& branch) const {
    return branch.step.event == Event::transmit && is_back_of_mirror(branch.step.surface, branch.step.front);
  }

  // Whether a beam runs in line with the light of the network at one of its ends: on the surface that it meets, or in a
  // plane before that.
  static bool in_line(NetworkSpan::End const& e, Mode const& mode, Vec3 at) {
    double const divergence = mode.wavelength / (pi * e.radius);
    return angle_between(e.travel, mode.travel) < 5 * divergence && length(at - e.point) < e.radius;
  }
  bool joins_network(BeamSpot const& spot) const {
    return launch_.span && std::ranges::any_of(launch_.span->ends, [&](NetworkSpan::End const& e) {
             return e.surface == spot.surface && in_line(e, spot.mode, spot.mode.origin);
           });
  }
  bool joins_network(LeavingBeam const& beam, double distance) const {
    if (!launch_.span) return false;
    double const index = view_.wavelength / beam.mode.wavelength;
    if (beam.order == 0 && beam.path_length + index * distance > launch_.span->longest + 1e-3) return true;
    return std::ranges::any_of(launch_.span->ends, [&](NetworkSpan::End const& e) {
      double const along = dot(e.point - beam.mode.origin, beam.mode.travel);
      return !e.surface.valid() && along > 0 && along < distance &&
             in_line(e, beam.mode, beam.mode.origin + along * beam.mode.travel);
    });
  }

  void arrive(Branch const& branch, Hit const& hit) {
    bool const launched_here = branch.depth == 0 && launch_.arrives_at.valid();
    LeavingBeam const& beam = branch.beam;
    Vec3 const travel = beam.mode.travel;
    Vertex vertex = make_vertex(view_, hit.surface, beam.mode.origin + hit.distance * travel, travel, hit.piece);
    find_media(view_, branch.media, travel, vertex);
    BeamSpot spot;
    spot.surface = hit.surface;
    spot.piece = hit.piece;
    spot.front = vertex.front;
    spot.normal = vertex.frame.e3;
    spot.mode = hit.distance > 0 ? propagated(beam.mode, hit.distance) : beam.mode;
    spot.mode.origin = vertex.point;
    spot.index = vertex.n_in;
    spot.field = beam.field;
    spot.power = beam.field.power();
    spot.cuts = beam.cuts;
    spot.clipped = branch.beside >= 0 ? branch.beside : beside_rim(view_, hit.surface, spot.mode);
    spot.path_length = beam.path_length + vertex.n_in * hit.distance;
    spot.gouy = beam.gouy + (hit.distance > 0 ? gouy(beam.mode, hit.distance) : 0);
    spot.parent = branch.depth > 0 ? branch.step.spot : BeamSpot::none;
    spot.event = branch.depth > 0 ? branch.step.event : Event::start;
    spot.order = std::max(beam.order, branch.media.depth > 0 ? rounds(spot) : 0);
    if (spot.order > limits_.order) {
      energy_balance_.order += spot.power;
      return;
    }
    auto const number = std::uint32_t(energy_balance_.spots++);
    sink_.arrived(spot, number, way_);
    if (!launched_here && joins_network(spot)) {
      energy_balance_.rejoined += spot.power;
      ++energy_balance_.beams;
      return sink_.ended(BeamEnd::rejoined, &spot, {spot.mode, spot.field, spot.path_length, spot.gouy, spot.order},
                         way_);
    }
    split(branch, spot, number, vertex, launched_here);
  }

  // Orders of a grating that propagate; adds the rest to the energy balance.
  std::vector<Way> orders(BeamSpot const& spot, Vertex const& vertex) {
    std::vector<Way> all;
    BeamEnergyBalance::Object& object = energy_balance_.objects[view_.surfaces[spot.surface.value].group.value];
    double const beside = spot.power * spot.clipped, meets = spot.power - beside;
    double stays = meets, strongest = 0;
    for (bool const through : {false, true})
      for_each_order(view_, vertex, spot.mode.travel, through, [&](SpecularWay const& order) {
        Way& w = all.emplace_back(Way{spot.field, 0, through, false, order});
        diffract(w.field, spot.mode.travel, vertex, order);
        scale(w.field, 1 - spot.clipped);
        w.power = w.field.power();
        stays -= w.power;
        strongest = std::max(strongest, w.power);
      });
    for (Way& w : all) w.departure = w.power < weaker * strongest;
    std::ranges::stable_sort(all, [](Way const& a, Way const& b) { return a.power > b.power; });
    object.landed += stays;
    object.scattered += meets * scatter_albedo(view_.laws, *vertex.optic, vertex.wi, vertex.n_in, vertex.n_out);
    object.beside += beside;
    if (spot.order > 0) object.ghosts += stays + beside;
    return all;
  }
  // Small facets that reflect or refract one direction into the other, and the phase of the order.
  static void diffract(BeamField& field, Vec3 travel, Vertex const& vertex, SpecularWay const& order) {
    Vec3 const across = s_axis(travel, order.order != 0 ? order.out : vertex.frame.e3, field.axis);
    Complex const phase = std::sqrt(order.share) * exp_turns({order.turns + (order.through ? 0 : 0.25), 0});
    for (int i = 0; i < field.states; ++i) {
      Jones& state = field.state[std::size_t(i)];
      Jones const in = about_axis(state, travel, field.axis, across);
      state = {phase * in.a, order.through ? phase * in.b : -(phase * in.b)};
    }
    field.axis = across;
  }

  // Number of earlier hits of the beam on this side of the surface along the same line.
  std::uint32_t rounds(BeamSpot const& at) const {
    double const width = spot(at.mode).major;
    return std::uint32_t(std::ranges::count_if(way_, [&](BeamStep const& s) {
      return s.surface == at.surface && s.front == at.front && dot(s.in, at.mode.travel) > 0.995 &&
             length(s.point - at.mode.origin) < width;
    }));
  }

  static auto field_after(BeamSpot const& spot, Amplitudes const& a, bool through) {
    auto field = spot.field;
    for (int i = 0; i < spot.field.states; ++i) {
      Vec3 axis = spot.field.axis;
      Jones const& in = spot.field.state[std::size_t(i)];
      field.state[std::size_t(i)] = through ? transmitted(in, spot.mode.travel, spot.normal, a, axis)
                                            : reflected(in, spot.mode.travel, spot.normal, a, axis);
      field.axis = axis;
    }
    return field;
  }

  // Reflected and transmitted parts of a beam at the surface; adds the rest to the energy balance.
  std::array<Way, 2> ways(BeamSpot const& spot, Vertex const& vertex, bool cavity) {
    std::array<Way, 2> both;
    both[1].through = true;
    BeamEnergyBalance::Object& object = energy_balance_.objects[view_.surfaces[spot.surface.value].group.value];
    double const beside = spot.power * spot.clipped, meets = spot.power - beside;
    double scattered = 0, left = 1;
    if (vertex.wi.z > 0) {
      Amplitudes const a =
          specular_amplitudes(view_.interfaces, *vertex.optic, vertex.wi.z, vertex.n_in, vertex.n_out, vertex.front);
      scattered = scatter_albedo(view_.laws, *vertex.optic, vertex.wi, vertex.n_in, vertex.n_out);
      for (Way& w : both) {
        w.field = field_after(spot, a, w.through);
        scale(w.field, 1 - spot.clipped);
      }
      double const specular = meets > 0 ? (both[0].field.power() + both[1].field.power()) / meets : 0;
      left = specular_remainder(view_.interfaces, *vertex.optic, specular, scattered);
    }
    for (Way& w : both) {
      scale(w.field, left);
      w.power = w.field.power();
    }
    if (vertex.n_in > vertex.n_out && both[1].power > 0 && beyond_critical(vertex)) turn_back(both);
    double const back = both[0].power, through = both[1].power;
    both[0].departure = back < weaker * through || back < slight * meets;
    both[1].departure = through < weaker * back && !both[0].departure;
    if (cavity && launch_.span) {  // what passes is the light of the network, whatever the mirror reflects and loses
      scale(both[1].field, both[1].power > 0 ? meets / both[1].power : 0);
      scale(both[0].field, 0);
      both[0].power = scattered = 0;
      both[1].power = both[1].field.power();
      both[1].departure = false;
    } else if (cavity) {  // the mode itself is reflected; what passes is the main beam outside
      energy_balance_.rejoined += both[0].power;
      both[0].power = 0;
      both[1].departure = false;
    }
    double const stays = meets - both[0].power - both[1].power - (cavity ? both[0].field.power() : 0);
    object.landed += stays;
    object.scattered += scattered * meets;
    object.beside += beside;
    if (spot.order > 0) object.ghosts += stays + beside;
    return both;
  }

  static bool beyond_critical(Vertex const& v) { return v.n_in * v.n_in * (1 - v.wi.z * v.wi.z) >= v.n_out * v.n_out; }
  // A coating of stated shares does not include the critical angle: beyond it all light is reflected.
  static void turn_back(std::array<Way, 2>& both) {
    double const all = both[0].power + both[1].power;
    if (both[0].power > 0)
      scale(both[0].field, all / both[0].power);
    else
      both[0].field = both[1].field;
    both[0].power = all;
    both[1].power = 0;
  }

  void split(Branch const& branch, BeamSpot const& spot, std::uint32_t number, Vertex const& vertex,
             bool launched_here) {
    if (vertex.optic->diffracts) return send(branch, spot, number, vertex, orders(spot, vertex));
    std::array<Way, 2> both = ways(spot, vertex, launched_here && !launch_.cavity.empty());
    if (both[1].power > both[0].power) std::swap(both[0], both[1]);
    send(branch, spot, number, vertex, both);
  }

  // `ways`: the strongest first.
  void send(Branch const& branch, BeamSpot const& spot, std::uint32_t number, Vertex const& vertex,
            std::span<Way const> ways) {
    bool const too_long = branch.depth >= limits_.longest, wide = 1 - spot.clipped < least_met;
    bool goes_on = false, faint = false;
    bool const two = std::ranges::count_if(ways, [](Way const& w) { return w.power > 0 && !w.departure; }) > 1;
    for (std::size_t i = ways.size(); i-- > 0;) {  // the stronger one is put last, and followed first
      Way const& w = ways[i];
      if (!(w.power > 0)) continue;
      bool const returns = w.through && is_back_of_mirror(spot.surface, spot.front);
      std::uint32_t const order = returns ? std::max(spot.order, 1u) : spot.order + (w.departure ? 1 : 0);
      bool const dim = !returns && w.power < limits_.floor;
      goes_on = goes_on || !w.departure;
      faint = faint || (!w.departure && dim);
      if (order > limits_.order)
        energy_balance_.order += w.power;
      else if (dim)
        energy_balance_.floor += w.power;
      else if (wide)
        energy_balance_.wide += w.power;
      else if (too_long)
        energy_balance_.longest += w.power;
      else
        waiting_.push_back(leave(branch, spot, number, vertex, w, order, two, i == 0));
    }
    if (goes_on && !faint && !wide && !too_long) return;
    ++energy_balance_.beams;
    LeavingBeam const here{spot.mode, spot.field, spot.path_length, spot.gouy, spot.order, spot.cuts};
    BeamEnd const stopped = faint ? BeamEnd::faint : wide ? BeamEnd::wide : BeamEnd::longest;
    sink_.ended(goes_on ? stopped : BeamEnd::landed, &spot, here, way_);
  }

  Branch leave(Branch const& branch, BeamSpot const& spot, std::uint32_t number, Vertex const& vertex, Way const& w,
               std::uint32_t order, bool two, bool strongest) const {
    Branch next;
    SurfaceCurvature const curvature = view_.shapes.visit(view_.surfaces[spot.surface.value].shape, [&](auto const& s) {
      return curvature_of(s, vertex.point, vertex.piece);
    });
    Vec3 const normal = vertex.front ? spot.normal : -spot.normal;  // the one of the shape
    bool const diffracts = vertex.optic->diffracts;
    next.beam.mode = diffracts                     ? diffracted(spot.mode, w.order.out, normal, curvature, vertex.n_in,
                                            w.through ? vertex.n_out : vertex.n_in)
                     : !w.through                  ? reflected(spot.mode, normal, curvature)
                     : vertex.n_in == vertex.n_out ? spot.mode
                                                   : refracted(spot.mode, normal, curvature, vertex.n_in, vertex.n_out);
    next.beam.field = w.field;
    next.beam.path_length = spot.path_length;
    next.beam.gouy = spot.gouy;
    next.beam.order = order;
    next.beam.cuts = spot.cuts;
    if (spot.clipped > least_cut)
      next.beam.cuts.push_back({spot.surface, spot.mode, branch.depth, spot.path_length, spot.clipped});
    next.step.surface = spot.surface;
    next.step.piece = vertex.piece;
    next.step.point = vertex.point;
    next.step.in = spot.mode.travel;
    next.step.out = next.beam.mode.travel;
    next.step.n_in = vertex.n_in;
    next.step.n_out = w.through ? vertex.n_out : vertex.n_in;
    next.step.path_length = spot.path_length;
    next.step.spot = number;
    next.step.front = spot.front;
    next.step.event = w.order.order != 0 ? Event::diffract : w.through ? Event::transmit : Event::reflect;
    next.step.diffracted = w.order.order;
    next.step.departure = w.departure;
    next.step.split = two;
    next.step.weaker = two && !strongest;
    next.from = {vertex.surface, vertex.piece, vertex.contact};
    next.media = w.through ? vertex.after : vertex.before;
    next.depth = branch.depth + 1;
    return next;
  }

  WorldView view_;
  Screens screens_;
  BeamLaunch const& launch_;
  TreeLimits limits_;
  BeamSink& sink_;
  BeamEnergyBalance energy_balance_;
  std::vector<Branch> waiting_;
  std::vector<BeamStep> way_;
};

}  // namespace

bool RimCut::repeats_in(RimCut const& later, double path) const {
  constexpr double alike = 0.2;  // relative, radii of the spots
  double const w = spot(mode).minor, there = spot(later.mode).minor;
  return by == later.by && !reflected && std::fabs(there / w - 1) < alike && path * mode.wavelength < w * w;
}

BeamEnergyBalance grow_tree(World const& world, BeamLaunch const& launch, TreeLimits const& limits, BeamSink& sink) {
  return Tree(world, launch, limits, sink).grow();
}

// Beams of the scene as roots of the beam tree.

namespace {

Mode mode_of(Footprint const& f, double wavelength) {
  if (f.profile == Profile::gaussian) return circular_mode(f.centre, f.travel, f.radius, f.curvature, wavelength);
  Astigmatism const& a = f.astigmatism;
  double const side = dot(cross(a.e1, a.e2), f.travel) < 0 ? -1 : 1;  // e1, e2 and the travel are right-handed
  Mode m;
  m.origin = f.centre;
  m.travel = f.travel;
  m.e1 = a.e1;
  m.e2 = side * a.e2;
  m.wavelength = wavelength;
  m.q11 = {a.c11, wavelength / (pi * a.w1 * a.w1)};
  m.q12 = side * a.c12;
  m.q22 = {a.c22, wavelength / (pi * a.w2 * a.w2)};
  return m;
}

// A state of the scene is linear; without one the light is unpolarised: two states at right angles.
BeamField field_of(Footprint const& f, bool polarised) {
  BeamField field;
  field.axis = any_normal(f.travel);
  Polarisation const& p = f.polarisation;
  if (polarised && p.q * p.q + p.u * p.u + p.v * p.v > 0.5) {
    field.axis = p.axis;
    double const half = std::sqrt(0.5 * (1 + p.q));  // of q: |a|^2 = (1 + q)/2, 2 conj(a) b = u + i v
    field.state[0] = half > 0 ? Jones{{half, 0}, {0.5 * p.u / half, 0.5 * p.v / half}} : Jones{{0, 0}, {1, 0}};
    return field;
  }
  field.states = 2;
  field.state[1] = {{0, 0}, {1, 0}};
  return field;
}

// Share that leaves the mirror of the launch: a tree without steps.
double passed_at_launch(World const& world, BeamLaunch const& launch) {
  BeamSink nobody;
  return grow_tree(world, launch, {0, 0, 0}, nobody).longest;
}

}  // namespace

std::vector<BeamLaunch> launches(World const& world) {
  WorldView const view = world.view();
  std::vector<BeamLaunch> all;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (world.feeds()[i].propagated) continue;
    if (f.profile != Profile::gaussian && f.profile != Profile::astigmatic) continue;
    if (std::ranges::find(world.spans, i, &NetworkSpan::mirror) != world.spans.end()) continue;
    BeamLaunch launch;
    launch.footprint = i;
    launch.beam = f.beam;
    launch.mode = mode_of(f, world.wavelength / f.index);
    launch.field = field_of(f, world.polarised);
    if (f.free) {
      launch.name = world.groups()[f.origin.value];
    } else {
      Crossing const met = view.cross(f.surface.value, {f.centre - f.backoff * f.travel, f.travel}, {});
      if (!(met.distance < infinity)) continue;  // the chief ray misses its own surface
      launch.arrives_at = f.surface;
      launch.piece = met.piece;
      launch.mode = propagated(launch.mode, met.distance - f.backoff);
      launch.name = world.name_of(f.surface);
      if (f.standing)
        for (Footprint const& other : world.footprints())
          if (other.standing && other.beam == f.beam) launch.cavity.push_back(other.surface);
    }
    auto const span = std::ranges::find(world.spans, i, &NetworkSpan::footprint);
    if (span != world.spans.end()) {
      launch.span = &*span;
      launch.cavity = span->cavity;
      launch.leaves = span->leaves;
      launch.name = world.beams[f.beam].name;
    } else if (!launch.cavity.empty()) {
      launch.passes = passed_at_launch(world, launch);
    }
    all.push_back(std::move(launch));
  }
  return all;
}

char const* name_of(BeamEnd end) {
  static constexpr char const* names[] = {"landed", "escaped", "rejoined", "faint", "longest", "wide"};
  return names[std::size_t(end)];
}

double BeamEnergyBalance::total() const {
  LongSum sum;
  for (double column : {double(media), double(escaped), double(rejoined), double(floor), double(order), double(longest),
                        double(wide), double(stopped)})
    sum += column;
  for (Object const& o : objects) {
    sum += o.landed;
    sum += o.beside;
  }
  return sum;
}

}  // namespace straytrace::world
