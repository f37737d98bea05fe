// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/wave_record.hpp"

#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

FieldRecord field_record(Field const& field) {
  FieldRecord record{std::uint32_t(field.grid.points), {}};
  record.values.reserve(2 * field.values.size());
  for (Complex const z : field.values) {
    record.values.push_back(float(z.real()));
    record.values.push_back(float(z.imag()));
  }
  return record;
}

HeightsRecord heights_record(ArmDraw const& d) {
  auto const all = [](std::vector<double> const& shares) { return std::accumulate(shares.begin(), shares.end(), 0.0); };
  PowerLedger const& l = d.ledger;
  return {d.roughness,
          d.loss,
          d.residual,
          std::uint32_t(d.round_trips),
          {l.mirror1, l.mirror2},
          {all(l.towards_mirror1), all(l.towards_mirror2)},
          l.beyond_band,
          d.mirrors};
}

RimRecord rim_record(World const& world, ArmWaves const& waves, std::size_t i) {
  ArmRim const& rim = waves.arm.rims[i];
  RimResult const& found = waves.rims[i];
  RimRecord record{world.name_of(rim.surface),
                   rim.centre,
                   rim.rim.radius,
                   rim.angle1,
                   rim.angle2,
                   waves.ledger.towards_mirror2[i],
                   waves.ledger.towards_mirror1[i],
                   found.speckle,
                   {}};
  for (std::size_t heights = 0; heights < found.draws.size(); ++heights) {
    RimDraw const& draw = found.draws[heights];
    for (std::size_t i = 0; i < draw.responses.size(); ++i)
      record.draws.push_back({std::uint32_t(heights), std::uint32_t(i), draw.responses[i], draw.clipped});
  }
  return record;
}

DiodeRecord diode_record(ArmWaves const& waves, std::size_t i) {
  Photodiode const& d = waves.arm.diodes[i];
  DiodeResult const& found = waves.diodes[i];
  bool const on_rim = d.plane > 0 && d.plane <= int(waves.arm.rims.size());
  return {d.name,
          on_rim ? std::uint32_t(d.plane - 1) : DiodeRecord::none,
          d.travel == Travel::towards_mirror1,
          {d.x + d.radius * std::cos(d.azimuth), d.y + d.radius * std::sin(d.azimuth)},
          d.area(),
          found.draws.empty() ? std::nan("") : found.draws.front(),
          found.mean,
          found.spread};
}

}  // namespace

WaveRecord record_of(World const& world, ArmWaves const& waves, std::string key, double power) {
  ArmCavity const& arm = waves.arm;
  WaveRecord record;
  record.key = std::move(key);
  record.beam = world.wave.beam_name;
  record.device = waves.device;
  record.power = power;
  record.wavelength = arm.cavity.wavelength;
  record.length = arm.cavity.length;
  record.grid = arm.cavity.grid;
  record.crossover = arm.crossover;
  record.eigenvalue = waves.mode.eigenvalue;
  for (ArmDraw const& d : waves.draws) record.heights.push_back(heights_record(d));
  record.perfect_loss = waves.perfect_loss;
  record.beyond_band = waves.ledger.beyond_band;
  for (std::size_t i : {0, 1}) {
    ArmMirror const& m = arm.mirrors[i];
    record.mirrors[i] = {world.name_of(m.surface),
                         m.radius,
                         m.curvature,
                         m.spot,
                         m.scattered,
                         m.roughness,
                         i == 0 ? waves.ledger.mirror1 : waves.ledger.mirror2,
                         waves.spots[i]};
  }
  record.modes = waves.modes;
  for (std::size_t i = 0; i < waves.rims.size(); ++i) record.rims.push_back(rim_record(world, waves, i));
  for (std::size_t i = 0; i < waves.diodes.size(); ++i) record.diodes.push_back(diode_record(waves, i));
  record.irradiance = waves.irradiance;
  record.grid_check = waves.grid_check;
  record.bands = waves.bands;
  for (Field const& field : waves.fields) record.fields.push_back(field_record(field));
  record.warnings = arm.warnings;
  return record;
}

ArmWaves waves_of(World const& world, WaveSettings const& settings, ArmCavity planned, WaveRecord const& record) {
  HeightsRecord const& first = record.heights.front();
  ArmWaves waves{arm_cavity(world, settings, std::move(planned)),
                 {record.eigenvalue, first.residual, int(first.round_trips), Field(Grid{})},
                 {},
                 record.perfect_loss,
                 record.modes,
                 {},
                 {},
                 record.irradiance,
                 {},
                 record.grid_check,
                 record.bands,
                 {record.mirrors[0].light, record.mirrors[1].light}};
  if (waves.arm.rims.size() != record.rims.size())
    throw NumericalError("the kept field of the cavity has other inner edges than the scene");
  waves.arm.warnings = record.warnings;
  waves.device = record.device;
  PowerLedger& ledger = waves.ledger;
  ledger.mirror1 = record.mirrors[0].lost;
  ledger.mirror2 = record.mirrors[1].lost;
  ledger.beyond_band = record.beyond_band;
  for (RimRecord const& rim : record.rims) {
    ledger.towards_mirror2.push_back(rim.towards_mirror2);
    ledger.towards_mirror1.push_back(rim.towards_mirror1);
    RimResult found{{}, rim.speckle};
    for (RimDrawRecord const& draw : rim.draws) {
      if (draw.heights >= found.draws.size()) found.draws.resize(draw.heights + 1);
      found.draws[draw.heights].clipped = draw.clipped;
      found.draws[draw.heights].responses.push_back(draw.response);
    }
    waves.rims.push_back(std::move(found));
  }
  for (HeightsRecord const& d : record.heights)
    waves.draws.push_back({d.roughness, d.loss, d.residual, int(d.round_trips), ledger, d.mirrors});
  return waves;
}

double WaveRecord::loss() const {
  double sum = 0;
  for (HeightsRecord const& d : heights) sum += d.loss;
  return sum / double(heights.size());
}

}  // namespace straytrace::wave
