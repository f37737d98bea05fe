// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_sums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/errors.hpp"
#include "ifo/interferometer.hpp"
#include "noise/project/route_noise.hpp"
#include "results/curves/band.hpp"

namespace straytrace::results {
namespace {

void keep_rows(PathTable& table, std::vector<std::size_t> const& rows) {
  std::vector<PathRow> kept;
  for (std::size_t const i : rows) kept.push_back(table.rows[i]);
  table.rows = std::move(kept);
}

// The remaining noise and its ratio to the total, as curves with their errors.
struct Curves {
  NoiseTrace after, factor;
};

void add_root(NoiseTrace& curve, WithError square) {
  double const root = std::sqrt(square.value);
  curve.asd.push_back(root > 0 ? root : not_a_number);
  curve.sigma.push_back(square.sigma / (2 * root));  // d sqrt(x) = dx/(2 sqrt(x))
}

Curves curves_without(std::set<std::uint64_t> const& left_out, CouplingTable const& coupling, NoiseBudget const& b) {
  std::vector<ReplicaSum> all(b.grid.size()), rest(b.grid.size());  // PSD
  std::vector<double> bound(b.grid.size());                         // of the rest
  for (std::size_t r = 0; r < b.routes.size(); ++r) {
    NoiseTrace const& t = b.routes[r];
    ReplicaPattern const pattern = t.resolved ? pattern_of(coupling, coupling.classes[r]) : ReplicaPattern{};
    bool const stays = !left_out.contains(t.hash);
    for (std::size_t i = 0; i < b.grid.size(); ++i) {
      ReplicaSum const power({t.psd(i), t.psd_sigma(i)}, pattern);
      all[i].add(power);
      if (stays) rest[i].add(power);
      if (stays && t.upper_bound) bound[i] += power.value();
    }
  }
  Curves c;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    add_root(c.after, rest[i].result());
    c.after.bound_share.push_back(bound[i] > 0 ? bound[i] / rest[i].value() : 0);
    add_root(c.factor, rest[i].share_of(all[i]));
  }
  return c;
}

}  // namespace

PathTable part_of(PathTable const& table, std::vector<std::size_t> const& rows) {
  PathTable part = table;
  keep_rows(part, rows);
  std::stable_partition(part.rows.begin(), part.rows.end(), [](PathRow const& row) { return row.resolved; });
  part.unresolved = part.faint = 0;
  for (PathRow const& row : part.rows) {
    part.unresolved += !row.resolved;
    part.faint += !row.resolved && row.faint;
  }
  return part;
}

Without without_rows(PathTable const& table, std::vector<std::size_t> const& left_out, CouplingTable const& coupling,
                     NoiseBudget const* budget) {
  std::set<std::size_t> const out(left_out.begin(), left_out.end());
  std::set<std::uint64_t> hashes;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (out.contains(i))
      hashes.insert(table.rows[i].hash);
    else
      kept.push_back(i);
  }
  Without w{table, {}};
  keep_rows(w.rest, kept);
  rank_and_sum(w.rest, w.rest.has_noise);
  if (!budget || !table.has_noise) return w;
  Curves c = curves_without(hashes, coupling, *budget);
  c.after.resolved = w.rest.missing() == 0;
  for (std::size_t k = 0; k < table.frequencies.size(); ++k) {
    double const hz = table.frequencies[k];
    w.strain.push_back(
        {hz, table.total_strain[k], strain_at(c.after, budget->grid, hz), strain_at(c.factor, budget->grid, hz)});
    w.rest.total_strain[k] = w.strain.back().after;
  }
  return w;
}

ReplicaPattern pattern_of(CouplingTable const& table, CouplingClass const& c) {
  auto const& histories = table.replica_histories;
  if (std::find(histories.begin(), histories.end(), 0u) != histories.end()) return {};
  double const sum = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  double const mean = sum / double(std::accumulate(histories.begin(), histories.end(), std::uint64_t{}));
  ReplicaPattern off;
  double square = 0;
  for (std::size_t r = 0; r < replica_count; ++r) {
    off[r] = c.replica_sum[r] - mean * double(histories[r]);
    square += off[r] * off[r];
  }
  if (!(square > 1e-24 * sum * sum)) return {};  // equal sums: the rest is rounding
  for (double& x : off) x /= std::sqrt(square);
  return off;
}

ReplicaSum::ReplicaSum(WithError value, ReplicaPattern const& pattern) : value_(value.value), off_(pattern) {
  bool const alone = std::all_of(pattern.begin(), pattern.end(), [](double x) { return x == 0; });
  if (alone) independent_ = value.sigma * value.sigma;
  for (double& x : off_) x *= value.sigma;
}

void ReplicaSum::add(ReplicaSum const& other) {
  value_ += other.value_;
  independent_ += other.independent_;
  for (std::size_t r = 0; r < replica_count; ++r) off_[r] += other.off_[r];
}

WithError ReplicaSum::result() const {
  double variance = independent_;
  for (double const x : off_) variance += x * x;
  return {value_, std::sqrt(variance)};
}

// d(p/P) = (dp - s dP)/P; the part of dP without a pattern holds that of dp.
WithError ReplicaSum::share_of(ReplicaSum const& total) const {
  if (!(total.value_ > 0)) return {not_a_number, not_a_number};
  double const s = value_ / total.value_;
  double variance = (1 - 2 * s) * independent_ + s * s * total.independent_;
  for (std::size_t r = 0; r < replica_count; ++r) {
    double const off = off_[r] - s * total.off_[r];
    variance += off * off;
  }
  return {s, std::sqrt(std::fmax(variance, 0)) / total.value_};
}

std::string first_ranks(std::vector<std::size_t> const& ranks) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < std::min(ranks.size(), most); ++k)
    text += fmt::format("{}#{}", k > 0 ? " " : "", ranks[k]);
  return ranks.size() > most ? text + fmt::format(" and {} more", ranks.size() - most) : text;
}

// Figures of merit.

namespace {

constexpr char const* ends[] = {"receiver ", "port "};

double merit(double mean, double error, double seconds) {
  double const relative = error / mean;
  return mean > 0 && error > 0 && seconds > 0 ? 1 / (relative * relative * seconds) : not_a_number;
}
double merit(Estimate const& e, double seconds) {
  return e.trusted ? merit(e.mean, e.std_error, seconds) : not_a_number;
}

// Of the resolved routes of a port together.
Merit of_port(CouplingTable const& table, std::uint32_t port, double seconds) {
  ReplicaSum all;
  for (CouplingClass const& c : table.classes)
    if (c.port.value == port && c.coupling.trusted)
      all.add({{c.coupling.mean, c.coupling.std_error}, pattern_of(table, c)});
  return {"port " + table.ports[port], merit(all.result().value, all.result().sigma, seconds)};
}

template <class Name>
void add_routes(std::vector<Merit>& all, CouplingTable const& table, std::vector<CouplingClass> const& classes,
                Name const& name, double seconds) {
  std::vector<CouplingClass const*> sorted;
  for (CouplingClass const& c : classes) sorted.push_back(&c);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](auto const* a, auto const* b) { return a->coupling.mean > b->coupling.mean; });
  for (CouplingClass const* c : sorted) all.push_back({name(table, *c), merit(c->coupling, seconds)});
}

bool is_end(Merit const& m) {
  return std::any_of(std::begin(ends), std::end(ends), [&](char const* end) { return m.what.starts_with(end); });
}

}  // namespace

std::vector<Merit> merits(RunContent const& run) {
  CouplingTable const& table = run.trace->coupling;
  double const seconds = run.trace->seconds;
  std::vector<Merit> all;
  for (std::uint32_t i = 0; i < table.ports.size(); ++i) all.push_back(of_port(table, i, seconds));
  for (std::size_t i = 0; i < table.receivers.size(); ++i)
    all.push_back({"receiver " + table.receivers[i], merit(table.received_power[i], seconds)});
  add_routes(all, table, table.classes, route_name, seconds);
  add_routes(all, table, table.received, received_name, seconds);
  return all;
}

std::string merit_text(std::vector<Merit> const& all, std::size_t routes) {
  std::string text;
  for (Merit const& m : all) {
    bool const route = !is_end(m);
    if (std::isnan(m.value) || (route && routes == 0)) continue;
    routes -= route;
    text += fmt::format("figure of merit  {:8.2g} /s  {}\n", m.value, m.what);
  }
  return text;
}

std::size_t class_of(CouplingTable const& table, PathRow const& row) {
  for (std::size_t i = 0; i < table.classes.size(); ++i)
    if (table.classes[i].hash == row.hash && table.ports[table.classes[i].port.value] == row.port) return i;
  throw InputError("the run file lacks a route of its path table", "repeat the run");
}

namespace {

// S: one-sided PSD of the quadrature of a unit field whose phase moves as the paths of the route do, mean over static
// phases; half of the PSD of the phase where motion is small.
std::vector<StrainFactor> factors_of(CouplingClass const& c, NoiseTrace const& trace, PathRow const& row,
                                     Interferometer const& ifo, double centre, double h) {
  bool const of_rim = c.kind == ClassKind::rim;  // its light is the main beam, without a phase (eq. N.21)
  double const phase = of_rim ? 0 : std::abs(ifo.strain_per_phase(c.port, centre)),
               amplitude = std::abs(of_rim ? ifo.strain_per_passing_amplitude(c.port, centre).value_or(not_a_number)
                                           : ifo.strain_per_amplitude(c.port, centre)),
               copies = ifo.copies(c.port), both = phase * phase + amplitude * amplitude,
               power = c.coupling.mean * c.reverse * copies;
  bool const bound = row.upper_bound();
  return {
      {"C", c.coupling.mean, "", "power that rejoins the mode on this route, of ordered paths, relative", bound},
      {"C_rev", c.reverse, "", "the reverse route adds in amplitude: 2 where it is another route"},
      {"N", copies, "", "equal, independent copies of the port in the detector; powers add"},
      {"kappa", row.phase_sensitivity, "rad/m",
       "rms phase sensitivity of the body that moves it: single path, all bounces counted; of 'other' weighted by "
       "noise"},
      {"phase", std::sqrt(trace.mean_square_phase), "rad", "rms; above 1 fringes wrap"},
      {"S", power > 0 && both > 0 ? h * h / (power * both) : not_a_number, "1/Hz",
       "one-sided PSD of the quadrature of a unit field, mean over static phases (half of the PSD of a small phase)"},
      {"T_phase", phase, "1", "strain per relative field in quadrature with the main field (Im s)"},
      {"T_amplitude", amplitude, "1", "strain per relative field in phase (Re s): radiation pressure"},
      {"h", h, "1/sqrt(Hz)", "sqrt(C C_rev N (T_phase^2 + T_amplitude^2) S): one-sided strain ASD", bound}};
}

}  // namespace

StrainFactors strain_factors(CouplingTable const& table, NoiseBudget const& budget, PathRow const& row,
                             Interferometer const& ifo, double hz) {
  FrequencyGrid const& grid = budget.grid;
  std::size_t const bin = grid.bin_of(hz), route = class_of(table, row);
  if (bin == grid.size())
    throw InputError(fmt::format("{:g} Hz is outside the band of the noise, {:g} Hz to {:g} Hz", hz, grid.edges.front(),
                                 grid.edges.back()),
                     "write --at with a frequency inside it");
  CouplingClass const& c = table.classes[route];
  NoiseTrace const& trace = budget.routes[route];
  double const centre = grid.centre(bin), h = trace.asd[bin];
  return {centre,
          grid.edges[bin],
          grid.edges[bin + 1],
          factors_of(c, trace, row, ifo, centre, h),
          {h, std::hypot(trace.sigma[bin], mirror_error(c.kind, c.coupling) / 2 * h), row.upper_bound()},
          !c.deterministic(),
          trace.resolved,
          trace.why_not,
          trace.linear_share[bin]};
}

}  // namespace straytrace::results
