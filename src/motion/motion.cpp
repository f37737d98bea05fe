// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/input/document.hpp"
#include "base/input/table.hpp"
#include "motion/axis_motion.hpp"
#include "spectra/spectrum.hpp"

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

struct Term {
  std::size_t input;
  std::complex<double> gain;
  Transfer through;
};
using Terms = std::vector<Term>;
using Axes = std::array<Terms, 6>;

class MotionReader {
 public:
  explicit MotionReader(Node const& table);

  bool knows(std::string const& name) const { return bodies_.contains(name); }
  // Motion of a body in terms of the inputs; resolves the bodies it refers to.
  Axes const& resolve(std::string const& name);
  void use(std::string const& name) { bodies_.at(name).used = true; }  // light reaches it, or it carries another body
  // Reports unused bodies; `of_run`: the bodies of a traced run, or null.
  void finish(std::vector<std::string> const* of_run);
  std::vector<MotionInput> inputs;
  std::vector<MotionFile> files;

 private:
  enum class State { untouched, under_way, done };
  struct Body {
    Node node;
    bool is_mode = false;  // an elastic mode of the body before the stroke: one coordinate, the first
    State state = State::untouched;
    Axes axes = {};
    bool used = false;
  };
  // One body while its coordinates are resolved: they may refer to each other.
  struct Draft {
    std::string const& name;
    std::array<AxisMotion, 6> written;
    std::array<State, 6> state{};
    Axes axes;
  };

  void read_body(std::string const& name, Body& body);
  void read_mode(std::string const& name, Body& body);
  Axes const* carrier(std::string const& name, std::string const& target, Node const& where);
  void carry_along(std::string const& name, Node const& other, Transfer const& through, Body& body);
  void resolve_axis(Draft& draft, int axis);
  void note_files(Draft const& draft, Axes const& axes, bool is_mode);
  void resolve_reference(Draft& draft, int axis, AxisReference const& reference);
  std::size_t gaussian(std::string name, OwnMotion const&);
  std::size_t tone(Tone const&);
  std::size_t drift();
  std::size_t joint_input(JointMotion const&, std::size_t column);
  Term passed_on(Term term, double scale, Transfer const& through, Node const& where) const;
  Term independent(Term const&, std::string name, AxisReference const&);

  std::map<std::string, Body> bodies_;
  std::map<std::pair<std::string, std::size_t>, std::size_t> joint_inputs_;
};

MotionReader::MotionReader(Node const& table) {
  for (auto& [name, node] : table.items()) {
    bodies_.try_emplace(name, Body{node});
    if (node.kind() != Node::Kind::table || !node.has("modes")) continue;
    for (auto& [mode, spec] : node.table("modes").items()) bodies_.try_emplace(name + "/" + mode, Body{spec, true});
  }
}

Axes const& MotionReader::resolve(std::string const& name) {
  Body& body = bodies_.at(name);
  if (body.state == State::untouched) {
    body.state = State::under_way;
    read_body(name, body);
    body.state = State::done;
  }
  return body.axes;
}

void MotionReader::finish(std::vector<std::string> const* of_run) {
  for (auto& [name, body] : bodies_) {
    if (body.used) continue;
    bool const unknown = of_run && std::find(of_run->begin(), of_run->end(), name) == of_run->end();
    std::string const near = unknown ? nearest_word(name, *of_run) : "";
    if (unknown)
      body.node.problem(fmt::format("the run has no {} '{}'", body.is_mode ? "mode" : "body", name),
                        !near.empty() ? fmt::format("did you mean '{}'?", near)
                        : body.is_mode
                            ? "phase sensitivities come from the trace: run the scene again with this mode in it"
                            : fmt::format("let a body of the run follow it: {}", fmt::join(*of_run, ", ")));
    else
      body.node.warning(fmt::format("body '{}' moves, but no part belongs to it", name),
                        "write 'body: " + name + "' at a part, or remove it");
    resolve(name);  // reports its own mistakes too
  }
}

namespace {

constexpr std::array<std::string_view, 1> only_still = {"still"};
constexpr char const* write_motion = "write 'motion: still' or 'motion: {x: ..., y: ..., z: ...}'";

// `motion` of a body that is not a table; nothing is reported where there is none.
void refuse_unless_still(Node const& motion) {
  if (!motion || motion.text() == only_still[0]) return;
  std::string const got =
      motion.kind() == Node::Kind::list ? "a list" : fmt::format("\"{}\"", shortened(motion.text()));
  std::array<std::string, 1> const known = {std::string(only_still[0])};
  motion.problem(fmt::format("'motion' cannot be {}", got), did_you_mean(motion.text(), known, write_motion));
}

// Reports keys of one coordinate that are written where coordinates are named.
bool report_misplaced(Node const& motion) {
  bool any = false;
  for (NodeData::Entry const& e : motion.data()->entries) {  // keys without a reader remain unknown
    std::string const& key = e.key;
    if (!says_how_one_moves(key)) continue;
    motion[key].problem(
        fmt::format("'{}' is the motion of one coordinate, which is not named", key),
        fmt::format("write it under the coordinate: z: {{{}: ...}}, and 'others: still' for the rest", key));
    any = true;
  }
  return any;
}

}  // namespace

void MotionReader::read_body(std::string const& name, Body& body) {
  if (body.is_mode) return read_mode(name, body);
  if (body.node.kind() != Node::Kind::table) {
    body.node.problem(fmt::format("body '{}' is a table", name),
                      "write {motion: still} or {motion: {x: ..., y: ..., z: ...}}");
    return;
  }
  body.node["modes"];
  body.node["pivot"];
  Node const motion = body.node["motion"];
  if (!body.node.has("motion")) body.node.lack("motion", fmt::format("body '{}' has no 'motion'", name), write_motion);
  body.node.refuse_unknown(fmt::format("body '{}'", name));
  if (motion.kind() != Node::Kind::table) return refuse_unless_still(motion);
  Draft draft{name, {}, {}, {}};
  double const uncertainty = read_uncertainty(motion["uncertainty"]);
  bool const rest_still = motion.has("others");
  if (rest_still) motion.choice("others", only_still);
  bool const follows = motion.has("follows");
  std::array<bool, 6> hangs{};
  std::vector<std::string> untold;
  if (motion.has("suspended")) hangs = add_suspended(motion["suspended"], draft.written);
  for (int axis = 0; axis < 6; ++axis) {
    Node const spec = motion[axis_names[axis]];
    if (spec) read_axis(spec, axis, uncertainty, draft.written[axis]);
    if (!spec && !hangs[axis] && !is_rotation(axis) && !rest_still && !follows) untold.emplace_back(axis_names[axis]);
  }
  if (!report_misplaced(motion) && !untold.empty())
    motion.problem(fmt::format("body '{}' has no motion along {}", name, fmt::join(untold, " and ")),
                   fmt::format("write '{}: still', or 'others: still' for all other coordinates", untold.front()));
  for (int axis = 0; axis < 6; ++axis) resolve_axis(draft, axis);
  body.axes = std::move(draft.axes);
  if (motion.has("through") && !follows)
    motion["through"].problem("'through' is the chain between a body and the one it follows",
                              "write 'follows: BODY' next to it, or 'through' in the motion of a coordinate");
  if (follows) carry_along(name, motion["follows"], read_chain(motion["through"]), body);
  if (motion.has("relative_to")) carry_along(name, motion["relative_to"], {}, body);
  note_files(draft, body.axes, false);
  motion.refuse_unknown(fmt::format("the motion of body '{}'", name));
}

void MotionReader::read_mode(std::string const& name, Body& body) {
  if (body.node.kind() != Node::Kind::table) {
    body.node.problem(fmt::format("mode '{}' is not a table", name), "write {shape: ..., motion: ...}");
    return;
  }
  body.node["shape"];
  Node const motion = body.node["motion"];
  if (!body.node.has("motion"))
    body.node.lack("motion", fmt::format("mode '{}' has no 'motion'", name),
                   "write 'motion: still', or the motion of its one coordinate, as of 'x' of a body");
  body.node.refuse_unknown(fmt::format("mode '{}'", name));
  if (!motion) return;
  Draft draft{name, {}, {}, {}};
  read_axis(motion, 0, 1, draft.written[0]);
  resolve_axis(draft, 0);
  note_files(draft, draft.axes, true);
  body.axes = std::move(draft.axes);
}

// Other motion of a coordinate may continue where a file ends.
void MotionReader::note_files(Draft const& draft, Axes const& axes, bool is_mode) {
  for (int axis = 0; axis < 6; ++axis)
    for (MotionFile file : draft.written[axis].files) {
      std::vector<Band> beside = draft.written[axis].bands;
      for (std::size_t i = draft.written[axis].own.size(); i < axes[axis].size(); ++i)  // own terms come first
        if (Spectrum const& s = inputs[axes[axis][i].input].spectrum; s.total() > 0)
          beside.push_back({s.lowest(), s.highest()});
      file.coordinate = is_mode ? draft.name : fmt::format("{} {}", draft.name, axis_names[axis]);
      file.covered = joined(file.known, beside);
      files.push_back(std::move(file));
    }
}

// The motion of the carrier of another body; empty and a problem when it is unknown or depends on that body.
Axes const* MotionReader::carrier(std::string const& name, std::string const& target, Node const& where) {
  auto const hit = bodies_.find(target);
  if (hit == bodies_.end()) {
    std::vector<std::string> names;
    for (auto const& entry : bodies_) names.push_back(entry.first);
    where.problem(fmt::format("body '{}' is not defined", target),
                  did_you_mean(target, names, "name a body of the table 'bodies'"));
    return nullptr;
  }
  if (hit->second.state == State::under_way) {
    where.problem(fmt::format("the motion of body '{}' refers to itself through '{}'", name, target),
                  "let one of the bodies state its own motion");
    return nullptr;
  }
  use(target);
  return &resolve(target);
}

// Adds the motion of another body, input by input, so that the two stay coherent.
void MotionReader::carry_along(std::string const& name, Node const& other, Transfer const& through, Body& body) {
  Axes const* const axes = carrier(name, other.as_word(), other);
  for (int axis = 0; axes && axis < 6; ++axis)
    for (Term const& term : (*axes)[axis]) body.axes[axis].push_back(passed_on(term, 1, through, other));
}

void MotionReader::resolve_axis(Draft& draft, int axis) {
  if (draft.state[axis] != State::untouched) return;
  draft.state[axis] = State::under_way;
  AxisMotion const& written = draft.written[axis];
  Terms& terms = draft.axes[axis];
  for (OwnMotion const& own : written.own)
    terms.push_back({gaussian(fmt::format("{} {}", draft.name, axis_names[axis]), own), own.scale, own.through});
  for (JointMotion const& j : written.joint)
    for (std::size_t column = 0; column < j.row.size(); ++column)
      if (j.row[column]) terms.push_back({joint_input(j, column), j.scale, chained(j.row[column], j.through)});
  for (Tone const& t : written.tones) terms.push_back({tone(t), t.amplitude, {}});
  if (written.drift != 0 && std::isfinite(written.drift)) terms.push_back({drift(), written.drift, {}});
  for (AxisReference const& r : written.references) resolve_reference(draft, axis, r);
  draft.state[axis] = State::done;
}

void MotionReader::resolve_reference(Draft& draft, int axis, AxisReference const& r) {
  Axes const* axes = &draft.axes;
  if (!r.body.empty() && r.body != draft.name) {
    axes = carrier(draft.name, r.body, r.where);
    if (!axes) return;
  } else if (draft.state[r.axis] == State::under_way) {
    r.where.problem(fmt::format("'{}' of body '{}' refers to itself", axis_names[axis], draft.name),
                    "let one coordinate state its own motion");
    return;
  } else {
    resolve_axis(draft, r.axis);
  }
  bool const of_mode = axes != &draft.axes && bodies_.at(r.body).is_mode;
  for (Term const& term : Terms((*axes)[of_mode ? 0 : std::size_t(r.axis)])) {
    MotionInput const& input = inputs[term.input];
    if (r.coherent)
      draft.axes[axis].push_back(passed_on(term, r.scale, r.through, r.where));
    else if (input.tone_frequency > 0 || input.drift)
      r.where.problem(
          fmt::format("a {} is deterministic, so it has no independent copy", input.drift ? "drift" : "sine"),
          fmt::format("write 'same_as: {}', or a '{}' of its own", axis_names[r.axis], input.drift ? "drift" : "sine"));
    else
      draft.axes[axis].push_back(independent(term, fmt::format("{} {}", draft.name, axis_names[axis]), r));
  }
}

Term MotionReader::passed_on(Term term, double scale, Transfer const& through, Node const& where) const {
  MotionInput const& input = inputs[term.input];
  term.gain *= scale;
  if (!through) return term;
  if (input.tone_frequency > 0)
    term.gain *= at_tone(through, input.tone_frequency, where);
  else if (input.drift)
    term.gain *= covers(through, 0, 0, where) ? (*through)(0).real() : 1;
  else if (covers(through, input.spectrum.lowest(), input.spectrum.highest(), where))
    term.through = chained(term.through, through);
  return term;
}

// A new input with the spectrum of another coordinate.
Term MotionReader::independent(Term const& term, std::string name, AxisReference const& r) {
  MotionInput const& input = inputs[term.input];
  OwnMotion copy{input.spectrum.scaled(std::norm(term.gain)), input.uncertainty};
  if (Transfer const& h = term.through)
    copy.spectrum = filtered(
        copy.spectrum, [&](double f) { return std::norm((*h)(f)); }, h->features());
  return passed_on({gaussian(std::move(name), copy), 1.0, {}}, r.scale, r.through, r.where);
}

std::size_t MotionReader::gaussian(std::string name, OwnMotion const& own) {
  auto const same = std::ranges::find_if(inputs, [&](MotionInput const& i) {
    return own.recorded && i.recorded && i.recorded->samples == own.recorded->samples;
  });
  if (same != inputs.end()) {  // one record is one motion
    same->uncertainty = std::max(same->uncertainty, own.uncertainty);
    return static_cast<std::size_t>(same - inputs.begin());
  }
  MotionInput& input = inputs.emplace_back();
  input.name = std::move(name);
  input.spectrum = own.spectrum;
  input.recorded = own.recorded;
  input.uncertainty = own.uncertainty;
  return inputs.size() - 1;
}

// Tones of one frequency form one input, because their phases are stated. Its uncertainty is the largest of theirs.
std::size_t MotionReader::tone(Tone const& t) {
  auto same = std::ranges::find_if(inputs, [&](MotionInput const& i) { return i.tone_frequency == t.frequency; });
  if (same == inputs.end()) {
    inputs.emplace_back().name = fmt::format("tone {} Hz", t.frequency);
    same = inputs.end() - 1;
    same->tone_frequency = t.frequency;
  }
  same->uncertainty = std::max(same->uncertainty, t.uncertainty);
  return static_cast<std::size_t>(same - inputs.begin());
}

std::size_t MotionReader::joint_input(JointMotion const& joint, std::size_t column) {
  auto const [hit, fresh] = joint_inputs_.try_emplace({joint.matrix, column}, inputs.size());
  if (fresh) {
    inputs.emplace_back().name = fmt::format("{} {}", joint.matrix, column + 1);
    inputs.back().spectrum = joint.unit;
  }
  inputs[hit->second].uncertainty = std::max(inputs[hit->second].uncertainty, joint.uncertainty);
  return hit->second;
}

// One clock for all: only the difference of drifts moves a fringe.
std::size_t MotionReader::drift() {
  auto same = std::ranges::find_if(inputs, [](MotionInput const& i) { return i.drift; });
  if (same == inputs.end()) {
    inputs.emplace_back().name = "drift";
    same = inputs.end() - 1;
    same->drift = true;
  }
  return static_cast<std::size_t>(same - inputs.begin());
}

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
