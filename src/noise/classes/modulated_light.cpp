// SPDX-License-Identifier: BSD-3-Clause
#include "noise/classes/modulated_light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/math/constants.hpp"

namespace straytrace::noise {
namespace {

constexpr int in_phase = 3, in_quadrature = 4;  // coordinates of the phase of light

bool modulates_phase(LightTone const& t) { return t.phase != 0; }
bool modulates_amplitude(LightTone const& t) { return t.amplitude != 0; }

BodyId add_body(CouplingTable& table, MotionSet& motion, std::string name) {
  motion.bodies.resize(std::max(motion.bodies.size(), table.bodies.size()));
  table.bodies.resize(motion.bodies.size());
  BodyId const body{std::uint32_t(motion.bodies.size())};
  motion.light.first_body = std::min(motion.light.first_body, body.value);
  motion.light.end_body = body.value + 1;
  motion.bodies.push_back(name);
  table.bodies.push_back(std::move(name));
  return body;
}

// Tones of one frequency are one input, because their phases are stated.
MotionInput& input_at(MotionSet& motion, double hz) {
  auto const same = std::ranges::find_if(motion.inputs, [&](MotionInput const& i) { return i.tone_frequency == hz; });
  if (same != motion.inputs.end()) return *same;
  MotionInput& input = motion.inputs.emplace_back();
  input.name = fmt::format("tone {} Hz", hz);
  input.tone_frequency = hz;
  return input;
}

// cos wt and sin wt of the delay, less 1 of the local field; differences of close numbers are avoided.
PhaseSensitivity phase_of_light(BodyId body, double turns, bool source, bool local) {
  PhaseSensitivity s{body, {}};
  double const half = std::sin(pi * turns);
  if (source) s.d[in_quadrature] = std::sin(2 * pi * turns);
  if (source && local)
    s.d[in_phase] = -2 * half * half;
  else if (source)
    s.d[in_phase] = 1 - 2 * half * half;
  else if (local)
    s.d[in_phase] = -1;
  return s;
}

double delay_turns(PathRecord const& r, double hz) {
  double const turns = hz * std::max(0.0, r.path_length) / speed_of_light;
  return turns - std::floor(turns);
}

void add_tone(CouplingTable& table, MotionSet& motion, LightTone const& tone) {
  BodyId const body = add_body(table, motion, fmt::format("{} {:g} Hz", tone.name, tone.frequency));
  std::complex<double> const now = std::polar(tone.phase, tone.start);  // a coordinate is Im(value exp(+2 pi i f t))
  MotionInput& input = input_at(motion, tone.frequency);
  input.gains.push_back({body, in_phase, std::complex<double>(0, 1) * now});
  input.gains.push_back({body, in_quadrature, now});
  for (CouplingClass& c : table.classes) {
    if (c.kind == ClassKind::rim) continue;  // the amplitude that passes has no phase (eq. N.21)
    bool const local = source_beam(motion.light, beam_of_port, c.port) == tone.beam;
    for (PathRecord& r : c.records) {
      bool const source = source_beam(motion.light, r.beam, c.port) == tone.beam;
      PhaseSensitivity const s = phase_of_light(body, delay_turns(r, tone.frequency), source, local);
      if (s.d[in_phase] != 0 || s.d[in_quadrature] != 0) r.phase_sensitivities.push_back(s);
    }
  }
}

}  // namespace

std::uint32_t source_beam(LightModulation const& light, std::uint32_t beam, PortId port) {
  if (beam != beam_of_port) return beam;
  return port.value < light.port_beam.size() ? light.port_beam[port.value] : no_light;
}

void add_phase_modulation(CouplingTable& table, MotionSet& motion) {
  std::vector<LightTone> const tones = motion.light.tones;
  for (LightTone const& tone : tones)
    if (modulates_phase(tone)) add_tone(table, motion, tone);
  for (LightTone& tone : motion.light.tones) tone.phase = 0;
  std::erase_if(motion.light.tones, [](LightTone const& t) { return !modulates_amplitude(t); });
}

ModulatedLight::ModulatedLight(CouplingTable const& table, MotionSet const& motion)
    : given_table_(table), given_motion_(motion) {
  if (std::ranges::none_of(motion.light.tones, modulates_phase)) return;
  table_ = table;
  motion_ = motion;
  add_phase_modulation(*table_, *motion_);
}

namespace {

// The records of a class whose beam has this tone, each twice: a field of m/2 that gains or loses f turns a second.
void add_sidebands(CouplingClass& sum, CouplingClass const& c, LightModulation const& light, LightTone const& tone,
                   BodyId clock) {
  double const share = tone.amplitude * tone.amplitude / 4;
  for (PathRecord const& r : c.records) {
    if (c.kind == ClassKind::rim || source_beam(light, r.beam, c.port) != tone.beam) continue;
    for (double const sign : {1.0, -1.0}) {
      PathRecord side = r;
      side.weight *= share;
      side.coupling *= share;
      for (std::complex<double>& field : side.field)
        field *= std::polar(tone.amplitude / 2, sign * (tone.start - 2 * pi * delay_turns(r, tone.frequency)));
      PhaseSensitivity turning{clock, {}};
      turning.d[in_phase] = sign * 2 * pi * tone.frequency;
      side.phase_sensitivities.push_back(turning);
      sum.records.push_back(std::move(side));
    }
  }
}

}  // namespace

AmplitudeSidebands amplitude_sidebands(CouplingTable const& table, MotionSet const& motion) {
  AmplitudeSidebands out{table, motion, std::vector<std::optional<std::size_t>>(table.classes.size())};
  out.motion.light.tones.clear();
  BodyId const clock = add_body(out.table, out.motion, "clock");
  MotionInput& input = out.motion.inputs.emplace_back();
  input.name = "modulation of amplitudes";
  input.drift = true;
  input.gains.push_back({clock, in_phase, 1.0});
  for (std::size_t i = 0; i < table.classes.size(); ++i) {
    CouplingClass const& c = table.classes[i];
    CouplingClass sum = c;
    sum.records.clear();
    for (LightTone const& tone : motion.light.tones)
      if (modulates_amplitude(tone)) add_sidebands(sum, c, motion.light, tone, clock);
    if (sum.records.empty()) continue;
    double carrier = 0, sides = 0;
    for (PathRecord const& r : c.records) carrier += r.weight;
    for (PathRecord const& r : sum.records) sides += r.weight;
    double const ratio = sides / carrier;
    sum.coupling.mean *= ratio;
    sum.coupling.std_error *= ratio;
    for (double& x : sum.replica_sum) x *= ratio;
    sum.phase_sensitivities.clear();
    out.of[i] = out.table.classes.size();
    out.table.classes.push_back(std::move(sum));
  }
  return out;
}

}  // namespace straytrace::noise
