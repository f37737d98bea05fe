// SPDX-License-Identifier: BSD-3-Clause
// /noise: strain noise curves on their frequency bins.
#include "base/errors.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
namespace {

using Doubles = std::vector<double>;
constexpr char const* strain = "1/sqrt(Hz)";

struct TraceColumn {
  char const* name;
  Doubles NoiseTrace::*member;
};
constexpr TraceColumn curves[] = {{"mean", &NoiseTrace::asd},
                                  {"sigma", &NoiseTrace::sigma},
                                  {"phase", &NoiseTrace::phase_asd},
                                  {"amplitude", &NoiseTrace::amplitude_asd}};
// Of the total, since schema 1.8.
constexpr TraceColumn error_columns[] = {{"power_sigma", &NoiseTrace::power_sigma},
                                         {"phase_sensitivities_sigma", &NoiseTrace::phase_sensitivities_sigma},
                                         {"paths_sigma", &NoiseTrace::paths_sigma}};
constexpr char const* linear_share = "linear_share";  // since schema 1.5
// Of routes, since schema 1.6; NaN where they were not made.
constexpr TraceColumn route_bands[] = {{"input_low", &NoiseTrace::input_low}, {"input_high", &NoiseTrace::input_high}};

struct BandColumn {
  char const* name;
  Doubles NoiseBands::*member;
};
constexpr BandColumn band_columns[] = {{"input_low", &NoiseBands::input_low},   {"input_high", &NoiseBands::input_high},
                                       {"speckle_05", &NoiseBands::speckle_05}, {"speckle_50", &NoiseBands::speckle_50},
                                       {"speckle_95", &NoiseBands::speckle_95}, {"coherent", &NoiseBands::coherent}};

void append_bins(Doubles& to, Doubles const& from, std::size_t bins, std::string const& name) {
  if (from.size() != bins) throw NumericalError("noise curve '" + name + "' has the wrong number of frequencies");
  to.insert(to.end(), from.begin(), from.end());
}

Doubles or_unknown(Doubles const& curve, std::size_t bins) {
  return curve.empty() ? Doubles(bins, not_a_number) : curve;
}

template <class Column>
void route_columns_of_noise(Column const& column) {
  column(
      "name", "", [](auto& t) -> auto& { return t.name; });
  column(
      "hash", "1", [](auto& t) -> auto& { return t.hash; });
  column(
      "mean_square_phase", "rad^2", [](auto& t) -> auto& { return t.mean_square_phase; });
  column(
      "resolved", "0 or 1", [](auto& t) -> auto& { return t.resolved; });
  column(
      "faint", "0 or 1", [](auto& t) -> auto& { return t.faint; });
  column(
      "why_not", "", [](auto& t) -> auto& { return t.why_not; });
}

template <class Column>
void source_columns(Column const& column) {
  column(
      "source", "", [](auto& s) -> auto& { return s.name; });
  column(
      "statement", "", [](auto& s) -> auto& { return s.statement; });
  column(
      "source_low", "1", [](auto& s) -> auto& { return s.low; });
  column(
      "source_high", "1", [](auto& s) -> auto& { return s.high; });
  column(
      "source_share", "1", [](auto& s) -> auto& { return s.share; });
}

void write_routes(hdf5::Writer& out, std::vector<NoiseTrace> const& routes, std::size_t bins) {
  for (TraceColumn const& curve : curves) {
    Doubles all;
    for (NoiseTrace const& t : routes) append_bins(all, t.*(curve.member), bins, t.name);
    out.array(std::string("/noise/routes/") + curve.name, all, strain, {routes.size(), bins});
  }
  Doubles shares;
  for (NoiseTrace const& t : routes) append_bins(shares, or_unknown(t.linear_share, bins), bins, t.name);
  out.array(std::string("/noise/routes/") + linear_share, shares, "1", {routes.size(), bins});
  for (TraceColumn const& band : route_bands) {
    Doubles all;
    for (NoiseTrace const& t : routes) append_bins(all, or_unknown(t.*(band.member), bins), bins, t.name);
    out.array(std::string("/noise/routes/") + band.name, all, strain, {routes.size(), bins});
  }
  route_columns_of_noise(ColumnWriter(out, "/noise/routes", routes));
}

void write_design(hdf5::Writer& out, std::vector<DesignCurve> const& design, std::size_t bins) {
  std::vector<std::string> names;
  Doubles all;
  for (DesignCurve const& d : design) {
    names.push_back(d.name);
    append_bins(all, d.asd, bins, d.name);
  }
  out.strings("/noise/design/name", names);
  out.array("/noise/design/asd", all, strain, {design.size(), bins});
}

void write_bands(hdf5::Writer& out, NoiseBands const& bands, std::size_t bins) {
  out.group("/noise/bands", "beside the Monte-Carlo error of the total: what inputs and static phases leave open");
  for (BandColumn const& column : band_columns) {
    Doubles checked;
    append_bins(checked, bands.*(column.member), bins, column.name);
    out.array(std::string("/noise/bands/") + column.name, checked, strain);
  }
  source_columns(ColumnWriter(out, "/noise/bands", bands.sources));
  out.strings("/noise/bands/taken_as_exact", bands.taken_as_exact);
}

NoiseBands read_bands(hdf5::Reader const& in, std::size_t bins) {
  NoiseBands bands;
  for (BandColumn const& column : band_columns)
    bands.*(column.member) = in.rows<double>(std::string("/noise/bands/") + column.name, bins);
  bands.sources.resize(in.strings("/noise/bands/source").size());
  source_columns(ColumnReader(in, "/noise/bands", bands.sources));
  bands.taken_as_exact = in.strings("/noise/bands/taken_as_exact");
  return bands;
}

Doubles slice(Doubles const& all, std::size_t row, std::size_t bins) {
  auto const begin = all.begin() + std::ptrdiff_t(row * bins);
  return {begin, begin + std::ptrdiff_t(bins)};
}

void read_routes(hdf5::Reader const& in, NoiseBudget& b) {
  b.routes.resize(in.array<std::uint64_t>("/noise/routes/hash").size());
  std::size_t const n = b.routes.size(), bins = b.grid.size();
  route_columns_of_noise(ColumnReader(in, "/noise/routes", b.routes));
  for (TraceColumn const& curve : curves) {
    Doubles const all = in.rows<double>(std::string("/noise/routes/") + curve.name, n, bins);
    for (std::size_t i = 0; i < n; ++i) b.routes[i].*(curve.member) = slice(all, i, bins);
  }
  TraceColumn const later[] = {{linear_share, &NoiseTrace::linear_share}, route_bands[0], route_bands[1]};
  for (TraceColumn const& curve : later) {
    std::string const place = std::string("/noise/routes/") + curve.name;
    if (!in.has(place)) continue;
    Doubles const all = in.rows<double>(place, n, bins);
    for (std::size_t i = 0; i < n; ++i) b.routes[i].*(curve.member) = slice(all, i, bins);
  }
}

void read_total(hdf5::Reader const& in, NoiseTrace& total, std::size_t bins) {
  total.name = in.attribute_text("/noise/total", "name");
  total.mean_square_phase = in.attribute_number("/noise/total", "mean_square_phase");
  total.resolved = in.attribute_count("/noise/total", "resolved") != 0;
  total.why_not = in.attribute_text("/noise/total", "why_not");
  for (TraceColumn const& curve : curves)
    total.*(curve.member) = in.rows<double>(std::string("/noise/total/") + curve.name, bins);
  for (TraceColumn const& part : error_columns) {
    std::string const place = std::string("/noise/total/") + part.name;
    if (in.has(place)) total.*(part.member) = in.rows<double>(place, bins);
  }
  if (in.has(std::string("/noise/total/") + linear_share))
    total.linear_share = in.rows<double>(std::string("/noise/total/") + linear_share, bins);
}

}  // namespace

void write_noise(hdf5::Writer& out, NoiseBudget const& b) {
  std::size_t const bins = b.grid.size();
  out.group("/noise", "one-sided strain amplitude spectral densities, mean over static phases");
  out.attribute("/noise", "margin", b.margin);
  out.attribute("/noise", "unresolved_hint", b.unresolved_hint);
  out.attribute("/noise", "faint_share", b.faint_share);
  Doubles centres;
  for (std::size_t i = 0; i < bins; ++i) centres.push_back(b.grid.centre(i));
  out.array("/noise/frequency_edges", b.grid.edges, "Hz");
  out.array("/noise/frequency", centres, "Hz");
  out.strings("/noise/unresolved", b.unresolved);
  out.strings("/noise/faint", b.faint);
  out.strings("/noise/warnings", b.warnings);
  out.group("/noise/total",
            "all resolved routes, and what was seen of the others; a lower bound when /noise/unresolved is not empty");
  out.attribute("/noise/total", "name", b.total.name);
  out.attribute("/noise/total", "mean_square_phase", b.total.mean_square_phase);
  out.attribute("/noise/total", "resolved", std::vector<std::uint64_t>{b.total.resolved});
  out.attribute("/noise/total", "why_not", b.total.why_not);
  for (TraceColumn const& curve : curves) {
    Doubles checked;
    append_bins(checked, b.total.*(curve.member), bins, "total");
    out.array(std::string("/noise/total/") + curve.name, checked, strain);
  }
  for (TraceColumn const& part : error_columns) {
    Doubles checked;
    append_bins(checked, or_unknown(b.total.*(part.member), bins), bins, "total");
    out.array(std::string("/noise/total/") + part.name, checked, strain);
  }
  Doubles shares;
  append_bins(shares, or_unknown(b.total.linear_share, bins), bins, "total");
  out.array(std::string("/noise/total/") + linear_share, shares, "1");
  out.array("/noise/total/bound_share", b.total.bound_share.empty() ? Doubles(bins) : b.total.bound_share, "1");
  out.group("/noise/routes", "one row per row of /classes");
  write_routes(out, b.routes, bins);
  out.group("/noise/design", "curves to compare with, on the centres of the bins");
  write_design(out, b.design, bins);
  if (b.bands.made()) write_bands(out, b.bands, bins);
}

NoiseBudget read_noise(hdf5::Reader const& in) {
  NoiseBudget b;
  b.grid.edges = in.array<double>("/noise/frequency_edges");
  std::size_t const bins = b.grid.size();
  b.margin = in.attribute_number("/noise", "margin");
  b.unresolved_hint = in.attribute_number("/noise", "unresolved_hint");
  b.unresolved = in.strings("/noise/unresolved");
  b.faint_share = in.attribute_number("/noise", "faint_share");
  b.faint = in.strings("/noise/faint");
  if (in.has("/noise/warnings")) b.warnings = in.strings("/noise/warnings");
  read_total(in, b.total, bins);
  read_routes(in, b);
  std::vector<std::string> const names = in.strings("/noise/design/name");
  Doubles const all = in.rows<double>("/noise/design/asd", names.size(), bins);
  for (std::size_t i = 0; i < names.size(); ++i) b.design.push_back({names[i], slice(all, i, bins)});
  if (in.has("/noise/bands")) b.bands = read_bands(in, bins);
  return b;
}

}  // namespace straytrace::results
