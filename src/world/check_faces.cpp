// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that share space: faces on each other, where rounding decides what light meets, and faces that pass through
// each other, which is seldom meant.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "world/face_pairs.hpp"
#include "world/read_parts.hpp"

namespace straytrace {
namespace {

constexpr double least_depth = 1e-5;  // m: what is drawn with less care than this is left alone

struct SharedSpace {
  int pairs = 0;
  FacePair deepest;
};

// By the two groups, so that a hundred baffles in one tube are one sentence.
std::map<std::pair<std::string, std::string>, SharedSpace> by_group(World const& world, std::vector<FacePair> const& pairs) {
  std::map<std::pair<std::string, std::string>, SharedSpace> all;
  auto const group = [&](SurfaceId id) { return world.groups()[world.surfaces()[id.value].group.value]; };
  for (FacePair const& p : pairs) {
    SharedSpace& s = all[std::minmax(group(p.first), group(p.second))];
    if (s.pairs++ == 0 || p.depth > s.deepest.depth) s.deepest = p;
  }
  return all;
}

std::string place_of(SharedSpace const& s) {
  auto const to_a_tenth_of_a_millimetre = [](double x) { return std::round(1e4 * x) / 1e4 + 0.0; };
  Vec3 const at = s.deepest.at;
  std::string const more = s.pairs == 2  ? ", and in one more place"
                           : s.pairs > 2 ? fmt::format(", and in {} more places", s.pairs - 1)
                                         : "";
  return fmt::format("at [{:.10g}, {:.10g}, {:.10g}] m{}", to_a_tenth_of_a_millimetre(at.x),
                     to_a_tenth_of_a_millimetre(at.y), to_a_tenth_of_a_millimetre(at.z), more);
}

// The entry of the scene that the later one of the two comes from.
Node entry_of(Scene const& scene, World const& world, SharedSpace const& shared) {
  std::string const& group = world.groups()[world.surfaces()[shared.deepest.second.value].group.value];
  for (Scene::Instance const& instance : scene.instances())
    if (group == instance.group || group.rfind(instance.group + '/', 0) == 0) return instance.placement;
  return scene.root()["scene"];
}

}  // namespace

void check_faces(Scene const& scene, World const& world) {
  for (auto const& [names, shared] : by_group(world, coincident_faces(world)))
    entry_of(scene, world, shared)
        .problem(fmt::format("faces of '{}' and '{}' lie on each other {}: rounding decides which of them light meets",
                             names.first, names.second, place_of(shared)),
                 "keep one of them, or move one by more than a nanometre");
  for (auto const& [names, shared] : by_group(world, crossing_faces(world, least_depth))) {
    bool const one_entry =
        names.first.substr(0, names.first.find('/')) == names.second.substr(0, names.second.find('/'));
    if (one_entry && names.first != names.second) continue;  // plates let into the box of a dump: as its author drew it
    entry_of(scene, world, shared)
        .warning(fmt::format("'{}' and '{}' pass through each other, {:.2g} mm deep, {}", names.first, names.second,
                             1e3 * shared.deepest.depth, place_of(shared)),
                 "light meets whichever comes first; change a length if they should only touch");
  }
}

}  // namespace straytrace
