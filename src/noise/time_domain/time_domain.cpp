// SPDX-License-Identifier: BSD-3-Clause
#include "noise/time_domain/time_domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "noise/classes/delayed_paths.hpp"
#include "noise/project/static_phase.hpp"
#include "noise/time_domain/phase_sum.hpp"
#include "spectra/fourier.hpp"

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

// The motion of the bodies themselves.
StrayLight without_copies(StrayLight light, std::size_t bodies) {
  std::erase_if(light.motion.coordinates, [&](MovingCoordinate const& c) { return c.body.value >= bodies; });
  return light;
}

std::complex<double> still_sum(std::span<StrayPath const> paths) {
  std::complex<double> sum = 0;
  for (StrayPath const& p : paths) sum += std::polar(p.amplitude, 2 * pi * p.turns);
  return sum;
}

// The factors m cos(2 pi f (t - tau_j) + start) of eq. N.25, as sums over paths with the factors cos and sin of
// 2 pi f tau_j - start.
void add_amplitude(std::vector<std::complex<double>>& field, std::span<StrayPath const> paths, LightTone const& tone,
                   MotionSeries const& motion, auto const& sum_of) {
  std::vector<StrayPath> in_phase, in_quadrature;
  for (StrayPath const& p : paths) {
    if (source_beam(motion.light, p.beam, p.port) != tone.beam) continue;
    double const turns = tone.frequency * p.length / speed_of_light;
    double const a = 2 * pi * (turns - std::floor(turns)) - tone.start;
    for (auto const& [factor, list] : {std::pair{std::cos(a), &in_phase}, std::pair{std::sin(a), &in_quadrature}}) {
      list->push_back(p);
      list->back().amplitude *= tone.amplitude * factor;
    }
  }
  if (in_phase.empty()) return;
  std::vector<std::complex<double>> const c = sum_of(in_phase), s = sum_of(in_quadrature);
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const cycles = tone.frequency * double(i) / motion.times.rate, a = 2 * pi * (cycles - std::floor(cycles));
    field[i] += std::cos(a) * c[i] + std::sin(a) * s[i];
  }
}

// s_j(t) times the change of its amplitude, to first order: by coordinate, its position times a sum over paths.
void add_levers(std::vector<std::complex<double>>& field, std::span<StrayPath const> paths, MotionSeries const& motion,
                auto const& sum_of) {
  std::vector<std::complex<double>> changes;
  for (MovingCoordinate const& m : motion.coordinates) {
    std::vector<StrayPath> moved;
    for (StrayPath const& p : paths)
      for (PhaseSensitivity const& lever : p.amplitude_levers)
        if (lever.body == m.body && lever.d[m.axis] != 0) {
          moved.push_back(p);
          moved.back().amplitude *= lever.d[m.axis];
        }
    if (moved.empty()) continue;
    std::vector<std::complex<double>> const s = sum_of(moved);
    changes.resize(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) changes[i] += m.position[i] * s[i];
  }
  for (std::size_t i = 0; i < changes.size(); ++i) field[i] += changes[i];
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
    auto const sum = [&](std::span<StrayPath const> some, SumProgress const& of_some) {
      std::vector<std::complex<double>> s = phase_sum(phase_terms(some, motion, delay), threads, direct, of_some);
      if (s.empty()) s.assign(motion.times.samples, still_sum(some));
      return s;
    };
    PortField field{PortId{port}, sum(by_port[port], of_all)};
    done += by_port[port].size();
    add_levers(field.field, by_port[port], motion, [&](std::span<StrayPath const> some) { return sum(some, {}); });
    for (LightTone const& tone : motion.light.tones)
      add_amplitude(field.field, by_port[port], tone, motion,
                    [&](std::span<StrayPath const> some) { return sum(some, {}); });
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

namespace {

// Adds d first . x + d/2 sum over second of +-(second . x)^2, eq. N.21, by the response to the main beam that passes.
void add_rim(std::vector<double>& h, CouplingTable const& table, CouplingClass const& c, MotionSeries const& motion,
             Interferometer const& ifo, TimeDomainSettings const& s) {
  RimTerms const terms = rim_terms(c);
  auto const along = [&](PathRecord const& r) {
    std::vector<double> y(motion.times.samples);
    for (MovingCoordinate const& m : motion.coordinates)
      for (PhaseSensitivity const& p : r.phase_sensitivities)
        if (p.body == m.body && p.d[m.axis] != 0)
          for (std::size_t i = 0; i < y.size(); ++i) y[i] += p.d[m.axis] * m.position[i];
    return y;
  };
  std::vector<double> field = along(*terms.first);
  for (std::size_t k = 0; k < terms.second.size(); ++k) {
    std::vector<double> const y = along(*terms.second[k]);
    for (std::size_t i = 0; i < field.size(); ++i) field[i] += 0.5 * terms.sign[k] * y[i] * y[i];
  }
  double const scale = std::sqrt(terms.first->weight * ifo.copies(c.port)), rate = motion.times.rate,
               high = s.band_high > 0 ? s.band_high : rate / 2;
  for (double& x : field) x *= scale;
  auto const guard = static_cast<std::size_t>(std::ceil(4 * rate / s.band_low));
  std::size_t const period = 2 * quick_length((field.size() + guard + 1) / 2);
  auto const response = [&](double hz) -> std::complex<double> {
    if (hz < s.band_low || hz > high) return 0;
    auto const t = ifo.strain_per_passing_amplitude(c.port, hz);
    if (!t) throw without_passing_amplitude(table.ports.at(c.port.value));
    return *t;
  };
  std::vector<double> const part = filtered(made_periodic(field, period), rate, response);
  h.resize(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) h[i] += part[i];
}

}  // namespace

StrayLight stray_light(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                       TimeDomainSettings const& s) {
  if (s.delay == Delay::by_hit) {
    TimeDomainSettings at_once = s;
    at_once.delay = Delay::none;
    DelayedPaths const late = with_delays(table, motion, s.band_high);
    return without_copies(stray_light(late.table, late.motion, ifo, at_once), motion.bodies.size());
  }
  std::vector<StrayPath> const paths = stray_paths(table, ifo, s.paths);
  bool const rims =
      std::ranges::any_of(s.paths.routes, [&](std::uint32_t r) { return table.classes.at(r).kind == ClassKind::rim; });
  if (paths.empty() && rims)
    throw InputError("routes of kind rim alone have no fringes to draw in time",
                     "add a route of another kind, or take their spectrum: straytrace noise");
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
  for (std::uint32_t const route : s.paths.routes)
    if (CouplingClass const& c = table.classes.at(route); c.kind == ClassKind::rim)
      add_rim(light.h, table, c, light.motion, ifo, s);
  for (double x : light.h)
    if (!std::isfinite(x)) throw NumericalError("the strain of these paths is not finite");
  return light;
}

double second_order_phase(double motion, double distance, double wavelength) {
  return pi / wavelength * motion * motion / distance;
}

double ray_tilt_phase(double angle, double before, double after, double wavelength) {
  return -4 * pi / wavelength * angle * angle * before * after / (before + after);
}

double delay_cycles(double hz, double path_length) { return hz * path_length / speed_of_light; }

namespace {

constexpr std::uint32_t no_vertex = 0xffffffffu;  // addresses of draws that belong to no record

// One number from two; any change of either changes half of the bits (the finaliser of SplitMix64).
std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a + 0x9e3779b97f4a7c15ull * (b + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Draws of one realisation, by route and address.
class PathDraws {
 public:
  PathDraws(std::uint64_t seed, std::uint32_t realisation) : seed_(mixed(seed, realisation)) {}
  double turns(std::uint64_t route, PathRecord const& r, std::uint32_t copy) const {
    std::uint64_t const place = mixed(r.history, std::uint64_t{copy} << 32 | r.connection);
    return Rng(seed_, mixed(route, place), r.event, Stream::static_phase).uniform();
  }
  double of_member(std::uint64_t route, std::size_t member, std::uint32_t copy) const {
    return Rng(seed_, mixed(route, std::uint64_t{copy} << 32 | member), no_vertex, Stream::static_phase).uniform();
  }
  double sign_of(std::uint64_t route) const { return of_member(route, 0, no_vertex) < 0.5 ? 0.5 : 0; }  // turns
  double of_route(std::uint64_t route) const {
    return Rng(seed_, route, no_vertex - 1, Stream::static_phase).uniform();
  }

 private:
  std::uint64_t seed_;
};

// Paths that no history found have no address but their place in the class. Those of a coherent family share a draw
// for each state of polarisation.
void add_computed(std::vector<StrayPath>& paths, CouplingClass const& c, StrayPath path, std::uint32_t copy,
                  PathDraws const& draws) {
  PathRecord const& r = c.records[path.record];
  if (!c.adds_fields()) {
    path.turns = draws.of_member(c.hash, path.record, copy);
    paths.push_back(path);
    return;
  }
  double const amplitude = path.amplitude / std::sqrt(r.weight);
  for (std::size_t state = 0; state < r.field.size(); ++state) {
    if (r.field[state] == 0.0) continue;
    path.amplitude = amplitude * std::abs(r.field[state]);
    path.turns = std::arg(r.field[state]) / (2 * pi) + draws.of_member(c.hash, state, copy);
    paths.push_back(path);
  }
}

struct Pick {
  std::size_t record;
  double share;  // of the power of the route
};

// Every record by its weight, or `n` of equal shares by one random offset.
std::vector<Pick> picked(CouplingClass const& c, std::size_t n, double offset) {
  double const weight =
      std::accumulate(c.records.begin(), c.records.end(), 0.0, [](double s, auto const& r) { return s + r.weight; });
  std::vector<Pick> picks;
  bool const all = n == 0 || n >= c.records.size() || (c.deterministic() && n != 1);
  double before = 0;
  for (std::size_t i = 0; i < c.records.size() && weight > 0; ++i) {
    double const share = c.records[i].weight / weight;
    if (all && share > 0) picks.push_back({i, share});
    if (!all) {
      double const from = std::ceil(before * double(n) - offset), to = std::ceil((before + share) * double(n) - offset);
      for (double k = from; k < to && picks.size() < n; ++k) picks.push_back({i, 1 / double(n)});
    }
    before += share;
  }
  if (!all && !picks.empty())  // rounding of the last border must not lose power
    for (Pick& p : picks) p.share = 1 / double(picks.size());
  return picks;
}

std::vector<double> phase_sensitivity_of(StrayPath const& path, MotionSeries const& motion) {
  std::vector<double> turns(motion.coordinates.size());
  for (std::size_t c = 0; c < turns.size(); ++c)
    for (PhaseSensitivity const& phase_sensitivity : path.phase_sensitivities)
      if (phase_sensitivity.body == motion.coordinates[c].body)
        turns[c] += phase_sensitivity.d[motion.coordinates[c].axis] / (2 * pi);
  return turns;
}

// Means and covariances over time of the coordinates of a motion.
class CoordinateMoments {
 public:
  explicit CoordinateMoments(MotionSeries const& motion) : n_(motion.coordinates.size()), covariance_(n_ * n_) {
    auto const samples = double(motion.times.samples);
    std::vector<double> mean(n_);
    for (std::size_t c = 0; c < n_; ++c) {
      auto const& x = motion.coordinates[c].position;
      mean[c] = std::accumulate(x.begin(), x.end(), 0.0) / samples;
    }
    for (std::size_t a = 0; a < n_; ++a)
      for (std::size_t b = a; b < n_; ++b) {
        double sum = 0;
        for (std::size_t i = 0; i < motion.times.samples; ++i)
          sum += (motion.coordinates[a].position[i] - mean[a]) * (motion.coordinates[b].position[i] - mean[b]);
        covariance_[a * n_ + b] = covariance_[b * n_ + a] = sum / samples;
      }
  }
  // rad^2, of the moving part of the phase; `phase_sensitivity` in turns per unit of each coordinate.
  double mean_square_phase(std::vector<double> const& phase_sensitivity) const {
    double turns2 = 0;
    for (std::size_t a = 0; a < n_; ++a)
      for (std::size_t b = 0; b < n_; ++b)
        turns2 += phase_sensitivity[a] * covariance_[a * n_ + b] * phase_sensitivity[b];
    return 4 * pi * pi * std::max(0.0, turns2);
  }

 private:
  std::size_t n_;
  std::vector<double> covariance_;
};

}  // namespace

std::vector<StrayPath> stray_paths(CouplingTable const& table, Interferometer const& ifo, PathChoice const& choice) {
  PathDraws const draws(choice.seed, choice.realisation);
  std::vector<StrayPath> paths;
  CouplingClass const* first_known = nullptr;
  for (std::uint32_t const route : choice.routes) {
    CouplingClass const& c = table.classes.at(route);
    if (c.kind == ClassKind::rim) continue;
    double const copies = ifo.copies(c.port), drawn = std::max(1.0, std::round(copies));
    std::optional<double> const known = choice.phases.empty() ? std::nullopt : choice.phases.at(route);
    if (known && !first_known) first_known = &c;
    std::vector<Pick> const picks = picked(c, known ? 1 : choice.per_route, draws.of_route(c.hash));
    for (std::uint32_t copy = 0; copy < std::uint32_t(drawn); ++copy) {
      std::uint32_t repeat = 0;  // of a record that represents several fields
      for (std::size_t p = 0; p < picks.size(); ++p) {
        PathRecord const& r = c.records[picks[p].record];
        repeat = p > 0 && picks[p - 1].record == picks[p].record ? repeat + 1 : 0;
        StrayPath path{c.port,
                       0,
                       0,
                       r.path_length,
                       r.phase_sensitivities,
                       route,
                       std::uint32_t(picks[p].record),
                       r.beam,
                       r.amplitude_levers};
        path.amplitude = std::sqrt(c.reverse * c.coupling.mean * picks[p].share * copies / drawn);
        if (known) {
          path.turns = *known / (2 * pi) + (first_known == &c ? 0 : draws.sign_of(c.hash));
          paths.push_back(path);
          continue;
        }
        if (c.deterministic()) {
          add_computed(paths, c, path, copy, draws);
          continue;
        }
        path.turns = draws.turns(c.hash, r, copy + repeat * std::uint32_t(drawn));
        paths.push_back(path);
      }
    }
  }
  return paths;
}

PhaseTerms phase_terms(std::span<StrayPath const> paths, MotionSeries const& motion, Delay delay) {
  std::vector<std::vector<double>> all;
  for (StrayPath const& p : paths) all.push_back(phase_sensitivity_of(p, motion));
  PhaseTerms t;
  std::vector<std::size_t> used;
  for (std::size_t c = 0; c < motion.coordinates.size(); ++c)
    if (std::ranges::any_of(all, [&](auto const& l) { return l[c] != 0; })) used.push_back(c);
  for (std::size_t c : used) t.coordinate.emplace_back(motion.coordinates[c].position);
  for (std::size_t c : used)
    if (delay == Delay::half_path) t.coordinate.emplace_back(motion.coordinates[c].velocity);
  for (std::size_t j = 0; j < paths.size(); ++j) {
    t.amplitude.push_back(paths[j].amplitude);
    t.turns.push_back(paths[j].turns);
    for (std::size_t c : used) t.phase_sensitivity.push_back(all[j][c]);
    for (std::size_t c : used) {
      bool const light = motion.light.is_light(motion.coordinates[c].body.value);  // delayed already (eq. N.25)
      if (delay == Delay::half_path)
        t.phase_sensitivity.push_back(light ? 0 : -all[j][c] * paths[j].length / (2 * speed_of_light));
    }
  }
  return t;
}

FastestFringe fastest_fringe(std::span<StrayPath const> paths, MotionSeries const& motion) {
  std::size_t const n = motion.coordinates.size();
  std::vector<double> largest(n);
  for (std::size_t c = 0; c < n; ++c)
    for (double v : motion.coordinates[c].velocity) largest[c] = std::max(largest[c], std::fabs(v));
  std::vector<std::pair<double, std::size_t>> bounds;  // no path is faster than this
  std::vector<std::vector<double>> phase_sensitivities;
  for (std::size_t j = 0; j < paths.size(); ++j) {
    phase_sensitivities.push_back(phase_sensitivity_of(paths[j], motion));
    double bound = 0;
    for (std::size_t c = 0; c < n; ++c) bound += std::fabs(phase_sensitivities[j][c]) * largest[c];
    bounds.emplace_back(-bound, j);
  }
  std::ranges::sort(bounds);
  FastestFringe best;
  for (auto const& [bound, j] : bounds) {
    if (-bound <= best.hz) break;
    for (std::size_t i = 0; i < motion.times.samples; ++i) {
      double rate = 0;
      for (std::size_t c = 0; c < n; ++c) rate += phase_sensitivities[j][c] * motion.coordinates[c].velocity[i];
      if (std::fabs(rate) > best.hz)
        best = {std::fabs(rate), j, motion.times.start + static_cast<double>(i) / motion.times.rate};
    }
  }
  return best;
}

MovingRoute moving_route(std::span<StrayPath const> paths, MotionSeries const& motion) {
  CoordinateMoments const moments(motion);
  struct Sums {
    double power = 0, square = 0, moved = 0;  // of p, p phi^2 and p (1 - exp(-phi^2)) over the paths of a route
  };
  std::map<std::uint32_t, Sums> by_route;
  for (StrayPath const& p : paths) {
    double const power = p.amplitude * p.amplitude, phase2 = moments.mean_square_phase(phase_sensitivity_of(p, motion));
    Sums& sums = by_route[p.route];
    sums.power += power;
    sums.square += power * phase2;
    sums.moved -= power * std::expm1(-phase2);
  }
  MovingRoute best;
  double moved = -1;
  for (auto const& [route, sums] : by_route)
    if (sums.moved > moved) {
      moved = sums.moved;
      best = {route, sums.power > 0 ? std::sqrt(sums.square / sums.power) : 0};
    }
  return best;
}

}  // namespace straytrace::noise
