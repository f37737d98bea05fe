// SPDX-License-Identifier: BSD-3-Clause
#include "device/laws.hpp"

#include "contract/optics/instances.hpp"

namespace straytrace::testing {
namespace {

template <class Law>
std::uint32_t optic_of(World& world) {
  Optic optic;
  optic.reflect = 0.2;
  optic.depolarise = 0.5;
  optic.laws = 1;
  optic.law[0] = world.add_law(instances<Law>().front());
  return world.add_optic(optic);
}
template <class... Law>
std::vector<std::uint32_t> optics_of(World& world, std::tuple<Law...>*) {
  return {optic_of<Law>(world)...};
}

}  // namespace

std::vector<std::uint32_t> optics_of_all_laws(World& world) {
  return optics_of(world, static_cast<LawTypes*>(nullptr));
}

}  // namespace straytrace::testing
