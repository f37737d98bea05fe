// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/time_domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "noise/time_domain/motion_series.hpp"

namespace straytrace::noise {
namespace {

constexpr double highest_rate = 1 << 20;  // Hz

SampleTimes times_of(TimeDomainSettings const& s, double rate) {
  return {s.start, rate, std::max<std::size_t>(2, static_cast<std::size_t>(std::llround(s.duration * rate)))};
}

SamplingRule rule_for(FastestFringe const& fastest, MotionSet const& motion) {
  return {fastest.hz, std::max(fastest.hz / 4, highest_motion(motion))};
}

std::string path_name(CouplingTable const& table, StrayPath const& path) {
  CouplingClass const& c = table.classes[path.route];
  PathRecord const& r = c.records[path.record];
  return c.deterministic() ? route_name(table, c)
                           : fmt::format("{} (history {}, vertex {})", route_name(table, c), r.history, r.event);
}

[[noreturn]] void refuse(CouplingTable const& table, StrayLight const& light, StrayPath const& fastest, double rate) {
  throw InputError(
      fmt::format("{:g} samples per second are too few for these fringes (docs/theory/spectra.md, eq. 7.13)", rate),
      fmt::format("{} reaches {:.5g} Hz at GPS {:.3f}; with a margin of {:.4g} Hz the rate must be above {:.5g} Hz\n  "
                  "write a rate of {:g} Hz, or omit it for this choice",
                  path_name(table, fastest), light.rule.fringe, light.fastest.time, light.rule.margin,
                  light.rule.least(), light.rule.automatic()));
}

// Motion at a sufficient rate, with its fringe rate.
void draw(StrayLight& light, MotionSet const& motion, std::span<StrayPath const> paths, TimeDomainSettings const& s,
          double rate) {
  light.times = times_of(s, rate);
  light.motion = draw_motion(motion, light.times, s.paths.seed, s.paths.realisation);
  light.fastest = fastest_fringe(paths, light.motion);
  light.rule = rule_for(light.fastest, motion);
}

// Draws at the rate of the rule, which follows from a draw.
void draw_by_rule(StrayLight& light, MotionSet const& motion, std::span<StrayPath const> paths,
                  TimeDomainSettings const& s) {
  double rate = SamplingRule{0, highest_motion(motion)}.automatic();
  draw(light, motion, paths, s, rate);
  while (light.rule.automatic() > rate) {
    rate = light.rule.automatic();
    if (rate > highest_rate)
      throw NumericalError(
          fmt::format("fringes of {:.4g} Hz need {:.4g} samples per second, more than 2^20", light.fastest.hz, rate));
    draw(light, motion, paths, s, rate);
  }
}

}  // namespace

double SamplingRule::automatic() const {
  return std::exp2(std::floor(std::log2(std::max({1023.0, least(), 5 * fringe}))) + 1);
}

std::vector<PortField> stray_fields(std::span<StrayPath const> paths, MotionSeries const& motion, Delay delay,
                                    unsigned threads, DirectSum const& direct, SumProgress const& progress) {
  std::vector<PortField> fields;
  std::vector<std::vector<StrayPath>> by_port;
  for (StrayPath const& p : paths) {
    if (by_port.size() <= p.port.value) by_port.resize(p.port.value + 1);
    by_port[p.port.value].push_back(p);
  }
  std::size_t done = 0;  // paths
  for (std::uint32_t port = 0; port < by_port.size(); ++port) {
    if (by_port[port].empty()) continue;
    auto const of_all = [&](double share) {
      if (progress) progress((double(done) + share * double(by_port[port].size())) / double(paths.size()));
    };
    PortField field{PortId{port}, phase_sum(phase_terms(by_port[port], motion, delay), threads, direct, of_all)};
    done += by_port[port].size();
    if (field.field.empty()) {  // static
      std::complex<double> still = 0;
      for (StrayPath const& p : by_port[port]) still += std::polar(p.amplitude, 2 * pi * p.turns);
      field.field.assign(motion.times.samples, still);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

std::vector<double> strain(std::span<PortField const> fields, Interferometer const& ifo, double rate, double band_low,
                           double band_high) {
  std::vector<double> h;
  for (PortField const& f : fields) {
    std::size_t const n = f.field.size();
    auto const guard = static_cast<std::size_t>(std::ceil(4 * rate / band_low));
    std::size_t const period = 2 * quick_length((n + guard + 1) / 2);
    double const high = band_high > 0 ? band_high : rate / 2;
    h.resize(n);
    for (bool const phase : {true, false}) {
      std::vector<double> quadrature(n);
      for (std::size_t i = 0; i < n; ++i) quadrature[i] = phase ? f.field[i].imag() : f.field[i].real();
      auto const response = [&](double hz) -> std::complex<double> {
        if (hz < band_low || hz > high) return 0;
        return phase ? ifo.strain_per_phase(f.port, hz) : ifo.strain_per_amplitude(f.port, hz);
      };
      std::vector<double> const part = filtered(made_periodic(quadrature, period), rate, response);
      for (std::size_t i = 0; i < n; ++i) h[i] += part[i];
    }
  }
  return h;
}

StrayLight stray_light(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                       TimeDomainSettings const& s) {
  std::vector<StrayPath> const paths = stray_paths(table, ifo, s.paths);
  if (paths.empty())
    throw InputError("the selected routes have no stored paths, so there is nothing to sum", "choose other routes");
  StrayLight light;
  light.paths = paths.size();
  if (s.rate > 0)
    draw(light, motion, paths, s, s.rate);
  else
    draw_by_rule(light, motion, paths, s);
  StrayPath const& fastest = paths[light.fastest.path];
  light.fastest_route = path_name(table, fastest);
  if (!(light.times.rate > light.rule.least())) refuse(table, light, fastest, light.times.rate);
  light.moving = moving_route(paths, light.motion);
  light.moving_route = route_name(table, table.classes[light.moving.route]);
  for (StrayPath const& p : paths)
    if (p.length > 0) light.longest_delay = std::max(light.longest_delay, p.length / speed_of_light);
  light.fields = stray_fields(paths, light.motion, s.delay, s.threads, s.direct, s.progress);
  light.h = strain(light.fields, ifo, light.times.rate, s.band_low, s.band_high);
  for (double x : light.h)
    if (!std::isfinite(x)) throw NumericalError("the strain of these paths is not finite");
  return light;
}

double second_order_phase(double motion, double distance, double wavelength) {
  return pi / wavelength * motion * motion / distance;
}

double delay_cycles(double hz, double path_length) { return hz * path_length / speed_of_light; }

}  // namespace straytrace::noise
