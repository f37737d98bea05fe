// SPDX-License-Identifier: BSD-3-Clause
// What a run says about itself: where it comes from, where the light went, how well it has converged.
#include <algorithm>
#include <cmath>
#include <map>

#include "page/page_json.hpp"
#include "report/csv.hpp"
#include "report/merit.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

PageJson with_error(Estimate const& e) { return {{"value", number(e.mean)}, {"sigma", number(e.std_error)}}; }

constexpr int least_replicas = 4;  // for a spread

// Relative standard error of the mean of the first replicas, for growing numbers of them: {histories, error}.
struct Convergence {
  std::vector<double> histories, error;
};

Convergence converging(std::array<double, replica_count> const& sums, CouplingTable const& table) {
  Convergence c;
  double sum = 0, n = 0;
  for (int r = 1; r <= replica_count; ++r) {
    sum += sums[std::size_t(r - 1)];
    n += double(table.replica_histories[std::size_t(r - 1)]);
    if (r < least_replicas || !(sum > 0) || !(n > 0)) continue;
    double square = 0;  // of the deviations of the sums of replicas from their expectation
    for (int i = 0; i < r; ++i) {
      double const off = sums[std::size_t(i)] - sum / n * double(table.replica_histories[std::size_t(i)]);
      square += off * off;
    }
    c.histories.push_back(n);
    c.error.push_back(std::sqrt(square * r / (r - 1)) / sum);
  }
  return c;
}

PageJson curve(std::string const& name, Convergence const& c) {
  return {{"name", name}, {"histories", numbers(c.histories)}, {"error", numbers(c.error)}};
}

PageJson objects_json(BlockSums const& total, std::vector<std::string> const& groups) {
  PageJson all = PageJson::array();
  for (std::size_t i = 0; i < std::max(groups.size(), total.absorbed.size()); ++i) {
    PageJson row = {{"name", i < groups.size() ? groups[i] : "(in media)"}};
    if (i < total.arrived.size())
      row["arriving"] = with_error(estimate(total.arrived[i], total.histories, total.blocks));
    if (i < total.absorbed.size())
      row["absorbed"] = with_error(estimate(total.absorbed[i], total.histories, total.blocks));
    all.push_back(row);
  }
  return all;
}

PageJson map_json(std::string const& name, std::string const& what, Receiver const& r, CellEstimates const& cells,
                  double watts, std::string const& unit) {
  std::vector<double> mean = cells.mean, error = cells.error;
  for (auto* list : {&mean, &error})
    for (std::size_t i = 0; i < list->size(); ++i) (*list)[i] *= watts / r.area(i);
  PageJson map = {
      {"name", name}, {"what", what}, {"unit", unit}, {"values", numbers(mean)}, {"errors", numbers(error)}};
  if (r.by_light) {
    std::vector<double> sides;
    MapCell whole{infinity, -infinity, infinity, -infinity};
    for (std::size_t i = 0; i < r.cells.size; ++i) {
      MapCell const& c = r.cells[i];
      sides.insert(sides.end(), {c.u_low, c.u_high, c.v_low, c.v_high});
      whole = {std::fmin(whole.u_low, c.u_low), std::fmax(whole.u_high, c.u_high), std::fmin(whole.v_low, c.v_low),
               std::fmax(whole.v_high, c.v_high)};
    }
    map["chart"] = chart_names[std::size_t(r.chart)];
    map["whole"] = {whole.u_low, whole.u_high, whole.v_low, whole.v_high};
    map["cells"] = sides;
  } else {
    map["columns"] = r.columns;
    map["rows"] = r.rows;
    map["x"] = {-r.half_width, r.half_width};
    map["y"] = {-r.half_height, r.half_height};
  }
  return map;
}

}  // namespace

PageJson provenance_json(RunContent const& run) {
  Provenance const& p = run.provenance;
  PageJson files = PageJson::array();
  for (auto const& [name, text] : run.files)
    files.push_back({{"name", name}, {"bytes", text.size()}, {"sha256", sha256(text)}});
  return {{"program", p.program},
          {"version", p.version},
          {"commit", p.commit},
          {"created", p.created},
          {"build", p.build_flags},
          {"model", run.model_hash},
          {"seed", run.trace->coupling.seed},
          {"histories", run.trace->coupling.histories},
          {"stop_rule", run.trace->stop_rule},
          {"complete", !run.trace->checkpointed()},
          {"seconds", number(run.trace->seconds)},
          {"interferometer", run.interferometer},
          {"replaced_by", run.motion_file},
          {"parameters", run.overrides},
          {"beam_power", number(run.beam_power > 0 ? run.beam_power : not_a_number)},
          {"reverse_routes", run.trace->coupling.reverse_routes},
          {"files", files}};
}

PageJson ledger_json(RunContent const& run) {
  BlockSums const& total = run.trace->total;
  PageJson fates = PageJson::array();
  for (int i = 0; i < fate_count; ++i)
    fates.push_back({{"name", name_of(Fate(i))},
                     {"power", with_error(estimate(total.ledger[std::size_t(i)], total.histories, total.blocks))}});
  return {{"emitted", with_error(estimate(total.emitted, total.histories, total.blocks))},
          {"fates", fates},
          {"closure", books_text(run)},
          {"objects", objects_json(total, run.trace->coupling.groups)}};
}

PageJson convergence_json(RunContent const& run, PathTable const& table) {
  CouplingTable const& coupling = run.trace->coupling;
  std::map<std::uint64_t, CouplingClass const*> by_hash;
  for (CouplingClass const& c : coupling.classes) by_hash[c.hash] = &c;
  std::array<double, replica_count> noise = {};
  PageJson curves = PageJson::array(), merit = PageJson::array();
  constexpr std::size_t shown = 6;
  for (PathRow const& row : table.rows) {
    CouplingClass const& c = *by_hash.at(row.hash);
    if (!row.resolved || c.deterministic()) continue;
    if (curves.size() < shown) curves.push_back(curve(row.sequence, converging(c.replica_sum, coupling)));
    if (!(row.share.value > 0) || !(c.coupling.mean > 0)) continue;
    for (std::size_t r = 0; r < noise.size(); ++r) noise[r] += row.share.value * c.replica_sum[r] / c.coupling.mean;
  }
  Convergence total = converging(noise, coupling);
  for (double& e : total.error) e /= 2;  // of the ASD: half of that of its square
  for (Merit const& m : merits(run)) {
    if (merit.size() >= 2 * shown) break;
    if (std::isfinite(m.value)) merit.push_back({{"name", m.what}, {"value", number(m.value)}});
  }
  return {{"total", curve("h in the band, total", total)}, {"routes", curves}, {"merit", merit}};
}

PageJson inputs_json(RunContent const& run) {
  PageJson sources = PageJson::array();
  if (!run.noise) return {{"sources", sources}, {"exact", PageJson::array()}};
  for (InputSource const& s : run.noise->bands.sources)
    sources.push_back({{"name", s.name},
                       {"statement", s.statement},
                       {"low", number(s.low)},
                       {"high", number(s.high)},
                       {"share", s.share > 0 ? number(100 * s.share) : PageJson()}});
  return {{"sources", sources}, {"exact", run.noise->bands.taken_as_exact}};
}

PageJson receivers_json(RunContent const& run) {
  PageJson all = PageJson::array(), maps = PageJson::array();
  if (run.receivers.empty()) return {{"list", all}, {"maps", maps}};
  ReceiverTable const table = receiver_table(run);
  BlockSums const& total = run.trace->total;
  double const watts = run.beam_power > 0 ? run.beam_power : 1;
  std::string const unit = run.beam_power > 0 ? "W" : "W per W of the main mode";
  for (std::size_t i = 0; i < table.receivers.size(); ++i) {
    ReceiverEntry const& e = table.receivers[i];
    PageJson routes = PageJson::array();
    for (ReceivedRoute const& r : e.routes) {
      if (routes.size() >= 50) break;
      routes.push_back({{"rank", r.rank},
                        {"route", r.sequence},
                        {"power", r.power.trusted ? number(watts * r.power.mean) : PageJson()},
                        {"sigma", r.power.trusted ? number(watts * r.power.std_error) : PageJson()},
                        {"share", number(100 * r.share.value)},
                        {"share_sigma", number(100 * r.share.sigma)},
                        {"why", r.power.why_not},
                        {"id", hash_text(r.hash)}});
    }
    all.push_back({{"name", e.name},
                   {"power", e.power.trusted ? number(watts * e.power.mean) : PageJson()},
                   {"sigma", e.power.trusted ? number(watts * e.power.std_error) : PageJson()},
                   {"why", e.power.why_not},
                   {"unit", unit},
                   {"routes", routes}});
    Receiver const& r = run.receivers[i];
    if (r.map_size() == 0) continue;
    maps.push_back(map_json(e.name, "irradiance", r,
                            cell_estimates(total.receivers[i].image, total.histories, total.blocks), watts,
                            unit == "W" ? "W/m²" : "1/m² (per W of the main mode)"));
  }
  return {{"list", all}, {"maps", maps}};
}

}  // namespace straytrace
