// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/sensor_noise.hpp"

#include <fmt/format.h>

#include <algorithm>

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

SensorNoise sensor_noise(CouplingTable const& table, MotionSet const& motion, NoiseSettings settings, PortId port,
                         SensorKind kind) {
  SensorNoise noise{port, {}, {}};
  bool const diffuse = kind == SensorKind::quadrant;
  settings.compare.clear();
  if (diffuse) settings.static_phases.clear();  // of the mode itself, not of the one with a half reversed
  CouplingTable own = table;
  own.classes.clear();
  for (std::uint32_t i = 0; i < table.classes.size(); ++i)
    if (table.classes[i].port.value != port.value) {
      continue;
    } else if (diffuse && table.classes[i].deterministic()) {
      ++noise.left_out;
    } else {
      noise.routes.push_back(i);
      own.classes.push_back(table.classes[i]);
    }
  noise.budget = project_noise(own, motion, SensorResponse(port, kind), settings);
  return noise;
}

SensorSeries sensor_series(CouplingTable const& table, MotionSet const& motion, TimeDomainSettings const& settings) {
  if (settings.delay == Delay::by_hit) {
    TimeDomainSettings at_once = settings;
    at_once.delay = Delay::none;
    DelayedPaths const late = with_delays(table, motion, settings.band_high);
    return sensor_series(late.table, late.motion, at_once);
  }
  OneCopy const every;
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
