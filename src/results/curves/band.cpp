// SPDX-License-Identifier: BSD-3-Clause
// Curves hold averages over bins, placed at the centres and connected by straight lines in log-log. A spectral line
// fills a single bin; next to it, and where a curve is 0, only the average of the bin is known.
#include "results/curves/band.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "results/text/columns.hpp"
#include "spectra/curve.hpp"

namespace straytrace::results {
namespace {

using Values = std::vector<double>;

// Above twice the geometric mean of its neighbours, whatever the slope there.
bool stands_out(Values const& curve, std::size_t i) {
  return i > 0 && i + 1 < curve.size() && curve[i] * curve[i] > 4 * curve[i - 1] * curve[i + 1];
}

// Above twice either neighbour.
bool is_line(Values const& curve, std::size_t i) {
  double const before = i > 0 ? curve[i - 1] : 0, after = i + 1 < curve.size() ? curve[i + 1] : 0;
  return curve.size() > 1 && curve[i] > 2 * std::max(before, after);
}

WithError curve_at(Values const& mean, Values const& sigma, FrequencyGrid const& grid, double hz) {
  auto const [low, x] = between_bins(mean, grid, hz);
  if (low == grid.size()) return {not_a_number, not_a_number};
  if (x == 0) return {mean.at(low), sigma.at(low)};
  double const value = log_log_value(mean[low], mean[low + 1], x);
  double const relative = (1 - x) * sigma.at(low) / mean[low] + x * sigma.at(low + 1) / mean[low + 1];
  return {value, value * std::fabs(relative)};
}

}  // namespace

BetweenBins between_bins(Values const& mean, FrequencyGrid const& grid, double hz) {
  std::size_t const n = grid.size(), own = grid.bin_of(hz);
  std::size_t low = 0;
  while (low + 2 < n && grid.centre(low + 1) <= hz) ++low;
  bool const smooth = own < n && n > 1 && mean.at(low) > 0 && mean.at(low + 1) > 0 && !stands_out(mean, low) &&
                      !stands_out(mean, low + 1);
  if (!smooth) return {own, 0};
  return {low, log_share(hz, grid.centre(low), grid.centre(low + 1))};
}

std::pair<double, double> band_of(FrequencyGrid const& grid, double low, double high) {
  if (grid.size() == 0 || high > low) return {low, high};
  return {grid.edges.front(), grid.edges.back()};
}

bool at_most(double value, double sigma, double bound_share) {
  constexpr double shown = 5e-4;  // less shows in no printed digit
  double const less = value * (1 - std::sqrt(std::max(0.0, 1 - bound_share)));
  return less > std::max(sigma, shown * value);
}

bool at_most(NoiseTrace const& trace, std::size_t bin) {
  double const sigma = trace.resolved ? trace.sigma.at(bin) : 0;  // the error of the observed part hides no bound
  return trace.upper_bound ||
         (bin < trace.bound_share.size() && at_most(trace.asd.at(bin), sigma, trace.bound_share[bin]));
}

std::size_t bound_bins(NoiseBudget const& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < b.grid.size(); ++i) count += at_most(b.total, i);
  return count;
}

WithError strain_at(NoiseTrace const& trace, FrequencyGrid const& grid, double hz) {
  WithError h = curve_at(trace.asd, trace.sigma, grid, hz);
  h.at_most = !std::isnan(h.value) && at_most(trace, grid.bin_of(hz));
  h.incomplete = !trace.resolved;
  return h;
}

BinLine line_at(NoiseTrace const& trace, FrequencyGrid const& grid, double hz) {
  std::size_t const i = grid.bin_of(hz);
  if (i == grid.size() || !is_line(trace.asd, i)) return {};
  double const width = std::sqrt(grid.width(i));
  return {{trace.asd[i] * width, trace.sigma.at(i) * width, at_most(trace, i), !trace.resolved},
          grid.edges[i],
          grid.edges[i + 1]};
}

double band_at(Values const& curve, FrequencyGrid const& grid, double hz) {
  return curve_at(curve, Values(curve.size(), 0.0), grid, hz).value;
}

double design_at(DesignCurve const& curve, FrequencyGrid const& grid, double hz) {
  return band_at(curve.asd, grid, hz);
}

WithError band_power(NoiseTrace const& trace, FrequencyGrid const& grid, double low, double high) {
  WithError power;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.centre(i) < low || grid.centre(i) > high) continue;
    power.value += trace.psd(i) * grid.width(i);
    power.sigma += trace.psd_sigma(i) * grid.width(i);
  }
  return power;
}

// The errors that are not Monte-Carlo errors, in words.

namespace {

// clang-format off

std::vector<TableColumn<SourceRow>> source_columns() {
  using Json = nlohmann::ordered_json;
  std::vector<TableColumn<SourceRow>> all;
  all.push_back({.key = "name", .kind = ColumnKind::text, .help = "material or motion",
    .value = [](SourceRow const& r) { return r.source.name; },
    .text = {10, "input"}, .json = {10}, .page = {10, "input"}, .left = true});
  all.push_back({.key = "status", .kind = ColumnKind::text, .help = "how well it is known",
    .value = [](SourceRow const& r) { return r.status; }, .page = {20}});
  all.push_back({.key = "statement", .kind = ColumnKind::text, .help = "stated bracket or uncertainty",
    .value = [](SourceRow const& r) { return r.source.statement; },
    .text = {20, "stated"}, .json = {20}, .page = {30, "stated"}, .left = true});
  all.push_back({.key = "factor_on_total", .kind = ColumnKind::list, .unit = "1",
    .help = "least and largest factor on h of the total, over the band", .text = {30, "h(total) x"}, .json = {30},
    .as_text = [](SourceRow const& r) {
      return std::isnan(r.source.low) ? "not known" : fmt::format("{:.3g} to {:.3g}", r.source.low, r.source.high); },
    .as_json = [](SourceRow const& r) { return Json{r.source.low, r.source.high}; }});
  all.push_back({.key = "low", .unit = "1", .help = "least factor on h of the total",
    .value = [](SourceRow const& r) { return r.source.low; }, .page = {40, "least factor on h"}});
  all.push_back({.key = "high", .unit = "1", .help = "largest factor on h of the total",
    .value = [](SourceRow const& r) { return r.source.high; }, .page = {50, "largest factor on h"}});
  all.push_back({.key = "share", .unit = "1", .help = "of the noise power on routes that it affects",
    .value = [](SourceRow const& r) { return r.source.share > 0 ? r.source.share : not_a_number; },
    .text = {40, "share of noise/%"}, .json = {40}, .page = {60, "noise power on its routes [%]", 100},
    .as_text = [](SourceRow const& r) {
      return r.source.share > 0 ? fmt::format("{:.3g}", 100 * r.source.share) : "-"; },
    .as_json = [](SourceRow const& r) { return r.source.share > 0 ? Json(r.source.share) : Json(nullptr); }});
  return all;
}

// clang-format on

}  // namespace

TableWriter<SourceRow> const& source_table() {
  static TableWriter<SourceRow> const table(source_columns());
  return table;
}

std::vector<SourceRow> source_rows(NoiseBands const& bands, ProjectionInputs const* traced) {
  std::vector<SourceRow> rows;
  for (InputSource const& s : bands.sources) {
    rows.push_back({s, s.statement.find("assumed") == std::string::npos ? "" : "assumed"});
    if (!traced || !rows.back().status.empty()) continue;
    for (MaterialSpread const& m : traced->materials)
      if (s.name == "material " + m.name) rows.back().status = m.status;
  }
  return rows;
}

namespace {

// h = 0 is never printed: it means that no route makes noise there, or that no route is resolved.
std::string strain_number(NoiseBudget const& b, double h) {
  if (h == 0) return b.unresolved.empty() ? "none" : "not resolved";
  return std::isnan(h) ? "-" : fmt::format("{:.2e}", h);
}

std::string sources(NoiseBands const& bands) {
  Columns c = source_table().text_head();
  for (SourceRow const& row : source_rows(bands)) c.rows.push_back(source_table().text_row(row));
  std::string text = bands.sources.empty() ? "" : aligned(c) + "\n";
  if (!bands.taken_as_exact.empty())
    text += fmt::format("No bracket or uncertainty is stated for: {}. They are taken as exact.\n",
                        fmt::join(bands.taken_as_exact, ", "));
  return text;
}

constexpr char const* composition_note =
    " (routes without a name carry too much of the noise, and it is not known on which materials their light scatters)";

std::string ranges(NoiseBudget const& b, std::vector<double> const& frequencies, std::vector<double> const& low,
                   std::vector<double> const& high) {
  std::string text;
  for (double const hz : frequencies) {
    double const from = band_at(low, b.grid, hz), to = band_at(high, b.grid, hz);
    text += text.empty() ? "" : ", ";
    bool const unknown = std::isnan(from) && std::isfinite(strain_at(b.total, b.grid, hz).value);
    text += unknown                ? "not known"
            : from == 0 && to == 0 ? strain_number(b, 0)
            : from == 0            ? fmt::format("up to {}", strain_number(b, to))
                                   : fmt::format("{} to {}", strain_number(b, from), strain_number(b, to));
  }
  return text;
}

}  // namespace

std::string lines_text(PathTable const& table) {
  std::string text;
  for (std::size_t i = 0; i < table.lines.size(); ++i)
    if (BinLine const& line = table.lines[i]; !std::isnan(line.rms.value))
      text += fmt::format(
          "{:g} Hz lies in a bin with a line, {:.4g} to {:.4g} Hz: {} rms, of which h is the mean density.\n",
          table.frequencies[i], line.low, line.high, with_error(line.rms));
  return text;
}

namespace {

// Lowest, mean and highest h over the positions of a body.
std::string position_text(NoiseBudget const& b, std::vector<double> const& frequencies) {
  if (b.positions.empty()) return "";
  PositionBand const band = position_band(b);
  Columns c;
  c.titles = {"frequency/Hz", "lowest h", "mean", "highest"};
  for (double const hz : frequencies) {
    std::vector<std::string> row{fmt::format("{:g}", hz)};
    for (auto const* curve : {&band.low, &b.total.asd, &band.high})
      row.push_back(strain_number(b, band_at(*curve, b.grid, hz)));
    c.rows.push_back(std::move(row));
  }
  return fmt::format("{} positions of '{}' over a quarter of the wavelength; mean: of the PSDs (eq. 1.13)\n{}",
                     b.positions.size(), b.scanned_body, aligned(c));
}

}  // namespace

std::string band_summary(NoiseBudget const& b, std::vector<double> const& frequencies) {
  if (!b.bands.made()) return position_text(b, frequencies);
  NoiseBands const& d = b.bands;
  bool const answer = std::any_of(b.total.asd.begin(), b.total.asd.end(), [](double h) { return h > 0; });
  if (!answer && !b.unresolved.empty())
    return "one realisation and input uncertainty: unknown, no route that causes noise is resolved\n";
  bool const bound = std::any_of(frequencies.begin(), frequencies.end(),
                                 [&](double hz) { return strain_at(b.total, b.grid, hz).at_most; });
  std::string text = position_text(b, frequencies);
  text += fmt::format("one realisation (5 to 95 %){} at {:g} Hz: {}\n",
                      !bound                 ? ""
                      : b.unresolved.empty() ? " of the upper bound"
                                             : " of the total, which is no bound,",
                      fmt::join(frequencies, ", "), ranges(b, frequencies, d.speckle_05, d.speckle_95));
  if (d.sources.empty())
    return text + fmt::format("inputs{} are taken as exact: no bracket or uncertainty is stated{}\n",
                              b.unresolved.empty() ? "" : " of the resolved routes",
                              b.unresolved.empty() ? "" : " for them");
  bool const unknown = std::any_of(frequencies.begin(), frequencies.end(), [&](double hz) {
    return std::isnan(band_at(d.input_low, b.grid, hz)) && std::isfinite(strain_at(b.total, b.grid, hz).value);
  });
  return text + fmt::format("input uncertainty{}: {}{}\n", b.unresolved.empty() ? "" : " of the light observed so far",
                            ranges(b, frequencies, d.input_low, d.input_high), unknown ? composition_note : "");
}

std::string band_text(NoiseBudget const& b, std::vector<double> const& frequencies) {
  if (!b.bands.made()) return "";
  Columns c;
  c.titles = {"frequency/Hz", "input low", "high", "speckle 5 %", "50 %", "95 %", "routes in power", "all in phase"};
  for (double const hz : frequencies) {
    std::vector<std::string> row{fmt::format("{:g}", hz)};
    for (auto const* curve : {&b.bands.input_low, &b.bands.input_high, &b.bands.speckle_05, &b.bands.speckle_50,
                              &b.bands.speckle_95, &b.total.asd, &b.bands.coherent})
      row.push_back(strain_number(b, band_at(*curve, b.grid, hz)));
    c.rows.push_back(std::move(row));
  }
  std::string text = aligned(c);
  text +=
      "\ninput: brackets of all materials at their low ends, at their high ends; independent standard deviations\n"
      "combine in quadrature. speckle: one realisation of the unknown static phases, once they are what they are;\n"
      "where fringes wrap the spread is an upper bound. Routes are added in power; 'all in phase' is the linear sum "
      "of\n"
      "their ASDs, the worst way in which the mean strengths of routes can add, and not a forecast.\n\n";
  return text + sources(b.bands);
}

std::string error_table(NoiseBudget const& b, std::vector<double> const& frequencies) {
  NoiseTrace const& t = b.total;
  if (t.paths_sigma.empty()) return {};
  Columns c;
  c.titles = {"error of h/%", "all", "power of the routes", "phase sensitivities", "kept paths"};
  std::size_t bin = 0;
  for (double const f : frequencies) {
    while (bin < b.grid.size() && b.grid.edges[bin + 1] <= f) ++bin;
    if (bin == b.grid.size() || f < b.grid.edges.front() || !(t.asd[bin] > 0)) continue;
    std::vector<std::string> row = {fmt::format("{:g} Hz", f)};
    for (auto const part : {&NoiseTrace::sigma, &NoiseTrace::power_sigma, &NoiseTrace::phase_sensitivities_sigma,
                            &NoiseTrace::paths_sigma}) {
      double const share = 100 * (t.*part)[bin] / t.asd[bin];
      row.push_back(std::isnan(share) ? "-" : share < 1e-3 ? "< 0.001" : fmt::format("{:.2g}", share));
    }
    c.rows.push_back(std::move(row));
  }
  if (c.rows.empty()) return {};
  std::size_t const most = records_kept(~std::uint64_t{0} / 2);  // by a route
  std::uint64_t blocks = 1;
  while (records_kept(blocks) < most) blocks *= 2;
  return "\n" + aligned(c) +
         fmt::format(
             "\nWhat the error would be if only one of them were uncertain. All fall as the root of the number "
             "of histories, that of the kept paths\nup to {} blocks, from which each route keeps {} paths.\n",
             blocks, most);
}

}  // namespace straytrace::results
