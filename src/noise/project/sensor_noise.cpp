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

}  // namespace straytrace::noise
