// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/cavity_waves.hpp"

#include <chrono>

#include "base/errors.hpp"
#include "session/interrupt.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

ArmWaves solve_waves(World const& world, unsigned threads, PrintOptions const& print, ArmOptions options) {
  InterruptGuard const guard;
  ProgressLine line(print.quiet);
  auto const begin = std::chrono::steady_clock::now();
  options.threads = int(threads);
  options.progress = [&](std::string const& what) {
    if (guard.stop())
      throw InputError("interrupted while the field of the cavity was computed; nothing was traced", "run it again");
    std::chrono::duration<double> const passed = std::chrono::steady_clock::now() - begin;
    line.at(passed.count(), [&] { return "wave: " + what; });
  };
  return solve_arm(world, world.wave, options);
}

}  // namespace straytrace::session
