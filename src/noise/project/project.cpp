// SPDX-License-Identifier: BSD-3-Clause
// Routes add in power: their static phases are independent (docs/theory/spectra.md, eq. 10.1, 1.13). Paths of a
// coherent family are one route.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <optional>
#include <tuple>
#include <utility>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "noise/classes/delayed_paths.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "noise/noise.hpp"
#include "noise/project/route_noise.hpp"
#include "noise/project/static_phase.hpp"
#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace::noise {
namespace {

// |T|^2 from Im s and from Re s to strain, at the centres of the bins. Within a bin of 4 % the mean of f^-4 differs
// from its value at the centre by 5e-4.
struct Response {
  Bins phase, amplitude;
  Bins relation;  // 2 Re(T_ph T_am*), from the cross spectrum of Re s and Im s
  Bins cross{};   // that, weighed; empty with random static phases
  double both(std::size_t i) const { return phase[i] + amplitude[i] + (cross.empty() ? 0 : cross[i]); }
};

// Eq. N.26: with S the mean over static phases and q = exp(2i phi_0) S'/S, Im s has S (1 - Re q), Re s S (1 + Re q),
// and their cross spectrum is S Im q.
Response with_static_phase(Response const& mean, std::vector<std::complex<double>> const& ratio, double phase) {
  Response t = mean;
  t.cross.resize(ratio.size());
  std::complex<double> const turn(std::cos(2 * phase), std::sin(2 * phase));
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    std::complex<double> const q = turn * ratio[i];
    t.phase[i] *= 1 - q.real();
    t.amplitude[i] *= 1 + q.real();
    t.cross[i] = q.imag() * t.relation[i];
  }
  return t;
}

std::vector<Response> responses(Interferometer const& ifo, std::size_t ports, FrequencyGrid const& grid) {
  std::vector<Response> out(ports);
  for (std::uint32_t p = 0; p < ports; ++p) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      std::complex<double> const phase = ifo.strain_per_phase(PortId{p}, grid.centre(i)),
                                 amplitude = ifo.strain_per_amplitude(PortId{p}, grid.centre(i));
      out[p].phase.push_back(std::norm(phase));
      out[p].amplitude.push_back(std::norm(amplitude));
      out[p].relation.push_back(2 * std::real(phase * std::conj(amplitude)));
    }
  }
  return out;
}

// Eq. N.21: of rims in the main beam of a port.
Response passing_response(Interferometer const& ifo, CouplingTable const& table, CouplingClass const& c,
                          FrequencyGrid const& grid) {
  Response out{Bins(grid.size()), {}, Bins(grid.size())};
  for (std::size_t i = 0; i < grid.size(); ++i) {
    auto const t = ifo.strain_per_passing_amplitude(c.port, grid.centre(i));
    if (!t) throw without_passing_amplitude(table.ports.at(c.port.value));
    out.amplitude.push_back(std::norm(*t));
  }
  return out;
}

// PSDs of one curve, before roots are taken.
struct PowerSum {
  explicit PowerSum(std::size_t bins) : phase(bins), amplitude(bins), cross(bins), linear(bins), drawn(bins) {}
  Bins phase, amplitude;                      // 1/Hz
  Bins cross;                                 // 1/Hz, of both quadratures together, where static phases are known
  Bins linear;                                // of both, first order in the motion of the bin
  Bins drawn;                                 // of both, variance [1/Hz^2] from spectra of drawn paths
  Bins guessed;                               // of both, variance [1/Hz^2] of hints; empty: there are none
  std::array<Replicas, error_parts> without;  // both
  double mean_square_phase = 0, power = 0;
  bool sampled = false, exact = false;  // whether it holds classes with a Monte-Carlo error, and without

  double both(std::size_t i) const { return phase[i] + amplitude[i] + cross[i]; }
  void add(RouteSpectrum const& route, Response const& t, double factor, double coupling) {
    for (std::size_t i = 0; i < phase.size(); ++i) {
      phase[i] += factor * t.phase[i] * route.psd[i];
      amplitude[i] += factor * t.amplitude[i] * route.psd[i];
      if (!t.cross.empty()) cross[i] += factor * t.cross[i] * route.psd[i];
      linear[i] += factor * t.both(i) * route.linear[i];
      if (!route.drawn.empty()) drawn[i] += std::pow(factor * t.both(i), 2) * route.drawn[i];
    }
    for (std::size_t part = 0; part < error_parts; ++part)
      for (std::size_t r = 0; r < replica_count; ++r) {
        Bins const& of_route = route.without[part][r];
        if (of_route.empty()) continue;
        without[part][r].resize(phase.size());
        for (std::size_t i = 0; i < phase.size(); ++i) without[part][r][i] += factor * t.both(i) * of_route[i];
      }
    mean_square_phase += coupling * route.mean_square_phase;
    power += coupling;
    (route.exact ? exact : sampled) = true;
  }
  // The observed part of an unresolved class, with an error as large as itself.
  void add_hint(PowerSum const& seen) {
    guessed.resize(phase.size());
    for (std::size_t i = 0; i < phase.size(); ++i) {
      phase[i] += seen.phase[i];
      amplitude[i] += seen.amplitude[i];
      cross[i] += seen.cross[i];
      linear[i] += seen.linear[i];
      guessed[i] += std::pow(seen.both(i), 2);
    }
  }
};

Strengths strengths_of(CouplingTable const& table, MotionSet const& motion, PhaseSpectra const& spectra) {
  Strengths out{spectra.classes().size(), {}, {}};
  for (CouplingClass const& c : table.classes) {
    out.first.push_back(out.weight.size());
    for (PathRecord const& record : c.records) {
      std::vector<double> const kappa = kappa_of(motion, spectra.classes(), record);
      out.kappa.insert(out.kappa.end(), kappa.begin(), kappa.end());
      out.weight.push_back(record.weight);
    }
  }
  return out;
}

double variance_at(Replicas const& without, std::size_t bin) {
  std::vector<double> values;
  for (Bins const& b : without)
    if (!b.empty()) values.push_back(b[bin]);
  return jackknife_variance(values);
}

// ASD, with the standard error sigma_asd = sigma_psd / (2 asd). The variances of the paths found, of the paths drawn
// among them and of hints are independent and add.
NoiseTrace finished(std::string name, PowerSum const& sum) {
  NoiseTrace t;
  t.name = std::move(name);
  t.mean_square_phase = sum.power > 0 ? sum.mean_square_phase / sum.power : 0;
  for (std::size_t i = 0; i < sum.phase.size(); ++i) {
    double const psd = sum.both(i);
    if (!std::isfinite(psd)) throw NumericalError(fmt::format("the noise of '{}' is not finite", t.name));
    t.asd.push_back(std::sqrt(psd));
    auto const of_asd = [&](double variance) { return std::sqrt(variance) / (psd > 0 ? 2 * t.asd.back() : 1); };
    auto const part = [&](ErrorPart p) {
      return sum.exact && !sum.sampled ? 0 : variance_at(sum.without[std::size_t(p)], i);
    };
    t.sigma.push_back(of_asd(part(ErrorPart::all) + sum.drawn[i] + (sum.guessed.empty() ? 0 : sum.guessed[i])));
    t.power_sigma.push_back(of_asd(part(ErrorPart::power)));
    t.phase_sensitivities_sigma.push_back(of_asd(part(ErrorPart::phase_sensitivities)));
    t.paths_sigma.push_back(of_asd(part(ErrorPart::paths) + sum.drawn[i]));
    t.phase_asd.push_back(std::sqrt(sum.phase[i]));
    t.amplitude_asd.push_back(std::sqrt(sum.amplitude[i]));
    t.linear_share.push_back(psd > 0 ? sum.linear[i] / psd : not_a_number);
  }
  return t;
}

// Why a class cannot enter the total; empty when it can.
std::string objection(CouplingTable const& table, CouplingClass const& c, RouteSpectrum const& route) {
  auto const replicas = std::ranges::count_if(table.replica_histories, [](auto n) { return n > 0; });
  if (!c.coupling.trusted) return c.coupling.why_not.empty() ? "its mean is not trusted" : c.coupling.why_not;
  if (c.coupling.mean > 0 && c.records.empty()) return "no path of it was kept";
  if (c.deterministic()) return {};
  if (replicas < 2) return "fewer than two replicas: no error can be given";
  if (route.rests_on_few())
    return fmt::format("its noise rests on about {:.0f} of the kept paths, the others hardly move",
                       std::max(1.0, route.paths_of_noise));
  return {};
}

// An unresolved class: its observed part, with its error.
PowerSum hint_of(PowerSum const& seen) {
  PowerSum hint(seen.phase.size());
  hint.add_hint(seen);
  hint.exact = true;  // replicas do not give its error
  hint.mean_square_phase = seen.mean_square_phase;
  hint.power = seen.power;
  return hint;
}

bool never_scored(CouplingClass const& c) {
  return c.coupling.scored == 0 && c.coupling.mean == 0 && c.records.empty();
}

double largest_ratio(PowerSum const& unresolved, PowerSum const& total) {
  double ratio = 0;
  for (std::size_t i = 0; i < total.phase.size(); ++i) {
    double const above = unresolved.both(i), below = total.both(i);
    if (above > 0) ratio = std::max(ratio, above / below);
  }
  return ratio;
}

// Largest standard error of the ASD by drawn paths, over the ASD.
DrawnError drawn_error(PowerSum const& total) {
  DrawnError worst;
  for (std::size_t i = 0; i < total.phase.size(); ++i) {
    double const psd = total.both(i), share = std::sqrt(total.drawn[i]) / (2 * psd);
    if (psd > 0 && share > worst.share) worst = {share, i};
  }
  return worst;
}

// That more histories do not lower the error of h: where it is mostly that of the kept paths, whose number has reached
// its limit (docs/theory/errors.md, Records). Empty: it falls, or is below 1e-4 of h.
std::string floor_note(NoiseBudget const& b, CouplingTable const& table) {
  std::size_t const kept = records_kept(table.histories / table.block_size);
  if (kept < records_kept(~std::uint64_t{0} / 2)) return {};
  double low = 0, high = 0, most = 1e-4, worst_hz = 0;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const h = b.total.asd[i], paths = b.total.paths_sigma[i], all = b.total.sigma[i];
    if (!(h > 0) || !(paths * paths > 0.5 * all * all) || !(paths > 1e-4 * h)) continue;
    if (low == 0) low = b.grid.edges[i];
    high = b.grid.edges[i + 1];
    if (paths / h > most) std::tie(most, worst_hz) = std::pair(paths / h, b.grid.centre(i));
  }
  if (low == 0) return {};
  return fmt::format(
      "the error of h between {:.3g} and {:.3g} Hz, up to {:.2g} % at {:.3g} Hz, is mostly that of the kept paths: a "
      "route keeps at most {}, so more histories do not lower it (docs/theory/errors.md, Records)",
      low, high, 100 * most, worst_hz, kept);
}

// `to_strain`: strain PSD over that of Im s, per bin.
void add_draws(NoiseTrace& trace, DrawBand const& draws, Bins const& to_strain) {
  for (std::size_t i = 0; i < draws.low.size(); ++i) {
    trace.draws_low.push_back(std::sqrt(to_strain[i] * draws.low[i]));
    trace.draws_high.push_back(std::sqrt(to_strain[i] * draws.high[i]));
    trace.draws_sigma.push_back(trace.asd[i] > 0 ? to_strain[i] * draws.error[i] / (2 * trace.asd[i]) : 0);
  }
  for (Bins const& psd : draws.psd) {
    Bins& asd = trace.draws.emplace_back();
    for (std::size_t i = 0; i < psd.size(); ++i) asd.push_back(std::sqrt(to_strain[i] * psd[i]));
  }
}

// What is known of the static phases of routes.
struct RoutePhases {
  std::vector<std::optional<double>> known;  // rad
  std::vector<bool> scanned;                 // those of the scanned body; empty: no body is scanned
  bool scans(std::size_t route) const { return route < scanned.size() && scanned[route]; }
};

// PSDs of the total with the scanned body at each of its positions, less their mean.
class Positions {
 public:
  explicit Positions(NoiseSettings const& s) : scanned_(s.scanned) {
    if (scanned_) change_.assign(scanned_->count, Bins(s.grid.size()));
  }
  void add(RouteSpectrum const& route, Response const& random, std::vector<std::complex<double>> const& ratio,
           double factor) {
    for (std::uint32_t k = 0; k < change_.size(); ++k) {
      Response const t = with_static_phase(random, ratio, scanned_->phase(k));
      for (std::size_t i = 0; i < route.psd.size(); ++i)
        change_[k][i] += factor * (t.both(i) - random.both(i)) * route.psd[i];
    }
  }
  void put_into(NoiseBudget& b) const {
    if (!scanned_) return;
    b.scanned_body = scanned_->body;
    for (std::uint32_t k = 0; k < change_.size(); ++k) {
      PositionCurve curve{scanned_->phase(k), {}};
      for (std::size_t i = 0; i < change_[k].size(); ++i)
        curve.asd.push_back(std::sqrt(std::max(0.0, b.total.psd(i) + change_[k][i])));
      b.positions.push_back(std::move(curve));
    }
  }

 private:
  std::optional<ScannedPhase> scanned_;
  std::vector<Bins> change_;
};

// Paths whose amplitude moves too much for the first order in their levers, and families, whose fields add without it.
void warn_of_levers(NoiseBudget& b, CouplingTable const& table, MotionSet const& motion, PhaseSpectra const& spectra) {
  constexpr double much = 0.1, share = 0.01;  // rms change of the amplitude; of the mean-square phase
  double worst = much, left_out = share;
  CouplingClass const *moved = nullptr, *family = nullptr;
  for (CouplingClass const& c : table.classes)
    for (PathRecord const& r : c.records) {
      if (r.amplitude_levers.empty()) continue;
      std::vector<double> const a = kappa_of(motion, spectra.classes(), r.amplitude_levers);
      double square = 0;
      for (std::size_t k = 0; k < a.size(); ++k)
        if (!spectra.classes()[k].drift) square += a[k] * spectra.variance(k);
      if (std::sqrt(square) > worst) std::tie(worst, moved) = std::pair(std::sqrt(square), &c);
      if (!c.adds_fields() || !(square > 0)) continue;
      double const phase = spectra.mean_square_phase(kappa_of(motion, spectra.classes(), r.phase_sensitivities));
      if (square / phase > left_out) std::tie(left_out, family) = std::pair(square / phase, &c);
    }
  if (moved)
    b.warnings.push_back(fmt::format(
        "the motion of bodies changes the amplitude of route '{}' by {:.2g} of itself (rms), too much for the first "
        "order that its noise contains (docs/theory/ghosts.md, eq. N.27)",
        route_name(table, *moved), worst));
  if (family)
    b.warnings.push_back(fmt::format(
        "ghosts whose fields add have no levers of the amplitude in h: those of route '{}' have {:.2g} of the power of "
        "the phase (docs/theory/ghosts.md, eq. N.27)",
        route_name(table, *family), left_out));
}

// The routes of a table under one motion, added up in their order.
class TableProjection {
 public:
  TableProjection(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                  NoiseSettings const& settings, RoutePhases const& phases)
      : table_(table),
        motion_(motion),
        ifo_(ifo),
        phases_(phases),
        spectra_(group_by_shape(motion), settings.grid),
        strengths_(strengths_of(table, motion, spectra_)),
        nodes_(spectra_, strengths_),
        response_(responses(ifo, table.ports.size(), settings.grid)),
        total_(settings.grid.size()),
        positions_(settings) {
    for (std::size_t i = 0; i < strengths_.size(); ++i)
      strength_.push_back(spectra_.mean_square_phase(strengths_.of(i)));
    budget_.grid = settings.grid;
    budget_.margin = settings.margin;
  }
  // `sideband`: the class of the modulated amplitude of the route, if it has one; of such a class there is no curve.
  void add_route(std::size_t r, std::optional<std::size_t> sideband);
  NoiseBudget budget();  // once, after all routes

 private:
  RouteSpectrum spectrum_of(std::size_t route) const;
  void add_doubtful();
  void finish_total();
  std::size_t bins() const { return budget_.grid.size(); }

  CouplingTable const& table_;
  MotionSet const& motion_;
  Interferometer const& ifo_;
  RoutePhases const& phases_;
  PhaseSpectra const spectra_;
  Strengths const strengths_;
  SpectrumInterpolator const nodes_;
  std::vector<Response> const response_;  // of each port
  std::vector<double> strength_;          // mean-square phase of each path, rad^2
  PowerSum total_;
  Positions positions_;
  std::vector<std::pair<std::size_t, PowerSum>> doubtful_;  // unresolved routes
  NoiseBudget budget_;
};

RouteSpectrum TableProjection::spectrum_of(std::size_t r) const {
  CouplingClass const& c = table_.classes[r];
  std::size_t const first = strengths_.first[r];
  RouteSpectrum route = c.kind == ClassKind::rim ? rim_spectrum(spectra_, motion_, c)
                        : c.adds_fields() ? family_spectrum(spectra_, motion_, c, std::span(strength_).subspan(first))
                                          : route_spectrum(table_, c, first, nodes_, strength_,
                                                           {spectra_, motion_, table_, c, strengths_, first});
  route.psd.resize(bins());
  route.linear.resize(bins());
  return route;
}

void TableProjection::add_route(std::size_t r, std::optional<std::size_t> sideband) {
  CouplingClass const& c = table_.classes[r];
  RouteSpectrum const route = spectrum_of(r);
  Response const random =
      c.kind == ClassKind::rim ? passing_response(ifo_, table_, c, budget_.grid) : response_.at(c.port.value);
  std::optional<double> const known = phases_.known[r];
  auto const relation =
      known || phases_.scans(r) ? phase_relation(spectra_, motion_, c) : std::vector<std::complex<double>>{};
  Response const t = known ? with_static_phase(random, relation, *known) : random;
  std::string const why_not = objection(table_, c, route);
  double const factor = c.reverse * ifo_.copies(c.port);
  if (phases_.scans(r)) positions_.add(route, random, relation, factor);
  auto const add_to = [&](PowerSum& sum) {
    sum.add(route, t, factor, c.coupling.mean);
    if (sideband) sum.add(spectrum_of(*sideband), random, factor, 0);
  };
  PowerSum own(bins());
  add_to(own);
  if (why_not.empty())
    add_to(total_);
  else if (!never_scored(c))
    doubtful_.emplace_back(r, own);
  NoiseTrace& trace =
      budget_.routes.emplace_back(finished(route_name(table_, c), why_not.empty() ? own : hint_of(own)));
  if (c.mixes_routes()) trace.mean_square_phase = route.mean_square_phase_of_noise;
  Bins to_strain;
  for (std::size_t i = 0; i < bins(); ++i) to_strain.push_back(factor * t.both(i));
  add_draws(trace, draw_band(c, strengths_.first[r], nodes_), to_strain);
  trace.hash = c.hash;
  trace.resolved = why_not.empty();
  trace.why_not = why_not;
}

// Of unresolved routes, the total contains what was observed.
void TableProjection::add_doubtful() {
  PowerSum unresolved(bins()), faint(bins());
  for (auto const& [r, own] : doubtful_) {
    NoiseTrace& trace = budget_.routes[r];
    trace.faint = !table_.classes[r].records.empty() && largest_ratio(own, total_) < faint_limit;
    (trace.faint ? budget_.faint : budget_.unresolved).push_back(trace.name + ": " + trace.why_not);
    (trace.faint ? faint : unresolved).add_hint(own);
  }
  budget_.unresolved_hint = largest_ratio(unresolved, total_);
  budget_.faint_share = largest_ratio(faint, total_);
  for (auto const& [r, own] : doubtful_) total_.add_hint(own);
}

void TableProjection::finish_total() {
  NoiseTrace& total = budget_.total = finished("total", total_);
  for (Bins& replica : total_.without[std::size_t(ErrorPart::all)])
    if (!replica.empty()) total.without.push_back(std::move(replica));
  for (std::size_t i = 0; i < total_.guessed.size(); ++i)
    total.hint_sigma.push_back(total.asd[i] > 0 ? std::sqrt(total_.guessed[i]) / (2 * total.asd[i]) : 0);
  total.resolved = budget_.unresolved.empty();
  bool const nothing = std::ranges::none_of(budget_.routes, [](auto const& t) { return t.resolved; });
  if (nothing && !total.resolved)  // unresolved is not zero
    for (Bins NoiseTrace::*curve :
         {&NoiseTrace::asd, &NoiseTrace::sigma, &NoiseTrace::power_sigma, &NoiseTrace::phase_sensitivities_sigma,
          &NoiseTrace::paths_sigma, &NoiseTrace::phase_asd, &NoiseTrace::amplitude_asd, &NoiseTrace::linear_share})
      (total.*curve).assign(bins(), not_a_number);
  if (!total.resolved) total.why_not = "a lower bound: of unresolved routes it contains the observed part";
}

NoiseBudget TableProjection::budget() {
  add_doubtful();
  finish_total();
  positions_.put_into(budget_);
  find_bounds(budget_, table_);
  warn_of_levers(budget_, table_, motion_, spectra_);
  if (std::string note = floor_note(budget_, table_); !note.empty()) budget_.warnings.push_back(std::move(note));
  if (nodes_.sampled())
    budget_.warnings.push_back(sharing_note(table_, motion_, spectra_, strengths_, nodes_, drawn_error(total_)));
  return std::move(budget_);
}

// `sidebands`: of each route that has a curve (TableProjection::add_route).
NoiseBudget project_at_once(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                            NoiseSettings const& settings, std::span<std::optional<std::size_t> const> sidebands,
                            RoutePhases const& phases) {
  auto const start = std::chrono::steady_clock::now();
  TableProjection projection(table, motion, ifo, settings, phases);
  for (std::size_t r = 0; r < sidebands.size(); ++r) projection.add_route(r, sidebands[r]);
  NoiseBudget budget = projection.budget();
  budget.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return budget;
}

}  // namespace

NoiseBudget project_noise(CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo,
                          NoiseSettings const& settings) {
  ModulatedLight const light(table, motion);
  RoutePhases const phases{known_phases(light.table(), light.motion(), settings.static_phases, ifo),
                           scanned_routes(light.table(), light.motion(), settings, ifo)};
  auto const project = [&](CouplingTable const& all, MotionSet const& moved,
                           std::span<std::optional<std::size_t> const> sidebands) {
    if (!settings.delay) return project_at_once(all, moved, ifo, settings, sidebands, phases);
    DelayedPaths const late = with_delays(all, moved, settings.grid.edges.back());
    return project_at_once(late.table, late.motion, ifo, settings, sidebands, phases);
  };
  if (light.motion().light.tones.empty())
    return project(light.table(), light.motion(), std::vector<std::optional<std::size_t>>(table.classes.size()));
  AmplitudeSidebands const all = amplitude_sidebands(light.table(), light.motion());
  return project(all.table, all.motion, all.of);
}

// Jackknife: scaled so that the sum of the squares is the variance.
std::vector<std::vector<double>> deviations(NoiseTrace const& total) {
  std::vector<std::vector<double>> out = total.without;
  auto const n = static_cast<double>(out.size());
  if (n < 2) return {};
  for (std::size_t i = 0; i < total.asd.size(); ++i) {
    double mean = 0;
    for (Bins const& own : out) mean += own[i] / n;
    double const factor = total.asd[i] > 0 ? std::sqrt((n - 1) / n) / (2 * total.asd[i]) : 0;
    for (Bins& own : out) own[i] = factor * (mean - own[i]);
  }
  return out;
}

PositionBand position_band(NoiseBudget const& b) {
  PositionBand band;
  for (std::size_t i = 0; !b.positions.empty() && i < b.grid.size(); ++i) {
    auto const at = [&](PositionCurve const& c) { return c.asd[i]; };
    auto const [low, high] = std::ranges::minmax_element(b.positions, {}, at);
    band.low.push_back(at(*low));
    band.high.push_back(at(*high));
  }
  return band;
}

// Which curves are upper bounds (docs/theory/diffraction.md, eq. 8.11: rims as one smooth wave; speckle lowers that).

void find_bounds(NoiseBudget& b, CouplingTable const& table) {
  std::size_t const bins = b.grid.size();
  std::vector<double> bound(bins);
  for (std::size_t r = 0; r < b.routes.size() && r < table.classes.size(); ++r) {
    NoiseTrace& t = b.routes[r];
    t.upper_bound = table.classes[r].kind == ClassKind::edge;
    for (std::size_t i = 0; t.upper_bound && i < bins; ++i) bound[i] += t.psd(i);
  }
  b.total.bound_share.clear();
  for (std::size_t i = 0; i < bins; ++i) {
    double const all = b.total.psd(i);
    b.total.bound_share.push_back(all > 0 ? std::min(bound[i] / all, 1.0) : 0);
  }
}

constexpr double lowest_hz = 1e-9, highest_hz = 1e12;  // of the band; the grid stays finite

double FrequencyGrid::centre(std::size_t i) const { return std::sqrt(edges[i] * edges[i + 1]); }

std::size_t FrequencyGrid::bin_of(double hz) const {
  if (size() == 0 || !(hz >= edges.front() && hz < edges.back())) return size();
  return std::size_t(std::ranges::upper_bound(edges, hz) - edges.begin()) - 1;
}

FrequencyGrid logarithmic_grid(double low_hz, double high_hz, double points_per_decade) {
  double const n = std::max(1.0, std::round(points_per_decade * std::log10(high_hz / low_hz)));
  FrequencyGrid grid;
  for (double i = 0; i < n; ++i) grid.edges.push_back(low_hz * std::pow(high_hz / low_hz, i / n));
  grid.edges.push_back(high_hz);
  return grid;
}

namespace {

// Of each body an angle, or of one a number of positions.
void read_static_phases(Node const& table, NoiseSettings& settings) {
  for (auto const& [body, phase] : table.items()) {
    if (body == "override") continue;
    if (phase.kind() != Node::Kind::table) {
      settings.static_phases.push_back({body, phase.as_number(dim::angle, -1e6, 1e6)});
      continue;
    }
    auto const count = std::uint32_t(phase.whole("positions", 8, 2, 360));
    phase.refuse_unknown("'static_phase'");
    if (settings.scanned)
      phase.problem(fmt::format("'{}' and '{}' both have positions", settings.scanned->body, body),
                    "scan one body, and state an angle for the other or leave it out");
    settings.scanned = ScannedPhase{body, count};
  }
}

}  // namespace

NoiseSettings read_noise_settings(Node const& table) {
  double low = 3, high = 1000, density = 60;
  NoiseSettings settings;
  if (table) {
    if (Node const band = table["band"]) {
      std::vector<double> const ends = band.as_numbers(dim::frequency, 2);
      low = ends[0];
      high = ends[1];
      if (low <= 0 || high <= low)
        band.problem("the band must go from a low to a higher frequency above zero", "write '[3 Hz, 1 kHz]'");
      else if (low < lowest_hz || high > highest_hz)
        band.problem("the band exceeds 1 nHz to 1 THz", "write '[3 Hz, 1 kHz]'");
    }
    read_static_phases(table.table("static_phase"), settings);
    settings.delay = table.flag("delay", settings.delay);
    density = table.number("points_per_decade", dim::plain, density, 1, 1000);
    settings.margin = table.number("margin", dim::plain, settings.margin, 1e-6, 1e6);
    for (Node const& name : table.list("compare")) settings.compare.push_back(name.as_word());
    table.refuse_unknown("'noise'");
  }
  bool const usable = low >= lowest_hz && low < high && high <= highest_hz && std::isfinite(density);
  settings.grid = usable ? logarithmic_grid(low, high, density) : logarithmic_grid(3, 1000, 60);
  return settings;
}

}  // namespace straytrace::noise
