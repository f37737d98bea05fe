// SPDX-License-Identifier: BSD-3-Clause
// Paths from both ends (docs/theory/sampling.md, eq. 1.15 to 1.21, 1.25 and 1.26): the power heuristic over all ways
// to make a path, against explicit sums and against walk and connections alone.
#include <map>

#include "support/baffled_tube.hpp"
#include "support/trace_received.hpp"
#include "trace/tally/history_tally.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing::trace_both_ends {
namespace {

// With roulette and windows off, the score of a path by strategy t is the light of the path times the density of t over
// the sum of the squares of the densities of all strategies (eq. 1.18). Here both are products written out.
class Explicit {
 public:
  Explicit(WorldView const& view, ReplayedPath const& path)
      : view_(view), path_(path.vertices), receiver_(is_receiver(view, path.goal)), goal_(path.goal) {
    follow();
    for (std::size_t i = 0; i < path_.size(); ++i)
      if (path_[i].event != Event::reflect && path_[i].event != Event::transmit) scatters_.push_back(i);
    Footprint const& beam = view.lit[path.source];
    start_ = connection_density(beam, path_[0].point, ahead_[0].normal());
  }
  std::size_t scattering() const { return scatters_.size(); }
  double light() const {
    double product = start_;
    for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
      Vertex const& v = ahead_[i];
      double const n = path_[i].n_out;
      if (path_[i].event == Event::reflect || path_[i].event == Event::transmit)
        product *= path_[i].event == Event::reflect ? v.reflect : v.transmit;
      else
        product *= scatter_eval(view_.laws, *v.optic, v.wi, v.frame.to_local(path_[i].out), v.n_in, v.n_out) / (n * n);
    }
    if (receiver_) return product;
    Footprint const& mode = view_.lit[goal_];
    Vertex const& y = ahead_.back();
    return product * point_density() * view_.wavelength * view_.wavelength * mode.share *
           scatter_eval(view_.laws, *y.optic, y.wi, y.frame.to_local(-mode.direction(y.point)), y.n_in, y.n_out);
  }
  // Of strategy t, over the product of the étendue of all legs.
  double density(std::size_t t) const {
    std::size_t const m = scatters_.size(), edge = m - 1 - t;  // the leg that is connected
    double product = 1;
    if (t < m) product *= start_ / view_.draws();
    for (std::size_t i = 0; i + t + 1 < m; ++i)
      if (t == 0 || i < edge) product *= forward(i);
    if (t == 0) return product;
    product *= point_density();
    if (t > 1) product *= sub_paths_of(view_, goal_);
    for (std::size_t i = t < m ? edge + 2 : 1; i < m; ++i) product *= backward(i);
    if (t == m) return product;
    std::size_t const a = scatters_[edge], b = scatters_[edge + 1];
    if (b != a + 1) return 0;
    if (t > 1) product *= 1 - behind_[b].reflect - behind_[b].transmit;
    return product / geometry(a);
  }
  double score(std::size_t strategy) const {
    double all = 0;
    for (std::size_t t = 0; t <= std::min<std::size_t>(most_ends, scatters_.size()); ++t)
      all += density(t) * density(t);
    return light() * density(strategy) / all;
  }
  double score_in_proportion() const {
    double all = 0;
    for (std::size_t t = 0; t <= std::min<std::size_t>(most_ends, scatters_.size()); ++t) all += density(t);
    return light() / all;
  }

 private:
  void follow() {
    MediaStack media;
    std::vector<MediaStack> legs;
    for (PassedVertex const& p : path_) {
      Vertex v = make_vertex(view_, p.surface, p.point, p.in);
      evaluate_scattering(view_, media, {}, p.in, v);
      media = dot(p.out, v.frame.e3) < 0 ? v.after : v.before;
      legs.push_back(media);
      ahead_.push_back(v);
    }
    for (std::size_t i = 0; i < path_.size(); ++i) {
      Vertex v = make_vertex(view_, path_[i].surface, path_[i].point, -path_[i].out);
      if (i + 1 < path_.size() || !receiver_)
        evaluate_scattering(view_, i + 1 < path_.size() ? legs[i] : MediaStack{}, {}, -path_[i].out, v);
      behind_.push_back(v);
    }
  }
  // Of the point on the goal: even over a receiver, by the intensity of a mode over a lit surface.
  double point_density() const {
    if (receiver_) return receiver_density(view_, receiver_of(view_, goal_));
    Footprint const& mode = view_.lit[goal_];
    return mode.intensity(path_.back().point) * std::fabs(dot(ahead_.back().normal(), mode.travel));
  }
  double leg(std::size_t i) const { return length(path_[i + 1].point - path_[i].point); }
  // n^2 cos cos'/d^2 of the leg from vertex i
  double geometry(std::size_t i) const {
    double const n = path_[i].n_out, d = leg(i);
    return n * n * std::fabs(dot(path_[i].out, ahead_[i].normal())) * ahead_[i + 1].cosine() / (d * d);
  }
  // Density per étendue of the walk from scattering vertex number i to the next one.
  double forward(std::size_t number) const {
    std::size_t i = scatters_[number];
    Vertex const& v = ahead_[i];
    Vec3 const wo = v.frame.to_local(path_[i].out);
    double const n = path_[i].n_out, law = scatter_pdf(view_.laws, *v.optic, v.wi, wo, v.n_in, v.n_out);
    double product = mixture_pdf(view_, v.side(), law, ahead_[i + 1].patch, leg(i), ahead_[i + 1].cosine());
    product *= (number == 0 ? 1 : v.albedo / v.kept()) / (n * n * std::fabs(wo.z));
    for (++i; i < scatters_[number + 1]; ++i)
      product *= (path_[i].event == Event::reflect ? ahead_[i].reflect : ahead_[i].transmit) / ahead_[i].kept();
    return product;
  }
  // Of a sub-path from there to the one before.
  double backward(std::size_t number) const {
    std::size_t i = scatters_[number];
    bool const last = number + 1 == scatters_.size();
    double product = 0;
    if (last && receiver_) {
      product = 1 / (pi * receiver_of(view_, goal_).sides());
    } else {
      Vertex const& v = behind_[i];
      Vec3 const wo = v.frame.to_local(-path_[i].in);
      double const n = path_[i].n_in, law = scatter_pdf(view_.laws, *v.optic, v.wi, wo, v.n_in, v.n_out);
      product = (last ? 1 : v.albedo) * law / (n * n * std::fabs(wo.z));
    }
    for (--i; i > scatters_[number - 1]; --i)
      product *= path_[i].event == Event::reflect ? behind_[i].reflect : behind_[i].transmit;
    return product;
  }

  WorldView const& view_;
  std::vector<PassedVertex> path_;
  bool receiver_;
  std::uint32_t goal_;
  std::vector<Vertex> ahead_, behind_;  // for light on its way, and for light the other way
  std::vector<std::size_t> scatters_;
  double start_ = 0;
};

// A lamp, a plate that reflects, scatters and transmits, a mirror, a window of glass, two receivers, one of which looks
// through the window, and a mode on the wall.
World all_kinds(bool targets, double sub_paths, std::uint32_t orders = 12) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 0.6);
  auto const add = [&](char const* name, double radius, Placement at, std::uint32_t front, std::uint32_t back) {
    return world.add_surface(disk(0, radius, at), front, back, body, world.add_group(name));
  };
  SurfaceId const lamp = add("lamp", 0.2, {{0, -0.2, 0}, {0, 0, 1}}, white, black);
  Optic half;
  half.reflect = 0.2;
  half.transmit = 0.1;
  half.laws = 2;
  half.law[0] = world.add_law(power_law(0.05, 1.5, 0.1));
  half.law[1] = world.add_law(Lambertian{0.3});
  std::uint32_t const plate = world.add_optic(half), mirror = mirror_optic(world, 0.7);
  add("plate", 0.5, {{0, 0, 0.6}, unit({0.2, 0.1, -1})}, plate, plate);
  SurfaceId const wall = add("wall", 0.5, {{-0.4, 0, 0.2}, {1, 0, 0}}, white, white);
  add("mirror", 0.4, {{0.5, 0, 0.3}, unit({-1, 0, 0.1})}, mirror, black);
  SurfaceId const chip = add("chip", 0.08, {{0.25, 0, 0.02}, {0, 0, 1}}, white, black),
                  eye = add("eye", 0.08, {{-0.2, 0.1, 0}, {0, 0, 1}}, black, black);
  add_plate(world, "window", 1.5, 0.05, 0.08, -0.2, 0.15);
  world.add_surface(cylinder(0.15, 0.05, 0.08, {{-0.2, 0, 0}}), black, black, body, world.add_group("barrel"));
  receive_on(world, "chip", chip);
  receive_on(world, "eye", eye);
  world.add_footprint(spot(lamp, {0, -0.2, 0}, {0, 0, -1}, Profile::gaussian, 0.15));
  Footprint mode =
      spot(wall, {-0.4, 0.1, 0.3}, unit({-1, 0.1, 0.2}), Profile::gaussian, 0.1, world.add_port("mode"), 1);
  mode.emits = false;
  mode.share = 0.7;
  world.add_footprint(mode);
  world.limits.max_order = orders;
  world.limits.route_vertices = 12;
  world.limits.roulette_below = 0;
  world.limits.window = false;
  world.finish();
  if (targets) {
    ImportanceSettings settings;
    settings.window = false;
    world.steer(make_importance(world, settings));
  }
  for (std::uint32_t i = 0; i < 2; ++i) world.set_sub_paths(i, sub_paths);
  world.set_sub_paths_of_mode(1, sub_paths);
  return world;
}

struct Found {
  std::uint64_t history;
  std::uint32_t event, number, goal;
  std::size_t strategy;  // t
  double score;
};
struct Collect : Silent {
  explicit Collect(WorldView const& w) : view(w) {}
  void score(PathState const& p, Vertex const&, std::uint32_t goal, std::uint32_t number, Vertex const&, double power) {
    all.push_back({p.history, p.event, number, goal, is_hit(number) ? 0u : 1u, power});
  }
  void score_through(PathState const& p, Vertex const&, Vertex const&, Chain const& chain, std::uint32_t goal,
                     Vertex const&, double power) {
    all.push_back({p.history, p.event, number_through(view, chain.ends, goal), goal, chain.ends + 1, power});
  }
  void score_lit(PathState const& p, std::uint32_t source, Vertex const&, Chain const& chain, std::uint32_t goal,
                 Vertex const&, double power) {
    all.push_back({p.history, p.event, number_lit(view, source, chain.hops, goal), goal, chain.ends, power});
  }
  WorldView const& view;
  std::vector<Found> all;
};

TEST(BothEnds, EveryStrategyHasItsWeight) {
  for (bool const targets : {false, true})
    for (double const sub_paths : {1.0, 0.3}) {
      World const world = all_kinds(targets, sub_paths);
      WorldView const view = world.view();
      Collect found(view);
      walk(world, 4000, found, [] {});
      std::map<std::size_t, int> seen, specular, of_mode;
      int missed = 0;
      for (Found const& f : found.all) {
        auto const path = replay(SteeredWorld::as_given(world), 1, f.history, f.event, f.number);
        ASSERT_TRUE(path.has_value());
        ASSERT_EQ(path->coupling, f.score);
        Explicit const by_hand(view, *path);
        double const expected = by_hand.score(f.strategy);
        EXPECT_NEAR(f.score, expected, 1e-12 * expected) << "t = " << f.strategy << " of " << by_hand.scattering();
        ++seen[f.strategy];
        if (!is_receiver(view, f.goal)) ++of_mode[f.strategy];
        if (by_hand.scattering() < path->vertices.size()) ++specular[f.strategy];
        double const balance = by_hand.score_in_proportion();
        if (std::fabs(f.score - balance) > 1e-3 * f.score) ++missed;
      }
      for (std::size_t t = 0; t <= most_ends; ++t) {
        EXPECT_GT(seen[t], 10) << t;
        EXPECT_GT(of_mode[t], 2) << t;
      }
      for (std::size_t const t : {0, 2, 3, 4}) EXPECT_GT(specular[t], 10) << t;
      EXPECT_GT(missed, int(found.all.size()) / 2);  // control: weights in proportion to the densities
    }
}

// Sub-paths change the error, never the mean, also where only some histories have them.
TEST(BothEnds, SameMeanAsWalkAndConnections) {
  constexpr std::uint32_t orders = 5;
  TraceResult const alone = run_histories(all_kinds(true, 0, orders), 1 << 19, 2),
                    both = run_histories(all_kinds(true, 1, orders), 1 << 18, 1),
                    some = run_histories(all_kinds(true, 0.3, orders), 1 << 18, 3);
  for (std::size_t i = 0; i < 2; ++i) {
    SampleMean const expected = received(alone, i);
    expect_mean("both ends", difference(received(both, i), expected), 0, 0.15 * expected.mean);
    expect_mean("some histories", difference(received(some, i), expected), 0, 0.15 * expected.mean);
    expect_rejected("half as much again", difference(scaled(received(both, i), 1.5), expected), 0);
  }
  SampleMean const expected = total_coupling(alone);
  expect_mean("mode, both ends", difference(total_coupling(both), expected), 0, 0.15 * expected.mean);
  expect_mean("mode, some histories", difference(total_coupling(some), expected), 0, 0.15 * expected.mean);
  expect_rejected("mode", difference(scaled(total_coupling(both), 1.5), expected), 0);
}

// A room with a lamp on its floor and, at this distance from its ceiling, a small receiver that looks along it
// (eq. 1.19).
World below_a_ceiling(double distance) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const lamp =
      world.add_surface(disk(0, 0.1, {{0.5, 0, 0}, {0, 0, 1}}), white, black, body, world.add_group("lamp"));
  world.add_surface(disk(0, 2, {{0, 0, 1}, {0, 0, -1}}), white, black, body, world.add_group("ceiling"));
  world.add_surface(disk(0, 2, {{0, 0, -0.1}, {0, 0, 1}}), white, black, body, world.add_group("floor"));
  receive_on(
      world, "eye",
      world.add_surface(disk(0, 2e-4, {{0, 0, 1 - distance}, {1, 0, 0}}), black, black, body, world.add_group("eye")));
  world.add_footprint(spot(lamp, {0.5, 0, 0}, {0, 0, -1}, Profile::even, 0.1));
  world.limits.max_order = 8;
  world.finish();
  return world;
}
double relative_variance(World const& world) {
  SampleMean const s = received(run_histories(world, 1 << 16));
  return s.std_error * s.std_error / (s.mean * s.mean) * double(s.n);
}
double variance_below_a_ceiling(double distance, double sub_paths) {
  World world = below_a_ceiling(distance);
  world.set_sub_paths(0, sub_paths);
  return relative_variance(world);
}
TEST(BothEnds, VarianceAtShortDistance) {
  EXPECT_LT(variance_below_a_ceiling(5e-4, 1), 2 * variance_below_a_ceiling(0.05, 1));
  EXPECT_GT(variance_below_a_ceiling(5e-3, 0), 2 * variance_below_a_ceiling(0.05, 0));  // control
}

// Two facing discs: connections find all light of first order, each with almost the same score. The power heuristic
// leaves it to them, whether there are sub-paths or not; weights in proportion to the densities give walk and sub-paths
// a share of the form factor, whose variance is as large. A receiver near a ceiling keeps its sub-paths.
World facing_discs() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.9), black = black_optic(world);
  SurfaceId const lamp = world.add_surface(disk(0, 0.1, {{}, {0, 0, 1}}), white, black, body, world.add_group("lamp"));
  receive_on(world, "eye",
             world.add_surface(disk(0, 0.1, {{0, 0, 1}, {0, 0, -1}}), black, black, body, world.add_group("eye")));
  world.add_footprint(spot(lamp, {}, {0, 0, -1}, Profile::even, 0.1));
  world.limits.max_order = 4;
  world.finish();
  return world;
}
TEST(BothEnds, LightThatConnectionsFindKeepsItsError) {
  World chosen = facing_discs(), forced = facing_discs(), alone = facing_discs();
  for (World* world : {&chosen, &forced, &alone}) steer(*world);
  EXPECT_EQ(chosen.receivers()[0].sub_paths, 0);
  forced.set_sub_paths(0, 1);
  alone.set_sub_paths(0, 0);
  constexpr double form_factor = 0.01;
  EXPECT_LT(relative_variance(forced), 1.1 * relative_variance(alone));
  EXPECT_LT(relative_variance(forced), form_factor / 5);  // fails with weights in proportion
  World near_ceiling = below_a_ceiling(5e-4);
  steer(near_ceiling);
  EXPECT_EQ(near_ceiling.receivers()[0].sub_paths, 1);
}

// A tube of 4 km with two receivers: targets find the light of both. Dealt numbers leave 0.28 of the variance without
// sub-paths, 0.51 with sub-paths in a quarter of the histories (eq. 1.25, 1.26). Without that factor a quarter is left.
TEST(BothEnds, SubPathsAreChosenForAllReceivers) {
  World chosen = baffled_tube();
  find_covered_receivers(chosen);
  for (Receiver const& r : chosen.receivers()) EXPECT_GT(r.sub_paths, 0);
  steer(chosen);
  for (Receiver const& r : chosen.receivers()) EXPECT_EQ(r.sub_paths, 0);
}

// A lamp lights a ceiling; its light reaches a mode on a small card below a window of glass (eq. 1.21): no connection
// from the ceiling ends on the card, and the walk rarely meets the spot.
World mode_behind_glass(double spot_radius) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const lamp = world.add_surface(disk(0, 0.1, {{0.5, 0, 0}, {0, 0, 1}}), white, black, body,
                                           world.add_group("lamp")),
                  card = world.add_surface(disk(0, 0.05, {{-0.2, 0, 0}, {0, 0, 1}}), white, black, body,
                                           world.add_group("card"));
  world.add_surface(disk(0, 2, {{0, 0, 1}, {0, 0, -1}}), white, black, body, world.add_group("ceiling"));
  add_plate(world, "window", 1.5, 0.05, 0.06, -0.2, 0.1);
  world.add_surface(cylinder(0.1, 0, 0.06, {{-0.2, 0, 0}}), black, black, body, world.add_group("barrel"));
  world.add_footprint(spot(lamp, {0.5, 0, 0}, {0, 0, -1}, Profile::even, 0.1));
  Footprint mode = spot(card, {-0.2, 0, 0}, {0, 0, -1}, Profile::gaussian, spot_radius, world.add_port("mode"), 1);
  mode.emits = false;
  world.add_footprint(mode);
  world.limits.max_order = 8;
  world.finish();
  return world;
}
double relative_variance_of_mode(World const& world) {
  SampleMean const s = total_coupling(run_histories(world, 1 << 16));
  return s.std_error * s.std_error / (s.mean * s.mean) * double(s.n);
}
TEST(BothEnds, ModeBehindGlass) {
  World chosen = mode_behind_glass(0.01), alone = mode_behind_glass(0.01);
  for (World* world : {&chosen, &alone}) steer(*world);
  EXPECT_EQ(chosen.footprints()[1].sub_paths, 1);
  alone.set_sub_paths_of_mode(1, 0);
  EXPECT_LT(relative_variance_of_mode(chosen), 0.1 * relative_variance_of_mode(alone));
}
// A mode that arrives at a frosted face from inside the glass: light from below is scattered through the face into it
// (eq. 1.21 with n = 1.5 on one side).
SampleMean into_the_glass(double sub_paths, std::uint64_t seed, double index = 1.5) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world), clear = glass_optic(world),
                      volume = world.add_volume({1.5, 0});
  Optic rough;
  rough.laws = 1;
  rough.law[0] = world.add_law(Lambertian{0.5});
  rough.through[0] = true;
  std::uint32_t const frosted = world.add_optic(rough);
  SurfaceId const lamp = world.add_surface(disk(0, 0.1, {{}, {0, 0, 1}}), white, black, body, world.add_group("lamp")),
                  face = world.add_surface(disk(0, 0.1, {{0, 0, 0.2}, {0, 0, -1}}), frosted, frosted, body,
                                           world.add_group("face"), volume);
  world.add_surface(disk(0, 0.1, {{0, 0, 0.21}, {0, 0, 1}}), clear, clear, body, world.add_group("top"), volume);
  world.add_surface(disk(0, 1, {{0, 0, -0.1}, {0, 0, 1}}), white, black, body, world.add_group("floor"));
  world.add_footprint(spot(lamp, {}, {0, 0, -1}, Profile::even, 0.1));
  Footprint mode = spot(face, {0, 0, 0.2}, {0, 0, -1}, Profile::gaussian, 0.03, world.add_port("mode"), 1);
  mode.index = index;
  mode.emits = false;
  world.add_footprint(mode);
  world.limits.max_order = 6;
  world.limits.roulette_below = 0;
  world.finish();
  world.set_sub_paths_of_mode(1, sub_paths);
  return total_coupling(run_histories(world, 1 << 17, seed));
}
TEST(BothEnds, ModeInGlass) {
  SampleMean const alone = into_the_glass(0, 1), both = into_the_glass(1, 2);
  expect_mean("both ends", difference(both, alone), 0, 0.05 * alone.mean);
  expect_rejected("etendue of air", difference(into_the_glass(1, 3, 1), alone), 0);
}
// In front of the lamp connections find all light of a mode: it has no sub-paths.
TEST(BothEnds, ModeThatConnectionsFind) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.9), black = black_optic(world);
  SurfaceId const lamp = world.add_surface(disk(0, 0.1, {{}, {0, 0, 1}}), white, black, body, world.add_group("lamp")),
                  card = world.add_surface(disk(0, 0.1, {{0, 0, 1}, {0, 0, -1}}), white, black, body,
                                           world.add_group("card"));
  world.add_footprint(spot(lamp, {}, {0, 0, -1}, Profile::even, 0.1));
  world.add_footprint(spot(card, {0, 0, 1}, {0, 0, 1}, Profile::even, 0.1, world.add_port("mode"), 1));
  world.limits.max_order = 4;
  world.finish();
  steer(world);
  EXPECT_EQ(world.footprints()[1].sub_paths, 0);
}

// Two grey discs of different size below a tilted plate and beside a mirror: what one sends to the other per area is
// the same both ways.
SampleMean exchanged(bool swapped, double albedo = 0.8) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const grey = lambertian_optic(world, 0.5), black = black_optic(world);
  double const radius[] = {0.02, 0.1};
  SurfaceId const discs[] = {
      world.add_surface(disk(0, radius[0], {{}, {0, 0, 1}}), grey, black, body, world.add_group("one")),
      world.add_surface(disk(0, radius[1], {{0.5, 0, 0}, {0, 0, 1}}), grey, black, body, world.add_group("two"))};
  world.add_surface(disk(0, 1, {{0, 0, 0.5}, unit({0.2, 0.1, -1})}), lambertian_optic(world, albedo), black, body,
                    world.add_group("plate"));
  world.add_surface(disk(0, 1, {{0.8, 0, 0.5}, {-1, 0, 0}}), mirror_optic(world, 0.9), black, body,
                    world.add_group("mirror"));
  receive_on(world, "receiver", discs[swapped ? 0 : 1]);
  Vec3 const centre = swapped ? Vec3{0.5, 0, 0} : Vec3{};
  world.add_footprint(spot(discs[swapped ? 1 : 0], centre, {0, 0, -1}, Profile::even, radius[swapped ? 1 : 0]));
  world.limits.max_order = 8;
  prepare(world);
  EXPECT_GT(world.receivers()[0].sub_paths, 0);
  double const area = pi * 0.01 * (swapped ? 1 : 0.04);
  return scaled(received(run_histories(world, 1 << 18)), area);
}
TEST(BothEnds, LampAndReceiverSwapped) {
  SampleMean const there = exchanged(false), back = exchanged(true);
  expect_mean("swapped", difference(there, back), 0, 0.08 * there.mean);
  expect_rejected("a darker plate", difference(there, exchanged(true, 0.5)), 0);
}

}  // namespace
}  // namespace straytrace::testing::trace_both_ends
