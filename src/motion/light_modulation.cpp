// SPDX-License-Identifier: BSD-3-Clause
#include "motion/light_modulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace straytrace::motion {
namespace {

constexpr char const* write_tone =
    "write {amplitude: 1 %, frequency: 40 Hz}, {phase: 0.1 rad, frequency: 40 Hz} or {deviation: 10 kHz, frequency: "
    "40 Hz}";

void read_tone(Node const& t, LightTone tone, std::vector<LightTone>& into) {
  if (t.kind() != Node::Kind::table) return t.problem("a modulation is a table", write_tone);
  bool const amplitude = t.has("amplitude"), phase = t.has("phase"), deviation = t.has("deviation");
  if (amplitude) tone.amplitude = t.number("amplitude", dim::plain, required, 0, 1);
  if (phase) tone.phase = t.number("phase", dim::angle, required, 0, 1e6);
  double const hz = deviation ? t.number("deviation", dim::frequency, required, 0, 1e12) : 0;
  tone.frequency = t.number("frequency", dim::frequency, required, 1e-6, 1e9);
  tone.start = t.number("start", dim::angle, 0, -1e6, 1e6);
  if (deviation) tone.phase = hz / tone.frequency;  // dphi/dt = 2 pi deviation at its peak
  t.refuse_unknown("a modulation");
  if (amplitude + phase + deviation != 1)
    return t.problem(amplitude + phase + deviation > 1 ? "a modulation is of amplitude, phase or frequency"
                                                       : "the size of the modulation is missing",
                     amplitude + phase + deviation > 1 ? "write one entry of a list for each" : write_tone);
  if (std::isfinite(tone.amplitude + tone.phase + tone.frequency + tone.start)) into.push_back(std::move(tone));
}

}  // namespace

LightModulation read_modulation(Node const& beams, Node const& ports, std::vector<std::string> const& port_names) {
  LightModulation light;
  std::vector<std::string> names;
  for (auto const& [name, beam] : beams.items()) {
    auto const number = std::uint32_t(names.size());
    names.push_back(name);
    if (beam.kind() != Node::Kind::table || !beam.has("modulation")) continue;
    auto const tones = beam["modulation"].as_list();
    if (tones.empty()) beam["modulation"].problem("'modulation' names no modulation", write_tone);
    for (Node const& tone : tones) read_tone(tone, {number, name}, light.tones);
  }
  if (light.tones.empty()) return light;
  light.port_beam.assign(port_names.size(), no_light);
  for (auto const& [name, port] : ports.items()) {
    auto const at = std::ranges::find(port_names, name);
    if (at == port_names.end() || port.kind() != Node::Kind::table || !port.has("beam")) continue;
    auto const beam = std::ranges::find(names, port["beam"].text());
    if (beam != names.end())
      light.port_beam[std::size_t(at - port_names.begin())] = std::uint32_t(beam - names.begin());
  }
  return light;
}

}  // namespace straytrace::motion
