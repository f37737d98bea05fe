// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/sensor_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "noise/classes/delayed_paths.hpp"

namespace straytrace::noise {
namespace {

constexpr std::uint32_t of_x = 1u << 30, of_y = 2u << 30;  // realisations of static phases no other draw uses

// Every port once: a sensor sees its own light, not that of equal copies.
class OneCopy final : public ifo::Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return 1; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return 0; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "sensors"; }
};

}  // namespace

CouplingTable cut_by(std::span<Sensor const> sensors, CouplingTable const& table) {
  CouplingTable out = table;
  for (CouplingClass& c : out.classes) {
    auto const on = std::ranges::find_if(sensors, [&](Sensor const& s) { return s.port.value == c.port.value; });
    if (on == sensors.end()) continue;
    double const factor = 1 / (on->share * on->share * (c.deterministic() ? 1 : on->caught));
    c.coupling.mean *= factor;
    c.coupling.std_error *= factor;
    for (double& x : c.replica_sum) x *= factor;
    for (PathRecord& r : c.records) {
      r.coupling *= factor;
      r.weight *= factor;
      for (std::complex<double>& field : r.field) field *= std::sqrt(factor);
    }
    for (PhaseSensitivityProduct& p : c.phase_sensitivities)
      for (double& x : p.sum) x *= factor;
  }
  return out;
}

namespace {

// Of the power of a route by one tone, relative to it: 2a times the mean of exp(-2 pi i f tau) over its paths.
std::complex<double> line_of(CouplingClass const& c, LightTone const& tone) {
  std::complex<double> sum = 0;
  double weight = 0;
  for (PathRecord const& r : c.records) {
    weight += r.weight;
    if (r.beam != tone.beam) continue;
    double const turns = tone.frequency * r.path_length / speed_of_light;
    sum += std::polar(r.weight, tone.start - 2 * pi * (turns - std::floor(turns)));
  }
  return weight > 0 ? 2 * tone.amplitude * sum / weight : 0;
}

}  // namespace

SourceLines source_lines(std::span<CouplingClass const* const> received, LightModulation const& light) {
  SourceLines lines;
  for (LightTone const& tone : light.tones)
    for (CouplingClass const* c : received) lines[tone.frequency] += c->coupling.mean * line_of(*c, tone);
  return lines;
}

std::vector<double> asd_of(SourceLines const& lines, FrequencyGrid const& grid) {
  std::vector<double> asd(grid.size());
  for (auto const& [hz, peak] : lines)
    if (std::size_t const bin = grid.bin_of(hz); bin < grid.size()) asd[bin] += std::norm(peak) / 2 / grid.width(bin);
  for (double& x : asd) x = std::sqrt(x);
  return asd;
}

void add_lines(TimeSeries& series, SourceLines const& lines, double factor) {
  for (auto const& [hz, peak] : lines)
    for (std::size_t i = 0; i < series.samples.size(); ++i) {
      double const cycles = hz * double(i) / series.rate;
      series.samples[i] += factor * (peak * std::polar(1.0, 2 * pi * (cycles - std::floor(cycles)))).real();
    }
}

SensorNoise sensor_noise(CouplingTable const& table, MotionSet const& motion, NoiseSettings settings, PortId port,
                         SensorKind kind) {
  SensorNoise noise{port, {}, {}};
  bool const diffuse = kind == SensorKind::quadrant;
  settings.compare.clear();
  settings.scanned.reset();                     // the mean over its positions
  if (diffuse) settings.static_phases.clear();  // of the mode itself, not of the one with a half reversed
  CouplingTable own = table;
  own.classes.clear();
  for (std::uint32_t i = 0; i < table.classes.size(); ++i)
    if (table.classes[i].port.value != port.value) {
      continue;
    } else if (table.classes[i].kind == ClassKind::rim || (diffuse && table.classes[i].deterministic())) {
      ++noise.left_out;
    } else {
      noise.routes.push_back(i);
      own.classes.push_back(table.classes[i]);
    }
  noise.budget = project_noise(own, motion, SensorResponse(port, kind), settings);
  return noise;
}

SensorSeries sensor_series(CouplingTable const& table, MotionSet const& motion, TimeDomainSettings const& stated) {
  if (stated.delay == Delay::by_hit) {
    TimeDomainSettings at_once = stated;
    at_once.delay = Delay::none;
    DelayedPaths const late = with_delays(table, motion, stated.band_high);
    return sensor_series(late.table, late.motion, at_once);
  }
  OneCopy const every;
  TimeDomainSettings settings = stated;
  std::erase_if(settings.paths.routes, [&](std::uint32_t r) { return table.classes[r].kind == ClassKind::rim; });
  StrayLight const light = stray_light(table, motion, every, settings);
  SensorSeries series{{}, light.fastest, light.times};
  auto const add = [&](std::vector<PortField> const& fields, char const* what, auto const& signal) {
    for (PortField const& f : fields) {
      TimeSeries s{fmt::format("{} {}", table.ports[f.port.value], what), "1", light.times.start, light.times.rate, {}};
      for (std::complex<double> const x : f.field) s.samples.push_back(signal(x));
      series.channels.push_back(std::move(s));
    }
  };
  auto const amplitude = [](std::complex<double> s) { return 2 * s.real(); };
  add(light.fields, "power", amplitude);
  add(light.fields, "phase", [](std::complex<double> s) { return s.imag(); });
  for (auto const& [what, draw] : {std::pair{"X", of_x}, std::pair{"Y", of_y}}) {
    PathChoice choice = settings.paths;
    choice.realisation += draw;
    choice.phases.clear();
    std::erase_if(choice.routes, [&](std::uint32_t r) { return table.classes[r].deterministic(); });
    std::vector<StrayPath> const paths = stray_paths(table, every, choice);
    add(stray_fields(paths, light.motion, settings.delay, settings.threads, settings.direct), what, amplitude);
  }
  return series;
}

namespace {

// Mean-square phase [rad^2] of the test motion on a path of `many_bounces` normal-incidence bounces: first order is
// exact to a part in 1e8.
constexpr double test_phase_squared = 1e-8, many_bounces = 100;

constexpr double shows_from = 0.01;  // of the observed coupling power: routes below it do not bend the coupling

NoiseBudget project_alone(CouplingTable const& table, MotionInput input, std::vector<std::string> const& bodies,
                          Interferometer const& ifo, FrequencyGrid const& grid) {
  MotionSet motion;
  motion.bodies = bodies;
  motion.inputs.push_back(std::move(input));
  NoiseSettings settings;
  settings.grid = grid;
  return project_noise(table, motion, ifo, settings);
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

}  // namespace

PredictedCoupling predict_coupling(CouplingTable const& table, std::vector<std::string> const& bodies,
                                   Interferometer const& ifo, FrequencyGrid const& grid, BodyAxis where) {
  double const low = grid.edges.front() / 2, high = 2 * grid.edges.back();
  double const rms = std::sqrt(test_phase_squared) * table.wavelength / (4 * pi * many_bounces);
  double const psd = rms * rms / (high - low), scale = 1 / std::sqrt(psd);
  MotionInput input;
  input.name = "test motion";
  input.spectrum = Spectrum({low, high}, {psd, psd});
  input.gains = {{where.body, where.axis}};
  NoiseBudget const budget = project_alone(table, input, bodies, ifo, grid);
  PredictedCoupling out;
  out.grid = grid;
  out.factor = scaled(budget.total.asd, scale);
  out.sigma = scaled(budget.total.sigma, scale);
  out.bound_share = budget.total.bound_share;
  out.unresolved = budget.unresolved;
  double all = 0, observed = 0;
  for (NoiseTrace const& t : budget.routes) {
    PredictedRoute r;
    r.name = t.name;
    r.factor = scaled(t.asd, scale);
    r.sigma = scaled(t.sigma, scale);
    r.phase = std::sqrt(t.mean_square_phase) / rms;
    r.multiplicity = r.phase * table.wavelength / (4 * pi);
    r.resolved = t.resolved;
    r.upper_bound = t.upper_bound;
    r.why_not = t.why_not;
    for (std::size_t i = 0; i < grid.size(); ++i) r.share += r.factor[i] * r.factor[i] * grid.width(i);
    if (r.share == 0) continue;  // does not touch the body
    if (r.resolved) all += r.share;
    observed += r.share;
    out.routes.push_back(std::move(r));
  }
  double steepest = 0;
  for (PredictedRoute const& r : out.routes)
    if (r.share >= shows_from * observed) steepest = std::max(steepest, r.phase);
  if (steepest > 0) out.linear_to = 1 / steepest;
  for (PredictedRoute& r : out.routes) r.share = all > 0 ? r.share / all : not_a_number;
  std::ranges::stable_sort(out.routes, [](PredictedRoute const& a, PredictedRoute const& b) {
    return std::pair(a.resolved, a.share) > std::pair(b.resolved, b.share);
  });
  return out;
}

DrivenResponse drive_body(CouplingTable const& table, std::vector<std::string> const& bodies, Interferometer const& ifo,
                          FrequencyGrid const& grid, BodyAxis where, double peak, double hz) {
  MotionInput input;
  input.name = "drive";
  input.tone_frequency = hz;
  input.gains = {{where.body, where.axis, peak}};
  DrivenResponse out;
  out.budget = project_alone(table, input, bodies, ifo, grid);
  for (NoiseTrace const& t : out.budget.routes) {
    double const z = std::sqrt(2 * t.mean_square_phase);  // of a sine
    if (z > 0) out.routes.push_back({t.name, z, z * hz, t.resolved});
    out.phase_peak = std::max(out.phase_peak, z);
  }
  out.cutoff = out.phase_peak * hz;
  return out;
}

MotionSet motion_along(MotionSet const& motion, BodyAxis where) {
  MotionSet out;
  out.bodies = motion.bodies;
  for (MotionInput input : motion.inputs) {
    std::erase_if(input.gains, [&](Gain const& g) { return !(g.body == where.body && g.axis == where.axis); });
    if (!input.gains.empty()) out.inputs.push_back(std::move(input));
  }
  return out;
}

double rms_of(MotionSet const& motion, BodyAxis where) {
  PhaseSensitivity phase_sensitivity;
  phase_sensitivity.body = where.body;
  phase_sensitivity.d[where.axis] = 1;
  MotionSet const own = motion_along(motion, where);
  double sum = 0;
  for (std::size_t i = 0; i < own.inputs.size(); ++i) {
    MotionInput const& input = own.inputs[i];
    if (input.drift) continue;
    auto const squared = [&](double f) { return own.sensitivity(i, {&phase_sensitivity, 1}, f); };
    sum += input.tone_frequency > 0 ? squared(input.tone_frequency) / 2
                                    : input.spectrum.multiplied(squared, input.spectrum.hz()).total();
  }
  return std::sqrt(sum);
}

}  // namespace straytrace::noise
