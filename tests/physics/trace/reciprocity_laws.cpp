// SPDX-License-Identifier: BSD-3-Clause
// Reciprocity for every BSDF model (docs/theory/sampling.md): a Lambertian disc lights a surface that scatters by
// the law, a black disc of the same area receives. Source and receiver swapped: the same watts, because
//   P = 1/(pi A) int int int G f G dA dA dA  with f(wi, wo) = f(wo, wi)   (eq. 1.2).
#include "contract/optics/instances.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_reciprocity_laws {
namespace {

// Discs of equal radius under 50 and 40 degrees on either side of the normal, at different distances: the specular
// direction of part of the surface lies on them, and most of it does not.
constexpr double radius = 0.3;

template <class Law>
SampleMean watts(Law const& law, bool swapped, double receiver_radius = radius) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  Optic optic;
  optic.laws = 1;
  optic.law[0] = world.add_law(law);
  auto const disc = [&](double degrees, double distance, double size, bool source, char const* name) {
    double const a = degrees * pi / 180;
    Vec3 const towards{std::sin(a), 0, std::cos(a)};
    return world.add_surface(Disk{distance * towards + Vec3{0, 0.05, 0}, -towards, 0, size}, source ? white : black,
                             black, body, world.add_group(name));
  };
  world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.3}, world.add_optic(optic), black, body, world.add_group("law"));
  // the discs do not see each other
  world.add_surface(Disk{{0, 0, 1.2}, {1, 0, 0}, 0, 0.7}, black, black, body, world.add_group("screen"));
  SurfaceId const one = disc(50, 1, swapped ? receiver_radius : radius, !swapped, swapped ? "receiver" : "source");
  SurfaceId const two = disc(-40, 1.3, swapped ? radius : receiver_radius, swapped, swapped ? "source" : "receiver");
  SurfaceId const source = swapped ? two : one;
  Vec3 const normal = world.view().normal(source, {});
  Disk const placed = world.view().shapes.visit(world.surfaces()[source.value].shape, [](auto const& s) {
    if constexpr (std::is_same_v<std::decay_t<decltype(s)>, Disk>)
      return s;
    else
      return Disk{};
  });
  world.add_footprint(spot(source, placed.centre, -normal, Profile::even, radius));
  receive_on(world, "receiver", swapped ? one : two);
  world.limits.max_order = 2;
  world.limits.roulette_below = 0;
  world.finish();
  SteeringTables tables = make_importance(world);  // aims from the source only: there is no third vertex
  for (std::size_t i = 0; i < tables.sides.size(); ++i)
    if (tables.strips[i / 2].surface != source) tables.sides[i].alpha = 1;
  tables.level = 0;
  world.steer(std::move(tables));
  return received(run_histories(world, 1 << 16));
}

template <class Law>
class ReciprocityOfLaw : public ::testing::Test {};
TYPED_TEST_SUITE(ReciprocityOfLaw, AllLaws);

TYPED_TEST(ReciprocityOfLaw, SwapScene13) {
  TypeParam const& law = instances<TypeParam>().front();
  SampleMean const there = watts(law, false), back = watts(law, true);
  ASSERT_GT(there.mean, 0);
  expect_mean("swapped", difference(there, back), 0, 0.15 * there.mean);
  // control: not of equal etendue
  expect_rejected("a receiver 25 % larger", difference(watts(law, false, 1.12 * radius), back), 0);
}

}  // namespace
}  // namespace straytrace::testing::trace_reciprocity_laws
