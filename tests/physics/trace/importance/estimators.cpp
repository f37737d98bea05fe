// SPDX-License-Identifier: BSD-3-Clause
// Case A27: the walk alone (eq. 1.7), connections alone (eq. 1.8) and both with the power heuristic (eq. 1.9) have
// the same mean. Walk and connections are written here once more without any weights, on the histories of the program.
#include <random>
#include <set>

#include "scene/scene.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_estimators {
namespace {

struct Receiver {
  Disk disc;
  std::uint32_t footprint = 1;
};

// f of one history by each technique, without specular last hops, which no connection can make. The scores of the
// program are stored by technique as well.
class Techniques : public Silent {
 public:
  Techniques(World const& world, Receiver receiver) : view_(world.view()), receiver_(receiver) {}

  void emitted(PathState const& path, Vertex const& vertex) { connect_unweighted(path, vertex); }
  void visit(PathState const& path, Vertex const& vertex) {
    if (vertex.surface == lit().surface && path.hop.pdf > 0)
      walk_ += path.power * rejoin(vertex) * intensity(vertex.point, vertex.frame.e3);
    if (path.event < view_.limits.max_order) connect_unweighted(path, vertex);
  }
  void score(PathState const& path, Vertex const&, std::uint32_t, std::uint32_t number, Vertex const&,
             double coupling) {
    if (is_hit(number) && !(path.hop.pdf > 0)) return;
    (is_hit(number) ? weighted_walk_ : weighted_connection_) += coupling;
  }
  void close() {
    double const sum = weighted_walk_ + weighted_connection_;
    walk.add(walk_);
    both.add(sum);
    walk_too_much.add(walk_ - sum);
    connection_too_much.add(connection_ - sum);
    twice_too_much.add(walk_ + connection_ - sum);
    one_weight_too_much.add(walk_ + weighted_connection_ - sum);
    walk_ = connection_ = weighted_walk_ = weighted_connection_ = 0;
  }
  Sampler walk, both, walk_too_much, connection_too_much, twice_too_much, one_weight_too_much;

 private:
  Footprint const& lit() const { return view_.lit[receiver_.footprint]; }
  // lambda^2 |u_hat|^2 of eq. 1.1
  double intensity(Vec3 y, Vec3 normal) const {
    Vec3 const off = y - lit().centre, across = off - dot(off, lit().travel) * lit().travel;
    double const w = lit().radius, r2 = dot(across, across);
    double const u2 = lit().profile == Profile::gaussian ? 2 / (pi * w * w) * std::exp(-2 * r2 / (w * w))
                                                         : (r2 < w * w ? 1 / (pi * w * w) : 0);
    return view_.wavelength * view_.wavelength * lit().share * u2 * std::fabs(dot(normal, lit().travel));
  }
  double rejoin(Vertex const& v) const {
    return scatter_eval(view_.laws, *v.optic, v.wi, v.frame.to_local(-lit().travel));
  }
  void connect_unweighted(PathState const& path, Vertex const& vertex) {
    Vec3 const y = receiver_.disc.sample(uniform_(engine_), uniform_(engine_)), span = y - vertex.point;
    double const d = length(span);
    if (!(d > 0) || vertex.surface == lit().surface) return;
    Vec3 const out = (1 / d) * span, wo = vertex.frame.to_local(out);
    Vertex const end = make_vertex(view_, lit().surface, y, out);
    if (wo.z <= 0 || end.wi.z <= 0 || view_.occluded({vertex.point, out, d * (1 - 1e-9)}, vertex.surface)) return;
    double const geometry = wo.z * end.wi.z / (d * d);  // eq. 1.3
    connection_ += path.power * scatter_eval(view_.laws, *vertex.optic, vertex.wi, wo) * geometry * rejoin(end) *
                   intensity(y, end.frame.e3) * receiver_.disc.area();  // over p_B = 1/area
  }

  WorldView view_;
  Receiver receiver_;
  std::mt19937_64 engine_{11};
  std::uniform_real_distribution<double> uniform_;
  double walk_ = 0, connection_ = 0, weighted_walk_ = 0, weighted_connection_ = 0;
};

// A small spot on an emitter, a large lit disc facing it, a baffle between them; all orders up to four.
struct Scene {
  World world;
  Receiver receiver;
  Scene() = default;
  Scene(Optic (*emitter)(World&), Profile profile) {
    BodyId const body = world.add_body("all", {});
    std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
    SurfaceId const a = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.5}, world.add_optic(emitter(world)), black, body,
                                          world.add_group("a"));
    receiver.disc = Disk{{0, 0, 1}, {0, 0, -1}, 0, 0.8};
    SurfaceId const b = world.add_surface(receiver.disc, grey, black, body, world.add_group("b"));
    world.add_surface(Disk{{0.3, 0, 0.5}, unit({1, 0, 0.5}), 0, 0.2}, grey, grey, body, world.add_group("baffle"));
    world.add_footprint(spot(a, {}, {0, 0, -1}, Profile::gaussian, 0.05));
    Vec3 const travel = unit({0.3, 0, 1});
    Footprint f = spot(b, {0, 0, 1}, travel, profile, profile == Profile::even ? 0.8 : 0.3, world.add_port("b"), 1);
    f.emits = false;
    f.share = 0.6;
    world.add_footprint(f);
    world.limits.max_order = 4;
    world.finish();
  }
};

// The receiver lies next to the emitter and receives its light only from a plate that reflects and scatters.
Scene over_a_plate(Optic (*plate)(World&)) {
  Scene scene;
  World& world = scene.world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
  SurfaceId const a = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, grey, black, body, world.add_group("a"));
  scene.receiver.disc = Disk{{1, 0, 0}, {0, 0, 1}, 0, 0.8};
  SurfaceId const b = world.add_surface(scene.receiver.disc, grey, black, body, world.add_group("b"));
  world.add_surface(Disk{{0.5, 0, 0.5}, {0, 0, -1}, 0, 2}, world.add_optic(plate(world)), black, body,
                    world.add_group("plate"));
  world.add_footprint(spot(a, {}, {0, 0, -1}, Profile::even, 0.1));
  Footprint f = spot(b, {1, 0, 0}, {0, 0, -1}, Profile::even, 0.8, world.add_port("b"), 1);
  f.emits = false;
  world.add_footprint(f);
  world.limits.max_order = 4;
  world.finish();
  return scene;
}

Optic of_lambert(World& world) {
  Optic o;
  o.laws = 1;
  o.law[0] = world.add_law(Lambertian{0.8});
  return o;
}
Optic of_lobe(World& world) {  // a lobe about the normal, a third of it reflected, and a Lambertian floor
  Optic o;
  o.reflect = 0.3;
  o.laws = 2;
  o.law[0] = world.add_law(power_law(0.05, 1.5, 0.1));
  o.law[1] = world.add_law(Lambertian{0.02});
  return o;
}

Optic of_plate(World& world) {
  Optic o;
  o.reflect = 0.6;
  o.laws = 1;
  o.law[0] = world.add_law(Lambertian{0.3});
  return o;
}

void compare(char const* what, Scene const& scene, std::uint64_t n, double effect) {
  Techniques t(scene.world, scene.receiver);
  walk(scene.world, n, t, [&] { t.close(); });
  double const size = t.both.mean().mean;
  expect_mean(what, t.walk_too_much.mean(), 0, effect * size);
  expect_mean(what, t.connection_too_much.mean(), 0, effect * size);
  EXPECT_LT(t.both.mean().std_error, 1.05 * t.walk.mean().std_error);
  expect_rejected("both counted fully", t.twice_too_much.mean(), 0);
  expect_rejected("weights on one technique only", t.one_weight_too_much.mean(), 0);
}

TEST(Estimators, LambertianEmitterA27) { compare("even", Scene(of_lambert, Profile::even), 1 << 19, 2e-2); }
TEST(Estimators, LobedEmitterA27) { compare("gaussian", Scene(of_lobe, Profile::gaussian), 1 << 20, 3e-2); }
TEST(Estimators, ReflectingScattererA27) {
  for (std::uint32_t const limit : {2u, 5u}) {  // short paths as well: nothing is lost at the order limit
    Scene scene = over_a_plate(of_plate);
    scene.world.limits.max_order = limit;
    compare("plate", scene, 1 << 19, 5e-2);
  }
}

// Closed form of the direct route of two facing discs: f = lambda^2 rho_1 rho_2 F_12/(pi A_2), F_12 of coaxial discs.
SampleMean direct(std::uint64_t n) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
  SurfaceId const a = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, grey, black, body, world.add_group("a"));
  SurfaceId const b = world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, grey, black, body, world.add_group("b"));
  world.add_footprint(spot(a, {}, {0, 0, -1}, Profile::even, 1));
  Footprint f = spot(b, {0, 0, 1}, {0, 0, 1}, Profile::even, 1, world.add_port("b"), 1);
  f.emits = false;
  world.add_footprint(f);
  world.limits.max_order = 1;
  world.finish();
  return route_coupling(run_histories(world, n), "a·S > b·S");
}
TEST(Estimators, ErrorFallsAsRootN) {
  double const expected = 1.064e-6 * 1.064e-6 * 0.25 * 0.3819660 / (pi * pi);
  SampleMean const few = direct(1 << 17), many = direct(1 << 19);
  expect_mean("direct", many, expected, 1e-2 * expected);
  expect_rejected("without the BSDF of the receiver", many, expected * 2 * pi);
  EXPECT_NEAR(few.std_error / many.std_error, 2, 0.5);  // 32 blocks determine their spread to 13 %
}

// Light that reaches the receiver over a mirror: only the walk can find it, with weight 1.
TEST(Estimators, SpecularHopKeepsItsWeight) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
  SurfaceId const a = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, grey, black, body, world.add_group("a"));
  world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 10}, mirror_optic(world, 0.7), black, body, world.add_group("m"));
  world.add_footprint(spot(a, {}, {0, 0, -1}, Profile::even, 1, world.add_port("a")));
  world.limits.max_order = 2;
  world.finish();
  TraceResult const r = run_histories(world, 1 << 19);
  // the disc sees itself as an image at twice the distance: F of coaxial discs r = 1, h = 2
  double const expected = 0.7 * 1.064e-6 * 1.064e-6 * 0.25 * 0.1715729 / (pi * pi);
  SampleMean const s = route_coupling(r, "a·S > m·R > a·S");
  expect_mean("image", s, expected, 3e-2 * expected);
  expect_rejected("half the weight", scaled(s, 0.5), expected);
}

// Squares of the sines under which light leaves the source and the first vertex behind it, of each history.
struct Hops {
  double first = 0, second = 0;
  bool reflected = false;  // at that vertex
};
class HopSink : public Silent {
 public:
  void visit(PathState const& path, Vertex const&) {
    double const sin2 = 1 - path.hop.cosine * path.hop.cosine;
    if (path.order == 1) hops_.first = sin2;
    if (path.order == 2) all.push_back({hops_.first, sin2, path.hop.left_by == Event::reflect});
  }
  std::vector<Hops> all;

 private:
  Hops hops_;
};
// Of histories `first`, `first + step`, ...
std::vector<Hops> hops_of(World const& world, std::uint64_t histories, std::uint64_t step, std::uint64_t first) {
  HopSink sink;
  for (std::uint64_t n = 0; n < histories; ++n) trace_history(world.view(), 1, first + step * n, sink);
  return sink.all;
}
// A plate in a sphere, lit by a free beam.
World plate_in_a_beam(double reflect) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world);
  Optic optic;
  optic.reflect = reflect;
  optic.laws = 1;
  optic.law[0] = world.add_law(Lambertian{1 - reflect});
  world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, world.add_optic(optic), black, body, world.add_group("plate"));
  world.add_surface(sphere(5), black, black, body, world.add_group("around"));
  world.add_footprint(free_beam(world.add_group("laser"), {0, 0, 1}, {0, 0, -1}, Profile::point, 0));
  world.limits.max_order = 3;
  world.finish();
  return world;
}

// What happens at the first vertex behind the source, and the direction in which light is scattered there, are dealt
// (docs/theory/sampling.md, Strata). A plate that scatters (eq. 3.3): 256 consecutive histories have each of 256 cells
// of sin^2 once. One that reflects a quarter: 64 of each 256. Control: histories of different blocks.
TEST(Estimators, SecondVerticesAreDealt) {
  World const white = plate_in_a_beam(0), quarter = plate_in_a_beam(0.25);
  std::uint64_t const block = white.view().block_size;
  auto const cells = [&](std::uint64_t step) {
    std::set<int> met;
    for (Hops const& h : hops_of(white, 256, step, 0)) met.insert(int(256 * h.second));
    return met.size();
  };
  EXPECT_EQ(cells(1), 256u);
  EXPECT_LT(cells(block), 200u) << "control";
  int control = 0;
  for (std::uint64_t first = 0; first < 8 * 256; first += 256) {
    auto const reflected = [&](std::uint64_t step) {
      return std::ranges::count_if(hops_of(quarter, 256, step, step * first), &Hops::reflected);
    };
    EXPECT_EQ(reflected(1), 64);
    control += reflected(block) == 64;
  }
  EXPECT_LT(control, 4);
}

// chi^2 of the counts of pairs in 8 x 8 boxes of the unit square.
template <class Pair>
double chi2_of(std::vector<Hops> const& all, Pair const& pair) {
  std::vector<double> count(64);
  for (Hops const& h : all) {
    auto const [a, b] = pair(h);
    ++count[std::size_t(8 * a) * 8 + std::size_t(8 * b)];
  }
  double const expected = double(all.size()) / 64;
  double chi2 = 0;
  for (double const n : count) chi2 += (n - expected) * (n - expected) / expected;
  return chi2;
}

// For one history, the directions of the first and the second hop, and the choice and the direction at the vertex
// between them, are independent: a mirror that scatters (eq. 3.3) into a white sphere; a plate that reflects half.
// One place in each of many blocks. Control: the first direction twice.
TEST(Estimators, DealtVerticesAreIndependent) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 1);
  SurfaceId const mirror = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, white, black, body, world.add_group("mirror"));
  world.add_surface(sphere(5), white, white, body, world.add_group("around"));
  world.add_footprint(spot(mirror, {}, {0, 0, -1}, Profile::even, 0.1));
  world.limits.max_order = 3;
  world.finish();
  constexpr double most = 63 + 5 * 11.2;  // 5 standard deviations of chi^2 with 63 degrees of freedom
  std::uint64_t const block = world.view().block_size;
  std::vector<Hops> const all = hops_of(world, 6400, block, 77);
  ASSERT_EQ(all.size(), 6400u);
  EXPECT_LT(chi2_of(all, [](Hops const& h) { return std::pair(h.first, h.second); }), most);
  EXPECT_GT(chi2_of(all, [](Hops const& h) { return std::pair(h.first, h.first); }), most) << "control";

  std::vector<Hops> scattered = hops_of(plate_in_a_beam(0.5), 6400, block, 77);
  std::erase_if(scattered, &Hops::reflected);
  auto const lower = std::ranges::count_if(scattered, [](Hops const& h) { return h.second < 0.5; });
  EXPECT_NEAR(double(lower) / double(scattered.size()), 0.5, 5 * 0.5 / std::sqrt(double(scattered.size())));
}

}  // namespace
}  // namespace straytrace::testing::trace_estimators
