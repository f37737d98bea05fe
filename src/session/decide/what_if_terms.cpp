// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

#include "io/markup.hpp"
#include "noise/bands/elasticity.hpp"
#include "noise/bands/inversion.hpp"
#include "report/html/page_json.hpp"
#include "results/curves/band.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/columns.hpp"
#include "session/decide/what_if.hpp"
#include "world/model/material.hpp"

namespace straytrace::session {
namespace {

using Exponents = std::vector<int>;

constexpr std::size_t most_terms = 128, most_bodies = 3, most_tried = 12;
constexpr int steps = 2;            // of the motion, to either side
constexpr double range = 4;         // of it, up and down
constexpr double minor = 1e-3;      // share of the noise; relative change of h that a slider must be able to make
constexpr double quadratic = 2e-3;  // of h: where no fringes wrap, the PSD follows the square of the motion to this

double sum_of(std::vector<Spectrum> const& terms, std::size_t bin) {
  double sum = 0;
  for (Spectrum const& psd : terms) sum += psd[bin];
  return sum;
}

bool in_band(FrequencyGrid const& grid, std::size_t bin, PathTable const& table) {
  return table.high <= table.low || (grid.centre(bin) >= table.low && grid.centre(bin) <= table.high);
}
// PSD in the bins of the frequencies, then its sum over the band of the table.
std::vector<double> places(NoiseTrace const& t, FrequencyGrid const& grid, PathTable const& table) {
  std::vector<double> out;
  auto const finite = [](double psd) { return psd > 0 ? psd : 0; };
  for (double const hz : table.frequencies)
    out.push_back(grid.bin_of(hz) < grid.size() ? finite(t.psd(grid.bin_of(hz))) : 0);
  double band = 0;
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (in_band(grid, i, table)) band += finite(t.psd(i)) * grid.width(i);
  out.push_back(band);
  return out;
}

// The coupling table with every row `other` split by the exponents of its routes.
class Split {
 public:
  Split(CouplingTable const& light, std::vector<MaterialSpread> const& materials) : table_(light) {
    auto const exponents_of = [&](std::vector<PathStep> const& steps) {
      Exponents all;
      for (MaterialSpread const& m : materials) all.push_back(scatters_on(m, steps));
      return all;
    };
    std::map<Exponents, bool> found;
    unknown_ = scaled_couplings(light, [&](std::vector<PathStep> const& steps) {
                 found.emplace(exponents_of(steps), true);
                 return 1.0;
               }).unknown;
    for (auto const& [exponents, ignored] : found) exponents_.push_back(exponents);
    if (exponents_.size() > most_terms) return;
    table_.classes.clear();
    for (std::size_t v = 0; v < exponents_.size(); ++v) {
      ScaledCouplings part = scaled_couplings(
          light, [&](std::vector<PathStep> const& steps) { return exponents_of(steps) == exponents_[v] ? 1.0 : 0.0; });
      for (CouplingClass& c : part.table.classes) {
        table_.classes.push_back(std::move(c));
        term_.push_back(v);
      }
    }
  }
  bool too_many() const { return exponents_.size() > most_terms; }
  CouplingTable const& table() const { return table_; }
  std::vector<Exponents> const& exponents() const { return exponents_; }
  std::size_t term_of(std::size_t part) const { return term_[part]; }
  std::size_t parts() const { return term_.size(); }
  // Of each class before it was split: share of its light whose scatters are not counted.
  std::vector<double> const& unknown() const { return unknown_; }

 private:
  CouplingTable table_;
  std::vector<Exponents> exponents_;
  std::vector<std::size_t> term_;  // by class of the table
  std::vector<double> unknown_;
};

// Ratios of PSDs with the motion of a body scaled, from the main parts of the light.
class Motions {
 public:
  Motions(Model const& model, Split const& split, std::vector<std::size_t> const& parts)
      : model_(model), of_term_(split.exponents().size(), 0) {
    table_ = split.table();
    table_.classes.clear();
    for (std::size_t const p : parts) {
      table_.classes.push_back(split.table().classes[p]);
      std::size_t& place = of_term_[split.term_of(p)];
      if (place == 0) place = ++groups_;  // 0: that of all parts together
      group_.push_back(place);
    }
    traced_ = psd(model.motion);
  }

  // [group][bin], relative PSDs while the body rests, and the largest relative change of h that this makes.
  std::vector<Spectrum> at_rest(BodyId body) const { return ratios(body, 0); }
  double change(std::vector<Spectrum> const& ratios) const { return most(ratios[0], Spectrum(bins(), 1)); }

  WhatIfTerms::Moved of(BodyId body, std::vector<Spectrum> const& still) const {
    WhatIfTerms::Moved moved{model_.motion.bodies[body.value], {}, of_term_, {}};
    std::vector<Spectrum> const least = ratios(body, 1 / range), largest = ratios(body, range);
    if (is_quadratic(still[0], least[0], 1 / range) && is_quadratic(still[0], largest[0], range)) {
      keep(moved, still);
      return moved;
    }
    for (int k = -steps; k <= steps; ++k) {  // fringes wrap
      moved.factors.push_back(std::pow(range, double(k) / steps));
      keep(moved, k == 0        ? std::vector<Spectrum>(groups_ + 1, Spectrum(bins(), 1))
                  : k == -steps ? least
                  : k == steps  ? largest
                                : ratios(body, moved.factors.back()));
    }
    return moved;
  }

 private:
  std::size_t bins() const { return model_.noise.grid.size(); }

  // [group][bin]; group 0: all.
  std::vector<Spectrum> psd(MotionSet const& motion) const {
    NoiseBudget const b = project_noise(table_, motion, *model_.detector, model_.noise);
    std::vector<Spectrum> out(groups_ + 1, Spectrum(bins(), 0));
    for (std::size_t p = 0; p < group_.size(); ++p)
      for (std::size_t i = 0; i < bins(); ++i)
        if (double const own = b.routes[p].psd(i); own > 0) {
          out[0][i] += own;
          out[group_[p]][i] += own;
        }
    return out;
  }
  std::vector<Spectrum> ratios(BodyId body, double factor) const {
    std::vector<Spectrum> out = psd(with_scaled_body(model_.motion, body, factor));
    for (std::size_t g = 0; g < out.size(); ++g)
      for (std::size_t i = 0; i < bins(); ++i) out[g][i] = traced_[g][i] > 0 ? out[g][i] / traced_[g][i] : 1;
    return out;
  }
  static void keep(WhatIfTerms::Moved& moved, std::vector<Spectrum> const& ratios) {
    moved.ratio.resize(ratios.size());
    for (std::size_t g = 0; g < ratios.size(); ++g) moved.ratio[g].push_back(ratios[g]);
  }
  static double most(Spectrum const& a, Spectrum const& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (b[i] > 0) largest = std::max(largest, std::fabs(std::sqrt(a[i] / b[i]) - 1));
    return largest;
  }
  static bool is_quadratic(Spectrum const& rest, Spectrum const& found, double factor) {
    Spectrum made;
    for (double const r : rest) made.push_back(r + factor * factor * (1 - r));
    return most(made, found) <= quadratic;
  }

  Model const& model_;
  CouplingTable table_;
  std::vector<std::size_t> of_term_, group_;  // group_: by class of the table
  std::size_t groups_ = 0;
  std::vector<Spectrum> traced_;
};

class TermMaker {
 public:
  TermMaker(Model const& model, CouplingTable const& light, NoiseBudget const& budget, PathTable const& table)
      : model_(model), budget_(budget), paths_(table), split_(light, model.traced.materials) {}

  WhatIfTerms made(std::size_t rows) {
    if (std::ranges::none_of(budget_.total.asd, [](double h) { return h > 0; }))
      return without("No sliders: the run has no noise in its band, or none that is resolved.");
    if (split_.too_many())
      return without(
          "No sliders: the routes scatter in too many ways for a page. straytrace noise RUN.h5 --set tells the same.");
    NoiseBudget const all = projected(model_.motion);
    out_.psd = by_term(all);
    if (!adds_up())
      return without(
          "No sliders: fields of several rows add coherently here. straytrace noise RUN.h5 --set tells the same.");
    out_.exponents = split_.exponents();
    out_.frequencies = paths_.frequencies;
    add_rows(all, rows);
    add_deviations(all);
    add_bodies(all);
    keep_materials();
    if (out_.materials.empty() && out_.moved.empty())
      return without("No sliders: no light that a material scatters, and no body whose motion changes h by 0.1 %.");
    find_unnamed();
    return std::move(out_);
  }

 private:
  static WhatIfTerms without(std::string reason) {
    WhatIfTerms none;
    none.none = std::move(reason);
    return none;
  }
  void find_unnamed() {
    for (std::size_t i = 0; i < bins(); ++i) {
      double sum = 0;
      for (std::size_t r = 0; r < budget_.routes.size() && r < split_.unknown().size(); ++r)
        if (double const psd = budget_.routes[r].psd(i); psd > 0) sum += split_.unknown()[r] * psd;
      out_.unnamed = std::max(out_.unnamed, sum / budget_.total.psd(i));
    }
  }
  NoiseBudget projected(MotionSet const& motion) const {
    return project_noise(split_.table(), motion, *model_.detector, model_.noise);
  }
  std::size_t bins() const { return budget_.grid.size(); }

  std::vector<Spectrum> by_term(NoiseBudget const& b) const {
    std::vector<Spectrum> out(split_.exponents().size(), Spectrum(bins(), 0));
    for (std::size_t p = 0; p < split_.parts(); ++p)
      for (std::size_t i = 0; i < bins(); ++i)
        if (double const psd = b.routes[p].psd(i); psd > 0) out[split_.term_of(p)][i] += psd;
    return out;
  }
  // Fields that add coherently over rows do not split into terms. Else their sum is that of the run up to the error of
  // drawn paths, and is made equal to it.
  bool adds_up() {
    for (std::size_t i = 0; i < bins(); ++i) {
      double const sum = sum_of(out_.psd, i), total = budget_.total.psd(i);
      if (!(std::fabs(sum - total) <= minor * total)) return false;
      for (Spectrum& own : out_.psd) own[i] *= sum > 0 ? total / sum : 1;
    }
    return true;
  }

  std::vector<std::vector<double>> places_of(NoiseBudget const& b, std::vector<std::size_t> const& parts) const {
    std::vector<std::vector<double>> out;
    for (std::size_t const p : parts) out.push_back(places(b.routes[p], budget_.grid, paths_));
    return out;
  }
  void add_rows(NoiseBudget const& all, std::size_t most) {
    for (PathRow const& row : paths_.rows) {
      if (out_.rows.size() == most) break;
      WhatIfTerms::Row r{row.hash, row.sequence + (row.resolved ? "" : " (unresolved)"), {}, {}};
      std::vector<std::size_t> parts;
      for (std::size_t p = 0; p < split_.parts(); ++p)
        if (split_.table().classes[p].hash == row.hash) parts.push_back(p);
      if (parts.empty()) continue;
      for (std::size_t const p : parts) r.terms.push_back(split_.term_of(p));
      r.psd = places_of(all, parts);
      parts_.push_back(std::move(parts));
      out_.rows.push_back(std::move(r));
    }
  }

  // Relative deviations of a term in the replicas: those of its routes by their share of it, averaged over the bins.
  void add_deviations(NoiseBudget const& all) {
    std::size_t const terms = out_.psd.size();
    out_.deviations.assign(terms, {});
    std::vector<double> weight(terms, 0);
    for (std::size_t p = 0; p < split_.parts(); ++p) {
      CouplingClass const& c = split_.table().classes[p];
      double share = 0;
      for (std::size_t i = 0; i < bins(); ++i)
        if (double const psd = all.routes[p].psd(i); psd > 0) share += psd / budget_.total.psd(i);
      weight[split_.term_of(p)] += share;
      if (!(c.coupling.mean > 0)) continue;
      ReplicaPattern const pattern = pattern_of(split_.table(), c);
      for (std::size_t r = 0; r < replica_count; ++r)
        out_.deviations[split_.term_of(p)][r] += share * pattern[r] * c.coupling.std_error / c.coupling.mean;
    }
    for (std::size_t v = 0; v < terms; ++v)
      for (double& d : out_.deviations[v]) d = weight[v] > 0 ? d / weight[v] : 0;
    for (std::size_t i = 0; i < bins(); ++i) {
      double square = 0;
      for (std::size_t r = 0; r < replica_count; ++r) {
        double d = 0;
        for (std::size_t v = 0; v < terms; ++v) d += out_.psd[v][i] * out_.deviations[v][r];
        square += d * d;
      }
      double const relative = 0.5 * std::sqrt(square) / budget_.total.psd(i),
                   stated = budget_.total.sigma[i] / budget_.total.asd[i];
      bool const by_replicas = relative > 1e-3 * stated;  // else the error of the run stays, as a share of h
      out_.error_factor.push_back(by_replicas ? stated / relative : 0);
      out_.error_kept.push_back(by_replicas || !(stated > 0) ? 0 : stated);
    }
  }

  // The fewest parts that leave less than `minor` of the noise at any frequency.
  std::vector<std::size_t> main_parts(NoiseBudget const& all) const {
    std::vector<std::size_t> order(split_.parts());
    std::iota(order.begin(), order.end(), 0);
    auto const most = [&](std::size_t p) {
      double share = 0;
      for (std::size_t i = 0; i < bins(); ++i)
        if (double const psd = all.routes[p].psd(i); psd > 0) share = std::max(share, psd / budget_.total.psd(i));
      return share;
    };
    std::vector<double> shares;
    for (std::size_t const p : order) shares.push_back(most(p));
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return shares[a] > shares[b]; });
    double rest = 0;
    for (double const share : shares) rest += share;
    std::size_t kept = 0;
    while (kept < order.size() && rest > minor) rest -= shares[order[kept++]];
    order.resize(kept);
    std::ranges::sort(order);
    return order;
  }

  void add_bodies(NoiseBudget const& all) {
    Motions const motions(model_, split_, main_parts(all));
    struct Effect {
      BodyId body;
      double change;
      std::vector<Spectrum> still;
    };
    std::vector<Effect> effects;
    std::vector<BodyId> lit;
    for (std::uint32_t b = 0; b < model_.motion.bodies.size(); ++b)
      if (b >= model_.traced.meets_light.size() || model_.traced.meets_light[b]) lit.push_back(BodyId{b});
    if (lit.size() > most_tried) {
      out_.left_out.push_back(fmt::format("motion: {} bodies are too many for a page", lit.size()));
      return;
    }
    for (BodyId const body : lit) {
      std::vector<Spectrum> still = motions.at_rest(body);
      if (double const change = motions.change(still); change > minor)
        effects.push_back({body, change, std::move(still)});
    }
    std::stable_sort(effects.begin(), effects.end(), [](auto const& a, auto const& b) { return a.change > b.change; });
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (i < most_bodies)
        out_.moved.push_back(motions.of(effects[i].body, effects[i].still));
      else
        out_.left_out.push_back(fmt::format("the motion of {}: others have more effect", name_of(effects[i].body)));
    }
  }
  std::string const& name_of(BodyId body) const { return model_.motion.bodies[body.value]; }

  // Materials that light of a term scatters on.
  void keep_materials() {
    std::vector<std::size_t> kept;
    for (std::size_t m = 0; m < model_.traced.materials.size(); ++m) {
      MaterialSpread const& material = model_.traced.materials[m];
      if (std::ranges::none_of(out_.exponents, [&](Exponents const& e) { return e[m] != 0; })) continue;
      if (material.of_reflection)
        out_.left_out.push_back(fmt::format("{}: its reflectance decides where light goes", material.name));
      else
        kept.push_back(m);
    }
    for (std::size_t const m : kept)
      out_.materials.push_back(
          {model_.traced.materials[m].name, largest_factor(model_.world, model_.traced.materials[m].name).factor});
    for (Exponents& e : out_.exponents) {
      Exponents own;
      for (std::size_t const m : kept) own.push_back(e[m]);
      e = std::move(own);
    }
  }

  Model const& model_;
  NoiseBudget const& budget_;
  PathTable const& paths_;
  Split const split_;
  WhatIfTerms out_;
  std::vector<std::vector<std::size_t>> parts_;  // by row
};

}  // namespace

WhatIfTerms what_if_terms(Model const& model, CouplingTable const& light, NoiseBudget const& budget,
                          PathTable const& table, std::size_t rows) {
  return TermMaker(model, light, budget, table).made(rows);
}

namespace {

std::string floats(std::vector<float> const& all) { return base64(all.data(), all.size() * sizeof(float)); }

// [term][bin], over the PSD of the total.
std::string shares_text(std::vector<Spectrum> const& psd, NoiseTrace const& total) {
  std::vector<float> all;
  for (Spectrum const& own : psd)
    for (std::size_t i = 0; i < own.size(); ++i) all.push_back(total.psd(i) > 0 ? float(own[i] / total.psd(i)) : 0.0f);
  return floats(all);
}

// [part][place], each over the total in its place.
PageJson over(std::vector<double> const& psd, std::vector<double> const& total) {
  std::vector<double> all;
  for (std::size_t k = 0; k < psd.size(); ++k) {
    double const whole = total[k % total.size()];
    all.push_back(whole > 0 ? psd[k] / whole : 0);
  }
  return report::numbers(all);
}

// [ratio][factor][bin]: the logarithm in thousandths, as 16-bit numbers; at rest, where there are no factors, the
// ratio.
PageJson moved_json(WhatIfTerms::Moved const& m) {
  PageJson j{{"name", m.name}, {"factors", m.factors}, {"of_term", m.of_term}};
  std::vector<float> rest;
  std::vector<std::int16_t> logarithms;
  for (auto const& of_group : m.ratio)
    for (Spectrum const& own : of_group)
      for (double const ratio : own) {
        rest.push_back(float(ratio));
        logarithms.push_back(std::int16_t(std::clamp(std::round(1000 * std::log(ratio)), -32767.0, 32767.0)));
      }
  if (m.factors.empty())
    j["rest"] = floats(rest);
  else
    j["logarithms"] = base64(logarithms.data(), logarithms.size() * sizeof(std::int16_t));
  return j;
}

}  // namespace

nlohmann::json what_if_json(WhatIfTerms const& t, NoiseBudget const& budget, PathTable const& table) {
  if (!t.none.empty()) return {{"none", t.none}};
  std::vector<double> const whole = places(budget.total, budget.grid, table);
  PageJson j{{"exponents", t.exponents},
             {"shares", shares_text(t.psd, budget.total)},
             {"left_out", t.left_out},
             {"error_factor", report::numbers(t.error_factor)}};
  j["error_kept"] = report::numbers(t.error_kept);
  j["unnamed"] = report::number(t.unnamed);
  j["materials"] = PageJson::array();
  for (auto const& m : t.materials) j["materials"].push_back({{"name", m.name}, {"most", report::number(m.most)}});
  std::vector<float> deviations;
  for (auto const& own : t.deviations) deviations.insert(deviations.end(), own.begin(), own.end());
  j["deviations"] = floats(deviations);
  j["moved"] = PageJson::array();
  for (auto const& m : t.moved) j["moved"].push_back(moved_json(m));
  j["rows"] = PageJson::array();
  for (auto const& row : t.rows) {
    std::vector<double> psd;
    for (auto const& part : row.psd) psd.insert(psd.end(), part.begin(), part.end());
    j["rows"].push_back(
        {{"id", hash_text(row.hash)}, {"name", row.name}, {"terms", row.terms}, {"shares", over(psd, whole)}});
  }
  j["frequencies"] = t.frequencies;
  j["bins"] = PageJson::array();
  for (double const hz : t.frequencies) {
    auto const [bin, next] = between_bins(budget.total.asd, budget.grid, hz);
    j["bins"].push_back(bin < budget.grid.size() ? PageJson{{"bin", bin}, {"next", next}} : PageJson(nullptr));
  }
  std::vector<double> band;
  for (std::size_t i = 0; i < budget.grid.size(); ++i)
    band.push_back(in_band(budget.grid, i, table) ? budget.total.psd(i) * budget.grid.width(i) / whole.back() : 0);
  j["band"] = report::numbers(band);
  return j;
}

LargestFactor largest_factor(World const& world, std::string const& material) {
  WorldView const view = world.view();
  LargestFactor least;
  for (MaterialInfo const& info : world.materials)
    for (double degrees = 0; info.name == material && degrees < 90; degrees += 5) {
      MaterialShares const now = shares_at(view, view.optics[info.optic], degrees);
      double const others = now.reflect + now.transmit, most = (1 - others) / now.scattered;
      if (most < least.factor) least = {most, degrees, now.scattered, others};
    }
  return least;
}

}  // namespace straytrace::session
