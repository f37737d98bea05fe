// SPDX-License-Identifier: BSD-3-Clause
// Where stray light joins the light of an interferometer again (docs/theory/interferometer.md).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace straytrace {

// The relative field s of a path refers to the main light named here.
enum class InjectionPoint : std::uint8_t {
  arm,               // an arm, scattered at its input mirror; the light that leaves it into the arm (eq. 9.1, 9.2)
  end_mirror,        // an arm, scattered at its end mirror; the light that leaves it into the arm
  through_end,       // an end mirror from behind, passed twice in s already; the light that leaves it into the arm
  end_bench,         // an end mirror from behind; the light that leaves it there (eq. 9.3, 9.4)
  short_arm,         // between splitter and input mirror, on the way to the arm; the light there (eq. 9.5)
  recycling_cavity,  // between power-recycling mirror and splitter, on the way to the splitter; the light there
  signal_cavity,     // between splitter and signal-recycling mirror, on the way out; the light there
  as_port,           // the signal-recycling mirror from outside; the light that leaves it (eq. 9.6)
  symmetric_port,    // the power-recycling mirror from outside; the light that comes back from it
  input_bench        // the input beam; that light (eq. 9.7)
};
constexpr std::array<std::string_view, 10> entrance_names = {
    "arm",           "end-mirror", "through-end",    "end-bench",  "short-arm", "recycling-cavity",
    "signal-cavity", "as-port",    "symmetric-port", "input-bench"};
// One of two equal arms has it, not the whole interferometer.
constexpr bool is_of_an_arm(InjectionPoint e) { return e <= InjectionPoint::short_arm; }
constexpr bool is_behind_the_end(InjectionPoint e) {
  return e == InjectionPoint::through_end || e == InjectionPoint::end_bench;
}
// Relative to the light that circulates in an arm.
constexpr bool is_inside_an_arm(InjectionPoint e) { return e <= InjectionPoint::through_end; }

}  // namespace straytrace
