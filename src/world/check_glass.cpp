// SPDX-License-Identifier: BSD-3-Clause
// Bare boundaries of glass without glass: light would pass them as if nothing were there.
#include <fmt/format.h>

#include <set>

#include "world/read_parts.hpp"

namespace straytrace {
namespace {

bool is_bare_boundary(World const& world, std::uint32_t optic) {
  Optic const& o = world.view().optics[optic];
  if (!o.has_interface) return false;
  return world.view().interfaces.visit(o.interface, [](auto const& interface) {
    if constexpr (std::is_same_v<std::decay_t<decltype(interface)>, Fresnel>)
      return interface.opaque.re == 0 && interface.opaque.im == 0;
    else
      return false;
  });
}

}  // namespace

void check_glass(Scene const& scene, World const& world) {
  std::set<std::uint32_t> told;
  for (Surface const& s : world.surfaces()) {
    if (s.volume != Surface::none || !(is_bare_boundary(world, s.front) || is_bare_boundary(world, s.back))) continue;
    if (!told.insert(s.group.value).second) continue;
    std::string const name = world.groups()[s.group.value], part = name.substr(name.rfind('/') + 1);
    scene.root()["scene"].warning(
        fmt::format("'{}' is a bare boundary (specular: fresnel), but nothing is filled with glass there: it neither "
                    "reflects nor refracts",
                    name),
        fmt::format("give it a medium, 'medium: fused_silica'; one part of a file: 'medium: {{{}: fused_silica}}'",
                    part));
  }
}

}  // namespace straytrace
