// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/rim_light.hpp"

#include "noise/project/rim_noise.hpp"

namespace straytrace::session {

bool counts_rims(Scene const& scene) { return scene.root().flag("rims", false); }

void check_rims(Scene const& scene, World const& world, Interferometer const& detector) {
  if (!counts_rims(scene)) return;
  constexpr double probe = 100;  // Hz
  for (CouplingClass const& c : moving_rim_classes(world).classes) {
    if (detector.strain_per_passing_amplitude(c.port, probe)) continue;
    InputError const error = without_passing_amplitude(world.ports()[c.port.value]);
    scene.root()["rims"].problem(error.reason(), error.remedy());
    return;
  }
}

}  // namespace straytrace::session
