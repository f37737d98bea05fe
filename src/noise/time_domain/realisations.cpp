// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/realisations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "motion/axis_motion.hpp"

namespace straytrace::noise {
namespace {

constexpr double level_hz[] = {10, 30, 100}, delay_hz = 100;
constexpr double level_width = 0.1;  // of the frequency, on both sides

// Mean PSD of the chosen routes between two frequencies, by the spectra of the motion. Bands wider than a bin take the
// power of the bins; narrower ones a power law between their centres, level in the outer halves of the band.
class ExactSpectrum {
 public:
  ExactSpectrum(NoiseBudget const& exact, std::vector<std::uint32_t> const& routes) : grid_(exact.grid) {
    std::vector<double> hz = {grid_.edges.front()}, psd;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      hz.push_back(grid_.centre(i));
      psd.push_back(0);
      for (std::uint32_t r : routes) psd.back() += exact.routes[r].psd(i);
    }
    bins_ = psd;
    hz.push_back(grid_.edges.back());
    psd.push_back(psd.back());
    psd.insert(psd.begin(), psd.front());
    between_ = Spectrum(std::move(hz), std::move(psd));
  }
  double mean(double low, double high) const {  // not a number outside of the band of the noise
    if (low < grid_.edges.front() || high > grid_.edges.back()) return not_a_number;
    double power = 0, widest = 0;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      double const width = std::min(high, grid_.edges[i + 1]) - std::max(low, grid_.edges[i]);
      if (width <= 0) continue;
      power += width * bins_[i];
      widest = std::max(widest, grid_.edges[i + 1] - grid_.edges[i]);
    }
    return (high - low < widest ? between_.power(low, high) : power) / (high - low);
  }

 private:
  FrequencyGrid grid_;
  std::vector<double> bins_;
  Spectrum between_;
};

double percentile(std::vector<double> sorted, double below) {
  if (sorted.size() < 5) return not_a_number;
  double const place = below * double(sorted.size() - 1);
  auto const i = std::min(std::size_t(place), sorted.size() - 2);
  return std::sqrt(sorted[i] + (place - double(i)) * (sorted[i + 1] - sorted[i]));
}

// Standard error of the mean: scatter of the realisations, or of the segments of the only one.
double relative_error(std::vector<double> const& values, double mean, WelchSpectrum const& w, std::size_t lines) {
  if (values.size() < 2) return 1 / std::sqrt(w.effective_averages * std::max(1.0, double(lines) / 1.5));
  double square = 0;
  for (double v : values) square += (v - mean) * (v - mean);
  return std::sqrt(square / double(values.size() * (values.size() - 1))) / mean;
}

BandLevel level(ExactSpectrum const& exact, Realisations const& all, std::size_t from, std::size_t to) {
  BandLevel b;
  double const half = all.hz()[1] / 2;
  b.low = all.hz()[from] - half;
  b.high = all.hz()[to] + half;
  b.hz = (b.low + b.high) / 2;
  std::vector<double> values = all.band(from, to);
  double mean = 0;
  for (double v : values) mean += v / double(values.size());
  b.asd = std::sqrt(mean);
  b.sigma = mean > 0 ? b.asd * relative_error(values, mean, all.last(), to - from + 1) / 2 : 0;
  std::sort(values.begin(), values.end());
  b.below = percentile(values, 0.05);
  b.median = percentile(values, 0.5);
  b.above = percentile(values, 0.95);
  b.exact = std::sqrt(exact.mean(b.low, b.high));
  return b;
}

BandLevel nothing(double hz) {
  return {hz, hz, hz, not_a_number, not_a_number, not_a_number, not_a_number, not_a_number, not_a_number};
}

// Second-order phases [rad] that frozen geometry neglects on a route, means over its paths by power.
struct SecondOrder {
  double transverse = 0;  // eq. 2.6, if the largest translation of a body on the path were transverse to its mean leg
  double ray_tilt = 0;    // eq. N.28, if its largest rotation were that of a mirror between two mean legs
};

SecondOrder second_order_of(CouplingTable const& table, StrayLight const& light) {
  CouplingClass const& c = table.classes[light.moving.route];
  double const legs = c.steps.size() > 2 ? double(c.steps.size() - 1) : 1;
  // A row of many routes may hold reflections.
  bool const reflects =
      c.steps.empty() || std::ranges::find(c.steps, Event::reflect, &PathStep::event) != c.steps.end();
  struct Largest {
    double translation = 0, rotation = 0;  // m, rad
  };
  std::map<std::uint32_t, Largest> by_body;
  for (MovingCoordinate const& m : light.motion.coordinates) {
    if (light.motion.light.is_light(m.body.value)) continue;  // the phase of light, which moves no body
    Largest& body = by_body[m.body.value];
    double& largest = is_rotation(m.axis) ? body.rotation : body.translation;
    for (double x : m.position) largest = std::max(largest, std::fabs(x));
  }
  SecondOrder sum;
  double power = 0;
  for (PathRecord const& record : c.records) {
    if (!(record.path_length > 0)) continue;
    Largest moved;
    for (PhaseSensitivity const& phase_sensitivity : record.phase_sensitivities)
      if (auto const at = by_body.find(phase_sensitivity.body.value); at != by_body.end()) {
        moved.translation = std::max(moved.translation, at->second.translation);
        moved.rotation = std::max(moved.rotation, at->second.rotation);
      }
    double const leg = record.path_length / legs;
    sum.transverse += record.weight * second_order_phase(moved.translation, leg, table.wavelength);
    if (reflects) sum.ray_tilt -= record.weight * ray_tilt_phase(moved.rotation, leg, leg, table.wavelength);
    power += record.weight;
  }
  return power > 0 ? SecondOrder{sum.transverse / power, sum.ray_tilt / power} : SecondOrder{};
}

// Uncertainty of h at 100 Hz due to the delays, relative to the noise of one body. Half of the path is the mean delay
// over a path and its reverse. A path without its reverse is delayed by anything from nothing to its whole length. By
// hit: hits on one body act together, none farther from the mean than half of the path (docs/theory/time_domain.md).
double delay_error_of(CouplingTable const& table, std::vector<std::uint32_t> const& routes, Delay delay) {
  double largest = 0;
  for (std::uint32_t const r : routes) {
    CouplingClass const& c = table.classes[r];
    bool const with_reverse = c.kind == ClassKind::ghost || c.reverse > 1;
    for (PathRecord const& record : c.records) {
      double const half = pi * delay_cycles(delay_hz, std::max(0.0, record.path_length));
      double const of_half = with_reverse ? half * half : half;
      largest = std::max(largest, delay == Delay::none ? 2 * half : delay == Delay::by_hit ? half * half / 2 : of_half);
    }
  }
  return largest;
}

}  // namespace

void Realisations::add(WelchSpectrum const& w) {
  psd_.push_back(w.psd);
  last_ = w;
}

std::vector<double> Realisations::band(std::size_t from, std::size_t to) const {
  std::vector<double> out;
  for (std::vector<double> const& psd : psd_) {
    double sum = 0;
    for (std::size_t k = from; k <= to; ++k) sum += psd[k];
    out.push_back(sum / double(to - from + 1));
  }
  return out;
}

TimeDomainSummary summarise(CouplingTable const& table, MotionSet const& motion, NoiseBudget const& exact_noise,
                            TimeDomainSettings const& s, StrayLight const& light, Realisations const& all) {
  std::vector<std::uint32_t> const& routes = s.paths.routes;
  TimeDomainSummary r;
  r.times = light.times;
  r.seed = s.paths.seed;
  r.realisations = all.size();
  r.routes = routes.size();
  r.paths = light.paths;
  r.rms_phase = light.moving.rms_phase;
  r.rms_phase_route = light.moving_route;
  r.rule = light.rule;
  r.fastest = light.fastest;
  r.fastest_route = light.fastest_route;
  r.delay = light.longest_delay;
  SecondOrder const neglected = second_order_of(table, light);
  r.second_order = neglected.transverse;
  r.ray_tilt = neglected.ray_tilt;
  r.retarded = s.delay == Delay::half_path;
  r.delay_by_hit = s.delay == Delay::by_hit;
  r.delay_error = delay_error_of(table, routes, s.delay);
  r.band_low = s.band_low;
  r.band_high = std::min(s.band_high, light.times.rate / 2);
  for (MotionInput const& input : motion.inputs) r.recorded |= input.recorded && !input.gains.empty();
  double const spacing = all.hz()[1];
  ExactSpectrum const exact(exact_noise, routes);
  for (double hz : level_hz) {
    auto const from = std::size_t(std::ceil(hz * (1 - level_width) / spacing)),
               to = std::size_t(std::floor(hz * (1 + level_width) / spacing));
    bool const resolved = from >= 1 && to >= from && to < all.hz().size() && hz * (1 - level_width) > r.band_low &&
                          hz * (1 + level_width) < r.band_high;
    r.levels.push_back(resolved ? level(exact, all, from, to) : nothing(hz));
    r.levels.back().hz = hz;
  }
  for (std::size_t k = 1; k + 1 < all.hz().size(); ++k)
    if (all.hz()[k] > r.band_low && all.hz()[k] < r.band_high) r.spectrum.push_back(level(exact, all, k, k));
  r.segment = 1 / spacing;
  r.segments = all.last().segments;
  r.noise_bandwidth = all.last().noise_bandwidth;
  return r;
}

TimeSeries strain_series(StrayLight const& light) { return {"h", "1", light.times.start, light.times.rate, light.h}; }

std::vector<TimeSeries> motion_channels(MotionSeries const& motion, MotionSet const& set) {
  std::vector<TimeSeries> all;
  for (MovingCoordinate const& c : motion.coordinates)
    all.push_back({fmt::format("{} {}", set.bodies[c.body.value], axis_names[c.axis]),
                   is_rotation(c.axis) ? "rad" : "m", motion.times.start, motion.times.rate, c.position});
  return all;
}

}  // namespace straytrace::noise
