// SPDX-License-Identifier: BSD-3-Clause
// Where sub-paths from receivers behind glass (docs/theory/sampling.md) need more than the path: the index of
// the medium in which they end, and the fact that they carry no polarisation.
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_sub_paths {
namespace {

constexpr double height = 0.2, lamp = 0.1;  // m

// A plate whose lower face is frosted: what arrives from below is scattered into the glass. Above it a receiver that
// looks down, through the clear upper face. `free`: the light comes from a plane below, else it starts on the face.
World frosted(double index, double receiver, bool free, bool covered) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), clear = glass_optic(world), volume = world.add_volume({index, 0});
  Optic rough;
  rough.laws = 1;
  rough.law[0] = world.add_law(Lambertian{0.5});
  rough.through[0] = true;
  SurfaceId const face = world.add_surface(disk(0, lamp, {{}, {0, 0, -1}}), world.add_optic(rough), black, body,
                                           world.add_group("frosted"), volume);
  world.add_surface(disk(0, 0.5, {{0, 0, 1e-4}, {0, 0, 1}}), clear, clear, body, world.add_group("clear"), volume);
  receive_on(
      world, "eye",
      world.add_surface(disk(0, receiver, {{0, 0, height}, {0, 0, -1}}), black, black, body, world.add_group("eye")));
  if (free)
    world.add_footprint(free_beam(world.add_group("laser"), {0, 0, -0.05}, {0, 0, 1}, Profile::even, lamp));
  else
    world.add_footprint(spot(face, {}, {0, 0, 1}, Profile::even, lamp));
  world.limits.max_order = 8;
  world.limits.roulette_below = 0;
  world.finish();
  if (covered) find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].behind_glass, covered);
  return world;
}

// Radiance over n^2 is conserved: outside, the face is a Lambertian one behind a surface that transmits 1 - R.
TEST(SubPaths, RadianceInGlass) {
  double const index = 1.5, eye = 1e-3, edge = std::atan(lamp / height);
  double sum = 0;
  for (int i = 0; i < 100; ++i) {
    double const angle = edge * (i + 0.5) / 100;
    Amplitudes const a = Fresnel{}.amplitudes(std::cos(angle), 1, index, true);
    sum += std::sin(2 * angle) * edge / 100 * (1 - 0.5 * (norm(a.rs) + norm(a.rp)));
  }
  double const expected = 0.5 * (eye * eye / (lamp * lamp)) * sum;
  for (bool const free : {false, true}) {
    SampleMean const w = received(run_histories(frosted(index, eye, free, true), 1 << 18));
    expect_mean("frosted", w, expected, 0.05 * expected);
    expect_rejected("radiance kept", w, index * index * expected);
    expect_rejected("no glass", received(run_histories(frosted(1, eye, free, true), 1 << 18)), expected);
    SampleMean const alone = received(run_histories(frosted(index, 0.09, free, false), 1 << 18, 2)),
                     both = received(run_histories(frosted(index, 0.09, free, true), 1 << 17));
    expect_mean("wide receiver", difference(both, alone), 0, 0.12 * alone.mean);
  }
}

// A card that scatters without depolarising, a tilted plate of glass above it, and a receiver. The light is polarised
// across the plane of incidence.
enum class SubPath { looked_for, asked_for, forced };
World polarised(double plate_index, bool narrow, SubPath how, double receiver = 0.09) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world);
  Optic card;
  card.laws = 1;
  card.law[0] = narrow ? world.add_law(gaussian(50, 0.03)) : world.add_law(Lambertian{0.8});
  card.depolarise = 0;
  world.add_surface(disk(0, 0.3, {{}, {0, 0, 1}}), world.add_optic(card), black, body, world.add_group("card"));
  receive_on(
      world, "eye",
      world.add_surface(disk(0, receiver, {{0, 0, height}, {0, 0, -1}}), black, black, body, world.add_group("eye")));
  std::uint32_t const clear = glass_optic(world), volume = world.add_volume({plate_index, 0});
  Vec3 const normal = {std::sqrt(0.75), 0, 0.5};
  for (double const side : {-1.0, 1.0})
    world.add_surface(disk(0, 0.1, {Vec3{0, 0, 0.1} + (side * 1e-4) * normal, side * normal}), clear, clear, body,
                      world.add_group("plate"), volume);
  Footprint beam = free_beam(world.add_group("laser"), {0, 0, 0.001}, {0, 0, -1}, Profile::even, narrow ? 1e-3 : 0.05);
  beam.polarisation = {{0, 1, 0}, 1, 0, 0};
  world.add_footprint(beam);
  world.polarised = true;
  world.limits.max_order = 12;
  world.limits.roulette_below = 0;
  world.finish();
  if (how == SubPath::asked_for) world.cover_receiver(0, true);
  find_covered_receivers(world);
  EXPECT_FALSE(world.receivers()[0].behind_glass);
  if (how == SubPath::forced) world.cover_receiver(0, true);
  return world;
}
SampleMean watts(World const& world, std::uint64_t histories, std::uint64_t seed = 1) {
  return received(run_histories(world, histories, seed));
}

// Plate at 60 degrees: (1 - R)/(1 + R) of the s wave, not the mean of both.
TEST(SubPaths, PolarisedScenesUseTheWalkOnly) {
  for (SubPath const how : {SubPath::looked_for, SubPath::asked_for}) {
    SampleMean const glass = watts(polarised(1.5, true, how), 1 << 16),
                     air = watts(polarised(1, true, how), 1 << 16, 2);
    SampleMean const through = {glass.mean / air.mean,
                                std::hypot(glass.std_error, glass.mean / air.mean * air.std_error) / air.mean, glass.n};
    Amplitudes const a = Fresnel{}.amplitudes(0.5, 1, 1.5, true);
    auto const plate = [](double r) { return (1 - r) / (1 + r); };
    expect_mean("s wave", through, plate(norm(a.rs)), 0.06);
    expect_rejected("unpolarised", through, 0.5 * (plate(norm(a.rs)) + plate(norm(a.rp))));
  }
}
TEST(SubPaths, PolarisedControl) {
  SampleMean const walk = watts(polarised(1.5, false, SubPath::looked_for, 0.04), 1 << 20),
                   control = watts(polarised(1.5, false, SubPath::forced, 0.04), 1 << 19, 2);
  expect_rejected("sub-paths without polarisation", difference(control, walk), 0);
}

// Also a measuring plane that is declared to be behind glass.
TEST(SubPaths, PolarisedPlane) {
  World world = polarised(1.5, true, SubPath::looked_for);
  Receiver plane;
  plane.surface = world.add_surface(disk(0, 0.1, {{0, 0, 0.19}, {0, 0, -1}}), 0, 0, {}, world.add_group("plane"));
  plane.clear = plane.behind_glass = true;
  world.add_receiver("plane", plane);
  world.finish();
  find_covered_receivers(world);
  EXPECT_FALSE(world.receivers()[1].behind_glass);
  world.polarised = false;
  world.cover_receiver(1, true);
  find_covered_receivers(world);
  EXPECT_TRUE(world.receivers()[1].behind_glass);
}

}  // namespace
}  // namespace straytrace::testing::trace_sub_paths
