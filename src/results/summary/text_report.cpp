// SPDX-License-Identifier: BSD-3-Clause
// report.txt and the sentence at its top.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text/words.hpp"
#include "results/curves/band.hpp"
#include "results/receivers/receivers.hpp"
#include "results/text/columns.hpp"
#include "wave/arm/wave_record.hpp"

namespace straytrace::results {
namespace {

// Three digits, never in powers of ten.
std::string hertz(double hz) { return fmt::format("{:.10g}", std::stod(fmt::format("{:.2e}", hz))); }

struct Comparison {
  std::size_t bins = 0, worst = 0;
  double low = 0, high = 0;                      // Hz, edges of the compared band
  double ratio = 0, sigma = 0;                   // h over margin line at the worst bin
  bool at_most = false;                          // that is an upper bound, or would be if no route were unresolved
  std::vector<std::pair<double, double>> above;  // Hz, bands where h exceeds the line
};

Comparison compare(NoiseBudget const& b, DesignCurve const& design, double low, double high) {
  Comparison c;
  bool inside = false;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const line = b.margin * design.asd.at(i), h = b.total.asd.at(i), f = b.grid.centre(i);
    if (f < low || f > high || !(line > 0) || !std::isfinite(h)) continue;
    double const ratio = h / line;
    if (c.bins++ == 0) c.low = b.grid.edges[i];
    c.high = b.grid.edges[i + 1];
    if (c.bins == 1 || ratio > c.ratio) {
      c.worst = i;
      c.ratio = ratio;
      c.sigma = b.total.sigma.at(i) / line;
      c.at_most = at_most(b.total, i);
    }
    if (ratio > 1 && inside) c.above.back().second = b.grid.edges[i + 1];
    if (ratio > 1 && !inside) c.above.emplace_back(b.grid.edges[i], b.grid.edges[i + 1]);
    inside = ratio > 1;
  }
  return c;
}

std::string bands(std::vector<std::pair<double, double>> const& all) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 3); ++i)
    text += fmt::format("{}{} to {} Hz", i > 0 ? ", " : "", hertz(all[i].first), hertz(all[i].second));
  return all.size() > 3 ? text + " and " + counted(all.size() - 3, "more band") : text;
}

std::string compared(NoiseBudget const& b, double low, double high) {
  std::string const subject = b.unresolved.empty() ? "Stray light" : "Stray light observed so far";
  if (b.design.empty()) return subject + " was not compared with a design curve; name one under 'noise: compare'.";
  DesignCurve const& design = b.design.front();
  Comparison const c = compare(b, design, low, high);
  if (c.bins == 0 && !b.total.asd.empty() && std::isnan(b.total.asd.front()))
    return "No route is resolved: there is no answer yet.";
  if (c.bins == 0)
    return fmt::format("The design curve {} has no values between {} and {} Hz.", design.name, hertz(low), hertz(high));
  std::string const line = fmt::format("the margin line {:g} x {}", b.margin, design.name);
  double const f = b.grid.centre(c.worst);
  if (!b.unresolved.empty() && !(c.ratio > 0)) return "No route is resolved: there is no answer yet.";
  if (!(c.ratio > 0) && b.routes.empty()) return "No traced light has rejoined a port: there is no answer yet.";
  if (!(c.ratio > 0))
    return fmt::format("{} makes no strain noise between {} and {} Hz: nothing it touches moves there.", subject,
                       hertz(c.low), hertz(c.high));
  std::string text;
  if (c.at_most && c.ratio <= 1)
    text = fmt::format("{} stays {} a factor {} below {} between {} and {} Hz; closest at {} Hz.", subject,
                       b.unresolved.empty() ? "at least" : "about", two_digits(1 / c.ratio, false), line, hertz(c.low),
                       hertz(c.high), hertz(f));
  else if (c.at_most)
    text = fmt::format("{} may exceed {} at {} (compared: {} to {} Hz), by a factor of {} at {} Hz.", subject, line,
                       bands(c.above), hertz(c.low), hertz(c.high),
                       with_error({c.ratio, c.sigma, true, !b.unresolved.empty()}), hertz(f));
  else if (c.ratio <= 1)
    text = fmt::format("{} stays a factor {} below {} between {} and {} Hz; closest at {} Hz.", subject,
                       with_error(1 / c.ratio, c.sigma / (c.ratio * c.ratio)), line, hertz(c.low), hertz(c.high),
                       hertz(f));
  else
    text = fmt::format("{} exceeds {} at {} (compared: {} to {} Hz), by up to a factor {} at {} Hz.", subject, line,
                       bands(c.above), hertz(c.low), hertz(c.high), with_error(c.ratio, c.sigma), hertz(f));
  if (!c.at_most && std::fabs(c.ratio - 1) < 2 * c.sigma) text += " This is within two standard errors of the line.";
  return text;
}

std::string section(std::string const& title) {
  return "\n" + title + "\n" + std::string(width_of(title), '=') + "\n\n";
}

std::string bullet(std::string const& text) { return "* " + text + "\n"; }

std::string strain_table(RunContent const& run, PathTable const& table) {
  std::string text = section("Strain noise");
  if (!run.noise) return text + "Not computed.\n";
  NoiseBudget const& b = *run.noise;
  Columns c;
  c.titles = {"frequency/Hz", "h/(1/sqrt(Hz))"};
  for (DesignCurve const& d : b.design) c.titles.push_back("h/" + d.name);
  for (std::size_t i = 0; i < table.frequencies.size(); ++i) {
    WithError const h = table.total_strain[i];
    std::vector<std::string> row = {fmt::format("{:g}", table.frequencies[i])};
    bool const inside = table.frequencies[i] >= b.grid.edges.front() && table.frequencies[i] < b.grid.edges.back();
    row.push_back(!std::isnan(h.value) ? with_error(h) : inside ? "no answer" : "outside the grid");
    for (DesignCurve const& d : b.design) {
      double const design = design_at(d, b.grid, table.frequencies[i]);
      row.push_back(std::isnan(h.value / design) ? "-" : with_error(h.over(design)));
    }
    c.rows.push_back(std::move(row));
  }
  text += aligned(c) +
          "\nOne-sided amplitude spectral density, mean over random static phases. Errors: one standard error, "
          "Monte Carlo only.\n";
  text += error_table(b, table.frequencies);
  text += lines_text(table);
  bool const bound = table.has_upper_bounds(), missing = !b.unresolved.empty();
  if (missing)
    text +=
        fmt::format("The values are {}: they contain the observed part of unresolved routes, with an equal error.\n",
                    bound ? "NO BOUNDS" : "LOWER BOUNDS");
  if (bound)
    text += fmt::format("'{}': upper bounds (routes of kind edge) contribute; speckle lowers them.\n",
                        missing ? "about" : "at most");
  return text;
}

constexpr double closed = 1e-12;  // relative; rounding of long sums stays below

constexpr std::uint64_t fewest_blocks = 32;  // for an error (docs/theory/errors.md)

// Over the main mode, and in watts where its power is known.
std::vector<std::string> power_cells(RunContent const& run, std::string const& name, Estimate const& e,
                                     std::string const& nothing) {
  auto const cell = [&](double unit) {
    return run.trace->total.blocks < fewest_blocks ? fmt::format("about {:.2g}", unit * e.mean)
                                                   : with_error(unit * e.mean, unit * e.std_error);
  };
  std::vector<std::string> row = {name, e.scored == 0 ? nothing : cell(1)};
  if (run.beam_power > 0) row.push_back(e.scored == 0 ? "" : cell(run.beam_power));
  return row;
}

std::string object_table(RunContent const& run) {
  std::string const text = objects_text(run);
  return text.empty() ? text : section("Light on objects") + text;
}

std::string assumed(RunContent const& run, std::vector<std::string> const& more) {
  std::string text = section("Assumptions");
  if (run.trace->coupling.ports.empty()) {
    for (std::string const& line : more) text += bullet(line);
    return text;
  }
  text += bullet(run.trace->coupling.reverse_routes
                     ? "A route and its reverse add in amplitude (C_rev on); all other routes add in power."
                     : "Reverse routes are not added in amplitude (C_rev off); routes add in power.");
  text += bullet("The geometry is frozen: motion changes phases, not which paths exist or how strong they are.");
  text += bullet("h is the mean over random static phases; one realisation of the speckle scatters around it.");
  if (!run.interferometer.empty()) text += bullet("Interferometer: " + run.interferometer);
  for (std::string const& line : more) text += bullet(line);
  return text;
}

std::string provenance(RunContent const& run) {
  Provenance const& p = run.provenance;
  std::string text = section("Provenance");
  text += fmt::format("program     {} {} ({})\nbuild       {}\ncreated     {}\nmodel hash  {}\n", p.program, p.version,
                      p.commit, p.build_flags, p.created, run.model_hash);
  text += fmt::format("seed        {}\nhistories   {} in {} blocks of {}{}\nmain file   {}\n", run.trace->coupling.seed,
                      run.trace->coupling.histories, run.trace->total.blocks, run.trace->coupling.block_size,
                      run.trace->checkpointed() ? ", checkpointed: can be continued" : "", run.main_file);
  for (std::string const& o : run.overrides) text += "override    " + o + "\n";
  for (auto const& [name, content] : run.files)
    text += fmt::format("input       {}  sha256 {}\n", name, sha256(content));
  return text;
}

std::string warnings(RunContent const& run) {
  std::string text;
  for (std::string const& w : run.all_warnings()) text += bullet(w);
  return section("Warnings") + (text.empty() ? "None.\n" : text);
}

}  // namespace

std::string energy_balance_text(RunContent const& run) {
  BlockSums const& total = run.trace->total;
  Columns c;
  c.titles = {"light", "power per history"};
  c.left = {true};
  if (run.beam_power > 0) c.titles.push_back("power/W");
  double balance_terms = 0;
  auto add = [&](std::string const& name, Moments const& m, double least_error = 0) {
    Estimate e = estimate(m, total.histories, total.blocks);
    e.std_error = std::max(e.std_error, least_error);
    double const mean = e.mean;
    bool const rounding = std::fabs(m.sum) < closed * total.emitted.sum;
    if (rounding) e.scored = 0;
    c.rows.push_back(power_cells(run, name, e, rounding && m.scored > 0 ? "rounding only" : "none seen"));
    return mean;
  };
  double const emitted = add("emitted", total.emitted);
  for (int i = 0; i < balance_term_count; ++i) {
    // The odds of the roulette are known; its rare survivors may not have been drawn.
    double const least_error =
        BalanceTerm(i) == BalanceTerm::roulette ? std::sqrt(total.window_variance) / double(total.histories) : 0;
    balance_terms += add(name_of(BalanceTerm(i)), total.energy_balance[std::size_t(i)], least_error);
  }
  std::string text = aligned(c);
  double const open = emitted > 0 ? std::fabs(emitted - balance_terms) / emitted : 0;
  text += fmt::format("\nClosure: emitted power and the sum of the terms differ by {:.1e} of the emitted power ({}).\n",
                      open, open < closed ? "rounding" : "MORE THAN ROUNDING: the energy balance does not close");
  text += "'roulette' and 'sampling' are zero on average.\n";
  text += fmt::format("{} surface events, {} rays, {} histories lost to geometry errors.\n", total.bounces, total.rays,
                      total.lost);
  return text;
}

std::string objects_text(RunContent const& run) {
  BlockSums const& total = run.trace->total;
  std::vector<std::string> const& groups = run.trace->coupling.groups;
  if (total.arrived.size() != groups.size() || groups.empty()) return {};
  Columns c;
  c.titles = {"object", "arriving per history", "absorbed per history"};
  c.left = {true};
  if (run.beam_power > 0)
    c.titles = {"object", "arriving per history", "arriving/W", "absorbed per history", "absorbed/W"};
  bool const known = total.absorbed.size() == groups.size() + 1;  // files of schema 1.2 lack it
  auto const cells = [&](std::vector<Moments> const& list, std::size_t i, std::string const& nothing) {
    Estimate e;
    if (i < list.size()) e = estimate(list[i], total.histories, total.blocks);
    if (std::fabs(e.mean) * double(total.histories) < closed * total.emitted.sum) e.scored = 0;  // rounding
    std::vector<std::string> row = power_cells(run, "", e, nothing);
    return std::vector<std::string>(row.begin() + 1, row.end());
  };
  std::vector<std::size_t> order(groups.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Moments> const& by = known ? total.absorbed : total.arrived;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return by[a].sum > by[b].sum; });
  if (known && total.absorbed.back().sum > 0) order.push_back(groups.size());
  for (std::size_t const i : order) {
    bool const media = i == groups.size();
    std::vector<std::string> row = {media ? "(in media)" : groups[i]};
    for (auto const& more : {cells(total.arrived, i, media ? "" : "none seen"),
                             cells(total.absorbed, i, known ? "none seen" : "not known")})
      row.insert(row.end(), more.begin(), more.end());
    c.rows.push_back(std::move(row));
  }
  return aligned(c) + "\nArrivals are counted at every encounter; the absorbed light sums to 'absorbed' above.\n";
}

std::string verdict_sentence(NoiseBudget const& b, double low_hz, double high_hz) {
  auto const [low, high] = band_of(b.grid, low_hz, high_hz);
  std::string text = compared(b, low, high);
  if (!b.faint.empty())
    text += fmt::format(
        " {} unresolved route{} too faint to matter ({}).", b.faint.size(), b.faint.size() == 1 ? " is" : "s are",
        b.faint_share > 0 ? fmt::format("seen: {:.1g} of the noise power at most", b.faint_share)
                          : std::string(b.faint.size() == 1 ? "nothing on it moves" : "nothing on them moves"));
  if (b.unresolved.empty()) return text + (b.faint.empty() ? " Unresolved: none." : " Otherwise unresolved: none.");
  text += fmt::format(
      " This is {}; unresolved ({}):", bound_bins(b) > 0 ? "no bound, since it contains upper bounds" : "a lower bound",
      b.unresolved.size());
  std::size_t const named = std::min<std::size_t>(b.unresolved.size(), 5);
  for (std::size_t i = 0; i < named; ++i) text += (i > 0 ? "; " : " ") + b.unresolved[i];
  return text + (named < b.unresolved.size() ? "; and more in the path table." : ".");
}

namespace {

constexpr double even = 0.03;  // relative change of the noise that counts as none

std::string change_of(SeamCheck::Light const& light) {
  if (std::isnan(light.change)) return "is not resolved";
  return fmt::format("changes by {:+.2g} % ± {:.2g} %", 100 * light.change, 100 * light.change_sigma);
}

// With two standard errors.
std::string judgement(SeamCheck::Light const& light) {
  double const change = std::fabs(light.change), margin = 2 * light.change_sigma;
  if (change + margin <= even) return "the result does not depend on the crossover angle within 3 %";
  if (change - margin > even)
    return "THE RESULT DEPENDS ON THE CROSSOVER ANGLE; 'straytrace wave SCENE --seam' compares three angles";
  return "more histories or draws ('map_draws') would tell whether that is within 3 %";
}

}  // namespace

std::string seam_sentence(RunContent const& run) {
  if (!run.noise || !run.waves || run.waves->rims.empty()) return "";
  if (!run.seam) return "Crossover angle: not checked; 'straytrace run' compares the noise at two angles.";
  SeamCheck const& c = *run.seam;
  return fmt::format(
      "Crossover angle: at {:.4g} instead of {:.4g} urad, light from baffles {} at {:.4g} Hz, all stray light {}{}: "
      "{}.",
      1e6 * c.other_crossover, 1e6 * c.crossover, change_of(c.baffles), c.frequency, change_of(c.total),
      run.motion_file.empty() ? "" : ", with the motion of the scene", judgement(c.total));
}

std::string text_report(RunContent const& run, PathTable const& table, std::size_t show,
                        std::vector<std::string> const& assumptions) {
  std::string const title = run.title.empty() ? "Stray light" : run.title;
  std::string text = title + "\n" + std::string(width_of(title), '#') + "\n\n";
  bool const received = !run.trace->coupling.receivers.empty();
  if (received && run.trace->coupling.ports.empty()) {
    text += "Light on receivers; the scene has no ports, so there is no strain noise.\n";
  } else {
    text += run.noise ? verdict_sentence(*run.noise, table.low, table.high) + "\n"
                      : std::string("Couplings only: the noise was not computed.\n");
    if (std::string const seam = seam_sentence(run); !seam.empty()) text += "\n" + seam + "\n";
    text += strain_table(run, table);
    if (run.noise && run.noise->bands.made())
      text += section("Input and speckle") + band_text(*run.noise, table.frequencies);
    text += section("Routes") + path_text(table, show);
  }
  if (received) text += section("Receivers") + receiver_text(receiver_table(run), show);
  text += section("Where the light went") + energy_balance_text(run) + object_table(run) + assumed(run, assumptions) +
          provenance(run) + warnings(run);
  return text;
}

}  // namespace straytrace::results
