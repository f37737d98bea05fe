// SPDX-License-Identifier: BSD-3-Clause
// Case A26: a path and its reverse add in amplitude (eq. 1.5). Fields of random scatterers are summed here without any
// use of the program: mean power over the sum of the ordered paths' powers. Then: what the traced classes carry.
#include <complex>
#include <random>
#include <vector>

#include "trace_support.hpp"

namespace straytrace::testing {
namespace {

using Complex = std::complex<double>;

// Random point scatterers with circular Gaussian amplitudes on two mirrors and two baffles; straight propagation.
class Speckle {
 public:
  struct Patch {
    std::vector<Vec3> at;
    std::vector<Complex> amplitude;
  };
  // `symmetric`: the way back is the way there. The twin breaks it by a random phase per leg and direction.
  explicit Speckle(bool symmetric) : symmetric_(symmetric) {}

  Patch patch(double z, int n, double width) {
    Patch p;
    for (int i = 0; i < n; ++i) {
      p.at.push_back({width * normal_(engine_), width * normal_(engine_), z});
      p.amplitude.push_back(Complex(normal_(engine_), normal_(engine_)) / std::sqrt(2.0));
    }
    return p;
  }
  Complex leg(Vec3 from, Vec3 to) {
    double const d = length(to - from), turn = symmetric_ ? 0 : 2 * pi * uniform_(engine_);
    return std::polar(1 / d, 2 * pi / 1.064e-6 * d + turn);
  }
  // Field at every scatterer of `to`, from the mode's light on `from`; power without interference comes along.
  struct Field {
    std::vector<Complex> value;
    std::vector<double> power;
  };
  Field spread(Patch const& from, Patch const& to) {
    Field f{std::vector<Complex>(to.at.size()), std::vector<double>(to.at.size())};
    for (std::size_t j = 0; j < to.at.size(); ++j)
      for (std::size_t i = 0; i < from.at.size(); ++i) {
        f.value[j] += from.amplitude[i] * leg(from.at[i], to.at[j]);
        f.power[j] += 1 / length2(to.at[j] - from.at[i]);
      }
    return f;
  }

 private:
  bool symmetric_;
  std::mt19937_64 engine_{26};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

struct Ratio {
  Sampler same_mirror, other_mode, two_baffles, direct, single;
};
// Mean of |sum of fields|^2 over the sum of the powers of all ordered paths; amplitudes have unit variance.
Ratio ratios(bool symmetric, int draws, int on_mirror) {
  Speckle speckle(symmetric);
  Ratio ratio;
  constexpr int n = 4;  // scatterers on each baffle
  for (int draw = 0; draw < draws; ++draw) {
    auto const m = speckle.patch(0, on_mirror, 0.02), m2 = speckle.patch(0.1, on_mirror, 0.02),
               a = speckle.patch(3, n, 0.3), b = speckle.patch(5, n, 0.3);
    auto const there = speckle.spread(m, a), back = speckle.spread(m, a), other = speckle.spread(m2, a);
    auto const b_there = speckle.spread(m, b), b_back = speckle.spread(m, b);
    Complex round, cross, chain, straight, one;
    double round_power = 0, cross_power = 0, chain_power = 0, straight_power = 0;
    for (std::size_t j = 0; j < n; ++j) {
      round += there.value[j] * a.amplitude[j] * back.value[j];
      round_power += there.power[j] * back.power[j];
      cross += there.value[j] * a.amplitude[j] * other.value[j];
      cross_power += there.power[j] * other.power[j];
      for (std::size_t l = 0; l < n; ++l) {
        // mirror > a > b > mirror and mirror > b > a > mirror
        chain += there.value[j] * a.amplitude[j] * speckle.leg(a.at[j], b.at[l]) * b.amplitude[l] * b_back.value[l];
        chain += b_there.value[l] * b.amplitude[l] * speckle.leg(b.at[l], a.at[j]) * a.amplitude[j] * back.value[j];
        double const d2 = length2(a.at[j] - b.at[l]);
        chain_power += 2 * there.power[j] * b_there.power[l] / d2;
      }
      for (std::size_t i = 0; i < m.at.size(); ++i) {  // mirror > a and a > mirror of a standing wave that lights both
        straight += m.amplitude[i] * a.amplitude[j] * (speckle.leg(m.at[i], a.at[j]) + speckle.leg(a.at[j], m.at[i]));
        straight_power += 2 / length2(m.at[i] - a.at[j]);
      }
    }
    for (Complex const& c : m.amplitude) one += c;
    ratio.same_mirror.add(std::norm(round) / round_power);
    ratio.other_mode.add(std::norm(cross) / cross_power);
    ratio.two_baffles.add(std::norm(chain) / chain_power);
    ratio.direct.add(std::norm(straight) / straight_power);
    ratio.single.add(std::norm(one) / on_mirror);
  }
  return ratio;
}

TEST(ReversePaths, FieldsOfRandomScatterersA26) {
  int const few = 6, many = 30;
  Ratio const r = ratios(true, 100000, few), s = ratios(true, 20000, many);
  expect_mean("mirror > baffle > same mirror", r.same_mirror.mean(), 2, 0.25);
  expect_mean("mirror > mirror of one standing wave", r.direct.mean(), 2, 0.15);
  expect_mean("out by one mode, back by another", r.other_mode.mean(), 1, 0.15);
  expect_mean("one vertex", r.single.mean(), 1, 0.05);
  // Two baffles see speckle of the same n scatterers: 2 (1 + 1/n), so 2 for a real surface.
  expect_mean("two baffles", r.two_baffles.mean(), 2 * (1 + 1.0 / few), 0.25);
  expect_mean("two baffles", s.two_baffles.mean(), 2 * (1 + 1.0 / many), 0.5);
}

TEST(ReversePaths, WithoutSymmetricPropagationTwin) {
  Ratio const r = ratios(false, 40000, 6);
  expect_rejected("mirror > baffle > same mirror", r.same_mirror.mean(), 2);
  expect_rejected("two baffles", r.two_baffles.mean(), 2 * (1 + 1.0 / 6));
  expect_rejected("mirror > mirror", r.direct.mean(), 2);
}

// Two mirrors and a baffle; are the mirrors lit by one beam?
World cavity(bool one_beam, bool reverse_routes) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const one = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.5}, white, black, body, world.add_group("one"));
  SurfaceId const two =
      world.add_surface(Disk{{0, 0, 2}, {0, 0, -1}, 0, 0.5}, white, black, body, world.add_group("two"));
  world.add_surface(Disk{{0, 0, 1}, {0, 0, 1}, 0.2, 1}, white, white, body, world.add_group("baffle"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::gaussian, 0.1, world.add_port("one"), 0));
  world.add_footprint(spot(two, {0, 0, 2}, {0, 0, 1}, Profile::gaussian, 0.1, world.add_port("two"), one_beam ? 0 : 1));
  world.limits.max_order = 2;
  world.reverse_routes = reverse_routes;
  world.finish();
  return world;
}
double reverse_of(World const& world, char const* route) {
  TraceResult const r = run_histories(world, 1 << 17);
  CouplingClass const* c = find_route(r, route);
  return c ? c->reverse : 0;
}

TEST(ReversePaths, ClassesCarryCrev) {
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S > baffle·S > one·S"), 2);
  EXPECT_EQ(reverse_of(cavity(false, true), "one·S > baffle·S > one·S"), 2);
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S > two·S"), 2);
  EXPECT_EQ(reverse_of(cavity(false, true), "one·S > two·S"), 1);             // leaves one mode, returns by another
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S"), 1);                      // its own reverse
  EXPECT_EQ(reverse_of(cavity(true, false), "one·S > baffle·S > one·S"), 1);  // the switch
}

}  // namespace
}  // namespace straytrace::testing
