// SPDX-License-Identifier: BSD-3-Clause
// Sequence of media along paths through touching, cemented, nested and overlapping glasses (C8.4),
// and the indices of the presets (docs/reference/library.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/every_module.hpp"
#include "base/units/media_presets.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/media_stack.hpp"

namespace straytrace::optics_media {
namespace {

constexpr std::uint32_t outside = Passage::none;

// A slab on a line: its volume fills [from, to].
struct Slab {
  std::uint32_t volume;
  double from, to;
  std::int32_t priority = 0;
};
struct Crossing {
  double at;
  Passage passage;
};

// Volumes a ray along the line goes through, from `start` on, upwards or downwards: one entry per boundary where the
// volume that fills the space changes. Surfaces closer than `contact` are one boundary.
std::vector<std::uint32_t> sequence(std::vector<Slab> const& slabs, double start, bool up, MediaStack stack = {},
                                    double contact = contact_distance) {
  std::vector<Crossing> met;
  for (Slab const& s : slabs)
    for (double const at : {s.from, s.to})
      if (up ? at > start : at < start) met.push_back({at, {s.volume, up == (at == s.from), s.priority}});
  std::stable_sort(met.begin(), met.end(),
                   [&](auto const& a, auto const& b) { return up ? a.at < b.at : a.at > b.at; });
  std::vector<std::uint32_t> seen;
  for (std::size_t i = 0; i < met.size(); ++i) {
    bool const touching = i + 1 < met.size() && std::fabs(met[i + 1].at - met[i].at) <= contact;
    MediumSides const s = touching ? sides(stack, met[i].passage, met[i + 1].passage) : sides(stack, met[i].passage);
    if (seen.empty()) seen.push_back(s.in);
    EXPECT_EQ(s.in, seen.back());  // nothing lost: each boundary begins where the last one ended
    if (s.out != s.in) seen.push_back(s.out);
    stack = s.after;
    i += touching;
  }
  EXPECT_FALSE(stack.overflow);
  return seen;
}
using Volumes = std::vector<std::uint32_t>;
Volumes reversed(Volumes v) {
  std::reverse(v.begin(), v.end());
  return v;
}
void expect_both_ways(std::vector<Slab> const& slabs, Volumes const& wanted) {
  EXPECT_EQ(sequence(slabs, -10, true), wanted);
  EXPECT_EQ(sequence(slabs, 10, false), reversed(wanted));
  auto turned = slabs;
  std::reverse(turned.begin(), turned.end());  // order of the surfaces in the scene
  EXPECT_EQ(sequence(turned, -10, true), wanted);
  EXPECT_EQ(sequence(turned, 10, false), reversed(wanted));
}

TEST(OpticsMedia, SingleAndSeparate) {
  expect_both_ways({{1, 0, 1}}, {outside, 1, outside});
  expect_both_ways({{1, 0, 1}, {2, 2, 3}}, {outside, 1, outside, 2, outside});
}

TEST(OpticsMedia, CementedTouchingAndOverlapping) {
  Volumes const doublet{outside, 1, 2, outside};
  expect_both_ways({{1, 0, 1}, {2, 1, 2}}, doublet);          // one shared face
  expect_both_ways({{1, 0, 1}, {2, 1 + 5e-10, 2}}, doublet);  // a gap of half a nanometre
  expect_both_ways({{1, 0, 1}, {2, 1 - 5e-10, 2}}, doublet);  // an overlap of as much
  expect_both_ways({{1, 0, 1}, {2, 1 - 1e-9, 2}}, doublet);
  expect_both_ways({{1, 0, 1}, {2, 0.9, 2}}, doublet);  // a real overlap: two boundaries, one change
  expect_both_ways({{1, 0, 1}, {2, 1.001, 2}}, {outside, 1, outside, 2, outside});
  expect_both_ways({{1, 0, 1}, {2, 1, 2}, {3, 2, 3}}, {outside, 1, 2, 3, outside});
}

// Control of the above: without joining what touches, a gap of vacuum appears in the cement.
TEST(OpticsMedia, WithoutContactAGapAppears) {
  EXPECT_EQ(sequence({{1, 0, 1}, {2, 1 + 5e-10, 2}}, -10, true, {}, -1), (Volumes{outside, 1, outside, 2, outside}));
}

TEST(OpticsMedia, Nested) {
  expect_both_ways({{1, 0, 4}, {2, 1, 3}}, {outside, 1, 2, 1, outside});  // a bubble in glass
  expect_both_ways({{1, 0, 6}, {2, 1, 5}, {3, 2, 4}}, {outside, 1, 2, 3, 2, 1, outside});
  expect_both_ways({{1, 0, 4}, {2, 0, 2, 1}}, {outside, 2, 1, outside});  // a shared face needs a priority
}

// A lens that reaches out of a tank fills its own space when it has the higher priority, from both sides; with equal
// ones the last volume entered wins (control).
TEST(OpticsMedia, Priority) {
  expect_both_ways({{1, 0, 2}, {2, 1, 3, 1}}, {outside, 1, 2, outside});
  expect_both_ways({{1, 0, 2, 1}, {2, 1, 3}}, {outside, 1, 2, outside});
  auto const place_of_change = [](std::int32_t priority) {
    MediaStack s;  // downwards: into 2 at 3, into 1 at 2
    s.enter(2, priority);
    return sides(s, {1, true, 0}).out;
  };
  EXPECT_EQ(place_of_change(1), 2u);
  EXPECT_EQ(place_of_change(0), 1u);
}

TEST(OpticsMedia, StartInside) {
  EXPECT_EQ(sequence({{1, 0, 1}}, 0.5, true), (Volumes{1, outside}));
  EXPECT_EQ(sequence({{1, 0, 1}, {2, 1, 2}}, 0.5, true), (Volumes{1, 2, outside}));
  MediaStack in_both;
  in_both.enter(1);
  in_both.enter(2);
  EXPECT_EQ(sequence({{1, 0, 4}, {2, 1, 3}}, 2, true, in_both), (Volumes{2, 1, outside}));
}

TEST(OpticsMedia, ReflectionSheetsAndCapacity) {
  MediaStack s;
  s.enter(7);
  MediumSides const back = sides(s, {7, false, 0});
  EXPECT_EQ(back.before.current(), 7u);  // reflected inside
  EXPECT_EQ(back.after.current(), outside);
  MediumSides const sheet = sides(s, {outside, true, 0});
  EXPECT_EQ(sheet.in, 7u);
  EXPECT_EQ(sheet.out, 7u);
  s.enter(7);
  EXPECT_EQ(s.depth, 1);
  for (std::uint32_t v = 0; v < MediaStack::capacity; ++v) s.enter(v + 10);
  EXPECT_TRUE(s.overflow);
  s.leave(7);
  EXPECT_EQ(s.depth, MediaStack::capacity - 1);
}

// Between equal glasses nothing is reflected; between nearly equal ones hardly anything.
TEST(OpticsMedia, EqualIndicesDoNotReflect) {
  for (double c : {0.0, 1e-6, 0.3, 1.0}) {
    Amplitudes const a = Fresnel{}.amplitudes(c, 1.45, 1.45, true);
    EXPECT_EQ(a.reflectance(), 0);
    EXPECT_EQ(a.transmittance(), 1);
  }
  EXPECT_GT(Fresnel{}.amplitudes(0.3, 1.45, 1.46, true).reflectance(), 1e-4);
}

// exp(-alpha d): 20 ppm/cm over 5 cm keep 1 - 100 ppm, to 1e-15 of the exact exponential. Control: decay of the field.
TEST(OpticsMedia, Absorption) {
  EXPECT_NEAR(kept_on_the_way(2e-3, 0.05), std::exp(-1e-4), 1e-15);
  EXPECT_GT(std::fabs(kept_on_the_way(1e-3, 0.05) - std::exp(-1e-4)), 1e-5);
  EXPECT_EQ(kept_on_the_way(0, 1e9), 1);
}

// docs/reference/library.md and catalogue values at the sodium or helium line, to the last printed digit.
TEST(OpticsMedia, PresetIndices) {
  auto const index = [](std::string_view name, double wavelength) {
    for (MediumPreset const& p : medium_presets())
      if (p.name == name) return index_of(p, wavelength).value_or(0);
    return -1.0;
  };
  EXPECT_NEAR(index("fused_silica", 1.064e-6), 1.44963, 5e-6);
  EXPECT_NEAR(index("fused_silica", 587.6e-9), 1.45846, 6e-6);
  EXPECT_NEAR(index("bk7", 1.064e-6), 1.50669, 6e-5);  // the data sheet gives 1.50663
  EXPECT_NEAR(index("bk7", 587.6e-9), 1.5168, 2e-5);
  EXPECT_NEAR(index("sapphire", 1.064e-6), 1.754, 6e-4);
  EXPECT_NEAR(index("calcium_fluoride", 587.6e-9), 1.43385, 5e-5);
  EXPECT_NEAR(index("silicon", 1.55e-6), 3.478, 1e-3);
  EXPECT_EQ(index("suprasil", 1.064e-6), 1.45003);
  EXPECT_EQ(index("herasil", 1.064e-6), 1.45012);
  EXPECT_EQ(index("silicon_carbide", 1.064e-6), 2.5835);
  EXPECT_EQ(index("silicon", 1.064e-6), 0);  // opaque there: outside the range
  EXPECT_EQ(index("suprasil", 1.55e-6), 0);
  for (MediumPreset const& p : medium_presets()) EXPECT_FALSE(p.source.empty()) << p.name;
}

}  // namespace
}  // namespace straytrace::optics_media
