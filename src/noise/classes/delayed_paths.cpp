// SPDX-License-Identifier: BSD-3-Clause
#include "noise/classes/delayed_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <memory>

#include "base/errors.hpp"
#include "base/math/constants.hpp"

namespace straytrace::noise {
namespace {

constexpr std::size_t most_points = 12;  // of an interpolation

// m, of the light that rejoins.
double longest_path(CouplingTable const& table) {
  double longest = 0;
  for (CouplingClass const& c : table.classes)
    for (PathRecord const& r : c.records) longest = std::max(longest, r.path_length);
  return longest;
}

// Copies of bodies that follow the motion later.
class DelayedBodies {
 public:
  DelayedBodies(DelayLattice lattice, std::size_t bodies) : lattice_(lattice), copy_(bodies) {}
  std::vector<PhaseSensitivity> split(std::vector<PhaseSensitivity> const&);  // into copies, by body
  MotionSet moved(MotionSet) const;                                           // all copies made so far follow

 private:
  BodyId copy(BodyId, std::size_t node);

  DelayLattice lattice_;
  std::vector<std::vector<BodyId>> copy_;  // by body and node; invalid: there is none
  std::vector<std::pair<BodyId, std::size_t>> made_;
};

bool unknown(PhaseSensitivity const& s) {
  return std::ranges::any_of(s.moment, [](double m) { return std::isnan(m); });
}

}  // namespace

DelayLattice::DelayLattice(double longest, double highest_hz) : longest_(longest) {
  if (!(longest > 0)) return;
  for (nodes_ = 2; error(highest_hz) > accuracy; ++nodes_)
    if (nodes_ == most)
      throw InputError(fmt::format("delays of light of up to {:.3g} ms are too long for noise up to {:.4g} Hz",
                                   1e3 * longest, highest_hz),
                       "lower the upper end of 'band' in 'noise', or write 'delay: no' there");
}

DelayLattice::Weights DelayLattice::at(double delay) const {
  if (nodes_ == 1) return {{0, 1}};
  std::size_t const points = std::min(nodes_, most_points);
  double const place = delay / longest_ * double(nodes_ - 1);
  double const low = std::floor(place) - double(points / 2 - 1), highest = double(nodes_ - points);
  auto const first = std::size_t(std::clamp(low, 0.0, highest));
  Weights weights;
  for (std::size_t i = 0; i < points; ++i) {
    double w = 1;
    for (std::size_t k = 0; k < points; ++k)
      if (k != i) w *= (place - double(first + k)) / (double(i) - double(k));
    if (w != 0) weights.emplace_back(first + i, w);
  }
  return weights;
}

double DelayLattice::error(double highest_hz) const {
  double worst = 0;
  double const omega = 2 * pi * highest_hz, half = longest_ / (2 * double(nodes_ - 1));
  for (std::size_t i = 0; i + 1 < nodes_; ++i) {
    double const between = delay(i) + half;
    std::complex<double> sum = -std::polar(1.0, omega * between);
    for (auto const& [node, w] : at(between)) sum += std::polar(w, omega * delay(node));
    worst = std::max(worst, std::abs(sum));
  }
  return worst;
}

DelayLattice::Weights DelayLattice::parts(double d, double moment) const {
  constexpr double rounding = 1e-9;
  if (nodes_ == 1) return {{0, d}};
  double const mean = moment / d;  // not finite where d is 0
  if (mean >= -rounding * longest_ && mean <= (1 + rounding) * longest_) {
    Weights weights = at(std::clamp(mean, 0.0, longest_));
    for (auto& [node, w] : weights) w *= d;
    return weights;
  }
  double const late = moment / longest_;
  return {{0, d - late}, {nodes_ - 1, late}};
}

BodyId DelayedBodies::copy(BodyId body, std::size_t node) {
  if (node == 0) return body;
  std::vector<BodyId>& of_body = copy_[body.value];
  of_body.resize(lattice_.size());
  if (!of_body[node].valid()) {
    of_body[node] = {std::uint32_t(copy_.size() + made_.size())};
    made_.emplace_back(body, node);
  }
  return of_body[node];
}

std::vector<PhaseSensitivity> DelayedBodies::split(std::vector<PhaseSensitivity> const& all) {
  std::map<std::uint32_t, PhaseSensitivity> parts;
  for (PhaseSensitivity const& s : all)
    for (int i = 0; i < 6; ++i) {
      if (s.d[i] == 0 && s.moment[i] == 0) continue;
      for (auto const& [node, part] : lattice_.parts(s.d[i], s.moment[i])) {
        BodyId const id = copy(s.body, node);
        parts.try_emplace(id.value, PhaseSensitivity{id}).first->second.d[i] += part;
      }
    }
  std::vector<PhaseSensitivity> out;
  for (auto const& [id, s] : parts) out.push_back(s);
  return out;
}

MotionSet DelayedBodies::moved(MotionSet motion) const {
  motion.bodies.resize(copy_.size());
  for (auto const& [body, node] : made_)
    motion.bodies.push_back(fmt::format("{} {:.4g} us ago", motion.bodies[body.value], 1e6 * lattice_.delay(node)));
  // Equal transfers stay one object: classes of motion tell them apart by it.
  std::map<std::pair<TransferFunction const*, std::size_t>, std::shared_ptr<TransferFunction const>> made;
  TransferFunction const unchanged({}, {}, 1);
  for (MotionInput& input : motion.inputs) {
    std::vector<Gain> const gains = input.gains;
    for (Gain const& gain : gains)
      for (std::size_t node = 1; node < copy_[gain.body.value].size(); ++node) {
        Gain late = gain;
        late.body = copy_[gain.body.value][node];
        if (!late.body.valid()) continue;
        double const delay = lattice_.delay(node);
        if (input.tone_frequency > 0) {
          late.value *= std::polar(1.0, -2 * pi * input.tone_frequency * delay);
        } else if (!input.drift) {  // a delayed drift has another static phase
          auto& shared = made[{gain.transfer.get(), node}];
          if (!shared)
            shared =
                std::make_shared<TransferFunction const>((gain.transfer ? *gain.transfer : unchanged).delayed(delay));
          late.transfer = shared;
        }
        input.gains.push_back(late);
      }
  }
  return motion;
}

DelayedPaths with_delays(CouplingTable const& table, MotionSet const& motion, double highest_hz) {
  DelayedPaths out{table, {}};
  out.table.received.clear();
  DelayedBodies bodies(DelayLattice(longest_path(table) / speed_of_light, highest_hz),
                       std::max(table.bodies.size(), motion.bodies.size()));
  for (CouplingClass& c : out.table.classes)
    for (PathRecord& r : c.records) {
      if (std::ranges::any_of(r.phase_sensitivities, unknown))
        throw InputError("this run has no delays of light: it is older than schema 2.4 of run files",
                         "trace it again with 'straytrace run', or write 'delay: no' in 'noise'");
      r.phase_sensitivities = bodies.split(r.phase_sensitivities);
    }
  out.motion = bodies.moved(motion);
  out.table.bodies = out.motion.bodies;
  return out;
}

namespace {

constexpr std::size_t looked_at = 12, sampled = 16;  // frequencies; paths of a route

// Squared phase per motion of all inputs, with delays and without, rad^2 ... times PSD.
struct PhasePower {
  double late = 0, at_once = 0;
};

// Of Gaussian inputs and tones in a bin.
class PhaseAt {
 public:
  PhaseAt(MotionSet const& motion, std::size_t bodies, FrequencyGrid const& grid, std::size_t bin)
      : hz_(grid.centre(bin)), by_body_(bodies) {
    for (std::uint32_t i = 0; i < motion.inputs.size(); ++i) {
      MotionInput const& input = motion.inputs[i];
      bool const tone = input.tone_frequency > 0;
      double const of_tone = tone && grid.bin_of(input.tone_frequency) == bin ? 0.5 / grid.width(bin) : 0;
      psd_.push_back(input.drift ? 0 : tone ? of_tone : input.spectrum.at(hz_));
      // Transfer functions are those of exp(-2 pi i f t), a tone is Im(value exp(+2 pi i f t)).
      omega_.push_back(2 * pi * (tone ? -input.tone_frequency : hz_));
      if (!(psd_.back() > 0)) continue;
      for (Gain const& g : input.gains)
        by_body_[g.body.value].push_back({i, g.axis, g.value * (g.transfer ? (*g.transfer)(hz_) : 1.0)});
    }
  }
  PhasePower of(PathRecord const& r) const {
    std::vector<std::complex<double>> late(psd_.size()), at_once(psd_.size());
    for (PhaseSensitivity const& s : r.phase_sensitivities)
      for (Term const& t : by_body_[s.body.value]) {
        double const d = s.d[t.axis], delay = s.moment[t.axis] / d, turn = omega_[t.input] * s.moment[t.axis];
        bool const one = d != 0 && delay >= 0 && delay <= r.path_length / speed_of_light;
        at_once[t.input] += t.gain * d;
        late[t.input] += t.gain * (one ? std::polar(1.0, turn / d) * d : std::complex<double>(d, turn));
      }
    PhasePower sum;
    for (std::size_t i = 0; i < psd_.size(); ++i) {
      sum.late += psd_[i] * std::norm(late[i]);
      sum.at_once += psd_[i] * std::norm(at_once[i]);
    }
    return sum;
  }

 private:
  struct Term {
    std::uint32_t input;
    int axis;
    std::complex<double> gain;
  };
  double hz_;
  std::vector<double> psd_, omega_;  // by input
  std::vector<std::vector<Term>> by_body_;
};

// From the highest down, and those with tones.
std::vector<std::size_t> bins_looked_at(FrequencyGrid const& grid, MotionSet const& motion) {
  std::size_t const bins = grid.size(), step = std::max<std::size_t>(1, bins / looked_at);
  std::vector<std::size_t> some;
  for (std::size_t bin = bins - 1; bin < bins; bin -= std::min(step, bin + 1)) some.push_back(bin);
  for (MotionInput const& input : motion.inputs)
    if (std::size_t const bin = input.tone_frequency > 0 ? grid.bin_of(input.tone_frequency) : bins;
        bin < bins && std::ranges::find(some, bin) == some.end())
      some.push_back(bin);
  return some;
}

}  // namespace

DelayEffect delay_effect(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                         NoiseBudget const& budget) {
  DelayEffect worst;
  for (std::size_t const bin : bins_looked_at(budget.grid, motion)) {
    double const hz = budget.grid.centre(bin), linear = budget.total.linear_share[bin];
    PhaseAt const phase(motion, std::max(table.bodies.size(), motion.bodies.size()), budget.grid, bin);
    PhasePower sum;
    for (CouplingClass const& c : table.classes) {
      double const strain =
          std::norm(ifo.strain_per_phase(c.port, hz)) + std::norm(ifo.strain_per_amplitude(c.port, hz));
      std::size_t const every = 1 + c.records.size() / sampled;
      for (std::size_t i = 0; i < c.records.size(); i += every) {
        PhasePower const one = phase.of(c.records[i]);
        double const factor = strain * c.reverse * ifo.copies(c.port) * c.records[i].weight * double(every);
        sum.late += factor * one.late;
        sum.at_once += factor * one.at_once;
      }
    }
    if (sum.at_once == 0 && sum.late > 0) return {hz, infinity};
    if (!(sum.at_once > 0) || std::isnan(sum.late) || std::isnan(linear)) continue;
    double const factor = std::sqrt(std::max(0.0, 1 + linear * (sum.late / sum.at_once - 1)));
    if (worst.hz == 0 || std::fabs(factor - 1) > std::fabs(worst.factor - 1)) worst = {hz, factor};
  }
  return worst;
}

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
