// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/drawn_optics.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <type_traits>

#include "base/input/document.hpp"
#include "world/build/network_powers.hpp"

namespace straytrace::session {
namespace {

NodeData const* entry(NodeData const* table, std::string_view key) {
  NodeData::Entry const* const found = table ? table->find(key) : nullptr;
  return found ? found->value.get() : nullptr;
}

// The values of `optic` in the components of an interferometer. No key counts as read by this.
std::set<std::string> names_of_optics(Node const& interferometer) {
  std::set<std::string> names;
  NodeData const* const components = entry(entry(interferometer.data().get(), "network"), "components");
  if (!components) return names;
  for (NodeData::Entry const& component : components->entries)
    for (NodeData::Entry const& kind : component.value->entries)
      if (NodeData const* const optic = entry(kind.value.get(), "optic")) names.insert(optic->text);
  return names;
}

}  // namespace

std::vector<DrawnOptic> drawn_optics(Node const& interferometer, World const& world) {
  if (names_of_optics(interferometer).empty()) return {};
  std::map<std::string, int> count;
  std::vector<DrawnOptic> all;
  std::vector<std::string> const bodies = world.body_names();
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    Surface const& surface = world.surfaces()[id];
    ++count[world.name_of({id})];
    world.view().shapes.visit(surface.shape, [&](auto const& s) {
      using Shape = std::decay_t<decltype(s)>;
      if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) {
        DrawnOptic optic{world.name_of({id}), surface.body.valid() ? bodies.at(surface.body.value) : "", s.reference(),
                         s.axis};
        if constexpr (std::is_same_v<Shape, Cap>) optic.curvature = s.curvature;
        all.push_back(std::move(optic));
      }
    });
  }
  std::erase_if(all, [&](DrawnOptic const& o) { return count[o.name] > 1; });
  return all;
}

// Powers of beams are not needed for surfaces: `faulty` asks for none.
std::vector<DrawnOptic> drawn_optics(Scene const& scene) {
  if (names_of_optics(scene.root()["interferometer"]).empty()) return {};
  Scene const again = read_scene(scene.main_file(), scene.overrides(), &scene.files());
  NetworkPowers powers;
  powers.faulty = true;
  return drawn_optics(again.root()["interferometer"], build_world(again, powers));
}

std::vector<DrawnOptic> named_optics(Node const& interferometer, std::vector<DrawnOptic> const& all) {
  std::set<std::string> const names = names_of_optics(interferometer);
  std::vector<DrawnOptic> used;
  for (DrawnOptic const& o : all)
    if (names.contains(o.name)) used.push_back(o);
  return used;
}

}  // namespace straytrace::session
