// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "motion/motion_reader.hpp"

namespace straytrace::motion {

double MotionSet::sensitivity(std::size_t i, std::span<PhaseSensitivity const> phase_sensitivities, double hz) const {
  std::complex<double> phase = 0;  // per unit of the input
  for (PhaseSensitivity const& phase_sensitivity : phase_sensitivities)
    for (Gain const& gain : inputs[i].gains)
      if (gain.body == phase_sensitivity.body)
        phase += phase_sensitivity.d[gain.axis] * gain.value * (gain.transfer ? (*gain.transfer)(hz) : 1.0);
  return std::norm(phase);
}

namespace {

// Equal chains become one object, so that bodies with equal motion are recognised.
void share_transfers(std::vector<Gain>& gains) {
  for (auto gain = gains.begin(); gain != gains.end(); ++gain)
    for (auto before = gains.begin(); gain->transfer && before != gain; ++before)
      if (before->transfer && *before->transfer == *gain->transfer) gain->transfer = before->transfer;
}

void report_missing_mode(Node const& table, std::string const& name) {
  auto const stroke = name.find('/');
  std::string const body = name.substr(0, stroke), mode = name.substr(stroke + 1);
  for (auto const& [other, node] : table.items())
    if (other == body)
      node.problem(fmt::format("mode '{}' has no motion", name),
                   fmt::format("add 'modes: {{{}: {{motion: still}}}}' to body '{}'", mode, body));
}

// A misspelt name is reported where it is written.
bool is_misspelt(Node const& table, std::string const& name, std::vector<std::string> const& of_run) {
  for (auto const& [other, node] : table.items())
    if (std::find(of_run.begin(), of_run.end(), other) == of_run.end() && nearest_word(other, of_run) == name)
      return true;
  return false;
}

// Bodies with all their modes, in one problem.
void report_missing(Node const& table, std::vector<std::string> const& names) {
  if (names.empty()) return;
  bool const one = names.size() == 1;
  table.problem(
      fmt::format("{} '{}' {} no motion", one ? "body" : "bodies", fmt::join(names, "', '"), one ? "has" : "have"),
      fmt::format("add '{}: {{motion: still}}' to 'bodies', or its spectrum{}", names[0], one ? "" : ", and so on"));
}

}  // namespace

std::vector<std::string> bodies_and_modes(Node const& bodies_table) {
  std::vector<std::string> names, modes;
  for (auto const& [name, node] : bodies_table.items()) {
    names.push_back(name);
    if (node.kind() != Node::Kind::table || !node.has("modes")) continue;
    for (auto const& [mode, spec] : node.table("modes").items()) modes.push_back(name + "/" + mode);
  }
  names.insert(names.end(), modes.begin(), modes.end());
  return names;
}

MotionSet read_motion(Node const& bodies_table, std::vector<std::string> const& bodies, bool traced,
                      std::vector<bool> const& placed) {
  MotionReader reader(bodies_table);
  MotionSet set;
  set.bodies = bodies;
  std::vector<Axes> axes(bodies.size());
  std::vector<std::string> missing;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bool const met = placed.empty() || placed[b];
    if (reader.knows(bodies[b])) {
      if (met) reader.use(bodies[b]);
      axes[b] = reader.resolve(bodies[b]);
      continue;
    }
    if (!met) continue;  // its motion does not affect any light
    if (bodies[b].find('/') != std::string::npos)
      report_missing_mode(bodies_table, bodies[b]);
    else if (!traced || !is_misspelt(bodies_table, bodies[b], bodies))
      missing.push_back(bodies[b]);
  }
  report_missing(bodies_table, missing);
  reader.finish(traced ? &bodies : nullptr);
  set.inputs = std::move(reader.inputs);
  set.files = std::move(reader.files);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int axis = 0; axis < 6; ++axis)
      for (auto const& [input, gain, through] : axes[b][axis])
        set.inputs[input].gains.push_back({BodyId{static_cast<std::uint32_t>(b)}, axis, gain, through});
  for (MotionInput& input : set.inputs) share_transfers(input.gains);
  std::erase_if(set.inputs, [](MotionInput const& i) { return i.gains.empty(); });
  return set;
}

}  // namespace straytrace::motion
